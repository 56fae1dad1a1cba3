// What is said about the thresholds of models.
import type { ThresholdList, ThresholdOfModel } from "../api/types";
import { plural } from "./format";

/**
 * The models of which there is something to say: a threshold in force or a better one, or, of a model that the reader has
 * chosen, why there is none.
 */
export function worthShowing(list: ThresholdList, chosen: readonly string[]): ThresholdOfModel[] {
  const isChosen = (one: ThresholdOfModel) => chosen.includes(one.model);
  const all = list.models.filter((one) => (chosen.length === 0 || isChosen(one)) && (one.in_force !== null || one.learnt !== null || isChosen(one)));
  // What waits for a decision first.
  return all.sort((a, b) => Number(isSuggested(b)) - Number(isSuggested(a)));
}

/** Whether the decisions suggest another threshold than the one in force. */
export const isSuggested = (one: ThresholdOfModel) => one.learnt !== null && one.learnt.min_score !== one.in_force?.min_score;

export function describeDecided({ accepted, rejected }: { accepted: number; rejected: number }): string {
  return `${accepted.toLocaleString("en")} accepted, ${rejected.toLocaleString("en")} rejected`;
}

/** What the decisions suggest, or why they suggest nothing. */
export function describeLearnt(one: ThresholdOfModel, minDecisions: number): string {
  if (one.learnt !== null) {
    const { min_score, accepted_below, rejected_below } = one.learnt;
    const decided = accepted_below + rejected_below;
    return `below ${min_score}, ${rejected_below === decided ? `all ${decided}` : `${rejected_below} of ${decided}`} were rejected`;
  }
  const decided = one.accepted + one.rejected;
  if (decided < minDecisions) return `a threshold is learnt from ${minDecisions} decisions on`;
  return "no score separates them";
}

export const describeBelow = (count: number) => (count === 0 ? "nothing undecided scores less" : `leaves out ${plural(count, "object")}`);
