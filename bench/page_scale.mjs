// node bench/page_scale.mjs URL [--api]: measures the triage page on a large index (make-large-index), served at URL, as
// JSON: the API's answers (ms), the time to the first list (ms), and the longest task of the page's main thread (ms)
// while the list is scrolled and the map is panned and zoomed. --api: the answers alone, without a browser. Needs
// /usr/bin/chromium and web/node_modules. bench/page_scale.py makes the index and serves it, also in PostgreSQL.
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const require = createRequire(fileURLToPath(new URL("../web/package.json", import.meta.url)));
const { chromium } = require("playwright-core");

const url = process.argv[2];
const isApiOnly = process.argv[3] === "--api";
const API = `${url}/api/v1`;

/** The value that a fraction of the sorted values does not exceed. */
const quantile = (values, part) => [...values].sort((a, b) => a - b)[Math.min(Math.floor(part * values.length), values.length - 1)];
const summary = (values) => ({
  n: values.length, median: +quantile(values, 0.5).toFixed(1), p99: +quantile(values, 0.99).toFixed(1), max: +Math.max(...values).toFixed(1),
});

let seed = 7;
const random = () => (seed = (seed * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;

/** The queries of a person who reviews, in turn; each a few times with other values. */
async function measureApi() {
  const { objects } = await (await fetch(`${API}/objects?limit=1000`)).json();
  const { models } = await (await fetch(`${API}/project`)).json();
  const some = (list) => list[Math.floor(random() * list.length)];
  const tile = (zoom) => {
    const { longitude_deg: east, latitude_deg: north } = some(objects.filter((one) => one.place)).place;
    const side = 2 ** zoom;
    const angle = (north * Math.PI) / 180;
    const x = Math.floor((east / 360 + 0.5) * side);
    return `/tiles/${zoom}/${x}/${Math.floor((0.5 - Math.asinh(Math.tan(angle)) / (2 * Math.PI)) * side)}`;
  };
  const queries = {
    project: () => "/project",
    videos: () => "/videos",
    videos_showing: () => {
      const { latitude_deg, longitude_deg } = some(objects.filter((one) => one.place)).place;
      return `/videos?shows=${latitude_deg},${longitude_deg}`;
    },
    thresholds: () => "/thresholds",
    first_page: () => "/objects?sort=queue&limit=100&offset=0",
    deep_page: () => `/objects?sort=queue&limit=100&offset=${100 * Math.floor(random() * 490)}`,
    next_match: () => `/objects?sort=queue&after=${some(objects).id}&limit=1&model=${some(models).name}&min_score=0.5`,
    around: () => `/objects?sort=rank&around=${some(objects).id}&limit=100`,
    counts: () => `/objects/counts?min_score=${random().toFixed(2)}&q=barn`,
    of_video: () => `/objects?video=${1 + Math.floor(random() * 1000)}&limit=200&offset=0`,
    object: () => `/objects/${some(objects).id}`,
    sightings: () => `/videos/${1 + Math.floor(random() * 1000)}/sightings?from=${Math.floor(random() * 500)}&to=600&limit=2000`,
    of_object: () => `/objects/${some(objects).id}/sightings?limit=100`,
    decisions: () => `/objects/${some(objects).id}/decisions`,
    tile_world: () => "/tiles/0/0/0",
    tile_filtered: () => `/tiles/0/0/0?min_score=${random().toFixed(2)}`,
    tile_low: () => tile(Math.floor(random() * 6)),
    tile_high: () => tile(6 + Math.floor(random() * 12)),
  };
  const times = Object.fromEntries(Object.keys(queries).map((name) => [name, []]));
  for (let round = 0; round < 60; round++) {
    for (const [name, make] of Object.entries(queries)) {
      const begin = performance.now();
      const answer = await fetch(API + make());
      await answer.arrayBuffer();
      if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
      times[name].push(performance.now() - begin);
    }
  }
  return { ...Object.fromEntries(Object.entries(times).map(([name, all]) => [name, summary(all)])), all: summary(Object.values(times).flat()) };
}

/** Returns a function that waits until nothing was loaded for half a second, but for the stream of events. */
function watch(page) {
  const open = new Set();
  let quietSince = performance.now();
  const isStream = (request) => request.url().endsWith("/api/v1/events");
  const ended = (request) => {
    if (open.delete(request)) quietSince = performance.now();
  };
  page.on("request", (request) => !isStream(request) && open.add(request));
  page.on("requestfinished", ended);
  page.on("requestfailed", ended);
  return async () => {
    const begun = performance.now();
    while (open.size > 0 || performance.now() - quietSince < 500) {
      if (performance.now() - begun > 60_000) throw new Error(`still loading: ${[...open].map((one) => one.url()).slice(0, 5)}`);
      await page.waitForTimeout(50);
    }
  };
}

async function measurePage() {
  const browser = await chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking"],
  });
  try {
    const firstLists = [];
    let page;
    let settle;
    for (let i = 0; i < 5; i++) {
      await page?.close();
      page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
      await page.addInitScript(() => {
        window.longTasks = [];
        new PerformanceObserver((list) => {
          for (const { startTime, duration } of list.getEntries()) window.longTasks.push({ startTime, duration });
        }).observe({ type: "longtask", buffered: true });
        new MutationObserver(() => {
          if (window.firstList === undefined && document.querySelector("[role=option]")) window.firstList = performance.now();
        }).observe(document, { childList: true, subtree: true });
      });
      settle = watch(page);
      await page.goto(url, { waitUntil: "commit" });
      await page.waitForFunction(() => window.firstList !== undefined);
      firstLists.push(await page.evaluate(() => window.firstList));
    }
    await page.waitForSelector(".map .canvas[data-ready=true]");
    await settle();
    const startTasks = await page.evaluate(() => window.longTasks.splice(0).map((one) => one.duration));
    const tasksOf = async (act) => {
      await act();
      await settle();
      const found = await page.evaluate(() => window.longTasks.splice(0).map((one) => one.duration));
      return { longest: Math.max(0, ...found), over_50: found.length };
    };
    const list = await page.locator(".rows").boundingBox();
    const map = await page.locator(".map").boundingBox();
    const middle = { x: map.x + map.width / 2, y: map.y + map.height / 2 };
    const scroll = await tasksOf(async () => {
      await page.mouse.move(list.x + 50, list.y + 100);
      for (let i = 0; i < 60; i++) await page.mouse.wheel(0, i % 10 === 9 ? 50_000 : 600);
    });
    const pan = await tasksOf(async () => {
      for (let i = 0; i < 8; i++) {
        await page.mouse.move(middle.x, middle.y);
        await page.mouse.down();
        for (let step = 1; step <= 12; step++) await page.mouse.move(middle.x + (i % 2 ? 8 : -8) * step, middle.y + 4 * step);
        await page.mouse.up();
      }
    });
    const zoom = await tasksOf(async () => {
      await page.mouse.move(middle.x, middle.y);
      for (let i = 0; i < 24; i++) await page.mouse.wheel(0, i < 12 ? -240 : 240);
    });
    return { first_list: summary(firstLists), start_longest: Math.max(0, ...startTasks), scroll, pan, zoom };
  } finally {
    await browser.close();
  }
}

console.log(JSON.stringify({ api: await measureApi(), ...(isApiOnly ? {} : { page: await measurePage() }) }, null, 1));
