// Tracks on the ground, in the video that is shown: of what moves, and of the selected object.
import { computed, effect, signal, untracked } from "@preact/signals";

import { listObjectSightings } from "./api/client";
import type { FoundObject, Sighting } from "./api/types";
import { type TrackPoint, groundTrack, momentsKey } from "./logic/ground_track";
import { notifyError } from "./notices";
import { objectOf, videoObjects } from "./objects";
import { cameraPath, colourOf, selected, video, videoId } from "./state";

/** Objects whose tracks are drawn at once, the best ones. */
const MAX_TRACKS = 20;

export interface Track {
  key: string;
  object: number;
  name: string;
  colour: string;
  pieces: TrackPoint[][];
}

const sightings = signal<ReadonlyMap<number, readonly Sighting[]>>(new Map());
/** Objects whose sightings were asked for, and what was known of them then. */
const asked = new Map<number, string>();
let shownVideo: number | null = null;

/** What moves, and the selected object unless it is known to stand. */
const wanted = computed(() => {
  const here = videoId.value;
  const hasGround = cameraPath.value?.points.some((one) => one.footprint) === true;
  if (here === null || !hasGround || videoObjects.value?.video !== here) return [];
  const moving = videoObjects.value.ids.flatMap((id) => objectOf(id) ?? []).filter((one) => (one.speed_m_s ?? 0) > 0);
  const chosen = selected.value;
  const isHere = chosen?.moments.some((one) => one.video_id === here) === true;
  const isOther = chosen !== null && isHere && chosen.speed_m_s !== 0 && !moving.some((one) => one.id === chosen.id);
  return [...(isOther ? [chosen] : []), ...moving.slice(0, MAX_TRACKS)];
});

async function load(object: FoundObject, target: number) {
  const state = momentsKey(object, target);
  asked.set(object.id, state);
  const moments = object.moments.filter((one) => one.video_id === target);
  const from = Math.min(...moments.map((one) => one.first_time_s));
  const to = Math.max(...moments.map((one) => one.last_time_s));
  try {
    const found = await listObjectSightings(object.id, from, to);
    if (videoId.peek() !== target || asked.get(object.id) !== state) return;
    sightings.value = new Map(sightings.peek()).set(object.id, found.sightings.filter((one) => one.video_id === target));
  } catch (error) {
    if (asked.get(object.id) === state) asked.delete(object.id);
    notifyError(error);
  }
}

// What a search has added to an object is read again; until it is there, the track that is known stays.
effect(() => {
  const [objects, target] = [wanted.value, videoId.value];
  untracked(() => {
    if (target !== shownVideo) {
      shownVideo = target;
      asked.clear();
      sightings.value = new Map();
    }
    if (target === null) return;
    for (const one of objects) if (asked.get(one.id) !== momentsKey(one, target)) void load(one, target);
  });
});

export const tracks = computed((): readonly Track[] => {
  const [path, shown] = [cameraPath.value, video.value];
  if (!path || !shown) return [];
  const frame = { width: shown.width_px, height: shown.height_px };
  return wanted.value.flatMap((object) => {
    const found = sightings.value.get(object.id);
    if (!found) return [];
    const pieces = groundTrack(found, path, frame);
    return [{ key: `object-${object.id}`, object: object.id, name: object.model, colour: colourOf(object.model), pieces }];
  });
});
