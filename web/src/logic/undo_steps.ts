// The steps that can be taken back, as a text that outlives a reload.
import type { Groups } from "./grouping";

/** Of each person; more would never be taken back by key. */
const MAX_STEPS = 50;

/** Which moments were one object before objects were joined or split. */
export interface Regrouping {
  groups: Groups;
  correction: number;
}

export const isRegrouping = (step: unknown): step is Regrouping =>
  typeof step === "object" && step !== null && "correction" in step && Number.isInteger(step.correction) && "groups" in step && Array.isArray(step.groups) && step.groups.every(isGroup);

const isGroup = (one: unknown) => Array.isArray(one) && one.length > 0 && one.every(Number.isInteger);

export function formatUndoSteps(steps: readonly (readonly [string, readonly unknown[]])[]): string {
  return JSON.stringify(steps.map(([name, all]) => [name, all.slice(-MAX_STEPS)]));
}

/** By person, oldest first. A text that this version of the page did not write gives none. */
export function readUndoSteps<Decision extends { id: number; reviewer: string; note: string }>(text: string | null): [string, (Decision[] | Regrouping)[]][] {
  const isDecision = (one: unknown) =>
    typeof one === "object" && one !== null && "verdict" in one && ["id", "reviewer", "note"].every((key) => typeof (one as Record<string, unknown>)[key] === (key === "id" ? "number" : "string"));
  const isStep = (one: unknown) => isRegrouping(one) || (Array.isArray(one) && one.every(isDecision));
  const isOfPerson = (one: unknown) => Array.isArray(one) && one.length === 2 && typeof one[0] === "string" && Array.isArray(one[1]) && one[1].every(isStep);
  try {
    const read: unknown = JSON.parse(text ?? "[]");
    return Array.isArray(read) && read.every(isOfPerson) ? (read as [string, (Decision[] | Regrouping)[]][]) : [];
  } catch {
    return [];
  }
}
