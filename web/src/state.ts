// The state of the page: one selection rules list, video and map. Views read signals; everything that changes them is a
// function here.
import { batch, computed, effect, signal, untracked } from "@preact/signals";

import { ApiFailure, getCameraPath, getObject, getProject, getTimes, listObjectSightings, listVideos, putReview } from "./api/client";
import type { CameraPath, FoundObject, ObjectDetail, Project, Verdict, Video } from "./api/types";
import { toCsv, toGeoJson } from "./logic/export";
import { NO_FILTERS, type Filters, makeMatcher } from "./logic/filters";
import { COORDINATE_STYLES, type CoordinateStyle, plural } from "./logic/format";
import { onEvent, startEvents } from "./events";
import { account } from "./session";
import { FrameTable } from "./logic/frame_table";
import { formatUrl, parseUrl } from "./logic/url_state";
import * as objects from "./objects";

const RETRY_MS = 3000;

export type Load<T> = { state: "loading" } | { state: "ready"; value: T } | { state: "failed"; message: string };

// ---- what the server has

export const project = signal<Load<Project>>({ state: "loading" });
export const videos = signal<Video[]>([]);
export const isConnected = signal(true);
/** Changes with the index that the server shows. */
export const indexVersion = signal(0);

// ---- what the user chose

export const filters = signal<Filters>(NO_FILTERS);
/** Leaves out of the list what the filters grey out. */
export const isOnlyMatching = signal(false);
export const sort = signal<objects.Sort>("queue");
/** Who reviews: written into each review. */
export const reviewer = signal(localStorage.getItem("reviewer") ?? "");
const reviewerName = () => account.value?.name ?? reviewer.value;
/** For the case that `can_review` is not set. */
export const whyNoReview = computed(() =>
  account.value?.role === "viewer"
    ? "You may look, but not review: that needs the role analyst."
    : "This index cannot be written: reviews are not kept.",
);
export const selectedId = signal<number | null>(null);
export const videoId = signal<number | null>(null);
/** The frame that the video shows; null before it shows one. */
export const shownFrame = signal<number | null>(null);
export const isPlaying = signal(false);
export const isOverlayHidden = signal(false);
/** The next drag over the frame boxes an object. */
export const isBoxing = signal(false);
export const isHelpOpen = signal(false);
export const coordinateStyle = signal<CoordinateStyle>(
  COORDINATE_STYLES.find((one) => one === localStorage.getItem("coordinates")) ?? "decimal",
);
/** Objects that the next decision is about, together. */
export const marked = signal<ReadonlySet<number>>(new Set());
export type Theme = "system" | "dark" | "light";
export const theme = signal<Theme>((localStorage.getItem("theme") as Theme | null) ?? "system");

const lightSystem = window.matchMedia("(prefers-color-scheme: light)");
const isSystemLight = signal(lightSystem.matches);
lightSystem.addEventListener("change", (event) => (isSystemLight.value = event.matches));
/** The colours shown: the chosen ones, or the system's. */
export const colours = computed(() => (theme.value === "system" ? (isSystemLight.value ? "light" : "dark") : theme.value));

/** Where the video should go. Each request is a new object, also to the same frame. */
export const seekRequest = signal<{ video: number; time: number } | null>(null);

// ---- what follows from both

export const matcher = computed(() => makeMatcher(filters.value));
export const selected = computed(() => (selectedId.value === null ? null : (objects.objectOf(selectedId.value) ?? null)));
export const video = computed(() => videos.value.find((one) => one.id === videoId.value) ?? null);
export const modelNames = computed(() =>
  project.value.state === "ready" ? project.value.value.models.map((one) => one.name) : [],
);
const modelById = computed(
  () => new Map(project.value.state === "ready" ? project.value.value.models.map((one) => [one.id, one.name]) : []),
);
export const modelName = (id: number) => modelById.value.get(id) ?? "";

export const frameTable = signal<Load<FrameTable>>({ state: "loading" });
export const cameraPath = signal<CameraPath | null>(null);
export const detail = signal<Load<ObjectDetail> | null>(null);
export const shownTime = computed(() =>
  shownFrame.value !== null && frameTable.value.state === "ready" ? frameTable.value.value.timeOf(shownFrame.value) : null,
);

