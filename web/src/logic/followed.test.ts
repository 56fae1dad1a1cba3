import { describe, expect, it } from "vitest";

import { momentsOf, nameOf, readTrack } from "./followed";

const row = (frame: number, time_s: number) => ({ frame, time_s, box: [1, 2, 3, 4] as const });

describe("a followed object", () => {
  it("is read from JSON Lines, by frame", () => {
    const lines = [row(2, 0.2), row(1, 0.1)].map((one) => JSON.stringify({ ...one, model: "box-1", ce90_m: null }));
    expect(readTrack(`${lines.join("\n")}\n\n`)).toEqual([row(1, 0.1), row(2, 0.2)]);
    expect(readTrack("")).toEqual([]);
  });

  it.each(["{", '{"frame": 1, "time_s": 0}', '{"frame": 1, "time_s": 0, "box": [1, 2, 3]}', '{"frame": "1", "time_s": 0, "box": [1, 2, 3, 4]}'])(
    "is not read from %s",
    (line) => {
      expect(() => readTrack(line)).toThrow();
    },
  );

  it("is called what the user said that it is", () => {
    expect(["truck in a.mp4", "box in b in c.mp4"].map(nameOf)).toEqual(["truck", "box"]);
  });

  it("has a moment for each time in sight", () => {
    expect(momentsOf([row(0, 0), row(1, 0.5), row(2, 1.5), row(9, 4), row(10, 4.2)])).toEqual([
      { first: 0, last: 1.5, frames: 3 },
      { first: 4, last: 4.2, frames: 2 },
    ]);
    expect(momentsOf([])).toEqual([]);
  });
});
