// The model that turns: which one is shown, its views and what they matched, from where it is seen.
import { batch, computed, effect, signal } from "@preact/signals";

import { getModelViews, listObjectSightings } from "./api/client";
import type { FoundObject, ModelViews, Sighting } from "./api/types";
import { messageOf } from "./logic/errors";
import { type Direction, matchedViews, nearest, viewsOf } from "./logic/turntable";
import { notifyError } from "./notices";
import * as selection from "./selection";
import { type Load, detail, project, selected } from "./state";

/** Null: none is shown. `object`: whose sightings come first. */
export const shown = signal<{ model: number; object: FoundObject | null; view: number | null } | null>(null);
const listed = signal<Load<ModelViews>>({ state: "loading" });
const ownSightings = signal<readonly Sighting[]>([]);
export const direction = signal<Direction>({ azimuth_deg: 45, off_nadir_deg: 50 });

export const model = computed(() => listed.value);
const known = computed(() => (listed.value.state === "ready" ? viewsOf(listed.value.value.views) : { views: [], isTurntable: true }));
export const views = computed(() => known.value.views);
export const isTurntable = computed(() => known.value.isTurntable);
export const present = computed(() => nearest(views.value, direction.value));
export const matched = computed(() =>
  matchedViews(ownSightings.value, listed.value.state === "ready" ? listed.value.value.sightings : [], shown.value?.object?.id ?? null),
);

/** @param view  the one to begin with */
export function open(modelId: number, object: FoundObject | null, view: number | null) {
  shown.value = { model: modelId, object, view };
}

/** The model of the selected object, as the best sighting shows it. */
export function openSelected() {
  const object = selected.value;
  const hasViews = project.value.state === "ready" && project.value.value.has_views;
  if (object === null || !hasViews) return;
  const best = detail.value?.state === "ready" ? detail.value.value.best : null;
  open(object.model_id, object, best?.view_index ?? null);
}

export function lookFrom(view: number) {
  const found = views.value.find((one) => one.index === view);
  if (found) direction.value = { azimuth_deg: found.azimuth_deg, off_nadir_deg: found.off_nadir_deg };
}

/** Goes to a sighting, in the video. */
export function goTo(sighting: Sighting) {
  batch(() => {
    shown.value = null;
    selection.select(sighting.object_id, { seek: false, push: true });
    selection.showTime(sighting.video_id, sighting.time_s);
  });
}

effect(() => {
  const one = shown.value;
  if (one === null) return;
  const abort = new AbortController();
  batch(() => {
    listed.value = { state: "loading" };
    ownSightings.value = [];
  });
  getModelViews(one.model, abort.signal)
    .then((value) =>
      batch(() => {
        listed.value = { state: "ready", value };
        // Without a view to begin with, the one that matched best.
        const first = one.view ?? matched.peek()[0]?.view;
        if (first !== undefined) lookFrom(first);
      }),
    )
    .catch((error: unknown) => {
      if (!abort.signal.aborted) listed.value = { state: "failed", message: messageOf(error) };
    });
  if (one.object !== null) {
    const { id, first_time_s, last_time_s } = one.object;
    listObjectSightings(id, first_time_s, last_time_s)
      .then(({ sightings }) => {
        if (!abort.signal.aborted) ownSightings.value = sightings;
      })
      .catch((error: unknown) => !abort.signal.aborted && notifyError(error));
  }
  return () => abort.abort();
});
