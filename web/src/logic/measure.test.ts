import { describe, expect, it } from "vitest";

import { offset } from "./geo";
import { areaOf, bearing, distance, formatDistance, formatSquare, lengthOf } from "./measure";

describe("measures on the ground", () => {
  it("know a degree of a meridian and of a parallel", () => {
    expect(distance([13, 52], [13, 53])).toBeCloseTo(111_195, -1);
    expect(distance([13, 60], [14, 60])).toBeCloseTo(55_597, -2);
  });

  it("know a square of 100 m, whichever way round, also across the antimeridian", () => {
    for (const corner of [[13.4, 52.5], [179.9999, -41]] as const) {
      const a = [corner[0], corner[1]] as [number, number];
      const square = [a, offset(a, 100, 0), offset(a, 100, 100), offset(a, 0, 100)].map(([x, y]) => [x > 180 ? x - 360 : x, y] as [number, number]);
      expect(areaOf(square)).toBeGreaterThan(9900);
      expect(areaOf(square)).toBeLessThan(10_100);
      expect(areaOf([...square].reverse())).toBeCloseTo(areaOf(square), 6);
      expect(lengthOf(square) / 300).toBeCloseTo(1, 1);
      expect(lengthOf(square, true) / 400).toBeCloseTo(1, 1);
    }
  });

  it("know the octant of the sphere, and directions", () => {
    expect(areaOf([[0, 0], [90, 0], [90, 90], [0, 90]])).toBeCloseTo((4 * Math.PI * 6_371_008.8 ** 2) / 8, -6);
    expect(bearing([13, 52], [13, 53])).toBe(0);
    expect(bearing([13, 0], [12, 0])).toBe(270);
  });

  it("are written as one reads them", () => {
    expect([1.26, 640.4, 1234, 12_345].map(formatDistance)).toEqual(["1.3 m", "640 m", "1,234 m", "12.35 km"]);
    expect([12.34, 5200, 52_000, 5.2e6].map(formatSquare)).toEqual(["12.3 m²", "5,200 m²", "5.20 ha", "5.20 km²"]);
  });
});
