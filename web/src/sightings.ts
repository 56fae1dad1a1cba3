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
const chunks = new Set<number>();
let loadedVideo: number | null = null;

/** Changes when sightings arrive. */
export const sightingsVersion = signal(0);

export const sightingsAt = (frame: number): readonly Sighting[] => byFrame.get(frame) ?? [];

/** Centres of an object's boxes in the frames up to this one, oldest first. */
export function trailOf(object: number, frame: number, frames: number): [number, number][] {
  return boxCentres(frame, frames, (at) => byFrame.get(at)?.find((one) => one.object_id === object)?.box);
}

async function loadChunk(video: number, chunk: number) {
  if (chunk < 0 || chunks.has(chunk)) return;
  chunks.add(chunk);
  try {
    const { sightings: found, truncated } = await listSightings(video, chunk * CHUNK_S, (chunk + 1) * CHUNK_S);
    if (loadedVideo !== video) return;
    if (truncated) notices.notify("A frame has more than 10,000 sightings: only some of them are shown.", "error");
    for (const sighting of found) {
      const others = byFrame.get(sighting.frame) ?? [];
      // The border of two pieces belongs to both.
      if (!others.some((one) => one.object_id === sighting.object_id)) byFrame.set(sighting.frame, [...others, sighting]);
    }
    sightingsVersion.value++;
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
  if (video !== loadedVideo) {
    byFrame.clear();
    chunks.clear();
    loadedVideo = video;
    sightingsVersion.value = sightingsVersion.peek() + 1;
  }
  if (video === null || time === null) return;
  const chunk = Math.floor(time / CHUNK_S);
  for (const wanted of [chunk, chunk + 1, chunk - 1]) void loadChunk(video, wanted);
});
