// Why a sighting was reported: which one is asked about, and its evidence.
import { effect, signal } from "@preact/signals";

import { getEvidence, listObjects, listSightings } from "./api/client";
import type { Evidence, FoundObject, Sighting } from "./api/types";
import { messageOf } from "./logic/errors";
import { type Rival, reachOf, rivalsOf } from "./logic/rivals";
import { objectOf } from "./objects";
import { sightingsAt } from "./sightings";
import { type Load, detail, selected, selectedId, shownFrame, videoId } from "./state";

/** Null: nothing is asked. `at` null: the object's best sighting. */
export const asked = signal<{ object: number; at: { video: number; frame: number } | null } | null>(null);
export const evidence = signal<Load<Evidence>>({ state: "loading" });
/** What other models explain the sighting; none as long as it is not known. */
export const rivals = signal<readonly Rival[]>([]);

/** About the selected object in the frame that is shown; if it is not in it, in its best sighting. */
export function ask() {
  const object = selected.value;
  if (!object) return;
  const [video, frame] = [videoId.value, shownFrame.value];
  const isInFrame = frame !== null && sightingsAt(frame).some((one) => one.object_id === object.id);
  const best = detail.value?.state === "ready" ? detail.value.value.best : null;
  const isBest = best !== null && best.video_id === video && best.frame === frame;
  asked.value = { object: object.id, at: isInFrame && !isBest && video !== null ? { video, frame } : null };
}

/** s, around a frame; its time may be rounded. */
const MOMENT_S = 2e-3;
/** Near a place; the best ones. */
const MAX_NEAR = 100;

async function findRivals(sighting: Sighting, own: FoundObject | null): Promise<Rival[]> {
  const { video_id: video, time_s: time } = sighting;
  const nearby = async ({ place }: FoundObject) =>
    place === null ? [] : (await listObjects(new URLSearchParams({ near: `${place.latitude_deg},${place.longitude_deg},${reachOf(place)}`, limit: String(MAX_NEAR) }))).objects;
  const [{ sightings }, near] = await Promise.all([listSightings(video, Math.max(time - MOMENT_S, 0), time + MOMENT_S), own ? nearby(own) : []]);
  const ids = [...new Set(sightings.filter((one) => one.frame === sighting.frame).map((one) => one.object_id))].filter((id) => !near.some((one) => one.id === id));
  const inFrame = ids.length === 0 ? [] : (await listObjects(new URLSearchParams({ ids: ids.slice(0, 1000).join(",") }))).objects;
  return rivalsOf(sighting, own, sightings, [...near, ...inFrame]);
}

effect(() => {
  const one = asked.value;
  if (one === null) return;
  const abort = new AbortController();
  evidence.value = { state: "loading" };
  rivals.value = [];
  getEvidence(one.object, one.at, abort.signal)
    .then((value) => {
      evidence.value = { state: "ready", value };
      // The evidence stands, whether they can be had or not.
      findRivals(value.sighting, objectOf(one.object) ?? null)
        .then((found) => {
          if (!abort.signal.aborted) rivals.value = found;
        })
        .catch(() => undefined);
    })
    .catch((error: unknown) => {
      if (!abort.signal.aborted) evidence.value = { state: "failed", message: messageOf(error) };
    });
  return () => abort.abort();
});

// The answer belongs to the selection.
effect(() => {
  const selection = selectedId.value;
  if (asked.peek() !== null && asked.peek()?.object !== selection) asked.value = null;
});