// Okabe and Ito's colours, which people with any colour vision tell apart; a name stands beside each.
// Their sky blue is the accent of the page, and left out.
const COLOURS = ["#e69f00", "#00b98a", "#cc79a7", "#f0e442", "#d55e00", "#9f8cff", "#c2a878"];
export function colourOf(model: string): string {
  const at = modelNames.value.indexOf(model);
  return COLOURS[Math.max(at, 0) % COLOURS.length] ?? "#e69f00";
}

// ---- messages

export interface Notice {
  id: number;
  text: string;
  kind: "info" | "error";
}
export const notices = signal<Notice[]>([]);
let nextNotice = 0;

export function notify(text: string, kind: Notice["kind"] = "info") {
  const id = nextNotice++;
  notices.value = [...notices.value.filter((one) => one.text !== text), { id, text, kind }];
  setTimeout(() => dismiss(id), kind === "error" ? 12_000 : 4000);
}

export function dismiss(id: number) {
  notices.value = notices.value.filter((one) => one.id !== id);
}

const messageOf = (error: unknown) => (error instanceof Error ? error.message : String(error));

// ---- loading

/** Loads what the page begins with; tries again by itself while the server does not answer. */
export async function load() {
  try {
    const [summary, found] = await Promise.all([getProject(), listVideos()]);
    objects.setQueueTime(summary.now_utc_us);
    await objects.loadList(sort.value, filters.value, isOnlyMatching.value);
    batch(() => {
      project.value = { state: "ready", value: summary };
      videos.value = found;
      isConnected.value = true;
    });
    await openFromUrl();
    startLive();
  } catch (error) {
    isConnected.value = !(error instanceof ApiFailure && error.status === 0);
    const isLoggedOut = error instanceof ApiFailure && error.status === 401;
    if (project.value.state !== "ready" && !isLoggedOut) project.value = { state: "failed", message: messageOf(error) };
    setTimeout(() => void load(), RETRY_MS);
  }
}

/** What has changed on the server: numbers, videos, tiles. The list keeps its order until the user asks for another. */
export async function refresh() {
  try {
    const [summary, found] = await Promise.all([getProject(), listVideos()]);
    const isFirst = objects.list.peek()?.total === 0 && summary.objects > 0;
    if (isFirst) objects.setQueueTime(summary.now_utc_us);
    await objects.refreshCounts();
    if (isFirst) await showNew();
    batch(() => {
      project.value = { state: "ready", value: summary };
      videos.value = found;
      indexVersion.value++;
    });
    if (videoId.peek() === null && found[0]) showTime(found[0].id, 0);
    if (selectedId.peek() === null && isFirst) step(1);
  } catch (error) {
    isConnected.value = !(error instanceof ApiFailure && error.status === 0);
  }
}

/** Makes the list anew, with what was found since it was made. */
export async function showNew() {
  await objects.loadList(sort.peek(), filters.peek(), isOnlyMatching.peek());
}

