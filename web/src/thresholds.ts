// Thresholds of models: what the decisions suggest, and what is in force for the team.
import { computed, signal } from "@preact/signals";

import { getThresholds, putThreshold } from "./api/client";
import type { ThresholdList, ThresholdOfModel } from "./api/types";
import { worthShowing } from "./logic/learnt";
import { me } from "./me";
import { notify, notifyError } from "./notices";
import { filters, project, setFilters } from "./state";

const known = signal<ThresholdList | null>(null);

/** Of the models that the reader looks at. */
export const shown = computed(() => (known.value === null ? [] : worthShowing(known.value, filters.value.models)));
/** Decisions from which on a threshold is learnt. */
export const minDecisions = computed(() => known.value?.min_decisions ?? 0);
/** Decided objects of categories, if the server has a model of them that can be refined. */
export const categoryDecisions = computed(() => {
  const hasModel = project.value.state === "ready" && project.value.value.categories !== null;
  if (!hasModel) return null;
  const categories = known.value?.models.filter((one) => one.is_category) ?? [];
  const sum = (read: (one: ThresholdOfModel) => number) => categories.reduce((count, one) => count + read(one), 0);
  return { accepted: sum((one) => one.accepted), rejected: sum((one) => one.rejected) };
});

function take(list: ThresholdList) {
  known.value = list;
  const inForce = new Map(list.models.flatMap((one) => (one.in_force ? [[one.model, one.in_force.min_score] as const] : [])));
  const before = filters.peek().thresholds;
  const isSame = before.size === inForce.size && [...inForce].every(([model, score]) => before.get(model) === score);
  if (!isSame) setFilters({ thresholds: inForce });
}

export async function load() {
  take(await getThresholds());
}

/** Puts a threshold into force, or ends it. */
export async function apply(model: ThresholdOfModel, minScore: number | null) {
  try {
    take(await putThreshold(model.model_id, minScore, me.peek()));
    notify(minScore === null ? `All of ${model.model} is shown again.` : `Of ${model.model}, what scores less than ${minScore} is left out, for everybody.`);
  } catch (error) {
    notifyError(error);
  }
}
