// What the decisions say about the scores of each model, and the thresholds that follow from them.
import type { ThresholdOfModel } from "../api/types";
import { refineCategories, canAdd } from "../jobs";
import { describeBelow, describeDecided, describeLearnt, isSuggested } from "../logic/learnt";
import * as state from "../state";
import * as thresholds from "../thresholds";
import { Swatch } from "./swatch";

function Row({ model }: { model: ThresholdOfModel }) {
  const { learnt, in_force: inForce } = model;
  const canReview = state.project.value.state === "ready" && state.project.value.value.can_review;
  return (
    <li class="learnt-row">
      <div>
        <Swatch model={model.model} /> <strong>{model.model}</strong>{" "}
        {inForce && (
          <span class="in-force" title={inForce.set_by === "" ? undefined : `Put into force by ${inForce.set_by}`}>
            only ≥ {inForce.min_score}: {describeBelow(inForce.undecided_below)}
          </span>
        )}
        <span class="muted">
          {inForce ? " · " : ""}
          {describeDecided(model)}; {describeLearnt(model, thresholds.minDecisions.value)}
        </span>
      </div>
      <div class="learnt-actions">
        {learnt && isSuggested(model) && (
          <button
            class="button"
            disabled={!canReview}
            title={`For everybody, until somebody ends it: ${describeBelow(learnt.undecided_below)}. What was decided stays.`}
            onClick={() => void thresholds.apply(model, learnt.min_score)}
          >
            Only ≥ {learnt.min_score}
          </button>
        )}
        {inForce && (
          <button class="button" disabled={!canReview} aria-label={`Show all of ${model.model}`} onClick={() => void thresholds.apply(model, null)}>
            Show all
          </button>
        )}
      </div>
    </li>
  );
}

function Categories() {
  const decided = thresholds.categoryDecisions.value;
  if (decided === null || decided.accepted + decided.rejected === 0) return null;
  const name = state.project.value.state === "ready" ? (state.project.value.value.categories ?? "") : "";
  return (
    <li class="learnt-row">
      <div>
        <strong>{name}</strong> <span class="muted">{describeDecided(decided)} of its categories</span>
      </div>
      <div class="learnt-actions">
        <button
          class="button"
          disabled={!canAdd.value}
          title="Makes a new category model that agrees with what was decided; this one stays as it is"
          onClick={() => void refineCategories()}
        >
          Refine
        </button>
      </div>
    </li>
  );
}

export function Learnt() {
  const models = thresholds.shown.value;
  const decided = thresholds.categoryDecisions.value;
  if (models.length === 0 && (decided === null || decided.accepted + decided.rejected === 0)) return null;
  return (
    <ul class="learnt" aria-label="Learnt from what was decided" tabIndex={0}>
      {models.map((one) => (
        <Row key={one.model_id} model={one} />
      ))}
      <Categories />
    </ul>
  );
}
