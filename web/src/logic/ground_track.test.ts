import { describe, expect, it } from "vitest";

import type { CameraPath } from "../api/types";
import type { Position } from "./geo";
import { groundTrack, momentsKey, onGround, placeAt, timeOnLine } from "./ground_track";

const square: Position[] = [[13, 52.001], [13.001, 52.001], [13.001, 52], [13, 52]];
const oblique: Position[] = [[-2, 4], [2, 4], [1, 0], [-1, 0]];

const path = (points: [number, Position[] | null][]): CameraPath => ({
  source: "telemetry",
  reason: null,
  ground_m: 0,
  points: points.map(([time_s, footprint]) => ({ time_s, position: [13, 52], altitude_m: 100, yaw_deg: 0, footprint })),
});

describe("the moments of an object", () => {
  it("differ when it was seen more in this video", () => {
    const moment = { id: 4, video_id: 1, first_time_s: 0, last_time_s: 2, frames: 5, score: 0.9 };
    const key = momentsKey({ moments: [moment] }, 1);
    expect(momentsKey({ moments: [{ ...moment, score: 0.95 }, { ...moment, video_id: 2 }] }, 1)).toBe(key);
    expect(momentsKey({ moments: [{ ...moment, last_time_s: 2.5, frames: 6 }] }, 1)).not.toBe(key);
    expect(momentsKey({ moments: [{ ...moment, id: 5 }] }, 1)).not.toBe(key);
    expect(momentsKey({ moments: [moment, { ...moment, first_time_s: 7, last_time_s: 8 }] }, 1)).not.toBe(key);
  });
});

describe("a box on the ground", () => {
  it("takes corners to corners", () => {
    for (const footprint of [square, oblique]) {
      [[0, 0], [1, 0], [1, 1], [0, 1]].forEach(([u = 0, v = 0], i) => {
        const at = onGround(footprint, u, v);
        expect(at?.[0]).toBeCloseTo(footprint[i]?.[0] ?? NaN, 9);
        expect(at?.[1]).toBeCloseTo(footprint[i]?.[1] ?? NaN, 9);
      });
    }
  });

  it("keeps straight lines: the diagonals meet in the middle of the frame", () => {
    // Those of the trapezoid from (-2, 4) to (1, 0) and from (2, 4) to (-1, 0) meet at y = 4 / 3.
    const middle = onGround(oblique, 0.5, 0.5);
    expect(middle?.[0]).toBeCloseTo(0, 9);
    expect(middle?.[1]).toBeCloseTo(4 / 3, 9);
  });

  it("is nowhere beyond the horizon, or on no ground", () => {
    expect(onGround(oblique, 0.5, -2)).toBeNull();
    expect(onGround([[0, 0], [1, 1], [2, 2], [3, 3]], 0.5, 0.5)).toBeNull();
  });
});

describe("a track", () => {
  const camera = path([[0, square], [1, square], [2, square], [3, null], [9, square], [10, square]]);
  const frame = { width: 100, height: 100 };
  const at = (time_s: number, x: number) => ({ time_s, box: [x - 5, 45, 10, 10] });

  it("follows the middles of boxes, in pieces", () => {
    const pieces = groundTrack([at(0, 0), at(1, 100), at(9, 50), at(10, 50)], camera, frame);
    expect(pieces.map((one) => one.map((point) => point.time))).toEqual([[0, 1], [9, 10]]);
    expect(pieces[0]?.[1]?.position[0]).toBeCloseTo(13.001, 9);
    expect(placeAt(pieces, 0.5)?.[0]).toBeCloseTo(13.0005, 9);
    expect(placeAt(pieces, 5)).toBeNull();
    expect(placeAt(pieces, 10)?.[0]).toBeCloseTo(13.0005, 9);
  });

  it("has no more points than a line needs, and its end", () => {
    const many = groundTrack(Array.from({ length: 4001 }, (_, i) => at(i / 4000, 50)), camera, frame);
    expect(many.flat().length).toBeLessThanOrEqual(502);
    expect(many.flat().at(-1)?.time).toBe(1);
  });
});

describe("the time on a line", () => {
  it("is that of the nearest point, between the points of the line", () => {
    const line = [{ time: 0, x: 0, y: 0 }, { time: 10, x: 100, y: 0 }, { time: 20, x: 100, y: 50 }];
    expect(timeOnLine(line, 25, 3)).toEqual({ time: 2.5, distance: 3 });
    expect(timeOnLine(line, 104, 25)).toEqual({ time: 15, distance: 4 });
    expect(timeOnLine(line.slice(0, 1), 3, 4)).toEqual({ time: 0, distance: 5 });
    expect(timeOnLine([], 0, 0)).toBeNull();
  });
});
