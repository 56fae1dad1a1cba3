import { describe, expect, it } from "vitest";

import type { CameraPath } from "../api/types";
import { AT_ONCE, findPlace } from "./place_search";

/** A video of a camera that shows a square of 0.001 degrees around a place, at 5 s. */
const over = (x: number, y: number): CameraPath => {
  const side = 5e-4;
  const footprint = [[x - side, y + side], [x + side, y + side], [x + side, y - side], [x - side, y - side]];
  return {
    source: "telemetry",
    reason: null,
    ground_m: 0,
    points: [{ time_s: 5, position: [x, y], altitude_m: 100, yaw_deg: 0, footprint }],
  };
};

describe("a place", () => {
  const paths = new Map([[1, over(13, 52)], [3, over(14, 52)], [4, over(14, 52)]]);
  const load = (video: number) => {
    const path = paths.get(video);
    return path ? Promise.resolve(path) : Promise.reject(new Error("the video is not there"));
  };
  const find = (videos: number[], tell: (searched: number) => boolean = () => true) => findPlace(videos, load, [14.0001, 52.0001], tell);

  it("is found in the first video that shows it, past those that cannot be read", async () => {
    expect(await find([1, 2, 3, 4])).toEqual({ found: { video: 3, time: 5 }, searched: 3, failed: 1 });
  });

  it("may be in none", async () => {
    expect(await find([1, 2])).toEqual({ found: null, searched: 2, failed: 1 });
    expect(await find([])).toEqual({ found: null, searched: 0, failed: 0 });
  });

  it("is looked for in all videos, some at a time, as long as somebody wants it", async () => {
    const told: number[] = [];
    const many = [...Array.from({ length: 999 }, () => 1), 3];
    const all = await find(many, (searched) => told.push(searched) > 0);
    expect(all).toEqual({ found: { video: 3, time: 5 }, searched: 1000, failed: 0 });
    expect(told).toEqual(Array.from({ length: 1000 / AT_ONCE }, (_, i) => i * AT_ONCE));
    expect((await find([3], () => false)).found).toBeNull();
  });
});
