import { describe, expect, it } from "vitest";

import { thresholdCost, withVerdict } from "./threshold_cost";

const bins = (counts: Record<number, number>) => Array.from({ length: 100 }, (_, i) => counts[i] ?? 0);

describe("thresholdCost", () => {
  const undecided = { scores: bins({ 90: 2, 60: 1, 20: 1 }), accepted_scores: bins({}), rejected_scores: bins({}) };

  it("follows from the scores where nobody has decided", () => {
    const cost = thresholdCost(undecided, 0.5);
    expect(cost.falseAlarms).toBeCloseTo(2 * 0.095 + 0.395);
    expect(cost.misses).toBeCloseTo(0.205);
    expect(thresholdCost(undecided, 0).misses).toBe(0);
  });

  it("knows what was decided, whatever its score", () => {
    // Beside these: below the threshold 3 accepted and 4 rejected, above it 5 accepted and 1 rejected.
    const decided = {
      scores: bins({ 90: 2, 60: 1, 20: 1 + 3, 10: 4, 95: 5 + 1 }),
      accepted_scores: bins({ 20: 3, 95: 5 }),
      rejected_scores: bins({ 10: 4, 95: 1 }),
    };
    const cost = thresholdCost(decided, 0.5);
    expect(cost.falseAlarms).toBeCloseTo(2 * 0.095 + 0.395);
    expect(cost.rejected).toBe(1);
    expect(cost.misses).toBeCloseTo(0.205 + 3);
    expect(thresholdCost(decided, 1)).toEqual({ rejected: 0, falseAlarms: 0, misses: expect.closeTo(2 * 0.905 + 0.605 + 0.205 + 8) as number });
  });
});

describe("withVerdict", () => {
  const before = { objects: 2, accepted: 0, rejected: 0, unreviewed: 2, scores: bins({ 20: 1, 99: 1 }), accepted_scores: bins({}), rejected_scores: bins({}) };

  it("moves an object from one verdict to another", () => {
    const accepted = withVerdict(before, 1, null, "accepted");
    expect(accepted).toEqual({ ...before, accepted: 1, unreviewed: 1, accepted_scores: bins({ 99: 1 }) });
    expect(withVerdict(accepted, 1, "accepted", "rejected")).toEqual({ ...before, rejected: 1, unreviewed: 1, rejected_scores: bins({ 99: 1 }) });
    expect(withVerdict(accepted, 1, "accepted", null)).toEqual(before);
  });
});
