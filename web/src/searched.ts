// How well the ground was searched for one model: loaded when it is to be shown on the map.
import { computed, effect, signal } from "@preact/signals";

import { getCoverage } from "./api/client";
import type { Coverage } from "./api/types";
import { messageOf } from "./logic/errors";
import { type Load, filters, indexVersion, models, project, selected, videoId } from "./state";

/** The reader wants it. */
export const isShown = signal(false);
const loaded = signal<Load<Coverage> | null>(null);

const hasViews = () => project.value.state === "ready" && project.value.value.has_views;

/** The model that the list is filtered by, else that of the selected object. */
export const searchedModel = computed(() => {
  const [name, ...others] = filters.value.models;
  const filtered = others.length === 0 && name !== undefined ? models.value.find((one) => one.name === name) : undefined;
  return filtered?.id ?? selected.value?.model_id ?? null;
});

/** null: not wanted, or no model is chosen. */
export const coverage = computed(() => (isShown.value && searchedModel.value !== null ? loaded.value : null));

effect(() => {
  const [model, video] = [searchedModel.value, videoId.value];
  void indexVersion.value;
  if (!isShown.value || model === null || video === null) return;
  if (!hasViews()) {
    loaded.value = { state: "failed", message: "`victorious serve --models DIR` names the models, which have the sizes" };
    return;
  }
  const abort = new AbortController();
  loaded.value = { state: "loading" };
  getCoverage(model, video, abort.signal)
    .then((value) => (loaded.value = { state: "ready", value }))
    .catch((error: unknown) => {
      if (!abort.signal.aborted) loaded.value = { state: "failed", message: messageOf(error) };
    });
  return () => abort.abort();
});