/** Saves the objects that match the filters as a file, in the order of the list. */
export async function saveList(kind: "csv" | "geojson") {
  try {
    const found = await objects.loadAll(sort.peek(), filters.peek());
    const text = kind === "csv" ? toCsv(found) : JSON.stringify(toGeoJson(found));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: kind === "csv" ? "text/csv" : "application/geo+json" }));
    link.download = `objects.${kind}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    notify(`Saved ${plural(found.length, "object")}.`);
  } catch (error) {
    notify(`The list is not saved: ${messageOf(error)}`, "error");
  }
}

let isLive = false;

/** Follows what the server tells from now on. */
function startLive() {
  if (isLive) return;
  isLive = true;
  let known: number | null = null;
  onEvent("index", (data) => {
    const { version } = data as { version: number };
    // The first one says what was loaded just now.
    if (known !== null && version !== known) void refresh();
    known = version;
  });
  startEvents();
}

async function openFromUrl() {
  const wanted = parseUrl(location.search);
  if (wanted.object !== null && !objects.objectOf(wanted.object)) await objects.locate(wanted.object).catch(() => undefined);
  const target = wanted.object === null ? undefined : objects.objectOf(wanted.object);
  if (target) {
    select(target.id, { seek: wanted.time === null });
  } else if (wanted.object !== null) {
    notify(`Object ${wanted.object} is not in this index (a new search may have joined or removed it).`, "error");
  }
  const first = wanted.video ?? target?.moments[0]?.video_id ?? videos.value[0]?.id ?? null;
  if (first !== null && wanted.time !== null) return showTime(first, wanted.time);
  const best = objects.list.value?.at(0);
  if (!target && wanted.object === null && best !== undefined) return select(best);
  if (first !== null && videoId.value === null && !target) showTime(first, 0);
}

// The list and the counts follow what the user chose.
effect(() => {
  const [order, chosen, isOnly] = [sort.value, filters.value, isOnlyMatching.value];
  if (project.value.state !== "ready") return;
  untracked(() => objects.follow(order, chosen, isOnly, (error) => notify(messageOf(error), "error")));
});

// What could not be loaded because the session had ended.
effect(() => {
  if (account.value !== null && project.peek().state === "ready") untracked(() => void refresh());
});

// What the time line shows of the video.
effect(() => {
  const id = videoId.value;
  void indexVersion.value;
  if (id === null) return;
  const abort = new AbortController();
  objects.loadVideoObjects(id, abort.signal).catch((error: unknown) => {
    if (!abort.signal.aborted) notify(messageOf(error), "error");
  });
  return () => abort.abort();
});

// Times and camera of the video that is shown.
effect(() => {
  const id = videoId.value;
  if (id === null) return;
  const abort = new AbortController();
  batch(() => {
    frameTable.value = { state: "loading" };
    cameraPath.value = null;
    shownFrame.value = null;
  });
  getTimes(id, abort.signal)
    .then((times) => (frameTable.value = { state: "ready", value: new FrameTable(times) }))
    .catch((error: unknown) => {
      if (!abort.signal.aborted) frameTable.value = { state: "failed", message: messageOf(error) };
    });
  getCameraPath(id, abort.signal)
    .then((path) => (cameraPath.value = path))
    .catch((error: unknown) => {
      if (!abort.signal.aborted) notify(messageOf(error), "error");
    });
  return () => abort.abort();
});

/** The object whose best sighting is to be shown once it is known. */
let seekToBest: number | null = null;

// The selection's details.
effect(() => {
  const id = selectedId.value;
  if (id === null) {
    detail.value = null;
    return;
  }
  const abort = new AbortController();
  detail.value = { state: "loading" };
  getObject(id, abort.signal)
    .then((value) => {
      batch(() => {
        detail.value = { state: "ready", value };
        if (seekToBest === id && value.best) showTime(value.best.video_id, value.best.time_s);
        if (seekToBest === id) seekToBest = null;
      });
    })
    .catch((error: unknown) => {
      if (!abort.signal.aborted) detail.value = { state: "failed", message: messageOf(error) };
    });
  return () => abort.abort();
});

effect(() => localStorage.setItem("reviewer", reviewer.value));
effect(() => localStorage.setItem("coordinates", coordinateStyle.value));

effect(() => {
  localStorage.setItem("theme", theme.value);
  document.documentElement.dataset["theme"] = colours.value;
});

// ---- the address bar

let urlTimer: ReturnType<typeof setTimeout> | undefined;

function writeUrl(push: boolean) {
  const url = formatUrl({ object: selectedId.value, video: videoId.value, time: shownTime.value });
  if (url === location.search) return;
  if (push) history.pushState(null, "", url || location.pathname);
  else history.replaceState(null, "", url || location.pathname);
}

effect(() => {
  // Not for each frame that plays.
  void shownFrame.value;
  void selectedId.value;
  if (project.value.state !== "ready" || isPlaying.value) return;
  clearTimeout(urlTimer);
  urlTimer = setTimeout(() => writeUrl(false), 250);
});

window.addEventListener("popstate", () => void openFromUrl());

// ---- actions

export function showTime(target: number, time: number) {
  batch(() => {
    videoId.value = target;
    seekRequest.value = { video: target, time };
  });
}

function isShown(object: FoundObject) {
  const time = shownTime.value;
  return object.moments.some(
    (one) => one.video_id === videoId.value && time !== null && one.first_time_s <= time && time <= one.last_time_s,
  );
}

/** Selects an object; the video goes to its best sighting unless it shows the object already. */
export function select(id: number, { seek = true, push = false } = {}) {
  const object = objects.objectOf(id);
  if (!object) {
    // Not loaded yet: a find on the map, say.
    objects
      .locate(id)
      .then(() => objects.objectOf(id) && select(id, { seek, push }))
      .catch((error: unknown) => notify(messageOf(error), "error"));
    return;
  }
  if (push && selectedId.value !== null && selectedId.value !== id) writeUrl(true);
  seekToBest = seek && !isShown(object) ? id : null;
  const known = detail.value;
  if (seekToBest !== null && selectedId.value === id && known?.state === "ready" && known.value.best) {
    showTime(known.value.best.video_id, known.value.best.time_s);
  }
  selectedId.value = id;
}

/** The nearest object of the list before or after the selected one that passes a test; the server knows what is not loaded. */
async function neighbour(by: 1 | -1, wanted: Filters): Promise<number | null> {
  const matches = makeMatcher(wanted);
  const id = selectedId.value;
  const found = objects.findNeighbour(id, by, matches);
  if (found === "end") return null;
  if (found !== "unknown") return found;
  return objects.askNeighbour(id, by, sort.value, wanted);
}

/** The next or previous object of the list that passes the filters. */
export function step(by: 1 | -1) {
  const from = selectedId.value;
  neighbour(by, filters.value)
    .then((id) => {
      if (id !== null && selectedId.value === from) select(id, { push: true });
    })
    .catch((error: unknown) => notify(messageOf(error), "error"));
}

/** The next or previous moment of the selected object. */
export function stepMoment(by: 1 | -1) {
  const object = selected.value;
  if (!object) return;
  const time = shownTime.value ?? 0;
  const order = object.moments;
  const position = (one: (typeof order)[number]) =>
    one.video_id === videoId.value ? one.first_time_s - time : one.video_id < (videoId.value ?? 0) ? -Infinity : Infinity;
  const next =
    by > 0
      ? order.find((one) => position(one) > 1e-3)
      : [...order].reverse().find((one) => position(one) < -1e-3);
  if (next) showTime(next.video_id, next.first_time_s);
  else notify(by > 0 ? "This is the last moment of the object." : "This is the first moment of the object.");
}

/** The next or previous frame in which the selected object was sighted, in any of its videos. */
export async function stepSighting(by: 1 | -1) {
  const object = selected.value;
  const video = videoId.value;
  if (!object || video === null) return;
  try {
    const all = await sightingTimes(object.id);
    const time = shownTime.value ?? 0;
    const isBeyond = (one: { video: number; time: number }) =>
      one.video === video ? by * (one.time - time) > 5e-4 : by * (one.video - video) > 0;
    const next = by > 0 ? all.find(isBeyond) : [...all].reverse().find(isBeyond);
    if (next && selectedId.value === object.id) showTime(next.video, next.time);
    else if (!next) notify(by > 0 ? "This is the last sighting of the object." : "This is the first sighting of the object.");
  } catch (error) {
    notify(messageOf(error), "error");
  }
}

let sightingsOf: { id: number; times: Promise<{ video: number; time: number }[]> } | null = null;

/** Of one object, by video and time; kept for the last one that was asked for. */
function sightingTimes(id: number) {
  if (sightingsOf?.id !== id) {
    const times = listObjectSightings(id).then((all) => all.map((one) => ({ video: one.video_id, time: one.time_s })));
    times.catch(() => (sightingsOf = null));
    sightingsOf = { id, times };
  }
  return sightingsOf.times;
}

export function stepFrame(by: number) {
  const table = frameTable.value;
  const id = videoId.value;
  if (table.state !== "ready" || id === null) return;
  const frame = table.value.clamp((shownFrame.value ?? 0) + by);
  seekRequest.value = { video: id, time: table.value.timeOf(frame) };
}

export function setFilters(change: Partial<Filters>) {
  filters.value = { ...filters.value, ...change };
}

// ---- reviews: shown at once, then confirmed

interface Decision {
  id: number;
  before: { verdict: Verdict; note: string };
}
const undoStack: Decision[][] = [];
/** Objects whose review the server does not have yet. */
export const pendingReviews = signal<ReadonlySet<number>>(new Set());
const latestWrite = new Map<number, number>();
let writes = 0;

async function writeReview(id: number, verdict: Verdict, note: string) {
  const write = ++writes;
  const stored = objects.objectOf(id)?.review ?? null;
  const isLatest = () => latestWrite.get(id) === write;
  latestWrite.set(id, write);
  pendingReviews.value = new Set([...pendingReviews.value, id]);
  objects.setReview(id, verdict === null && note === "" ? null : { verdict, note, reviewer: reviewerName(), updated_utc_us: Date.now() * 1000 });
  while (isLatest()) {
    try {
      const review = await putReview(id, verdict, note, reviewerName());
      isConnected.value = true;
      if (isLatest()) objects.setReview(id, review);
      break;
    } catch (error) {
      if (!isLatest()) return;
      if (!(error instanceof ApiFailure && (error.status === 0 || error.status === 401))) {
        notify(`The review is not stored: ${messageOf(error)}`, "error");
        objects.setReview(id, stored);
        break;
      }
      // Nothing typed is lost: the review is kept and sent again once the server answers, or the user has logged in.
      if (error.status === 0) isConnected.value = false;
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
  }
  if (!isLatest()) return;
  const left = new Set(pendingReviews.value);
  left.delete(id);
  pendingReviews.value = left;
}

function canReview() {
  const isAllowed = project.value.state !== "ready" || project.value.value.can_review;
  if (!isAllowed) notify(whyNoReview.value, "error");
  return isAllowed;
}

export function review(id: number, verdict: Verdict, note?: string) {
  const object = objects.objectOf(id);
  if (!object) return;
  if (!canReview()) return;
  undoStack.push([decisionBefore(object)]);
  void writeReview(id, verdict, note ?? object.review?.note ?? "");
}

const decisionBefore = (object: FoundObject): Decision => ({
  id: object.id,
  before: { verdict: object.review?.verdict ?? null, note: object.review?.note ?? "" },
});

/** Marks the selected object, or takes its mark back. */
export function toggleMark(id: number | null) {
  if (id === null) return;
  const next = new Set(marked.value);
  if (!next.delete(id)) next.add(id);
  marked.value = next;
}

/** Marks what lies between two objects of the list, as far as it is loaded and matches the filters. */
export function markRange(from: number, to: number) {
  const list = objects.list.value;
  const [a, b] = [list?.positionOf(from), list?.positionOf(to)];
  if (!list || a === undefined || b === undefined) return toggleMark(to);
  const next = new Set(marked.value);
  for (let at = Math.min(a, b); at <= Math.max(a, b); at++) {
    const id = list.at(at);
    const object = id === undefined ? undefined : objects.objectOf(id);
    if (object && matcher.value(object)) next.add(object.id);
  }
  marked.value = next;
}

/** One decision about all marked objects; one step of undo. */
function decideMarked(verdict: Exclude<Verdict, null>) {
  const all = [...marked.value].flatMap((id) => objects.objectOf(id) ?? []);
  undoStack.push(all.map(decisionBefore));
  for (const object of all) void writeReview(object.id, verdict, object.review?.note ?? "");
  marked.value = new Set();
  notify(`${plural(all.length, "object")} ${verdict}. U takes it back.`);
}

/** Decides about the selected object and goes on to the next one that is not reviewed. */
export function decide(verdict: Exclude<Verdict, null>) {
  if (!canReview()) return;
  if (marked.value.size > 0) return decideMarked(verdict);
  const object = selected.value;
  if (!object) return;
  const next = neighbour(1, { ...filters.value, review: "none" });
  review(object.id, verdict);
  notify(`${object.model} ${object.id}: ${verdict}. U takes it back.`);
  next
    .then((id) => {
      if (id !== null && selectedId.value === object.id) select(id, { push: true });
    })
    .catch((error: unknown) => notify(messageOf(error), "error"));
}

export function undo() {
  const last = undoStack.pop();
  if (!last) {
    notify("There is nothing to take back.");
    return;
  }
  for (const one of last) void writeReview(one.id, one.before.verdict, one.before.note);
  if (last[0]) select(last[0].id);
}
