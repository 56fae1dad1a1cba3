import { describe, expect, it } from "vitest";

import { isBelow, isWeak } from "./weak";

describe("a weak find", () => {
  const object = { model: "jeep", score: 0.49, review: null };
  const decided = (verdict: "accepted" | null) => ({ ...object, review: { verdict, note: "", reviewer: "ann", updated_utc_us: 0 } });

  it("is of a model, scores below 0.5, and was decided by nobody", () => {
    const categories = new Set(["car"]);
    expect(isWeak(object, categories)).toBe(true);
    expect(isWeak({ ...object, score: 0.5 }, categories)).toBe(false);
    expect(isWeak({ ...object, model: "car" }, categories)).toBe(false);
    expect(isWeak(decided("accepted"), categories)).toBe(false);
    expect(isWeak(decided(null), categories)).toBe(true);
  });

  it("stands below the bound, of which the list says where it is", () => {
    const scores = [0.9, 0.5, 0.4, 0.3].map((score) => ({ score }));
    expect(scores.map((one, i) => isBelow(scores[i - 1], one))).toEqual([false, false, true, false]);
  });
});
