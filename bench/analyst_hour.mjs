// node bench/analyst_hour.mjs DEMO_URL LARGE_URL INPUTS: the browser's part of analyst_hour.py, which says what it does.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const require = createRequire(fileURLToPath(new URL("../web/package.json", import.meta.url)));
const { chromium } = require("playwright-core");

const [demoUrl, largeUrl, inputs] = process.argv.slice(2);
const { one, other, photo, frame, box, shots } = JSON.parse(inputs);
const REVIEWS = 200;
const SELECTED = "[role=option][aria-selected=true]";

const seconds = {};
let page;
const api = async (path) => (await page.request.get(`/api/v1${path}`)).json();

/** Waits for what the server says. */
async function until(path, test) {
  while (!test(await api(path))) await new Promise((resolve) => setTimeout(resolve, 200));
}

async function step(name, run) {
  const begin = performance.now();
  const result = await run();
  seconds[name] = +((performance.now() - begin) / 1000).toFixed(2);
  if (shots) await page.screenshot({ path: `${shots}/${String(Object.keys(seconds).length).padStart(2, "0")}-${name}.png` });
  return result;
}

const shownFrame = (wanted) =>
  page.waitForFunction((text) => document.querySelector(".stage canvas")?.dataset.frame === text, String(wanted), { timeout: 60_000 });

async function openDemo() {
  await page.goto("/");
  await page.waitForSelector("[role=option]");
}

/** Each object by J: the frame that shows it best, or the present one where that shows it, too. */
async function findObjects() {
  const { objects } = await api("/objects?sort=queue");
  for (const [i, object] of objects.entries()) {
    if (i > 0) await page.keyboard.press("j");
    await page.waitForSelector(`#object-${object.id}[aria-selected=true]`);
    const { best } = await api(`/objects/${object.id}`);
    const { times_s: times } = await api(`/videos/${best.video_id}/times`);
    await page.waitForFunction(([all, moments]) => {
      const time = all[Number(document.querySelector(".stage canvas")?.dataset.frame)];
      return moments.some((one) => time >= one.first_time_s - 1e-3 && time <= one.last_time_s + 1e-3);
    }, [times, object.moments], { timeout: 60_000 });
  }
  return objects.length;
}

async function addVideos() {
  await page.getByRole("button", { name: "Add" }).click();
  await page.setInputFiles("input[type=file]", [one, other]);
  for (const name of ["one.mp4", "other.mp4"]) await page.waitForSelector(`.job.done:has(strong:text-is("${name}"))`);
}

/** Boxes the thing in its frame and opens what can be done with it. */
async function boxIt() {
  const { videos } = await api("/videos");
  const video = videos.find((each) => each.name.endsWith("one.mp4"));
  const { times_s: times } = await api(`/videos/${video.id}/times`);
  await page.goto(`/?video=${video.id}&t=${times[frame]}`);
  await shownFrame(frame);
  const at = await page.evaluate(([width, height]) => {
    const area = document.querySelector(".stage canvas").getBoundingClientRect();
    const scale = Math.min(area.width / width, area.height / height);
    return { scale, x: area.x + (area.width - width * scale) / 2, y: area.y + (area.height - height * scale) / 2 };
  }, [video.width_px, video.height_px]);
  const corner = (x, y) => [at.x + x * at.scale, at.y + y * at.scale];
  await page.keyboard.press("b");
  await page.mouse.move(...corner(box[0], box[1]));
  await page.mouse.down();
  await page.mouse.move(...corner(box[0] + box[2], box[1] + box[3]), { steps: 4 });
  await page.mouse.up();
  await page.waitForSelector("dialog.model[open]");
  return videos;
}

async function findElsewhere() {
  const videos = await boxIt();
  const wanted = videos.find((each) => each.name.endsWith("other.mp4")).id;
  await page.fill("#model-name", "crate");
  await page.getByRole("button", { name: "Make the model" }).click();
  await until(`/objects?model=crate&video=${wanted}`, ({ objects }) => objects.length > 0);
  await page.keyboard.press("/");
  await page.keyboard.type("crate");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => document.querySelectorAll("[role=option]:not(.greyed)").length > 0);
}

