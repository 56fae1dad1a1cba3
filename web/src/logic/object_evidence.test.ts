import { describe, expect, it } from "vitest";

import type { ObjectEvidence } from "../api/types";
import { describeObject } from "./object_evidence";

const good: ObjectEvidence = {
  recognitions: 12, frames: 14, by_shape: 0, missed: 0, size_ratio: 1.004, lines: 14, missing_lines: 1, place_rejected: false,
  headings: 14, contradicting_headings: 2, view_spread_deg: 23.4,
};

describe("what all sightings of an object say", () => {
  it("is a sentence each", () => {
    expect(describeObject(good)).toEqual([
      "Recognised in 12 of 14 frames.",
      "Its size is that of the model, by where its lines of sight meet.",
      "13 of 14 lines of sight meet at its place.",
      "Its heading is the same in 12 of 14 frames.",
      "The directions from which it is seen spread by 23° (one standard deviation).",
    ]);
    expect(describeObject({ ...good, size_ratio: 0.82 })).toContain("By where its lines of sight meet, it is 18 % smaller than the model.");
    expect(describeObject({ ...good, size_ratio: 1.3 })).toContain("By where its lines of sight meet, it is 30 % larger than the model.");
  });

  it("says how it was recognised, and where it was not", () => {
    expect(describeObject({ ...good, by_shape: 12, missed: 3 })[0]).toBe(
      "Recognised in 12 of 14 frames, by the shape of its edges. A search missed it in 3 frames in which it was tracked.",
    );
    expect(describeObject({ ...good, by_shape: 4 })[0]).toContain(", in 4 by the shape");
    expect(describeObject({ ...good, recognitions: 1, frames: 1 })[0]).toBe("Recognised in 1 of 1 frame.");
  });

  it("says nothing that is not known", () => {
    const video = { ...good, size_ratio: null, lines: 0, missing_lines: 0, headings: 0, contradicting_headings: 0, view_spread_deg: null };
    expect(describeObject(video)).toEqual(["Recognised in 12 of 14 frames."]);
    expect(describeObject({ ...good, place_rejected: true })).toContain("Its place is doubtful, therefore size and heading are not used.");
  });
});
