import { describe, expect, it } from "vitest";

import type { CameraPath } from "../api/types";
import { MAX_VIDEOS, findPlace } from "./place_search";

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
  const find = (videos: number[], isWanted = () => true) => findPlace(videos, load, [14.0001, 52.0001], isWanted);

  it("is found in the first video that shows it, past those that cannot be read", async () => {
    expect(await find([1, 2, 3, 4])).toEqual({ video: 3, time: 5 });
  });

  it("may be in none", async () => {
    expect(await find([1, 2])).toBeNull();
    expect(await find([])).toBeNull();
  });

  it("is looked for in so many videos, and as long as somebody wants it", async () => {
    expect(await find([...Array.from({ length: MAX_VIDEOS }, () => 1), 3])).toBeNull();
    expect(await find([3], () => false)).toBeNull();
  });
});
