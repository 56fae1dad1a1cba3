// The steps that can be taken back, as a text that outlives a reload.

/** Of each person; more would never be taken back by key. */
const MAX_STEPS = 50;

export function formatUndoSteps(steps: readonly (readonly [string, readonly unknown[]])[]): string {
  return JSON.stringify(steps.map(([name, all]) => [name, all.slice(-MAX_STEPS)]));
}

/** By person, oldest first. A text that this version of the page did not write gives none. */
export function readUndoSteps<Decision extends { id: number; reviewer: string; note: string }>(text: string | null): [string, Decision[][]][] {
  const isDecision = (one: unknown) =>
    typeof one === "object" && one !== null && "verdict" in one && ["id", "reviewer", "note"].every((key) => typeof (one as Record<string, unknown>)[key] === (key === "id" ? "number" : "string"));
  const isStep = (one: unknown) => Array.isArray(one) && one.every(isDecision);
  const isOfPerson = (one: unknown) => Array.isArray(one) && one.length === 2 && typeof one[0] === "string" && Array.isArray(one[1]) && one[1].every(isStep);
  try {
    const read: unknown = JSON.parse(text ?? "[]");
    return Array.isArray(read) && read.every(isOfPerson) ? (read as [string, Decision[][]][]) : [];
  } catch {
    return [];
  }
}
