import { describe, expect, it } from "vitest";

import type { ObjectEvidence } from "../api/types";
import { describeObject } from "./object_evidence";

const good: ObjectEvidence = {
  recognitions: 12, frames: 14, by_shape: 0, missed: 0, size_ratio: 1.004, lines: 14, missing_lines: 1, place_rejected: false,
  headings: 14, contradicting_headings: 0, view_steps: 11, view_jumps: 0, view_spread_deg: 23.4,
};

const textsOf = (evidence: ObjectEvidence) => describeObject(evidence).map((one) => one.text);

describe("what all sightings of an object say", () => {
  it("has no doubt of a good one", () => {
    expect(describeObject(good).some((one) => one.isDoubt)).toBe(false);
    expect(textsOf(good)).toEqual([
      "Recognised in 12 of 14 frames.",
      "Its size is that of the model, by where its lines of sight meet.",
      "13 of 14 lines of sight meet at its place.",
      "It faces one way in 14 of 14 frames.",
      "It is seen from directions 23° apart.",
    ]);
  });

  it("names doubts first", () => {
    const said = describeObject({ ...good, size_ratio: 0.82, contradicting_headings: 6, view_jumps: 2 });
    expect(said.filter((one) => one.isDoubt).map((one) => one.text)).toEqual([
      "By where its lines of sight meet, it is 18 % smaller than the model.",
      "It faces one way in 8 of 14 frames.",
      "Its view jumps by more than 50° 2 times within two seconds.",
    ]);
    expect(said.findIndex((one) => !one.isDoubt)).toBe(3);
  });

  it("says how it was recognised, and where it was not", () => {
    expect(textsOf({ ...good, by_shape: 12, missed: 3 })[0]).toBe(
      "Recognised in 12 of 14 frames, by the shape of its edges; searched for in vain in 3 frames where it was followed to.",
    );
    expect(textsOf({ ...good, by_shape: 4 })[0]).toContain(", in 4 by the shape");
    expect(describeObject({ ...good, recognitions: 2, missed: 4 })[0]?.isDoubt).toBe(true);
  });

  it("says nothing that is not known", () => {
    const video = { ...good, size_ratio: null, lines: 0, missing_lines: 0, headings: 0, view_spread_deg: null };
    expect(textsOf(video)).toEqual(["Recognised in 12 of 14 frames."]);
    expect(textsOf({ ...good, place_rejected: true })).toContain("Its place is in doubt, so that size and heading say nothing.");
  });
});
