// Why a sighting was reported: which one is asked about, and its evidence.
import { effect, signal } from "@preact/signals";

import { getEvidence } from "./api/client";
import type { Evidence } from "./api/types";
import { messageOf } from "./logic/errors";
import { sightingsAt } from "./sightings";
import { type Load, detail, selected, selectedId, shownFrame, videoId } from "./state";

/** Null: nothing is asked. `at` null: the object's best sighting. */
export const asked = signal<{ object: number; at: { video: number; frame: number } | null } | null>(null);
export const evidence = signal<Load<Evidence>>({ state: "loading" });

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

effect(() => {
  const one = asked.value;
  if (one === null) return;
  const abort = new AbortController();
  evidence.value = { state: "loading" };
  getEvidence(one.object, one.at, abort.signal)
    .then((value) => (evidence.value = { state: "ready", value }))
    .catch((error: unknown) => {
      if (!abort.signal.aborted) evidence.value = { state: "failed", message: messageOf(error) };
    });
  return () => abort.abort();
});

// The answer belongs to the selection.
effect(() => {
  if (asked.peek() !== null && asked.peek()?.object !== selectedId.value) asked.value = null;
});
