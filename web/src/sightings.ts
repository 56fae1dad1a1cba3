// The sightings of the video that is shown, fetched in pieces around the time that is shown.
import { effect, signal } from "@preact/signals";

import { listSightings } from "./api/client";
import type { Sighting } from "./api/types";
import { boxCentres } from "./logic/overlay";
import { needObjects } from "./objects";
import * as notices from "./notices";
import * as state from "./state";

const CHUNK_S = 10;

const byFrame = new Map<number, Sighting[]>();
/** Of each piece, the states of the index (`indexVersion`) for which it was asked last, and which is shown. */
const chunks = new Map<number, { asked: number; shown: number }>();
let loadedVideo: number | null = null;

/** Changes when sightings arrive. */
export const sightingsVersion = signal(0);

export const sightingsAt = (frame: number): readonly Sighting[] => byFrame.get(frame) ?? [];

/** Centres of an object's boxes in the frames up to this one, oldest first. */
export function trailOf(object: number, frame: number, frames: number): [number, number][] {
  return boxCentres(frame, frames, (at) => byFrame.get(at)?.find((one) => one.object_id === object)?.box);
}

/** What a piece holds takes the place of what it held in an earlier state of the index. */
function showChunk(chunk: number, found: readonly Sighting[]) {
  const isInside = ({ time_s: time }: Sighting) => time >= chunk * CHUNK_S && time <= (chunk + 1) * CHUNK_S;
  for (const [frame, held] of byFrame) if (held.some(isInside)) byFrame.delete(frame);
  for (const sighting of found) byFrame.set(sighting.frame, [...(byFrame.get(sighting.frame) ?? []), sighting]);
  sightingsVersion.value++;
}

async function loadChunk(video: number, chunk: number, version: number) {
  const known = chunks.get(chunk) ?? { asked: -1, shown: -1 };
  if (chunk < 0 || known.asked === version) return;
  chunks.set(chunk, { ...known, asked: version });
  try {
    const { sightings: found, truncated } = await listSightings(video, chunk * CHUNK_S, (chunk + 1) * CHUNK_S);
    const now = chunks.get(chunk);
    // Answers may come in another order than they were asked for.
    if (loadedVideo !== video || now === undefined || now.shown > version) return;
    now.shown = version;
    if (truncated) notices.notify("A frame has more than 10,000 sightings: only some of them are shown.", "error");
    showChunk(chunk, found);
    // Their reviews, and whether the filters grey them out.
    await needObjects(found.map((one) => one.object_id));
  } catch (error) {
    if (loadedVideo !== video) return;
    chunks.delete(chunk);
    notices.notifyError(error);
  }
}

effect(() => {
  const video = state.videoId.value;
  const time = state.shownTime.value;
  const version = state.indexVersion.value;
  if (video !== loadedVideo) {
    byFrame.clear();
    chunks.clear();
    loadedVideo = video;
    sightingsVersion.value = sightingsVersion.peek() + 1;
  }
  if (video === null || time === null) return;
  const chunk = Math.floor(time / CHUNK_S);
  for (const wanted of [chunk, chunk + 1, chunk - 1]) void loadChunk(video, wanted, version);
});
