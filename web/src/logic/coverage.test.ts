import { describe, expect, it } from "vitest";

import type { LeftOutTime } from "../api/types";
import { bandsOf, describeCoverage, describeLeftOut, endOf, listLeftOut, searchedHours } from "./coverage";

const names = (id: number) => ["", "jet", "jeep", "truck", "boat"][id] ?? "";
const leftOut = (from_s: number, to_s: number | null, reason: LeftOutTime["reason"], model_ids: number[] | null = null): LeftOutTime => ({
  from_s,
  to_s,
  reason,
  model_ids,
});

describe("describeLeftOut", () => {
  it("says when, why and for what", () => {
    expect(describeLeftOut(leftOut(0.3, null, "not_wanted"), names)).toBe("0:00.30 to the end: outside of --from and --to");
    expect(describeLeftOut(leftOut(0, null, "not_begun"), names)).toBe("not searched");
    expect(describeLeftOut(leftOut(0, 6, "not_begun", [2]), names)).toBe("0:00.00 to 0:06.00: not searched for jeep");
    expect(describeLeftOut(leftOut(1, 2, "thinned", [1, 2, 3, 4]), names)).toBe(
      "0:01.00 to 0:02.00: jet, jeep, truck and 1 more: searched in part only, to keep the pace",
    );
  });
});

describe("bandsOf", () => {
  it("tells what was searched for all models, for some and for none", () => {
    const video = {
      is_searched: false,
      searched: [{ from_s: 0, to_s: 2 }],
      left_out: [leftOut(2, 4, "not_wanted", [1]), leftOut(4, null, "not_yet"), leftOut(5, 6, "damaged")],
    };
    expect(bandsOf(video, 8, 2).map(({ from, to, state, leftOut: out }) => [from, to, state, out.length])).toEqual([
      [0, 2, "whole", 0],
      [2, 4, "part", 1],
      [4, 5, "none", 1],
      [5, 6, "none", 2],
      [6, 8, "none", 1],
    ]);
    expect(bandsOf({ is_searched: true, searched: [{ from_s: 0, to_s: 5.9 }], left_out: [] }, 6, 2).every((one) => one.state === "whole")).toBe(true);
  });
  it("knows when each model is left out for a reason of its own", () => {
    const video = { is_searched: false, searched: [], left_out: [leftOut(0, 2, "not_wanted", [1]), leftOut(0, 4, "not_begun", [2])] };
    expect(bandsOf(video, 4, 2).map((one) => one.state)).toEqual(["none", "part"]);
  });
  it("shows a pace as a part", () => {
    expect(bandsOf({ is_searched: false, searched: [], left_out: [leftOut(0, 6, "thinned")] }, 6, 2).map((one) => one.state)).toEqual(["part"]);
  });
});

describe("describeCoverage", () => {
  it("names what is left out", () => {
    const all = { is_searched: true, searched: [{ from_s: 0, to_s: 5 }], left_out: [] };
    expect(describeCoverage(all, names)).toBeNull();
    const times = [leftOut(0, 1, "not_wanted"), leftOut(2, 3, "not_wanted")];
    expect(describeCoverage({ ...all, left_out: times }, names)).toBe("0:00.00 to 0:01.00: outside of --from and --to; and 1 more");
    expect(listLeftOut(times, names).split("\n")).toHaveLength(2);
  });
});

it("shows what is missing after the last frame", () => {
  expect(endOf(6, null)).toBe(6);
  expect(endOf(6, { is_searched: false, searched: [], left_out: [leftOut(6, 10, "damaged"), leftOut(0, 99, "not_yet")] })).toBe(10);
});

it("counts hours of all videos", () => {
  expect(searchedHours([{ searched_s: 7200 }, { searched_s: 1800 }, { searched_s: 0 }])).toBeCloseTo(2.5);
});
