// What the page loads: at its beginning, when the server tells of something new, and when the user chose something else.
import { batch, effect, untracked } from "@preact/signals";

import { ApiFailure, getCameraPath, getProject, getTimes, isAlive, listVideos, onUnreachable } from "./api/client";
import { onEvent, startEvents } from "./events";
import { messageOf } from "./logic/errors";
import { FrameTable } from "./logic/frame_table";
import { parseUrl } from "./logic/url_state";
import { me } from "./me";
import { notify, notifyError } from "./notices";
import * as objects from "./objects";
import { select, showTime, step } from "./selection";
import { account } from "./session";
import * as thresholds from "./thresholds";
import {
  cameraPath, detail, filters, frameTable, indexVersion, isConnected, isOnlyMatching, project, selectedId, setFilters, shownFrame, sort, videoId, videos,
} from "./state";

const RETRY_MS = 3000;

/** Whether the server does not answer, or its database is away: it tells so itself. */
const isAway = (error: unknown) => error instanceof ApiFailure && (error.status === 0 || error.status === 503);

/** Says that the server is away, asks until it is back, and loads then what was missed. */
let isWaiting = false;
async function waitForServer() {
  isConnected.value = false;
  if (isWaiting) return;
  isWaiting = true;
  do await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
  while (!(await isAlive()));
  isWaiting = false;
  isConnected.value = true;
  if (project.peek().state === "ready") void refresh();
}
onUnreachable(() => void waitForServer());

/** Loads what the page begins with; tries again by itself while the server does not answer. */
export async function load() {
  try {
    const [summary, found] = await Promise.all([getProject(), listVideos()]);
    objects.setQueueTime(summary.now_utc_us);
    await thresholds.load();
    // The list begins as the address says.
    if (project.peek().state !== "ready") takeFilters(parseUrl(location.search));
    await Promise.all([objects.loadList(sort.value, filters.value, isOnlyMatching.value), objects.countOwn()]);
    batch(() => {
      project.value = { state: "ready", value: summary };
      videos.value = found;
      isConnected.value = true;
    });
    await openFromUrl();
    startLive(summary.index_version);
  } catch (error) {
    isConnected.value = !isAway(error);
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
    const [isThere] = await Promise.all([objects.reread(selectedId.peek()), objects.refreshCounts(), thresholds.load()]);
    if (!isThere) await followSelected();
    if (isFirst) await showNew();
    batch(() => {
      project.value = { state: "ready", value: summary };
      videos.value = found;
      isConnected.value = true;
      indexVersion.value++;
    });
    if (videoId.peek() === null && found[0]) showTime(found[0].id, 0);
    if (selectedId.peek() === null && isFirst) step(1);
  } catch (error) {
    isConnected.value = !isAway(error);
    if (isAway(error)) setTimeout(() => void refresh(), RETRY_MS);
  }
}

/** The selected object is not there any more: that which it was joined into is selected, or none. */
async function followSelected() {
  const id = selectedId.peek();
  const known = detail.peek();
  const key = known?.state === "ready" && known.value.id === id ? known.value.key : null;
  const now = key === null ? null : await objects.idOfKey(key);
  if (selectedId.peek() !== id) return;
  if (now === null) selectedId.value = null;
  else select(now, { seek: false });
}

/** Makes the list anew, with what was found since it was made. @param also  is done in the moment in which it is shown */
export async function showNew(also?: () => void) {
  await objects.loadList(sort.peek(), filters.peek(), isOnlyMatching.peek(), also);
}

let isLive = false;

/** Follows what the server tells, from the version that was loaded: what came in between is loaded, too. */
function startLive(loaded: number) {
  if (isLive) return;
  isLive = true;
  let known = loaded;
  onEvent("index", (data) => {
    const { version } = data as { version: number };
    if (version !== known) void refresh();
    known = version;
  });
  startEvents();
}

/** Sets what an address says of the list. */
function takeFilters({ filters: chosen, order, isAllListed }: ReturnType<typeof parseUrl>) {
  batch(() => {
    if (JSON.stringify({ ...filters.peek(), ...chosen }) !== JSON.stringify(filters.peek())) setFilters(chosen);
    sort.value = order;
    isOnlyMatching.value = !isAllListed;
  });
}

async function openFromUrl() {
  const wanted = parseUrl(location.search);
  takeFilters(wanted);
  const id = typeof wanted.object === "string" ? await objects.idOfKey(wanted.object).catch(() => null) : wanted.object;
  if (id !== null && !objects.objectOf(id)) await objects.locate(id).catch(() => undefined);
  const target = id === null ? undefined : objects.objectOf(id);
  if (target) {
    select(target.id, { seek: wanted.time === null });
  } else if (wanted.object !== null) {
    const name = typeof wanted.object === "string" ? "The object of this link" : `Object ${wanted.object}`;
    notify(`${name} is not in this index (a new search may have joined or removed it).`, "error");
  }
  const first = wanted.video ?? target?.moments[0]?.video_id ?? videos.value[0]?.id ?? null;
  if (first !== null && wanted.time !== null) return showTime(first, wanted.time);
  const best = objects.list.value?.at(0);
  if (!target && wanted.object === null && best !== undefined) return select(best);
  if (first !== null && videoId.value === null && !target) showTime(first, 0);
}

window.addEventListener("popstate", () => void openFromUrl());

// The list and the counts follow what the user chose.
effect(() => {
  const [order, chosen, isOnly] = [sort.value, filters.value, isOnlyMatching.value];
  void me.value;
  if (project.value.state !== "ready") return;
  untracked(() => objects.follow(order, chosen, isOnly, notifyError));
});

// Whose decisions are the reader's: not for each letter of a name that is typed.
effect(() => {
  void me.value;
  if (project.peek().state !== "ready") return;
  const timer = setTimeout(() => void objects.countOwn().catch(notifyError), 300);
  return () => clearTimeout(timer);
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
    if (!abort.signal.aborted) notifyError(error);
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
      if (!abort.signal.aborted) notifyError(error);
    });
  return () => abort.abort();
});
