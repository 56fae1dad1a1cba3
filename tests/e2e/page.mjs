// Drives the page in Chromium for test_page.py: node page.mjs SCENARIO URL. Prints what fails and exits with 1; exits with
// 77 if there is no browser.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const require = createRequire(fileURLToPath(new URL("../../web/package.json", import.meta.url)));
const { chromium } = require("playwright-core");

const AXE = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const BROWSER = "/usr/bin/chromium";
const FLAGS = [
  "--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];
// Drawn in software, a map costs more than all that the other scenarios check: without WebGL the page says so, and works.
const WITH_MAP = ["triage", "many", "tiles", "accessible", "videos", "narrow"];
const ORANGE = [230, 159, 0]; // of the first model (state.ts)
const SELECTED = "[role=option][aria-selected=true]";

const api = async (page, path) => (await page.request.get(`/api/v1${path}`)).json();

/** Waits for what the server says: waitForFunction does not wait for what an async function promises. */
async function until(page, path, test) {
  const end = Date.now() + 120_000;
  while (!test(await api(page, path))) {
    assert.ok(Date.now() < end, `${path} does not become what is waited for`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}
/** Waits until what is read is, or matches, what is wanted: the page draws after the event that changes it. */
async function becomes(read, wanted, what) {
  const fits = (value) => (wanted instanceof RegExp ? wanted.test(value ?? "") : value === wanted);
  const end = Date.now() + 30_000;
  for (let value = await read(); !fits(value); value = await read()) {
    assert.ok(Date.now() < end, `${what ?? read}: ${value} instead of ${wanted}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}
const shownFrame = (page) => page.evaluate(() => Number(document.querySelector(".stage canvas").dataset.frame ?? NaN));
const selectedId = async (page) => Number((await page.locator(SELECTED).getAttribute("id")).replace("object-", ""));

/**
 * Answers requests of the page by `handler` from now on. The browser intercepts some time after it was told to, and lets
 * pass what the page asks meanwhile: requests are tried until one is intercepted.
 */
async function intercept(page, pattern, handler, options) {
  const probe = "**/intercepted";
  await page.route(pattern, handler, options);
  await page.route(probe, (route) => route.fulfill({ status: 204 }));
  await becomes(() => page.evaluate(async () => (await fetch("/intercepted")).status), 204, "requests are intercepted");
  await page.unroute(probe);
}

async function waitForFrame(page, frame) {
  await page.waitForFunction(
    (wanted) => document.querySelector(".stage canvas")?.dataset.frame === String(wanted), frame, { timeout: 60_000 },
  );
}

/** Saves the list by its menu, which downloads nothing before an item is chosen. */
async function saveAs(page, item) {
  await page.locator(".list .menu > button").focus();
  await page.keyboard.press("ArrowDown");
  await page.waitForFunction(() => document.activeElement.role === "menuitem");
  await page.getByRole("menuitem", { name: item }).click();
  await page.getByRole("menu").waitFor({ state: "detached" });
}

/** axe finds nothing in what is shown now, in the dark nor in the light. */
async function checkAccessible(page, what) {
  if (!(await page.evaluate(() => "axe" in window))) await page.evaluate(AXE);
  for (const theme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme: theme });
    await page.waitForFunction((wanted) => document.documentElement.dataset.theme === wanted, theme);
    // Colours change within a moment.
    await page.evaluate(() => Promise.all(document.getAnimations().map((one) => one.finished.catch(() => undefined))));
    const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    const told = violations.map(({ id, help, nodes }) => `${id}: ${help}\n${nodes.map((one) => `    ${one.html.slice(0, 160)} ${one.failureSummary.replace(/\s+/g, " ").slice(0, 240)}`).join("\n")}`);
    assert.deepEqual(told, [], `${what}, ${theme}: ${told.length} faults:\n${told.join("\n")}`);
  }
}

async function open(page, path) {
  await page.goto(path);
  await page.waitForSelector(".stage canvas[data-frame]");
}

/** The same once it stands still; null if there is none or it keeps moving. */
async function findStillOnMap(page, colour, below = 0) {
  let before = null;
  for (let tries = 0; tries < 30; tries++) {
    const found = await findOnMap(page, colour, below);
    if (found && before && Math.hypot(found.x - before.x, found.y - before.y) < 1) return found;
    before = found;
    await page.waitForTimeout(200);
  }
  return null;
}

/** The middle of the northernmost mark of a colour on the map, `below` px from its top on, in the page; null if there is none. */
async function findOnMap(page, [red, green, blue], below = 0) {
  await page.waitForSelector(".map .canvas[data-ready=true]");
  const box = await page.locator(".map").boundingBox();
  const image = (await page.screenshot({ clip: box })).toString("base64");
  const found = await page.evaluate(
    async ([bytes, wanted, below]) => {
      const picture = new Image();
      picture.src = `data:image/png;base64,${bytes}`;
      await picture.decode();
      const canvas = new OffscreenCanvas(picture.width, picture.height);
      const context = canvas.getContext("2d");
      context.drawImage(picture, 0, 0);
      const { data } = context.getImageData(0, 0, picture.width, picture.height);
      let [count, x, y] = [0, 0, 0];
      let top = null;
      for (let at = 4 * picture.width * below; at < data.length; at += 4) {
        if (wanted.some((value, i) => Math.abs(data[at + i] - value) > 6)) continue;
        const here = { x: (at / 4) % picture.width, y: Math.floor(at / 4 / picture.width) };
        top ??= here;
        if (Math.hypot(here.x - top.x, here.y - top.y) > 30) continue;
        count++;
        x += here.x;
        y += here.y;
      }
      return count < 20 ? null : { x: x / count, y: y / count };
    },
    [image, [red, green, blue], below],
  );
  return found && { x: box.x + found.x, y: box.y + found.y };
}

/** Where hovering over the map shows a text: looked for in rows from the south: the camera of this test flies north. */
async function findTip(page, pattern) {
  const box = await page.locator(".map").boundingBox();
  const places = [0.8, 0.7, 0.6, 0.5, 0.4].flatMap((part) =>
    Array.from({ length: 20 }, (_, i) => [Math.round(box.x + box.width / 2 + 10 * (i - 10)), Math.round(box.y + part * box.height)]),
  );
  for (const [x, y] of places) {
    await page.mouse.move(x, y);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    const tip = page.locator(".map .tip");
    const found = (await tip.count()) > 0 ? pattern.exec(await tip.innerText()) : null;
    if (found) return { x, y, found };
  }
  return assert.fail(`no line on the map shows ${pattern}`);
}

/** An area filters the list and the address, drawn by coordinates and by mouse. */
async function checkArea(page, objects, only, marker) {
  const countText = () => page.locator(".list h2").innerText();
  const waitForCount = (count) =>
    page.waitForFunction((text) => document.querySelector(".list h2")?.textContent?.startsWith(text), `${count} of`);
  const { latitude_deg: latitude, longitude_deg: longitude } = only.place;
  const half = 1e-5;
  await page.keyboard.press("d");
  await page.fill("#area-corners", "52.5");
  await becomes(() => page.locator("#area-corners").getAttribute("aria-invalid"), "true");
  await page.fill("#area-corners", `${latitude - half},${longitude - half} ${latitude + half},${longitude + half}`);
  await page.keyboard.press("Enter");
  await waitForCount(1);
  await becomes(() => page.locator("[role=option].greyed").count(), objects.length - 1);
  await page.waitForFunction(() => location.search.includes("area="));
  await open(page, page.url());
  await waitForCount(1);
  await page.getByRole("button", { name: "in the area" }).click();
  await page.waitForFunction(() => !location.search.includes("area="));
  await becomes(() => countText(), `${objects.length} objects`);

  await page.waitForSelector(".map .canvas[data-ready=true]");
  await page.click(`#object-${only.id}`);
  const [from, to] = [-12, 12].map((by) => ({ x: marker.x + by, y: marker.y + by }));
  await page.keyboard.press("d");
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(marker.x, marker.y);
  await page.mouse.move(to.x, to.y);
  await page.mouse.up();
  await page.waitForSelector(".map form.area", { state: "detached" });
  await page.waitForFunction(() => location.search.includes("area="));
  await page.getByText("Clear filters").click();
}

/** From a sighting of the selected object to the next one that was recognised: a tracked one need not match. */
async function toRecognised(page, object) {
  const { sightings } = await api(page, `/objects/${object.id}/sightings`);
  const frames = sightings.map((one) => one.frame);
  await page.waitForFunction((wanted) => wanted.includes(Number(document.querySelector(".stage canvas").dataset.frame)), frames);
  for (let i = frames.indexOf(await shownFrame(page)); sightings[i].source !== "recognised"; i++) {
    await page.keyboard.press("]");
    await waitForFrame(page, frames[i + 1]);
  }
}

/** Why an object was found: its matches stage by stage, by keyboard; an error that is shown. */
async function checkEvidence(page, object) {
  await page.click(`#object-${object.id}`);
  const { best } = await api(page, `/objects/${object.id}`);
  await page.evaluate(() => document.activeElement?.blur());
  await toRecognised(page, object);
  await page.keyboard.press("w");
  await page.waitForSelector("dialog.why[open] .evidence svg");
  const frame = (await page.locator("#why-title small").innerText()).match(/frame ([\d,]+)/)[1].replaceAll(",", "");
  const evidence = await api(page, `/objects/${object.id}/evidence?video=${best.video_id}&frame=${frame}`);
  const numbers = await page.locator("dialog.why .stage-choice strong").allInnerTexts();
  assert.deepEqual(numbers.map((one) => Number(one.replaceAll(",", ""))), evidence.stages.map((one) => one.matches));
  const inliers = evidence.stages.at(-1).matches;
  assert.ok(inliers >= 5 && evidence.pose, "the pose is found again");
  // How the matches cover the object, in words and on the view.
  await becomes(() => page.locator("dialog.why .cover-text").innerText(), /^The matches span \d+ % of the object\.$/);
  await becomes(() => page.locator(".evidence polygon.cover").count(), 1);
  // What all of its sightings say.
  await becomes(() => page.locator("dialog.why .whole-object li.muted").first().innerText(), /^Recognised in [\d,]+ of [\d,]+ frames?/);
  // The last stage is shown at first: what survived. The arrow keys go through the others.
  await becomes(() => page.locator(".evidence .match.inlier").count(), inliers);
  await becomes(() => page.locator(".evidence .match:not(.inlier)").count(), 0);
  await page.locator("dialog.why input[type=radio]:checked").focus();
  for (let i = 1; i < numbers.length; i++) await page.keyboard.press("ArrowLeft");
  await page.getByLabel("Whole frame").check();
  await page.waitForFunction(
    (count) => document.querySelectorAll(".evidence .match").length === count, evidence.stages[0].matches,
  );
  await page.getByLabel("Lines").uncheck();
  await becomes(() => page.locator(".evidence .match line").count(), 0);
  await page.getByLabel("Lines").check();
  for (const image of await page.locator(".evidence image").all()) {
    const address = await image.getAttribute("href");
    assert.equal((await page.request.get(address)).status(), 200, address);
  }
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.why[open]", { state: "detached" });
  // Matches of one small patch speak against it.
  const [corner] = evidence.view.outline;
  const patch = evidence.matches.map((one, i) => ({ ...one, template: [corner[0] + (i % 3), corner[1] + (i % 2)] }));
  await intercept(page, "**/evidence*", (route) => route.fulfill({ json: { ...evidence, matches: patch } }));
  await page.getByRole("button", { name: "why", exact: true }).click();
  await page.locator("dialog.why .cover-text.doubt", { hasText: `All ${inliers} matches lie in one small patch` }).waitFor();
  await checkAccessible(page, "a doubt");
  await page.unroute("**/evidence*");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.why[open]", { state: "detached" });
  // Another model at the same part of the frame is named. Where that cannot be had, the evidence stands.
  const { objects } = await api(page, "/objects");
  const other = objects.find((one) => one.model_id !== object.model_id && one.review?.verdict !== "rejected");
  const rival = { ...evidence.sighting, object_id: other.id, model_id: other.model_id, score: 0.41 };
  for (const answer of [{ status: 404 }, { json: { sightings: [evidence.sighting, rival], truncated: false } }]) {
    const asked = page.waitForResponse((one) => one.url().includes(`/videos/${best.video_id}/sightings`));
    await intercept(page, "**/videos/*/sightings*", (route) => route.fulfill(answer));
    await page.getByRole("button", { name: "why", exact: true }).click();
    await page.waitForSelector("dialog.why[open] .evidence svg");
    await asked;
    if (!answer.status) continue;
    assert.equal(await page.locator("dialog.why .rivals").count(), 0);
    await page.keyboard.press("Escape");
    await page.waitForSelector("dialog.why[open]", { state: "detached" });
    await page.unroute("**/videos/*/sightings*");
  }
  await becomes(() => page.locator("dialog.why .rivals").innerText(), `Also explained by: ${other.model} 0.41`);
  await page.unroute("**/videos/*/sightings*");
  await checkAccessible(page, "rivals");
  await page.locator("dialog.why .rivals button").click();
  await becomes(() => selectedId(page), other.id);
  await page.waitForSelector("dialog.why[open]", { state: "detached" });
  await page.click(`#object-${object.id}`);
  await toRecognised(page, object);
  // An error says what is missing.
  await intercept(page, "**/evidence*", (route) => route.fulfill({ status: 404, json: { code: "not_found", message: "the video is not there", field: null } }));
  await page.getByRole("button", { name: "why", exact: true }).click();
  await page.locator("dialog.why [role=alert]", { hasText: "the video is not there" }).waitFor();
  await page.unroute("**/evidence*");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.why[open]", { state: "detached" });
}

/** The names in a frame are drawn after all lines: no trail strikes out a name. */
async function checkOverlay(page) {
  const frame = await shownFrame(page);
  await page.evaluate(() => {
    const prototype = CanvasRenderingContext2D.prototype;
    window.drawn = [];
    for (const name of ["drawImage", "stroke", "fillText"]) {
      const original = prototype[name];
      prototype[name] = function (...values) {
        if (this.canvas.closest(".stage")) window.drawn.push(name);
        return original.apply(this, values);
      };
    }
  });
  await page.keyboard.press(",");
  await waitForFrame(page, frame - 1);
  const drawn = await page.evaluate(() => window.drawn);
  const last = drawn.slice(drawn.lastIndexOf("drawImage"));
  assert.ok(last.includes("fillText") && last.includes("stroke"), `nothing is drawn over the frame: ${drawn}`);
  assert.ok(last.lastIndexOf("stroke") < last.indexOf("fillText"), `lines over names: ${last}`);
  await page.keyboard.press(".");
  await waitForFrame(page, frame);
}

/** The time line by keys, like any slider. */
async function checkTimeKeys(page) {
  const { times_s: times } = await api(page, "/videos/1/times");
  await page.getByRole("slider", { name: "Time" }).focus();
  for (const [key, frame] of [["Home", 0], ["ArrowUp", 1], ["ArrowDown", 0], ["End", times.length - 1]]) {
    await page.keyboard.press(key);
    await waitForFrame(page, frame);
  }
  await page.keyboard.press("PageDown");
  const wanted = 0.9 * times.at(-1);
  await waitForFrame(page, times.reduce((best, one, i) => (Math.abs(one - wanted) < Math.abs(times[best] - wanted) ? i : best), 0));
  await page.evaluate(() => document.activeElement.blur());
}

/** A place without a radius is one of 200 m; what is not complete says what is missing. */
async function checkNear(page, object) {
  const { latitude_deg: latitude, longitude_deg: longitude } = object.place;
  await page.fill("#search", `near ${latitude},`);
  await page.locator(".hint", { hasText: "latitude and longitude" }).waitFor();
  await page.fill("#search", `near ${latitude} ${longitude}`);
  await page.locator(".hint", { hasText: "200 m" }).waitFor();
  await becomes(() => page.locator(`#object-${object.id}.greyed`).count(), 0);
  await page.fill("#search", "");
}

/** What is printed: the list with places, the map with north and scale, from what index and when. The page stays as it is. */
async function checkPrint(page, objects) {
  const stored = () => page.evaluate(() => [localStorage.getItem("theme"), document.documentElement.dataset.theme]);
  const before = await stored();
  await page.evaluate(() => {
    window.print = () => {
      window.dispatchEvent(new Event("beforeprint"));
      window.isPrinting = true;
      window.printedRows = document.querySelectorAll(".print-sheet tbody tr").length;
    };
  });
  await saveAs(page, "Print map and list");
  await page.waitForFunction(() => window.isPrinting);
  assert.notEqual(await page.evaluate(() => window.printedRows), 0);
  assert.deepEqual(await stored(), before);
  await page.emulateMedia({ media: "print" });
  const sheet = page.locator(".print-sheet");
  await sheet.waitFor();
  assert.equal(await page.locator(".page").isVisible(), false);
  const [text, { name }] = [await sheet.innerText(), await api(page, "/project")];
  assert.ok(text.startsWith(name.replace(/.*\//, "")), text);
  assert.match(text, new RegExp(`${objects.length} objects; printed \\d{4}-\\d\\d-\\d\\d \\d\\d:\\d\\d UTC`));
  await becomes(() => sheet.locator("tbody tr").count(), objects.length);
  assert.match(await sheet.locator("tbody tr").first().innerText(), /33U UU \d{5} \d{5}\s+\d+\.\d m/);
  // The picture is the map: not of one colour.
  const colours = await sheet.locator("img").evaluate(async (image) => {
    await image.decode();
    const canvas = new OffscreenCanvas(image.naturalWidth, image.naturalHeight);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    return new Set(Array.from({ length: data.length / 400 }, (_, i) => data[400 * i] >> 3)).size;
  });
  assert.ok(colours > 4, `${colours} shades`);
  await page.emulateMedia({ media: null });
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await sheet.waitFor({ state: "detached" });
  assert.deepEqual(await stored(), before);
}

/** A server that hangs is reported within some seconds; decisions are stored once it is back. */
async function checkLostServer(page, object) {
  await page.evaluate(() => document.activeElement.blur());
  await page.click(`#object-${object.id}`);
  const hang = () => {};
  await intercept(page, "**/api/v1/**", hang);
  await page.keyboard.press("x");
  const banner = page.locator(".lost");
  await banner.waitFor();
  await page.locator(".verdict.pending").first().waitFor();
  await checkAccessible(page, "a server that is away");
  const [lost, head] = [await banner.boundingBox(), await page.locator(".head").boundingBox()];
  assert.ok(lost.y + lost.height <= head.y + 1, "the banner covers the header");
  await page.unroute("**/api/v1/**", hang);
  await banner.waitFor({ state: "detached" });
  await until(page, `/objects/${object.id}`, ({ review }) => review?.verdict === "rejected");
  await page.keyboard.press("u");
  await until(page, `/objects/${object.id}`, ({ review }) => review?.verdict !== "rejected");
  // A picture that cannot be had leaves no broken image.
  await intercept(page, "**/thumbnail*", (route) => route.fulfill({ status: 404, body: "" }));
  await page.goto(page.url());
  await page.locator(".crop .none", { hasText: "no picture" }).waitFor();
  await page.unroute("**/thumbnail*");
}

/** A click decides and goes on as its key does; at the end of the queue nothing is decided again. The first object is accepted. */
async function checkQueue(page, objects) {
  const reviewed = (count) => until(page, "/objects/counts", ({ accepted, rejected }) => accepted + rejected === count);
  const [, second] = objects;
  await page.click(`#object-${second.id}`);
  await page.locator(".inspector .accept").click();
  await page.waitForSelector(`#object-${second.id} .verdict.accepted:not(.pending)`);
  // Space plays: the button that was clicked does not keep it.
  await page.keyboard.press(" ");
  await page.waitForFunction(() => !document.querySelector("video").paused);
  await page.keyboard.press(" ");
  await reviewed(2);
  await becomes(async () => (await api(page, `/objects/${second.id}`)).review?.verdict, "accepted");
  for (const { id } of objects.slice(2)) {
    await becomes(() => selectedId(page), id);
    await page.keyboard.press("x");
  }
  await reviewed(objects.length);
  await page.locator(".inspector .status", { hasText: "All reviewed" }).waitFor();
  const last = await selectedId(page);
  const { verdict } = (await api(page, `/objects/${last}`)).review;
  await page.keyboard.press(verdict === "accepted" ? "x" : "a");
  await page.locator(".notice", { hasText: "All reviewed" }).waitFor();
  await page.keyboard.press("j");
  await page.locator(".notice", { hasText: "last object" }).waitFor();
  await becomes(async () => (await api(page, `/objects/${last}`)).review.verdict, verdict);
  for (let left = objects.length - 1; left > 0; left--) {
    await page.keyboard.press("u");
    await reviewed(left);
  }
  // The list by Home and End.
  await page.locator(".rows").focus();
  await page.keyboard.press("End");
  await becomes(() => selectedId(page), objects.at(-1).id);
  await page.keyboard.press("Home");
  await becomes(() => selectedId(page), objects[0].id);
  await page.keyboard.press("j");
  await becomes(() => selectedId(page), second.id);
}

/** A rejection takes a reason, by key or by click, as long as its message stands; undo takes back both. */
async function checkReasons(page, object) {
  const hasNote = (wanted) => until(page, `/objects/${object.id}`, ({ review }) => (review?.note ?? null) === wanted);
  const notice = page.locator(".notice", { hasText: `${object.model} ${object.id}: rejected` });
  await page.click(`#object-${object.id}`);
  await page.keyboard.press("x");
  await notice.waitFor();
  // What is typed is no reason.
  await page.keyboard.press("/");
  await page.keyboard.type("3");
  await becomes(() => page.inputValue("#search"), "3");
  await page.fill("#search", "");
  await page.keyboard.press("Escape");
  await page.keyboard.press("3");
  await hasNote("nothing there");
  await notice.getByRole("button", { name: "wrong place or size" }).click();
  await hasNote("wrong place or size");
  await becomes(() => notice.innerText(), /rejected, wrong place or size\./);
  await page.keyboard.press("u");
  await hasNote(null);
  await notice.waitFor({ state: "detached" });
  await page.keyboard.press("3");
  assert.deepEqual([await notice.count(), (await api(page, `/objects/${object.id}`)).review], [0, null]);
}

async function triage(page) {
  // The list greys out what filters exclude; other scenarios leave it out.
  await open(page, "/?list=all");
  const { objects } = await api(page, "/objects");
  assert.ok(objects.length >= 2, "the test needs two objects");
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, objects.length);
  await becomes(() => selectedId(page), objects[0].id, "the best object is selected at first");

  // A click in the list seeks the video to the best sighting.
  const second = objects[1];
  await page.click(`#object-${second.id}`);
  await becomes(() => selectedId(page), second.id);
  const { best, key } = await api(page, `/objects/${second.id}`);
  await waitForFrame(page, best.frame);
  await becomes(() => page.locator(".inspector h2").innerText(), second.model);
  assert.ok(await page.locator(".crop img").first().evaluate((image) => image.complete || image.decode().then(() => true)));

  // The address bar holds the selection and the time; a colleague who opens it sees the same.
  await page.waitForFunction(([name, time]) => {
    const query = new URLSearchParams(location.search);
    return query.get("object") === name && Math.abs(Number(query.get("t")) - time) < 0.01;
  }, [key, best.time_s]);
  await open(page, page.url());
  await becomes(() => selectedId(page), second.id);
  await waitForFrame(page, best.frame);

  // The map shows an object's marker, by the colour of its model; a click on it selects the object.
  const { models } = await api(page, "/project");
  const only = objects
    .filter((one) => one.model === models[0].name)
    .reduce((north, one) => (one.place.latitude_deg > north.place.latitude_deg ? one : north));
  await page.locator(`[role=option]:not(#object-${only.id})`).first().click();
  assert.notEqual(await selectedId(page), only.id);
  const marker = await findStillOnMap(page, ORANGE); // the map moves to what is selected
  assert.ok(marker, "the map has no marker of the object");
  await page.mouse.click(marker.x, marker.y);
  await page.waitForSelector(`#object-${only.id}[aria-selected=true]`);
  await becomes(() => selectedId(page), only.id);
  await checkArea(page, objects, only, marker);

  // Hovering over the camera's path or an object's track shows the time, a click goes there.
  const { times_s: times } = await api(page, "/videos/1/times");
  await page.getByRole("button", { name: "All", exact: true }).click();
  await findStillOnMap(page, ORANGE);
  for (const line of [/^camera at 0:([\d.]+)$/, new RegExp(`^${only.model} at 0:([\\d.]+)$`)]) {
    const tip = await findTip(page, line);
    await page.mouse.click(tip.x, tip.y);
    const time = Number(tip.found[1]);
    await waitForFrame(page, times.reduce((best, one, i) => (Math.abs(one - time) < Math.abs(times[best] - time) ? i : best), 0));
  }
  await page.click(`#object-${objects[0].id}`);

  // One key decides and goes on; the server has it; U takes it back.
  await page.keyboard.press("a");
  await page.waitForSelector(`#object-${objects[0].id} .verdict.accepted:not(.pending)`);
  await becomes(() => selectedId(page), second.id, "the next object is selected");
  await becomes(async () => (await api(page, `/objects/${objects[0].id}`)).review?.verdict, "accepted");
  await page.keyboard.press("x");
  await page.waitForSelector(`#object-${second.id} .verdict.rejected:not(.pending)`);
  await page.keyboard.press("u");
  await page.waitForSelector(`#object-${second.id} .verdict`, { state: "detached" });
  await becomes(async () => (await api(page, `/objects/${second.id}`)).review, null);

  await checkReasons(page, second);
  await checkQueue(page, objects);

  // A note by keyboard alone; the other keys are letters while it is typed.
  await page.keyboard.press("n");
  await page.keyboard.type("next to a shed");
  await page.keyboard.press("Escape");
  await until(page, `/objects/${second.id}`, ({ review }) => review?.note === "next to a shed");

  // Who reviews is kept with the review.
  await page.fill("#reviewer", "Ann");
  await page.keyboard.press("Escape");
  await page.click(`#object-${second.id}`);
  await page.keyboard.press("a");
  await page.waitForSelector(`#object-${second.id} .verdict.accepted:not(.pending)`);
  await becomes(async () => (await api(page, `/objects/${second.id}`)).review?.reviewer, "Ann");
  await becomes(() => page.locator(`#object-${second.id} .verdict`).getAttribute("title"), "accepted by you");

  // Some at once: marked by key and by Shift and click, decided by one key, taken back by one.
  const ids = objects.map((one) => one.id);
  await page.click(`#object-${ids[0]}`);
  await page.keyboard.press("m");
  await page.locator(`#object-${ids.at(-1)}`).click({ modifiers: ["Shift"] });
  await becomes(() => page.locator(".row.marked").count(), objects.length);
  await page.keyboard.press("x");
  await page.waitForFunction((count) => document.querySelectorAll(".row .verdict.rejected:not(.pending)").length === count, objects.length);
  await becomes(async () => (await api(page, "/objects/counts")).rejected, objects.length);
  await page.keyboard.press("u");
  await page.waitForFunction(() => document.querySelectorAll(".row .verdict.rejected").length === 0);
  await until(page, "/objects/counts", ({ rejected }) => rejected === 0);
  await becomes(async () => (await api(page, `/objects/${second.id}`)).review?.verdict, "accepted");

  await checkPersons(page, objects);

  // Coordinates as MGRS.
  await page.getByLabel("Coordinates as").selectOption("mgrs");
  await becomes(() => page.locator(".facts-grid .wide:not(.seen) dd").innerText(), /^33U UU \d{5} \d{5}/);

  // The next sighting is the next frame that the object was found in.
  await page.click(`#object-${objects[0].id}`);
  const { sightings } = await api(page, `/objects/${objects[0].id}/sightings`);
  const frameNumbers = sightings.map((one) => one.frame);
  await page.waitForFunction((wanted) => wanted.includes(Number(document.querySelector(".stage canvas").dataset.frame)), frameNumbers);
  const sighted = frameNumbers.indexOf(await shownFrame(page));
  const by = sighted > 0 ? -1 : 1;
  await page.keyboard.press(by < 0 ? "[" : "]");
  await waitForFrame(page, frameNumbers[sighted + by]);

  await checkEvidence(page, objects[0]);

  // A filter greys out; j and k skip what it greys.
  await page.keyboard.press("/");
  await page.keyboard.type(second.model);
  await page.keyboard.press("Escape");
  const greyed = objects.filter((one) => one.model !== second.model).length;
  await becomes(() => page.locator("[role=option].greyed").count(), greyed);
  await becomes(() => page.locator("[role=option]").count(), objects.length, "nothing is hidden");
  await page.waitForFunction((text) => document.querySelector(".list h2")?.textContent?.startsWith(text), `${objects.length - greyed} of`);
  // Shown alone, then all again. A reload finds again what was set.
  await page.getByText("matches only").click();
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, objects.length - greyed);
  await page.selectOption("#sort", "rank");
  await page.waitForFunction(() => location.search.includes("order=rank") && location.search.includes("q=") && !location.search.includes("list="));
  await open(page, page.url());
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, objects.length - greyed);
  assert.deepEqual([await page.inputValue("#search"), await page.inputValue("#sort")], [second.model, "rank"]);
  await page.selectOption("#sort", "queue");
  await page.getByText("matches only").click();
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, objects.length);
  await page.getByText("Clear filters").click();

  // Frames by keys, and the help.
  const before = await shownFrame(page);
  await page.keyboard.press(".");
  await waitForFrame(page, before + 1);
  await page.keyboard.press(",");
  await waitForFrame(page, before);
  await page.keyboard.press("?");
  await page.waitForSelector("dialog.help[open]");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.help[open]", { state: "detached" });

  await checkOverlay(page);
  await checkTimeKeys(page);
  await checkNear(page, second);
  await checkPrint(page, objects);
  await checkLostServer(page, second);
}

/** Distances and areas are measured by positions and by clicks, which do nothing else meanwhile. */
async function checkMeasuring(page, map) {
  const [frame, selected] = [await shownFrame(page), await page.locator(SELECTED).count()];
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press("r");
  const measured = page.locator(".measured");
  await page.fill("#measure-positions", "52.5,13.4 52.501,13.4");
  await page.keyboard.press("Enter");
  await becomes(() => measured.innerText(), /^111 m\s+last 111 m, 0°$/);
  await page.fill("#measure-positions", "52.501,13.402");
  await page.keyboard.press("Enter");
  // A right angle of 111.2 m and 135.4 m: half of their product.
  await becomes(() => measured.innerText(), /^247 m\s+last 135 m, 90°\s+area 7,5\d\d m², around it 422 m$/);
  await checkAccessible(page, "measuring");
  await page.getByRole("button", { name: "New" }).click();
  // The panel is smaller now: the map has to take its new size before it is clicked, else it moves between two clicks.
  await becomes(() => measured.innerText(), /^Click from place to place/);
  await page.waitForFunction(() => {
    const canvas = document.querySelector(".map .maplibregl-canvas");
    return canvas.clientHeight === canvas.closest(".maplibregl-map").clientHeight;
  });
  for (const part of [0.4, 0.6]) await page.mouse.click(map.x + part * map.width, map.y + map.height / 2);
  await becomes(() => measured.innerText(), /^[\d.,]+ k?m\s+last [\d.,]+ k?m, 90°$/);
  await page.keyboard.press("Backspace");
  await becomes(() => measured.innerText(), /^Click from place to place/);
  assert.deepEqual([await shownFrame(page), await page.locator(SELECTED).count()], [frame, selected]);
  await page.keyboard.press("Escape");
  await measured.waitFor({ state: "detached" });
}

/** Three videos: what was seen where and when, by which of them. The second looks at other ground, the third has no telemetry. */
async function videos(page) {
  await open(page, "/?video=1&t=0");
  const { videos: all } = await api(page, "/videos");
  const { objects } = await api(page, "/objects");
  for (const { id, moments } of objects) {
    const own = new Set(moments.map((one) => one.video_id));
    const wanted = own.size > 1 ? `${own.size} videos` : all.find((one) => own.has(one.id)).name.replace(/.*\//, "");
    await becomes(() => page.locator(`#object-${id} .where`).innerText(), wanted);
  }
  // Times belong to a video: an object that two show has those of each, in the panel, the list and the tables.
  const twice = objects.find(({ moments }) => new Set(moments.map((one) => one.video_id)).size > 1);
  await page.locator(`#object-${twice.id}`).click();
  const timesIn = (id) => {
    const own = twice.moments.filter((one) => one.video_id === id);
    return [Math.min(...own.map((one) => one.first_time_s)), Math.max(...own.map((one) => one.last_time_s))];
  };
  const shownIn = [...new Set(twice.moments.map((one) => one.video_id))].sort();
  const nameOf = (id) => all.find((one) => one.id === id).name;
  const wanted = shownIn.map((id) => `${timesIn(id).map((one) => one.toFixed(1)).join(" – ")} s in ${nameOf(id).replace(/.*\//, "")}`);
  await becomes(async () => (await page.locator(".inspector .seen dd").allInnerTexts()).map((one) => one.replace(/ \(.*/, "")).join("; "), wanted.join("; "));
  await becomes(() => page.locator(`#object-${twice.id} .facts`).first().innerText(), /^\d+\.\d – \d+\.\d s here$/);
  await page.locator(".inspector .seen dd button").nth(1).click();
  await becomes(() => page.locator(".stage .corner").innerText(), nameOf(shownIn[1]).replace(/.*\//, ""));
  const saved = async (item) => {
    const [file] = await Promise.all([page.waitForEvent("download"), saveAs(page, item)]);
    return readFileSync(await file.path(), "utf8").trim();
  };
  const [head, ...rows] = (await saved("Moments by video (CSV)")).split("\r\n").map((one) => one.split(","));
  assert.deepEqual(head.slice(0, 5), ["object_id", "model", "video", "first_time_s", "last_time_s"]);
  const own = rows.filter(([id]) => Number(id) === twice.id).map(([, , name, first, last]) => [name, Number(first), Number(last)]);
  assert.deepEqual(own, shownIn.map((id) => [nameOf(id), ...timesIn(id)]));
  const { features } = JSON.parse(await saved("Map (GeoJSON)"));
  assert.deepEqual(features.find(({ id }) => id === twice.id).properties.videos, shownIn.map(nameOf));
  const kml = await saved("Map (KML)");
  assert.deepEqual([...kml.matchAll(/<Placemark id="object-(\d+)">/g)].map(([, id]) => Number(id)), features.map(({ id }) => id));
  const [geoPackage] = await Promise.all([page.waitForEvent("download"), saveAs(page, "Map (GeoPackage)")]);
  assert.equal(geoPackage.suggestedFilename(), "objects.gpkg");
  assert.equal(readFileSync(await geoPackage.path()).subarray(0, 15).toString(), "SQLite format 3");
  await open(page, "/?video=1&t=0");
  // The middle of the map shows the camera's path; its ground says when, and a click goes there.
  await page.waitForSelector(".map .canvas[data-ready=true]");
  await page.getByRole("button", { name: "All", exact: true }).click();
  await page.waitForTimeout(500);
  const map = await page.locator(".map .on-map").boundingBox();
  const seen = page.locator(".map .seen");
  await checkMeasuring(page, map);
  const hover = async (x, y) => {
    await page.mouse.move(x, y);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    return (await seen.count()) > 0 ? seen.innerText() : "";
  };
  await becomes(() => hover(map.x + map.width / 2, map.y + map.height / 2), /^shown at 0:0\d\.\d\d by one\.mp4$/);
  // Ground that only the second video shows, north of it: found by a click, and named from then on. The third one shows
  // no ground, and is not looked through.
  const asked = [];
  page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  for (let i = 0; i < 2; i++) await page.locator(".maplibregl-ctrl-zoom-out").click();
  await page.waitForTimeout(1000);
  const x = map.x + map.width / 2 - 25; // beside the objects
  let other = null;
  for (let y = map.y + 60; y < map.y + map.height / 2 && !other; y += 12) {
    if ((await hover(x, y)) !== "") break;
    await page.mouse.click(x, y);
    const told = page.locator(".notice", { hasText: /Seen in two\.mp4|No video showed this place/ });
    await told.waitFor();
    if (/Seen in/.test(await told.innerText())) other = y;
    // On a busy machine it goes by itself meanwhile.
    await page.getByRole("button", { name: "Dismiss" }).first().click({ timeout: 4000 }).catch(() => told.waitFor({ state: "detached" }));
  }
  assert.ok(other, "the second video is not found by its ground");
  assert.ok(!asked.includes("/api/v1/videos/3/camera"));
  await becomes(() => page.locator(".stage .corner").innerText(), "two.mp4");
  await page.selectOption("#video", "3");
  await page.locator(".map .reason", { hasText: "no telemetry" }).waitFor();
}

/** A list of thousands: any part of it, the neighbour that is not loaded, clusters on the map. */
async function many(page) {
  await page.goto("/");
  await page.waitForSelector("[role=option]");
  const { objects: total } = await api(page, "/objects/counts");
  assert.ok(total > 2500, `the test needs many objects, not ${total}`);
  assert.ok((await page.locator(".row").count()) < 60, "only rows that can be seen are in the document");

  // The end of the list, without what lies between.
  await page.locator(".rows").evaluate((rows) => rows.scrollTo(0, rows.scrollHeight));
  const { objects: last } = await api(page, `/objects?offset=${total - 1}`);
  await page.waitForSelector(`#object-${last[0].id}`);

  // An object that the address names is found in the list, wherever it stands.
  const { objects: middle } = await api(page, "/objects?offset=1234&limit=1");
  await page.goto(`/?object=${middle[0].id}`);
  await page.waitForSelector(`#object-${middle[0].id}[aria-selected=true]`);

  // The next match may be far away: the server finds it.
  const { objects: rare } = await api(page, "/objects?model=rare");
  assert.ok(rare.length >= 2);
  await page.keyboard.press("/");
  await page.keyboard.type("rare");
  await page.keyboard.press("Escape");
  await page.waitForFunction((text) => document.querySelector(".list h2")?.textContent?.startsWith(text), `${rare.length} of`);
  // Alone, from the first one on, also where all are listed.
  const first = page.locator(`#object-${rare[0].id}`);
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, rare.length);
  await page.getByText("matches only").click();
  await page.waitForFunction(() => document.querySelector("[role=option]")?.getAttribute("aria-setsize") === "3000");
  await first.waitFor();
  await page.getByText("matches only").click();
  await page.waitForFunction((count) => document.querySelectorAll("[role=option]").length === count, rare.length);
  const after = await api(page, `/objects?after=${middle[0].id}&model=rare&limit=1`);
  await page.keyboard.press("j");
  await page.waitForSelector(`#object-${after.objects[0].id}[aria-selected=true]`);
  const before = await api(page, `/objects?before=${after.objects[0].id}&model=rare&limit=1`);
  await page.keyboard.press("k");
  await page.waitForSelector(`#object-${before.objects[0].id}[aria-selected=true]`);

  // A decision counts at once, and the server has it.
  await page.keyboard.press("a");
  await page.waitForFunction(() => /^1 of/.test(document.querySelector(".progress")?.textContent ?? ""));
  await until(page, "/objects/counts", ({ accepted }) => accepted === 1);

  // The message takes it back, U does after a reload, too.
  await page.locator(".notice").getByRole("button", { name: "Undo" }).click();
  await until(page, "/objects/counts", ({ accepted }) => accepted === 0);
  await page.keyboard.press("a");
  await until(page, "/objects/counts", ({ accepted }) => accepted === 1);
  await page.reload();
  await page.waitForSelector("[role=option]");
  await page.keyboard.press("u");
  await until(page, "/objects/counts", ({ accepted }) => accepted === 0);

  // A cluster on the map opens where it is clicked.
  await page.getByText("Clear filters").click();
  await page.getByRole("button", { name: "All", exact: true }).click();
  const grid = () => page.locator(".map .readout").last().innerText().then((text) => /grid .*/.exec(text)?.[0]);
  const cluster = await findStillOnMap(page, await page.evaluate(() => {
    const probe = document.createElement("div");
    probe.style.color = "var(--accent)";
    document.body.append(probe);
    const rgb = getComputedStyle(probe).color.match(/\d+/g).map(Number);
    probe.remove();
    return rgb;
  }), 50); // below the map's buttons
  assert.ok(cluster, "the map has no cluster");
  const gridBefore = await grid();
  await page.mouse.click(cluster.x, cluster.y);
  await page.waitForFunction(
    (text) => ![...document.querySelectorAll(".map .readout")].some((one) => one.textContent.includes(text)), gridBefore,
  );
}

/** The number that the frame on the page shows, and the number that the page says it has. */
const readNumber = (page) =>
  page.evaluate(() => {
    const canvas = document.querySelector(".stage canvas");
    const [width, height] = [320, 240];
    const scale = Math.min(canvas.width / width, canvas.height / height);
    const left = (canvas.width - width * scale) / 2;
    const top = (canvas.height - height * scale) / 2;
    let shown = 0;
    for (let bit = 0; bit < 8; bit++) {
      const x = left + ((bit + 0.5) * width * scale) / 8;
      const [grey] = canvas.getContext("2d").getImageData(Math.round(x), Math.round(top + 0.12 * height * scale), 1, 1).data;
      if (grey > 128) shown |= 1 << bit;
    }
    return { shown, said: Number(canvas.dataset.frame) };
  });

/** After each seek and while playing, the picture is the frame that the overlay is drawn for. */
async function frames(page) {
  await open(page, "/");
  await checkFrames(page);
}

/** Of a video of which only the first 0.3 s were searched, the time line shows this part alone, and says why. */
async function coverage(page) {
  await open(page, "/");
  const { duration_s: duration, left_out: leftOut } = await api(page, "/videos/1");
  assert.equal(duration, null);
  assert.deepEqual(leftOut.map(({ from_s, to_s, reason }) => [from_s, to_s, reason]), [[0.3, null, "not_wanted"]]);
  const text = "0:00.30 to the end: outside of --from and --to";
  const [ruler, whole, none] = await Promise.all(
    [".timeline .ruler .track", ".timeline .searched.whole", ".timeline .searched.none"].map((one) => page.locator(one).boundingBox()),
  );
  const { times_s: times } = await api(page, "/videos/1/times");
  assert.ok(Math.abs(whole.width / ruler.width - 0.3 / times.at(-1)) < 0.02, `${whole.width} of ${ruler.width} is searched`);
  assert.ok(Math.abs(none.x - (whole.x + whole.width)) < 2 && Math.abs(none.x + none.width - (ruler.x + ruler.width)) < 2);
  assert.equal(await page.locator(".timeline .searched.none").getAttribute("title"), text);
  assert.equal(await page.locator(".timeline .searched.whole").getAttribute("title"), "Searched for all models");
  assert.equal(await page.locator(".timeline .left-out p").innerText(), text);
  await page.locator(".timeline .searched.none").click();
  await becomes(() => shownFrame(page), Math.round((times.length - 1) * (1 + 0.3 / times.at(-1)) / 2), "the frame under the pointer");
}

/** The server copies what the browser cannot play; after a seek, the copy shows the frame that the video has there. */
async function copies(page) {
  await open(page, "/");
  await page.waitForFunction(() => document.querySelector("video").src.endsWith("/copy"), null, { timeout: 60_000 });
  await page.waitForFunction(() => !document.querySelector(".stage .message"));
  await checkFrames(page);
  // The next visitor plays the copy at once.
  await open(page, "/?video=1&t=0.5");
  await page.waitForFunction(() => document.querySelector("video").src.endsWith("/copy"));
}

/** Whatever is shown, by seeking, stepping and playing, the overlay belongs to it. The frames show their numbers. */
async function checkFrames(page) {
  await becomes(() => page.locator(".list").innerText(), /Nothing found/);
  const { times_s: times } = await api(page, "/videos/1/times");
  assert.equal(times.length, 90);
  const ruler = await page.locator(".timeline .ruler .track").boundingBox();
  let seed = 7;
  for (let i = 0; i < 25; i++) {
    seed = (seed * 1103515245 + 12345) % 2 ** 31;
    const x = Math.round(ruler.x + (seed / 2 ** 31) * ruler.width);
    const time = ((x - ruler.x) / ruler.width) * times.at(-1);
    const wanted = times.reduce((best, one, at) => (Math.abs(one - time) < Math.abs(times[best] - time) ? at : best), 0);
    await page.mouse.click(x, ruler.y + 6);
    await waitForFrame(page, wanted);
    assert.deepEqual(await readNumber(page), { shown: wanted, said: wanted });
  }
  await page.mouse.click(ruler.x + 0.3, ruler.y + 6);
  await waitForFrame(page, 0);
  for (let frame = 1; frame <= 12; frame++) {
    await page.keyboard.press(".");
    await waitForFrame(page, frame);
    assert.deepEqual(await readNumber(page), { shown: frame, said: frame });
  }
  await page.keyboard.press(" ");
  const seen = new Set();
  for (let i = 0; i < 60; i++) {
    const { shown, said } = await readNumber(page);
    assert.equal(said, shown, "while playing");
    seen.add(shown);
    if (seen.size > 12) break;
    await page.evaluate(() => new Promise(requestAnimationFrame));
  }
  assert.ok(seen.size > 3, `the video does not play: only frames ${[...seen]}`);
}

/** A format that the browser cannot play is shown as images. */
async function images(page) {
  await open(page, "/?video=1&t=0");
  await becomes(() => page.locator(".stage").innerText(), /frame by frame/);
  await page.keyboard.press(".");
  await waitForFrame(page, 1);
}

/** Where the frame lies on the stage: px of the page per px of the frame, and the page's place of its corner. */
async function placeOfFrame(page) {
  const { x, y } = await page.locator(".stage > canvas").boundingBox();
  const [left, top, scale] = (await page.locator(".stage > canvas").getAttribute("data-place")).split(" ").map(Number);
  return { scale, x: x + left, y: y + top };
}

/** How far what the stage shows of some pixels of a frame is from the frame itself, of 255; each pixel is drawn as a square. */
async function differenceFromFrame(page, video, frame, pixels, place) {
  const { x, y } = await page.locator(".stage > canvas").boundingBox();
  const stage = { left: place.x - x, top: place.y - y, scale: place.scale };
  return page.evaluate(async ([url, pixels, stage]) => {
    const bitmap = await createImageBitmap(await (await fetch(url)).blob());
    const copy = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    copy.drawImage(bitmap, 0, 0);
    const shown = document.querySelector(".stage > canvas").getContext("2d");
    const differences = pixels.map(([x, y]) => {
      const [a] = copy.getImageData(x, y, 1, 1).data;
      const [b] = shown.getImageData(Math.round(stage.left + (x + 0.5) * stage.scale - 0.5), Math.round(stage.top + (y + 0.5) * stage.scale - 0.5), 1, 1).data;
      return Math.abs(a - b);
    });
    return differences.reduce((sum, one) => sum + one, 0) / pixels.length;
  }, [`/api/v1/videos/${video}/frames/${frame}`, pixels, stage]);
}

/** Zoom, pan, brightness, magnifier and full screen; boxes, clicks and drawn boxes follow. */
async function zoomed(page) {
  await open(page, "/");
  const { objects } = await api(page, "/objects");
  const { best, key } = await api(page, `/objects/${objects[0].id}`);
  await open(page, `/?object=${key}&video=${best.video_id}&t=${best.time_s}`);
  await waitForFrame(page, best.frame);
  const video = await api(page, `/videos/${best.video_id}`);
  const stage = await page.locator(".stage > canvas").boundingBox();
  const whole = await placeOfFrame(page);
  assert.ok(Math.abs(whole.scale - Math.min(stage.width / video.width_px, stage.height / video.height_px)) < 1e-2);
  const [left, top, width, height] = best.box;
  const centre = [left + width / 2, top + height / 2];
  const at = ({ x, y, scale }, [right, down]) => [x + right * scale, y + down * scale];
  // A pointer is at a whole pixel of the page. A frame that is narrower than its place stays in the middle of it.
  const point = [stage.x + stage.width / 2, stage.y + stage.height / 2 - 20].map(Math.round);
  const middle = [(point[0] - whole.x) / whole.scale, (point[1] - whole.y) / whole.scale];
  const around = ([x, y], radius) => Array.from({ length: 400 }, (_, i) => [Math.round(x + (((i % 20) - 9.5) / 10) * radius), Math.round(y + ((Math.floor(i / 20) - 9.5) / 10) * radius)]);

  // By the wheel, at the pointer: what lies below it stays there.
  await page.mouse.move(...point);
  for (let i = 0; i < 8; i++) await page.mouse.wheel(0, -200);
  await page.waitForFunction((scale) => Number(document.querySelector(".stage > canvas").dataset.place.split(" ")[2]) > 8 * scale, whole.scale);
  const near = await placeOfFrame(page);
  for (const axis of [0, 1]) assert.ok(Math.abs(at(near, middle)[axis] - point[axis]) < 20, `what lies below the pointer stays there: ${at(near, middle)}, ${point}`);
  await page.keyboard.down("o");
  await page.waitForTimeout(100);
  const enlarged = await differenceFromFrame(page, best.video_id, best.frame, around(middle, 3), near);
  assert.ok(enlarged < 12, `pixels differ by ${enlarged} when they are enlarged`);
  await page.keyboard.up("o");

  // A drag moves the frame, and is no click: nothing plays, the selection stays.
  await page.mouse.down();
  await page.mouse.move(point[0] + 60, point[1] + 25, { steps: 5 });
  await page.mouse.up();
  await becomes(async () => Math.round((await placeOfFrame(page)).x - near.x), 60);
  assert.equal(Math.round((await placeOfFrame(page)).y - near.y), 25);
  assert.deepEqual([await page.evaluate(() => document.querySelector("video").paused), await selectedId(page)], [true, objects[0].id]);

  // The part that is shown is moved by keys, on the small picture of all of it; Home ends it.
  const overview = page.getByRole("application", { name: /The part of the frame/ });
  await overview.focus();
  const before = await placeOfFrame(page);
  await page.keyboard.press("ArrowLeft");
  await becomes(async () => (await placeOfFrame(page)).x > before.x + 20, true);
  assert.equal(await shownFrame(page), best.frame, "the arrow does not step");
  await checkAccessible(page, "zoomed in");
  await page.keyboard.press("Home");
  await overview.waitFor({ state: "detached" });
  assert.deepEqual(await placeOfFrame(page), whole);

  // A pixel of the video is one of the screen; a video that is smaller than its place is enlarged.
  await page.keyboard.press("1");
  const native = whole.scale < 1 ? 1 : 2 * whole.scale;
  await becomes(async () => Math.abs((await placeOfFrame(page)).scale - native) < 1e-3, true);

  // Close up of the selection; a click beside it plays, one on it selects it; a box is in pixels of the video.
  await page.keyboard.press("Shift+Z");
  await becomes(async () => (await placeOfFrame(page)).scale !== native, true);
  const close = await placeOfFrame(page);
  for (const axis of [0, 1]) assert.ok(Math.abs(at(close, centre)[axis] - (axis ? stage.y + stage.height / 2 : stage.x + stage.width / 2)) < stage.width / 3);
  await page.mouse.click(...at(close, centre));
  await becomes(() => selectedId(page), objects[0].id);
  assert.ok(await page.evaluate(() => document.querySelector("video").paused));
  await page.keyboard.press("b");
  await page.mouse.move(...at(close, [left, top]));
  await page.mouse.down();
  await page.mouse.move(...at(close, [left + width, top + height]), { steps: 4 });
  await page.mouse.up();
  await page.waitForSelector("dialog.model[open]");
  await page.fill("#model-name", "close");
  const [asked] = await Promise.all([page.waitForRequest((one) => one.method() === "POST" && one.url().endsWith("/jobs")), page.getByRole("button", { name: "Make the model" }).click()]);
  const { box } = asked.postDataJSON();
  best.box.forEach((side, i) => assert.ok(Math.abs(side - box[i]) <= 1.5, `box ${box} instead of ${best.box}`));
  await page.getByRole("button", { name: "Close" }).click();

  // The magnifier enlarges what lies below the pointer; the rest stays.
  await page.keyboard.press("0");
  await page.keyboard.press("z");
  await page.keyboard.down("o");
  await page.mouse.move(...at(whole, centre));
  await page.waitForTimeout(100);
  const factor = Math.max(2.5, 2 / whole.scale);
  const [x, y] = at(whole, centre);
  const lens = { scale: whole.scale * factor, x: x - (x - whole.x) * factor, y: y - (y - whole.y) * factor };
  const magnified = await differenceFromFrame(page, best.video_id, best.frame, around(centre, 14), lens);
  assert.ok(magnified < 15, `pixels below the magnifier differ by ${magnified}`);
  await page.keyboard.up("o");
  await page.keyboard.press("z");

  // Brightness changes the frame that is shown, not the names over it.
  const mean = () => page.evaluate(() => {
    const canvas = document.querySelector(".stage > canvas");
    const { data } = canvas.getContext("2d").getImageData(canvas.width / 4, canvas.height / 4, canvas.width / 2, canvas.height / 2);
    return data.reduce((sum, value, i) => (i % 4 === 3 ? sum : sum + value), 0) / ((data.length * 3) / 4);
  });
  const asFilmed = await mean();
  await page.getByRole("button", { name: "Brightness and contrast" }).click();
  await page.locator("#brightness").fill("0.5");
  await becomes(async () => Math.abs((await mean()) - 0.5 * asFilmed) < 0.12 * asFilmed, true, "half as bright");
  await checkAccessible(page, "brightness and contrast");
  await page.getByRole("button", { name: "As filmed" }).click();
  await becomes(async () => Math.abs((await mean()) - asFilmed) < 1, true);
  await page.locator("#contrast").press("Escape");
  await page.locator("#contrast").waitFor({ state: "detached" });

  // The video alone; decisions by key go on.
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press("f");
  await page.locator(".list").waitFor({ state: "hidden" });
  assert.ok((await page.locator(".stage").boundingBox()).width > 1200);
  await page.keyboard.press("a");
  await until(page, `/objects/${objects[0].id}`, ({ review }) => review?.verdict === "accepted");
  await page.keyboard.press("f");
  await page.locator(".list").waitFor();

  // However many lanes the time line has, and whatever is selected, the video keeps its size.
  const sizes = [stage.height];
  for (const lanes of [objects.length, 0]) {
    if (lanes === 0) {
      await intercept(page, (url) => url.pathname.endsWith("/objects") && url.searchParams.has("video"), (route) => route.fulfill({ json: { objects: [], total: 0 } }));
    }
    await open(page, "/?t=0&video=1");
    await becomes(() => page.locator(".timeline .lane").count().then((count) => (lanes === 0 ? count <= 1 : count >= lanes)), true);
    sizes.push((await page.locator(".stage").boundingBox()).height);
  }
  assert.deepEqual(sizes, [sizes[0], sizes[0], sizes[0]]);
}

/** Draws a box around a sighting, in its frame. */
async function boxInFrame(page, sighting) {
  const video = await api(page, `/videos/${sighting.video_id}`);
  const { scale, x, y } = await page.evaluate((video) => {
    const area = document.querySelector(".stage canvas").getBoundingClientRect();
    const scale = Math.min(area.width / video.width_px, area.height / video.height_px);
    return { scale, x: area.x + (area.width - video.width_px * scale) / 2, y: area.y + (area.height - video.height_px * scale) / 2 };
  }, video);
  await waitForFrame(page, sighting.frame);
  const [left, top, width, height] = sighting.box;
  const at = (right, down) => [x + right * scale, y + down * scale];
  await page.keyboard.press("b");
  await page.mouse.move(...at(left, top));
  await page.mouse.down();
  await page.mouse.move(...at(left + width / 2, top + height / 2));
  await page.waitForSelector(".drawn-box");
  await page.mouse.move(...at(left + width, top + height));
  await page.mouse.up();
  await page.waitForSelector("dialog.model[open]");
  await becomes(() => page.evaluate(() => document.activeElement.id), "model-name");
  assert.ok(await page.locator("dialog.model canvas").evaluate(({ width, height }) => width > 20 && height > 20));
}

/** Keeps in `window.labels` what is written over frames from now on. */
async function recordLabels(page) {
  await page.evaluate(() => {
    window.labels = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
      if (this.canvas.closest(".stage")) window.labels.push(text);
      return fillText.call(this, text, ...place);
    };
  });
}

/** An empty page leads to the first finds: an object, a video, the search. */
async function steps(page, [photo, video]) {
  await page.goto("/");
  const step = (number) => page.locator(`.first-steps .step:nth-child(${number})`);
  const states = async () => (await Promise.all([1, 2, 3].map((one) => step(one).getAttribute("class")))).map((one) => one.replace("step ", "")).join(" ");
  await becomes(states, "open waits waits");
  await checkAccessible(page, "an empty index");
  assert.ok(await step(2).locator("button").isDisabled());

  // A video alone is not sent before there is something to search for; the server would not take its search either.
  await page.getByRole("button", { name: "Add" }).click();
  await page.setInputFiles("aside input[type=file]", video);
  await page.locator(".notice", { hasText: "First say what is to be found" }).waitFor();
  await page.keyboard.press("Escape");
  assert.equal((await api(page, "/jobs")).jobs.length, 0);

  // The sample is three jobs, in this order.
  await page.getByRole("button", { name: "Try the sample" }).click();
  await until(page, "/jobs", ({ jobs }) => jobs.length === 3);
  const { jobs: queued } = await api(page, "/jobs");
  assert.deepEqual(queued.sort((a, b) => a.id - b.id).map((one) => one.kind), ["model", "sample", "index"]);
  await becomes(states, "runs runs waits");
  for (const { id } of queued.reverse()) await page.request.post(`/api/v1/jobs/${id}/cancel`, { data: {} });
  await until(page, "/jobs", ({ jobs }) => jobs.every((one) => one.state === "cancelled"));
  for (const { id } of queued) await page.request.delete(`/api/v1/jobs/${id}`);
  await becomes(states, "open waits waits");

  // The object is boxed in its photo, here by keys.
  await step(1).locator("input[type=file]").setInputFiles(photo);
  await page.waitForSelector("dialog.model[open]");
  const canvas = page.locator("dialog.model .photo canvas");
  await canvas.press("ArrowRight");
  for (let i = 0; i < 20; i++) for (const key of ["ArrowLeft", "ArrowUp"]) await canvas.press(key);
  for (let i = 0; i < 40; i++) for (const key of ["Shift+ArrowRight", "Shift+ArrowDown"]) await canvas.press(key);
  await checkAccessible(page, "a photo that is boxed");
  const [asked] = await Promise.all([page.waitForRequest((one) => one.method() === "POST" && one.url().endsWith("/api/v1/jobs")), page.getByRole("button", { name: "Make the model" }).click()]);
  const [[left, top, width, height]] = asked.postDataJSON().boxes;
  assert.ok(left === 0 && top === 0 && width > 100 && height > 100, `box ${asked.postData()}`);
  await becomes(states, "done open waits");
  await step(2).locator("input[type=file]").setInputFiles(video);
  await page.waitForSelector("[role=option]", { timeout: 120_000 });
  assert.equal(await page.locator(".first-steps").count(), 0);
}

/** From nothing to finds: photos are dropped, then a video; the results come without a reload, to every tab. */
async function jobs(page, [photos, video]) {
  await page.goto("/");
  await page.waitForSelector(".first-steps");
  const second = await page.context().newPage();
  await second.goto(page.url());
  await second.waitForSelector(".first-steps");
  await page.getByRole("button", { name: "Add" }).click();

  const makeModel = async (photo) => {
    await page.waitForSelector("dialog.model[open]");
    const name = photo.replace(/.*\/|\.png$/g, "");
    await becomes(() => page.inputValue("#model-name"), name);
    await page.getByText("Its transparent background marks the object").waitFor();
    await page.getByRole("button", { name: "Make the model" }).click();
    await page.waitForSelector(`.job.done:has(strong:text-is("${name}"))`);
  };
  const [first, last] = photos.split(",");
  await page.setInputFiles("aside input[type=file]", first);
  await makeModel(first);

  // Dropped on the page, as from the desktop: a photo with the video, which is searched for it, too.
  const data = await page.evaluateHandle(() => new DataTransfer());
  for (const [path, name] of [[video, "dropped flight.mp4"], [last, last]]) {
    await data.evaluate(
      (transfer, [bytes, name]) => transfer.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name)),
      [readFileSync(path).toString("base64"), name.replace(/.*\//, "")],
    );
  }
  await page.dispatchEvent("body", "dragover", { dataTransfer: data });
  await page.waitForSelector(".drop-over");
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
  await makeModel(last);
  await page.waitForSelector(".job.done:has(strong:text-is('dropped flight.mp4'))");
  const { jobs: searches } = await api(page, "/jobs");
  assert.equal(searches.filter((one) => one.kind === "index").length, 1);
  await until(page, "/objects?model=truck", ({ objects }) => objects.length > 0);
  for (const tab of [page, second]) {
    await tab.waitForSelector("[role=option]");
    await tab.waitForFunction(() => document.querySelector(".stage canvas[data-frame]"));
  }
  // One stream of events for both tabs: the first forwards the events to the second. A list that began while the video
  // was still searched offers what was found since.
  const { objects: found } = await api(page, "/objects/counts");
  for (const tab of [page, second]) {
    const lists = (count) => document.querySelectorAll("[role=option]").length === count;
    const more = tab.locator(".button.new");
    await Promise.race([tab.waitForFunction(lists, found), more.waitFor()]);
    if (await more.isVisible()) await more.click();
    await tab.waitForFunction(lists, found);
  }

  // A clip of an object, as a download. The panel lies above what is below it, and opens again.
  await page.getByRole("button", { name: "Close" }).click();
  await page.getByRole("button", { name: "make a clip" }).click();
  const save = page.getByRole("link", { name: "Save the clip" });
  await save.waitFor();
  const [clip] = await Promise.all([page.waitForEvent("download"), save.click()]);
  assert.match(clip.suggestedFilename(), /^(crate|truck)-\d+-dropped_flight\.mp4$/);
  assert.equal(readFileSync(await clip.path()).subarray(4, 8).toString(), "ftyp");

  // The list as a table.
  const [table] = await Promise.all([page.waitForEvent("download"), saveAs(page, "Table (CSV)")]);
  const lines = readFileSync(await table.path(), "utf8").trim().split("\r\n");
  assert.equal(lines.length, 1 + (await page.locator("[role=option]").count()));

  // What is boxed in a frame is followed through the video, or searched for in all videos.
  const { best, key } = await api(page, `/objects/${await selectedId(page)}`);
  // What the search has added since the object was selected is shown.
  await becomes(() => page.locator(".inspector .crop").first().innerText(), new RegExp(`best sighting, 0:0${best.time_s.toFixed(2)}`));
  await open(page, `/?object=${key}&video=${best.video_id}&t=${best.time_s}`);
  await boxInFrame(page, best);
  await page.getByRole("button", { name: "Follow it in this video" }).click();
  await page.fill("#track-type", "truck");
  await page.getByRole("button", { name: "Follow it", exact: true }).click();
  // It is an object as any other: listed, shown, reviewed, exported.
  const follow = page.locator("li.job", { hasText: "truck in" });
  await becomes(() => follow.locator(".job-state").innerText(), /^Followed [\d.]+ – [\d.]+ s/);
  await follow.getByRole("button", { name: "Show" }).click();
  await page.waitForSelector(".inspector h2:has-text('boxed/truck')");
  const followed = await api(page, `/objects/${await selectedId(page)}`);
  assert.deepEqual([followed.model, followed.evidence], ["boxed/truck", null]);
  await page.waitForSelector("[role=option][aria-selected=true]:has-text('boxed/truck')");
  await becomes(() => page.locator(".timeline .lane.selected .moment").first().getAttribute("title"), /boxed\/truck/);
  await page.keyboard.press("a");
  await until(page, `/objects/${followed.id}`, ({ review }) => review?.verdict === "accepted");
  await open(page, `/?object=${key}&video=${best.video_id}&t=${best.time_s}`);
  await boxInFrame(page, best);
  await becomes(() => page.inputValue("#model-name"), "");
  await recordLabels(page);
  await page.fill("#model-name", "boxed");
  await page.getByRole("button", { name: "Make the model" }).click();
  await until(page, "/objects?model=boxed", ({ objects }) => objects.length > 0);
  // It is drawn in the frame that is shown, without a reload.
  await page.waitForFunction(() => window.labels.includes("boxed"));

  // All of a photo without a transparent background is the object only if the reader says so.
  const buffer = await (await page.request.get(`/api/v1/videos/${best.video_id}/frames/${best.frame}`)).body();
  await page.setInputFiles("aside input[type=file]", { name: "My photo (1).jpg", mimeType: "image/jpeg", buffer });
  const whole = page.getByLabel("The object fills the photo");
  await whole.waitFor();
  const isRefused = () => page.getByRole("button", { name: "Make the model" }).isDisabled();
  assert.deepEqual([await page.inputValue("#model-name"), await isRefused()], ["my-photo-1", true]);
  await whole.check();
  await becomes(isRefused, false);
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.model[open]", { state: "detached" });

  // A search that is done says what was found, and leads there.
  const search = page.locator(".job.done:has(strong:text-is('dropped flight.mp4'))").first();
  await becomes(() => search.locator(".job-state").innerText(), /^(\d+ objects? found|Already searched, nothing new)/);
  await search.getByRole("button", { name: "Show" }).click();
  await page.waitForFunction(() => location.search.includes("in="));
  await page.getByRole("button", { name: "Clear filters" }).click();
  await page.locator(".jobs-button").click();

  // A live source that is no address, and one that does not answer.
  await page.fill("#live-url", "http://127.0.0.1/");
  await page.getByRole("button", { name: "Start" }).click();
  await becomes(() => page.locator(".live .problem").innerText(), /^The address must begin with rtsp:/);
  await page.fill("#live-url", "rtsp://ann:secret@127.0.0.1:1/camera");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".job.failed:has(strong:text-is('rtsp://127.0.0.1:1/camera'))");
  await becomes(() => page.locator("aside.jobs").getByText("secret").count(), 0, "passwords are shown to nobody");

  // What cannot be read says why.
  await page.setInputFiles("aside input[type=file]", { name: "broken.mp4", mimeType: "video/mp4", buffer: Buffer.from("no video") });
  await page.waitForSelector(".job.failed:has(strong:text-is('broken.mp4'))");
  await becomes(() => page.locator(".job.failed .job-state").first().innerText(), /broken\.mp4/);
  await becomes(() => page.locator(".notice.error:has-text('broken')").count(), 0, "it is said once");
  const broken = page.locator(".job.failed:has(strong:text-is('broken.mp4'))");
  // Every page tries it again, not only the one that started it, and its list tells.
  const other = await page.context().newPage();
  await open(other, page.url());
  await other.locator(".jobs-button").click();
  const { jobs: told } = await api(page, "/jobs");
  const [failed] = told.filter((one) => one.title === "broken.mp4");
  await other.locator(".job.failed:has(strong:text-is('broken.mp4'))").getByRole("button", { name: "Retry" }).click();
  await until(page, "/jobs", ({ jobs: now }) =>
    now.length === told.length && now.some((one) => one.id === failed.id && one.ended_utc_us > failed.ended_utc_us));
  await becomes(() => broken.count(), 1);
  await other.locator(".job.failed:has(strong:text-is('broken.mp4'))").getByRole("button", { name: "Remove" }).click();
  await broken.waitFor({ state: "detached" });
  await other.close();
  // So is a job that is done.
  const made = page.locator(".job.done").first();
  const title = await made.locator("strong").innerText();
  const before = await page.locator(".job.done").count();
  await made.getByRole("button", { name: "Remove" }).click();
  await becomes(() => page.locator(".job.done").count(), before - 1, title);
  await page.setInputFiles("aside input[type=file]", { name: "notes.txt", mimeType: "text/plain", buffer: Buffer.from("x") });
  await page.waitForSelector(".notice.error:has-text('notes.txt')");

  // Telemetry that comes later: what was found is deleted only after a question.
  const telemetry = ["time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg",
    ...Array.from({ length: 10 }, (_, time) => `${time},${52.4995 + 1e-4 * time},13.407,140,0,-80,0,60`)].join("\n");
  const searchesAgain = async () => (await api(page, "/jobs")).jobs.filter((one) => one.kind === "index" && one.video_id === best.video_id);
  const earlier = (await searchesAgain()).length;
  const question = page.getByRole("alertdialog", { name: /^Search .* from the beginning with flight\.csv/ });
  for (const answer of ["Cancel", "Search again"]) {
    await page.getByLabel("Telemetry of the video").setInputFiles({ name: "flight.csv", mimeType: "text/csv", buffer: Buffer.from(telemetry) });
    await question.waitFor();
    if (answer === "Cancel") await checkAccessible(page, "a question");
    await question.getByRole("button", { name: answer }).click();
    await question.waitFor({ state: "detached" });
    if (answer === "Cancel") assert.equal((await searchesAgain()).length, earlier);
  }
  await until(page, "/jobs", ({ jobs: now }) => now.filter((one) => one.kind === "index" && one.state === "done" && one.video_id === best.video_id).length > earlier);
  await until(page, `/videos/${best.video_id}/camera`, ({ source }) => source !== null);
}

// Each person decides alone: what others decided, what one has not, and where they disagree. Ann has accepted the
// second object, somebody without a name the first.
async function checkPersons(page, objects) {
  const [first, second] = objects;
  const mark = (object) => page.locator(`#object-${object.id} .verdict`);
  const notGreyed = () => page.locator(".row:not(.greyed)").count();
  await page.fill("#reviewer", "Bob");
  await page.keyboard.press("Escape");
  await page.click(`#object-${second.id}`);
  await becomes(() => mark(second).getAttribute("title"), "accepted by Ann");
  await becomes(() => mark(second).innerText(), /Ann$/);
  const accept = page.locator(".inspector .accept");
  await becomes(() => accept.getAttribute("aria-pressed"), "false", "Bob has not decided");
  await becomes(() => page.locator(".inspector .status").innerText(), /Not reviewed by you/);
  await becomes(() => page.locator(".decisions").innerText(), /Team: accepted[^]*accepted Ann/);
  await page.waitForFunction(() => /, 0 by you$/.test(document.querySelector(".progress").innerText));

  // What one has not decided is gone through by key, decided by others or not.
  await page.getByRole("button", { name: "not by you" }).click();
  await becomes(() => notGreyed(), objects.length);
  await page.click(`#object-${first.id}`);
  await page.keyboard.press("a");
  await page.waitForSelector(`#object-${second.id}[aria-selected=true]`);
  await page.keyboard.press("x");
  await page.waitForSelector(`#object-${second.id} .verdict.disputed:not(.pending)`);
  await becomes(() => notGreyed(), objects.length - 2);
  const { review, decisions, is_disputed } = await api(page, `/objects/${second.id}`);
  assert.deepEqual([review.reviewer, review.verdict, is_disputed], ["Bob", "rejected", true]);
  assert.deepEqual(decisions.map((one) => `${one.reviewer} ${one.verdict}`), ["Bob rejected", "Ann accepted", " null"]);
  // All of them by Bob.
  await page.waitForFunction(() => /2 of \d+ reviewed$/.test(document.querySelector(".progress").innerText));
  await page.getByRole("button", { name: "disputed" }).click();
  await page.waitForFunction(() => document.querySelector(".list h2").innerText.startsWith("1 of "));
  await becomes(() => notGreyed(), 1);
  await page.click(`#object-${second.id}`);
  await becomes(() => mark(second).innerText(), "disputed");
  await becomes(() => page.locator(".decisions").innerText(), /Disputed\. Team: rejected[^]*rejected you[^]*accepted Ann/);

  // What another decides elsewhere is shown without a reload; taking back one's own decision leaves those of others.
  const body = { verdict: "rejected", note: "the same shed", reviewer: "Cid" };
  assert.equal((await page.request.put(`/api/v1/objects/${second.id}/review`, { data: body })).status(), 200);
  await page.waitForSelector(".decisions li:has-text('the same shed')");
  await page.request.put(`/api/v1/objects/${second.id}/review`, { data: { ...body, verdict: null, note: "" } });
  await page.waitForSelector(".decisions li:has-text('Cid')", { state: "detached" });
  await page.keyboard.press("u");
  await page.waitForSelector(`#object-${second.id} .verdict.accepted:not(.disputed):not(.pending)`);
  await page.keyboard.press("u");
  await page.waitForSelector(`#object-${first.id} .verdict.others:not(.pending)`);
  await becomes(async () => (await api(page, "/objects/counts?review=own&reviewer=Bob")).objects, 0);
  await page.getByRole("button", { name: "Clear filters" }).click();
  await page.fill("#reviewer", "Ann");
  await page.keyboard.press("Escape");
}

/** How often the server looks for changes. */
const WATCH_MS = 200;

/** What was accepted and rejected suggests a threshold, which is put into force, shown to every tab, and ended. */
async function thresholds(page) {
  await page.goto("/");
  await page.waitForSelector("[role=option]");
  await page.fill("#reviewer", "Ann");
  const row = page.locator(".learnt-row");
  const decide = (id, verdict) => page.request.put(`/api/v1/objects/${id}/review`, { data: { verdict, reviewer: "Ann" } });
  // Objects 1 to 20 are of "common", best first: 0.99, 0.94, ...; the better half is real.
  for (let id = 1; id <= 6; id++) await decide(id, "accepted");
  for (let id = 16; id <= 18; id++) await decide(id, "rejected");
  await page.getByRole("group", { name: "Filters" }).getByRole("button", { name: "common" }).click();
  await page.waitForSelector(".learnt-row:has-text('6 accepted, 3 rejected; a threshold is learnt from 10 decisions on')");
  await page.getByRole("button", { name: "Clear filters" }).click();
  await row.waitFor({ state: "detached" });
  await decide(15, "rejected");
  await page.waitForSelector(".learnt-row:has-text('6 accepted, 4 rejected; below 0.3, all 4 were rejected')");
  await becomes(() => page.locator(".row.greyed").count(), 0, "nothing changes by itself");

  // Of another reader, who hears of changes late: what came in between is loaded, too.
  const second = await (await page.context().browser().newContext({ baseURL: page.url() })).newPage();
  let tell;
  const isTold = new Promise((resolve) => (tell = resolve));
  await second.route("**/api/v1/events", async (route) => {
    await isTold;
    await route.continue();
  });
  await second.goto("/");
  await second.waitForSelector("[role=option]");
  await page.getByRole("button", { name: "Only ≥ 0.3" }).click();
  await page.waitForSelector(".learnt-row:has-text('only ≥ 0.3')");
  await page.waitForTimeout(10 * WATCH_MS);
  tell();
  // 0.09 and 0.04; what was decided stays, and other models are not asked.
  for (const tab of [page, second]) {
    await tab.waitForFunction(() => document.querySelector(".list h2")?.textContent === "22 of 24 objects");
    await tab.waitForSelector(".learnt-row:has-text('only ≥ 0.3: leaves out 2 objects')");
  }
  await checkAccessible(page, "a threshold in force");
  await page.waitForFunction(() => document.querySelector("[role=option]")?.getAttribute("aria-setsize") === "22");
  const [table] = await Promise.all([page.waitForEvent("download"), saveAs(page, "Table (CSV)")]);
  assert.equal(readFileSync(await table.path(), "utf8").trim().split("\r\n").length, 1 + 22);
  await becomes(async () => (await api(page, "/objects?limit=100")).objects.length, 24, "the index is as it was");
  await page.reload();
  await page.waitForFunction(() => document.querySelector(".list h2")?.textContent === "22 of 24 objects");
  await becomes(() => page.getByRole("button", { name: "Clear filters" }).count(), 0, "it is the team's, not a filter of the reader");

  await page.getByRole("button", { name: "Show all of common" }).click();
  for (const tab of [page, second]) await tab.waitForFunction(() => document.querySelector(".list h2")?.textContent === "24 objects");
  await page.getByRole("button", { name: "Only ≥ 0.3" }).waitFor();
  await checkCost(page, decide);
}

/** What the slider costs is that of the other filters, and knows what was decided. Of "rare" there are 0.1, 0.2, 0.3 and 0.4. */
async function checkCost(page, decide) {
  const becomesCost = (falseAlarms, misses) =>
    becomes(() => page.locator(".cost").innerText(), `${falseAlarms}\nabout ${misses} real objects hidden`);
  await page.getByRole("group", { name: "Filters" }).getByRole("button", { name: "rare" }).click();
  await page.locator("#threshold").fill("0.25");
  await becomesCost("about 1.3 false alarms shown", "0.3");
  await decide(21, "accepted");
  await becomesCost("about 1.3 false alarms shown", "1.2");
  await decide(24, "rejected");
  await becomesCost("1 rejected; about 0.7 further false alarms", "1.2");
  await checkAccessible(page, "a threshold and its cost");
}

/** The main states, looked at by axe in both themes. */
async function accessible(page) {
  await open(page, "/");
  await page.waitForSelector(".map .canvas[data-ready=true]");
  await page.waitForSelector(".crop .turn");
  const { objects } = await api(page, "/objects");
  await checkAccessible(page, "the page");
  const blur = () => page.evaluate(() => document.activeElement?.blur());

  // Filters, marks, decisions, a note, an area that is being drawn.
  await page.keyboard.press("m");
  await page.fill("#search", objects[0].model);
  await blur();
  await page.keyboard.press("a");
  await page.waitForSelector(`#object-${objects[0].id} .verdict.accepted:not(.pending)`);
  await page.click(`#object-${objects[0].id}`);
  await page.keyboard.press("m");
  await page.keyboard.press("d");
  await page.waitForSelector(".map form.area");
  await checkAccessible(page, "filtered, marked, an area drawn");
  await page.keyboard.press("Escape");
  await page.getByRole("button", { name: "Clear filters" }).click();

  // The dialogs.
  for (const [key, dialog] of [["?", "dialog.help[open]"], ["w", "dialog.why[open] .evidence svg"], ["t", "dialog.turning[open] .turntable canvas[data-view]"]]) {
    await blur();
    await page.keyboard.press(key);
    await page.waitForSelector(dialog);
    await checkAccessible(page, dialog);
    await page.keyboard.press("Escape");
    await page.waitForFunction(() => document.querySelector("dialog[open]") === null);
  }

  // Jobs and the dialog of a new model.
  await page.getByRole("button", { name: "Add" }).click();
  await page.setInputFiles("aside input[type=file]", { name: "broken.mp4", mimeType: "video/mp4", buffer: Buffer.from("no video") });
  await page.waitForSelector(".job.failed");
  await checkAccessible(page, "the list of jobs, with an error");
  await page.setInputFiles("aside input[type=file]", { name: "a.png", mimeType: "image/png", buffer: Buffer.from("no image") });
  await page.waitForSelector("dialog.model[open]");
  await checkAccessible(page, "the dialog of a new model");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => document.querySelector("dialog[open]") === null);
  // Escape closes the panel, too.
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press("Escape");
  await page.waitForSelector("aside.jobs", { state: "detached" });
}

/** A tablet, and a laptop at 200 %: nothing is cut off, and the map has room for what it shows. */
async function narrow(page) {
  await open(page, "/");
  await page.waitForSelector(".map .canvas[data-ready=true]");
  await page.waitForSelector(".facts-grid .wide");
  const box = (selector) => page.locator(selector).first().boundingBox();
  for (const [width, height] of [[1024, 768], [820, 1180], [1280, 720], [720, 450], [640, 400]]) {
    const what = `${width} x ${height}`;
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(300);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), `${what}: wider than the window`);
    for (const selector of [".inspector", ".list", ".head", ".map .tools", ".review .buttons"]) {
      const cut = await page.locator(selector).evaluate((one) => one.scrollWidth - one.clientWidth);
      assert.ok(cut <= 1, `${what}: ${selector} is cut off by ${cut} px`);
    }
    for (const name of ["why", "turn"]) assert.ok(await page.getByRole("button", { name, exact: true }).isVisible(), `${what}: ${name}`);
    const [map, head] = [await box(".map .on-map"), await box(".head")];
    assert.ok(map.height >= 190 && map.width >= 260, `${what}: the map has ${map.width} x ${map.height}`);
    assert.ok(head.height < 100, `${what}: the header has ${head.height}`);
    await page.keyboard.press("d");
    await becomes(() => page.evaluate(() => document.activeElement.id), "area-corners");
    const [form, field, area] = [await box("form.area"), await box("#area-corners"), await box(".map .on-map")];
    assert.ok(form.y >= area.y + area.height - 1, `${what}: the form covers the map`);
    assert.ok(field.y >= 0 && field.y + field.height <= height, `${what}: the field is out of sight`);
    await page.keyboard.press("Escape");
    await page.waitForSelector("form.area", { state: "detached" });
  }
  // List and decision are above the fold; what opens or is said covers neither them nor the map's controls.
  const isApart = (a, b) => a.x + a.width <= b.x + 1 || b.x + b.width <= a.x + 1 || a.y + a.height <= b.y + 1 || b.y + b.height <= a.y + 1;
  for (const [width, height] of [[1440, 900], [1024, 768], [720, 450]]) {
    const what = `${width} x ${height}`;
    await page.setViewportSize({ width, height });
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.waitForTimeout(300);
    for (const selector of [".inspector .accept", ".inspector .reject", SELECTED]) {
      const { y, height: own } = await box(selector);
      assert.ok(y >= 0 && y + own <= height + 1, `${what}: ${selector} ends at ${y + own}`);
    }
    const checkApart = async (selector, others) => {
      const covering = await box(selector);
      for (const one of others) assert.ok(isApart(covering, await box(one)), `${what}: ${selector} covers ${one}`);
    };
    await page.keyboard.press("x");
    await page.locator(".notice", { hasText: "rejected" }).waitFor();
    await checkApart(".notice", [".list", ".inspector", ".map", ".stage-tools"]);
    await page.keyboard.press("u");
    await page.waitForFunction(() => document.querySelector(".notice") === null);
    await page.getByRole("button", { name: "Add" }).click();
    await checkApart("aside.jobs", [".list", ".inspector", ".map .tools", ".maplibregl-ctrl-group"]);
    // The video alone remains alone.
    await page.keyboard.press("f");
    await becomes(() => page.locator(".page").evaluate((one) => getComputedStyle(one).gridTemplateAreas), '"video"', what);
    await page.keyboard.press("f");
    await page.keyboard.press("Escape");
    await page.locator("aside.jobs").waitFor({ state: "detached" });
    if (width >= 1100) continue;
    await page.getByRole("button", { name: "Filters" }).click();
    const rows = await box(".rows");
    assert.ok(Math.min(rows.y + rows.height, height) - rows.y >= 160, `${what}: the open filters leave the list ${rows.height} at ${rows.y}`);
    await checkApart("#filters", [".rows"]);
    await checkAccessible(page, `${what}, with filters`);
    await page.getByRole("button", { name: "Filters" }).click();
  }
  // A tablet folds the filters.
  await page.setViewportSize({ width: 1024, height: 768 });
  await becomes(() => page.locator(".chips").isVisible(), false);
  await page.getByRole("button", { name: "Filters" }).click();
  await page.getByRole("button", { name: "to review" }).click();
  const [rows, below] = [await box(".rows"), await box(".inspector")];
  assert.ok(rows.height >= 160 && rows.y + 160 <= below.y, `the open filters leave the list ${rows.height} at ${rows.y}`);
  await becomes(() => page.locator(".inspector").evaluate((one) => one.scrollHeight <= one.clientHeight), true, "all facts are shown");
  await checkAccessible(page, "a tablet, with filters");
}

/** A search that is behind its live source says so in the list of jobs and over the picture; one that keeps up does not. */
async function checkBehind(page, source) {
  const { jobs } = await api(page, "/jobs");
  const second = await page.context().newPage();
  let behind_s = 12.4;
  await second.route("**/api/v1/jobs", (route) => route.fulfill({ json: { jobs: jobs.map((one) => ({ ...one, behind_s })) } }));
  await second.route("**/api/v1/events", (route) => route.fulfill({ contentType: "text/event-stream", body: "" }));
  // Nor do other tabs tell it.
  await second.addInitScript(() => (window.BroadcastChannel = class { postMessage() {} }));
  const show = async () => {
    await second.goto("/");
    await second.getByRole("button", { name: "1 job" }).click();
    await second.waitForSelector(`.job.running:has(strong:text-is("${source}"))`);
    await second.waitForSelector(".stage [role=alert]");
  };
  await show();
  await second.locator(".job.running .behind", { hasText: /^up to 13 s behind$/ }).waitFor();
  await second.locator(".stage .corner .behind", { hasText: /^up to 13 s behind$/ }).waitFor();
  await checkAccessible(second, "a live source that is behind");
  behind_s = 0.6;
  await show();
  await becomes(() => second.locator(".behind").count(), 0, "it keeps up");
  await second.close();
}

/** A live source by its address: its finds are on the page while it sends; stopped, they stay. */
async function live(page, [source]) {
  await page.goto("/");
  await page.waitForSelector(".empty");
  await page.getByRole("button", { name: "Add" }).click();
  await page.fill("#live-url", source);
  await page.getByRole("button", { name: "Start" }).click();
  const job = (state) => `.job.${state}:has(strong:text-is("${source}"))`;
  await page.waitForSelector(job("running"));
  await page.waitForSelector("[role=option]", { timeout: 120_000 });
  await becomes(() => page.locator(job("running")).count(), 1, "finds come while the source sends");
  // What is shown of it: its frames are not kept.
  await page.waitForSelector(".stage [role=alert]:has-text('its frames are not kept')");
  await checkBehind(page, source);
  await page.locator(job("running")).getByRole("button", { name: "Stop" }).click();
  await page.waitForSelector(job("done"), { timeout: 60_000 });
  const { objects } = await api(page, "/objects");
  assert.ok(objects.length > 0, "what it found stays");
  const { videos } = await api(page, "/videos");
  assert.deepEqual(videos.map((one) => one.name), [source]);
}

/** A base map lies below what was found, with its attribution. */
async function tiles(page, [described]) {
  const { colour, attribution } = JSON.parse(described);
  await page.emulateMedia({ colorScheme: "light" }); // in the dark, images are darker
  await page.goto("/");
  await page.waitForSelector(".map .canvas[data-ready=true]");
  let found = null;
  for (let tries = 0; tries < 100 && !found; tries++) {
    found = await findOnMap(page, colour);
    if (!found) await page.waitForTimeout(200);
  }
  assert.ok(found, `no tile of colour ${colour} on the map`);
  await becomes(() => page.locator(".map .attribution").count(), attribution === "" ? 0 : 1);
  if (attribution !== "") await becomes(() => page.locator(".map .attribution").innerText(), attribution);
  // Other colours of the page: the map stays.
  await page.emulateMedia({ colorScheme: "dark" });
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark");
  await becomes(() => page.locator(".notice.error:has-text('base map')").count(), 0);
}

/** A model turns by drag, keys and its disc; the views that matched are shown, and lead to their sightings. */
async function turning(page) {
  await open(page, "/?object=9001");
  await page.waitForSelector("#object-9001[aria-selected=true]");
  await page.waitForSelector(".crop .turn");
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press("t");
  const shownView = () => page.evaluate(() => Number(document.querySelector(".turntable canvas").dataset.view ?? NaN));
  const waitForView = (view) => page.waitForFunction((wanted) => document.querySelector(".turntable canvas")?.dataset.view === String(wanted), view);
  await waitForView(7); // of the best sighting
  const { views } = await api(page, `/models/${(await api(page, "/objects/9001")).model_id}/views`);
  assert.equal(views.length, 25);
  await becomes(() => page.locator(".disc .dot").count(), 25);
  await becomes(() => page.locator(".disc .dot.own").count(), 2);
  await becomes(() => page.locator(".disc .dot.others").count(), 1);

  // Each step of a ring by key, the whole way round; then up to straight above and down to the lowest ring.
  const turntable = page.locator(".turntable");
  await turntable.focus();
  const seen = [];
  for (let i = 0; i < 12; i++) {
    seen.push(await shownView());
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction((before) => document.querySelector(".turntable canvas").dataset.view !== String(before), seen[i]);
  }
  assert.equal(new Set(seen).size, 12);
  await becomes(() => shownView(), 7);
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowUp");
  await waitForView(0);
  await becomes(() => turntable.getAttribute("aria-valuetext"), /straight from above/);
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowDown");
  const lowest = await page.waitForFunction(() => Number(document.querySelector(".turntable canvas").dataset.view)).then((one) => one.jsonValue());
  assert.ok(views[lowest].off_nadir_deg > 59, `view ${lowest}`);

  // A drag passes views one after the other, without waiting for the server: all have come.
  await page.waitForFunction(() => new Set(performance.getEntriesByType("resource").map((one) => /views\/(\d+)$/.exec(one.name)?.[1]).filter(Boolean)).size >= 25);
  const box = await turntable.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const dragged = new Set();
  for (let right = 0; right <= 240; right += 20) {
    await page.mouse.move(x + right, y);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    dragged.add(await shownView());
  }
  await page.mouse.up();
  assert.ok(dragged.size >= 4, `only views ${[...dragged]}`);

  // The picture is drawn, and that of another view is another one.
  const ink = () => page.evaluate(() => {
    const canvas = document.querySelector(".turntable canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let [low, high] = [255, 0];
    for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 0) [low, high] = [Math.min(low, data[at]), Math.max(high, data[at])];
    return high - low;
  });
  assert.ok((await ink()) > 40, "a rendering is drawn");

  // The views that matched: its own first; a click goes to the sighting.
  const matches = page.locator(".match-view");
  await becomes(() => matches.count(), 3);
  await becomes(() => matches.nth(0).innerText(), /This object/);
  await becomes(() => matches.nth(2).innerText(), /Object 9002/);
  await matches.nth(2).hover();
  await waitForView(20);
  await matches.nth(1).click();
  await page.waitForSelector("dialog.turning[open]", { state: "detached" });
  await waitForFrame(page, 5);
  await becomes(() => selectedId(page), 9001);

  // By mouse from the view beside the best sighting; photos go one by one.
  const photo = (await api(page, "/objects?model=crate")).objects[0];
  await page.click(`#object-${photo.id}`);
  await page.getByRole("button", { name: "Turn crate" }).click();
  await waitForView(0);
  await becomes(() => page.locator(".disc").count(), 0, "photos have no direction");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog.turning[open]", { state: "detached" });
}

/**
 * Without a link: prints the one of the second object, which an older link by its id becomes. With it, and what it showed: shows
 * the same object, which has another id now.
 */
async function link(page, [sent, shown]) {
  const { objects } = await api(page, "/objects");
  if (sent === undefined) {
    const [, { id, model, first_time_s }] = objects;
    const { key } = await api(page, `/objects/${id}`);
    // This server has no models: the page opens without a complaint about jobs.
    await Promise.all([page.waitForResponse((answer) => answer.url().endsWith("/api/v1/jobs")), open(page, `/?object=${id}`)]);
    await becomes(() => selectedId(page), id);
    await becomes(() => page.locator(".notice.error").count(), 0);
    await page.waitForFunction((name) => new URLSearchParams(location.search).get("object") === name, key);
    console.log(JSON.stringify({ link: new URL(page.url()).search, id, model, first_time_s, frame: await shownFrame(page) }));
    return;
  }
  const before = JSON.parse(shown);
  await open(page, `/${sent}`);
  await page.waitForSelector(SELECTED);
  const after = objects.find((one) => one.model === before.model && one.first_time_s === before.first_time_s);
  assert.notEqual(after.id, before.id, "the test needs another id");
  await becomes(() => selectedId(page), after.id);
  await waitForFrame(page, before.frame);
  await page.goto("/?object=0123456789abcdef.1.2.3.4.5.jeep");
  await page.locator(".notice.error", { hasText: "The object of this link is not in this index" }).waitFor();
}

async function accounts(page, [password]) {
  const logIn = async (name, word) => {
    await page.fill("#log-in-name", name);
    await page.fill("#log-in-password", word);
    await page.keyboard.press("Enter");
  };
  await page.goto("/");
  await page.waitForSelector("dialog.log-in[open]");
  await becomes(() => page.locator("[role=option]").count(), 0, "nothing is shown before");
  await checkAccessible(page, "the log-in");
  assert.equal(await page.evaluate(() => document.activeElement.id), "log-in-name");
  await page.keyboard.press("Escape");
  await logIn("ann", "not her password");
  await page.waitForSelector("dialog.log-in .problem:has-text('name or password is wrong')");
  await logIn("ann", password);
  await page.waitForSelector(".stage canvas[data-frame]");
  await becomes(() => page.locator(".head .user").innerText(), /ann analyst/);
  await becomes(() => page.locator("#reviewer").count(), 0, "the account says who reviews");
  const { objects } = await api(page, "/objects");
  await page.keyboard.press("a");
  await page.waitForSelector(`#object-${objects[0].id} .verdict.accepted:not(.pending)`);
  await becomes(async () => (await api(page, `/objects/${objects[0].id}`)).review?.reviewer, "ann");

  // A session that ends while the page is open: what was decided is stored after the next log-in.
  await becomes(() => selectedId(page), objects[1].id);
  // It ends with the decision: another request that is refused before it opens the form, which takes the key.
  const reviews = "**/api/v1/objects/*/review";
  await intercept(page, reviews, async (route) => {
    await page.context().clearCookies();
    const { cookie: _, ...headers } = await route.request().allHeaders();
    const refused = await route.fetch({ headers });
    assert.equal(refused.status(), 401);
    await route.fulfill({ response: refused });
  }, { times: 1 });
  await page.keyboard.press("x");
  await page.waitForSelector("dialog.log-in[open]");
  await logIn("ann", password);
  await page.waitForSelector(`#object-${objects[1].id} .verdict.rejected:not(.pending)`);
  await becomes(async () => (await api(page, `/objects/${objects[1].id}`)).review?.verdict, "rejected");

  // Log-out leaves nothing on the page, and the next user is asked for.
  await page.click(".head .user button");
  await page.waitForSelector("dialog.log-in[open]");
  await becomes(() => page.locator("[role=option]").count(), 0);
  assert.equal((await page.request.get("/api/v1/objects")).status(), 401);
  await logIn("bob", password);
  await page.waitForSelector("[role=option]");
  assert.ok(await page.locator(".inspector .accept").isDisabled(), "a viewer does not review");
  await page.keyboard.press("b");
  await page.waitForSelector(".notice.error:has-text('You may look, but not add or search')");
  await page.keyboard.press("x");
  await page.waitForSelector(".notice.error:has-text('role analyst')");
  await becomes(async () => (await api(page, `/objects/${objects[0].id}`)).review?.verdict, "accepted");
}

/** Two videos wait; a worker finds the objects of one, and that the other is gone. */
async function workers(page, [program, db]) {
  await page.goto("/");
  await page.getByRole("button", { name: "Workers" }).click();
  const panel = page.getByRole("complementary", { name: "Workers" });
  const videos = panel.getByRole("row", { name: /^Videos/ });
  await becomes(() => videos.innerText(), /^Videos\s+2\s+0\s+0\s+0\s+0$/, "two are queued");
  await panel.getByText("No worker has a task").waitFor();
  await panel.getByText(/known once the queued videos are cut/).waitFor();
  await checkAccessible(page, "the panel of workers");

  const worked = spawnSync(program, ["work", "--db", db, "--until-empty", "--retry-delay", "0"]);
  assert.equal(worked.status, 1, String(worked.stderr));
  await becomes(() => videos.innerText(), /^Videos\s+0\s+0\s+0\s+1\s+1$/, "one is done, one has failed");
  const failed = panel.getByRole("listitem").filter({ hasText: "gone.mp4" });
  await becomes(() => failed.innerText(), /no such file|does not exist|cannot open/i);
  await page.locator("[role=option]").first().waitFor();
  await panel.getByRole("button", { name: "Close" }).click();
  await panel.waitFor({ state: "detached" });
}

/** More tabs than a browser has connections to one server: one of them listens to its events, for all. */
async function tabs(page) {
  const streams = [];
  page.context().on("request", (request) => request.url().endsWith("/api/v1/events") && streams.push(request));
  const others = [];
  for (let i = 0; i < 6; i++) others.push(await page.context().newPage());
  const all = [...others, page];
  for (const one of all) {
    await one.goto("/");
    await one.waitForSelector("[role=option]");
  }
  assert.equal(streams.length, 1);
  const { objects } = await api(page, "/objects");
  /** Decides in one tab, and waits until each has heard of it. */
  const decide = async (one, key, object, verdict) => {
    await one.click(`#object-${object.id}`);
    await one.keyboard.press(key);
    for (const open of all) await open.waitForSelector(`#object-${object.id} .verdict.${verdict}:not(.pending)`);
  };
  await decide(all[3], "a", objects[0], "accepted");
  // The one that listens is closed.
  await all.shift().close();
  await decide(page, "x", objects[1], "rejected");
  assert.equal(streams.length, 2);
}

/** A note is typed before the browser has drawn what was selected: no letter is lost, none is a command. */
async function notes(page) {
  await page.addInitScript(() => {
    window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 3000);
  });
  await page.goto("/");
  await page.waitForSelector(SELECTED);
  for (const [key, text] of [["j", "next to a shed"], ["k", "an axle is missing"], ["j", "next to an axle"]]) {
    const before = await selectedId(page);
    await page.keyboard.press(key);
    await page.keyboard.press("n");
    await page.keyboard.type(text);
    const id = await selectedId(page);
    assert.notEqual(id, before);
    // Without leaving the field: a reload loses nothing.
    await until(page, `/objects/${id}`, ({ review }) => review?.note === text && review.verdict === null);
    await page.keyboard.press("Escape");
  }
}

/** Objects that are one are joined, and moments of another one split off; both are taken back, also after a reload. */
async function grouping(page) {
  await page.goto("/");
  await page.waitForSelector(SELECTED);
  const groups = async () => {
    const { objects } = await api(page, "/objects");
    return JSON.stringify(objects.map(({ moments }) => moments.map(({ id }) => id).sort()).sort());
  };
  const rows = async () => (await page.locator("[role=option]").evaluateAll((all) => all.map((one) => Number(one.id.replace("object-", ""))))).sort().join();
  const mark = (id) => page.click(`#object-${id}`, { modifiers: ["Control"] });
  const becomeObjects = async (wanted, selected) => {
    await becomes(groups, JSON.stringify(wanted));
    await becomes(rows, wanted.map(([id]) => id).join());
    await becomes(() => selectedId(page), selected);
  };
  await becomeObjects([[1], [2], [3], [4]], 1);

  const join = page.locator(".marked-bar").getByRole("button", { name: "Join" });
  for (const id of [1, 3]) await mark(id);
  await becomes(() => join.getAttribute("title"), /different models.*: common, rare/);
  await becomes(() => join.getAttribute("aria-disabled"), "true");
  for (const id of [3, 2]) await mark(id);
  await becomes(() => join.getAttribute("aria-disabled"), "false");
  await page.keyboard.press("g");
  await page.locator(".notice", { hasText: "Joined 2 objects." }).waitFor();
  await becomeObjects([[1, 2], [3], [4]], 1);
  assert.equal(await page.locator(".marked-bar").count(), 0);
  await page.reload();
  await page.waitForSelector(SELECTED);
  await page.keyboard.press("u");
  await becomeObjects([[1], [2], [3], [4]], 1);

  for (const id of [1, 2]) await mark(id);
  await join.click();
  await becomeObjects([[1, 2], [3], [4]], 1);
  await page.locator(".inspector").getByRole("button", { name: "2 moments" }).click();
  await page.locator(".inspector .moment input").nth(1).check();
  await checkAccessible(page, "moments");
  await page.locator(".inspector").getByRole("button", { name: "split off 1 moment" }).click();
  const told = page.locator(".notice", { hasText: "Split object 1: 1 moment is object 2." });
  await told.waitFor();
  await becomeObjects([[1], [2], [3], [4]], 1);
  await told.getByRole("button", { name: "Show" }).click();
  await becomes(() => selectedId(page), 2);
  await page.keyboard.press("u");
  await becomeObjects([[1, 2], [3], [4]], 1);
}

const [scenario, url, ...inputs] = process.argv.slice(2);
if (!existsSync(BROWSER)) {
  console.log(`SKIPPED: ${BROWSER} is not installed`);
  process.exit(77);
}
const hasMap = WITH_MAP.includes(scenario);
const browser = await chromium.launch({ executablePath: BROWSER, args: hasMap ? FLAGS : [...FLAGS, "--disable-webgl"] });
try {
  const context = await browser.newContext({ baseURL: url, viewport: { width: 1280, height: 720 }, colorScheme: "dark" });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  const faults = [];
  page.on("pageerror", (error) => faults.push(`error on the page: ${error.message}`));
  page.on("console", (message) => {
    const isExpected = /status of 4\d\d|GPU stall/.test(message.text());
    const isOfMap = /^Image .* could not be loaded/.test(message.text());
    if ((message.type() === "error" || isOfMap) && !isExpected) faults.push(`console: ${message.text()}`)
  });
  page.on("request", (request) => {
    const isOfBaseMap = scenario === "tiles" && request.url().startsWith(JSON.parse(inputs[0]).origin ?? url);
    if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(url) && !isOfBaseMap) faults.push(`asks ${request.url()}`);
  });
  await { triage, link, frames, coverage, copies, images, many, thresholds, tiles, turning, accessible, live, zoomed, jobs, steps, workers, accounts, videos, narrow, tabs, notes, grouping }[scenario](page, inputs);
  if (!hasMap) await becomes(() => page.locator(".map [role=alert]").innerText(), /needs WebGL/);
  assert.deepEqual(faults, []);
} finally {
  await browser.close();
}