async function follow() {
  await boxIt();
  await page.getByRole("button", { name: "Follow it in this video" }).click();
  await page.getByRole("button", { name: "Follow it", exact: true }).click();
  await page.waitForSelector(".timeline .moment.followed", { timeout: 600_000 });
}

async function dropPhoto() {
  const data = await page.evaluateHandle((bytes) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], "truck.png"));
    return transfer;
  }, readFileSync(photo).toString("base64"));
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
  await page.waitForSelector("dialog.model[open]");
  await page.getByRole("button", { name: "Make the model" }).click();
  await until("/objects?model=truck", ({ objects }) => objects.length > 0);
}

/** Around the southern half of what has a place. */
async function drawArea() {
  await openDemo();
  const { objects } = await api("/objects?limit=1000");
  const places = objects.flatMap((each) => each.place ?? []).sort((a, b) => a.latitude_deg - b.latitude_deg);
  const half = places.slice(0, Math.ceil(places.length / 2));
  const reach = 2e-5;
  const range = (name) => [Math.min(...half.map((each) => each[name])) - reach, Math.max(...half.map((each) => each[name])) + reach];
  const [[south, north], [west, east]] = [range("latitude_deg"), range("longitude_deg")];
  await page.keyboard.press("d");
  await page.fill("#area-corners", `${south},${west} ${north},${east}`);
  await page.keyboard.press("Enter");
  await page.waitForFunction((text) => document.querySelector(".list h2")?.textContent?.startsWith(text), `${half.length} of`);
  return half.length;
}

async function saveAs(kind) {
  await page.getByRole("button", { name: "Save" }).click();
  await page.getByRole("menuitem", { name: { csv: "Table (CSV)", geojson: "Map (GeoJSON)" }[kind] }).click();
}

async function exportList(count) {
  for (const kind of ["csv", "geojson"]) {
    const [file] = await Promise.all([page.waitForEvent("download"), saveAs(kind)]);
    const text = readFileSync(await file.path(), "utf8");
    assert.equal(kind === "csv" ? text.trim().split("\r\n").length - 1 : JSON.parse(text).features.length, count, kind);
  }
}

/** By A and X in turn: an item ends when the next one is selected, all of them when the server has every decision. */
async function review() {
  const { accepted, rejected } = await api("/objects/counts");
  const before = accepted + rejected;
  const times = [];
  for (let i = 0; i < REVIEWS; i++) {
    const id = await page.locator(SELECTED).getAttribute("id");
    const begin = performance.now();
    await page.keyboard.press(i % 2 ? "x" : "a");
    await page.waitForFunction(([selector, last]) => {
      const now = document.querySelector(selector);
      return now !== null && now.id !== last;
    }, [SELECTED, id]);
    times.push(performance.now() - begin);
  }
  await until("/objects/counts", ({ accepted, rejected }) => accepted + rejected >= before + REVIEWS);
  return times.sort((a, b) => a - b);
}

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking"],
});
try {
  const newPage = async (baseURL) => {
    const made = await (await browser.newContext({ baseURL, viewport: { width: 1280, height: 720 }, colorScheme: "dark" })).newPage();
    made.setDefaultTimeout(600_000);
    return made;
  };
  page = await newPage(demoUrl);
  await step("open", openDemo);
  const found = await step("find-the-objects", findObjects);
  await step("add-two-videos", addVideos);
  await step("box-and-find-elsewhere", findElsewhere);
  await step("follow", follow);
  await step("drop-a-photo", dropPhoto);
  const inside = await step("draw-an-area", drawArea);
  await step("export", () => exportList(inside));
  page = await newPage(largeUrl);
  await step("open-a-queue", openDemo);
  const times = await step("review-200", review);
  const ms = (part) => Math.round(times[Math.min(Math.floor(part * times.length), times.length - 1)]);
  console.log(JSON.stringify({ objects: found, in_area: inside, seconds, review_ms: { median: ms(0.5), max: ms(1) } }, null, 2));
} finally {
  await browser.close();
}
