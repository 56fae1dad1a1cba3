// What is selected and shown, and how to move: between objects, moments, sightings and frames.
import { batch, effect } from "@preact/signals";

import { getObject, listObjectSightings } from "./api/client";
import type { FoundObject } from "./api/types";
import { writeUrl } from "./address";
import { messageOf } from "./logic/errors";
import { type Filters, isFiltered, makeMatcher } from "./logic/filters";
import { notify, notifyError } from "./notices";
import { me } from "./me";
import * as objects from "./objects";
import { detail, filters, frameTable, indexVersion, isQueueDone, seekRequest, selected, selectedId, shownFrame, shownTime, sort, videoId } from "./state";

/** The object whose best sighting is to be shown once it is known. */
let seekToBest: number | null = null;

// The selection's details, again when a search has added to it.
effect(() => {
  const id = selectedId.value;
  void indexVersion.value;
  if (id === null) {
    detail.value = null;
    return;
  }
  const abort = new AbortController();
  const known = detail.peek();
  const isKnown = known?.state === "ready" && known.value.id === id;
  if (!isKnown) detail.value = { state: "loading" };
  getObject(id, abort.signal)
    .then((value) => {
      batch(() => {
        detail.value = { state: "ready", value };
        if (seekToBest === id && value.best) showTime(value.best.video_id, value.best.time_s);
        if (seekToBest === id) seekToBest = null;
      });
    })
    .catch((error: unknown) => {
      if (!abort.signal.aborted && !isKnown) detail.value = { state: "failed", message: messageOf(error) };
    });
  return () => abort.abort();
});

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
      .catch(notifyError);
    return;
  }
  if (push && selectedId.value !== null && selectedId.value !== id) writeUrl(true);
  seekToBest = seek && !isShown(object) ? id : null;
  const known = detail.value;
  if (seekToBest !== null && selectedId.value === id && known?.state === "ready" && known.value.best) {
    showTime(known.value.best.video_id, known.value.best.time_s);
  }
  batch(() => {
    selectedId.value = id;
    isQueueDone.value = false;
  });
}

/**
 * The nearest object of the list before or after another one that passes a test; the server knows what is not loaded.
 * @param id  null: the list is entered at its first or last object
 */
export async function neighbour(by: 1 | -1, wanted: Filters, id = selectedId.value): Promise<number | null> {
  const matches = makeMatcher(wanted, me.peek());
  const found = objects.findNeighbour(id, by, matches);
  if (found === "end") return null;
  if (found !== "unknown") return found;
  return id === null && by < 0 ? objects.askLast(sort.value, wanted) : objects.askNeighbour(id, by, sort.value, wanted);
}

/** The next or previous object of the list that passes the filters. */
export function step(by: 1 | -1) {
  const from = selectedId.value;
  neighbour(by, filters.value)
    .then((id) => {
      if (id === null) sayEnd(by);
      else if (selectedId.value === from) select(id, { push: true });
    })
    .catch(notifyError);
}

function sayEnd(by: 1 | -1) {
  if (objects.list.value?.total === 0) return;
  const what = isFiltered(filters.value) ? "object that matches the filters" : "object of the list";
  notify(by > 0 ? `This is the last ${what}.` : `This is the first ${what}.`);
}

/** The first or last object of the list that passes the filters. */
export function stepToEnd(end: "first" | "last") {
  const from = selectedId.value;
  neighbour(end === "first" ? 1 : -1, filters.value, null)
    .then((id) => {
      if (id !== null && selectedId.value === from) select(id, { push: true });
    })
    .catch(notifyError);
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
    const all = await sightingTimes(object);
    const time = shownTime.value ?? 0;
    const isBeyond = (one: { video: number; time: number }) =>
      one.video === video ? by * (one.time - time) > 5e-4 : by * (one.video - video) > 0;
    const next = by > 0 ? all.find(isBeyond) : [...all].reverse().find(isBeyond);
    if (next && selectedId.value === object.id) showTime(next.video, next.time);
    else if (!next) notify(by > 0 ? "This is the last sighting of the object." : "This is the first sighting of the object.");
  } catch (error) {
    notifyError(error);
  }
}

let sightingsOf: { id: number; version: number; times: Promise<{ video: number; time: number }[]> } | null = null;

/** Of one object, by video and time; kept for the last one that was asked for. */
function sightingTimes(object: FoundObject) {
  const version = indexVersion.peek();
  if (sightingsOf?.id !== object.id || sightingsOf.version !== version) {
    const times = listObjectSightings(object.id, object.first_time_s, object.last_time_s).then(({ sightings, truncated }) => {
      if (truncated) notify("The object has more sightings at one time than can be loaded: some are left out.", "error");
      return sightings.map((one) => ({ video: one.video_id, time: one.time_s }));
    });
    times.catch(() => (sightingsOf = null));
    sightingsOf = { id: object.id, version, times };
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
