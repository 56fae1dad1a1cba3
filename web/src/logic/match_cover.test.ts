import { describe, expect, it } from "vitest";

import { areaOf, describeCover, hullOf, matchCover } from "./match_cover";

const square = [[0, 0], [100, 0], [100, 100], [0, 100]];

describe("how matches cover an object", () => {
  it("measures the hull, whatever its order and inner points", () => {
    const hull = hullOf([[10, 10], [50, 50], [90, 90], [10, 90], [90, 10], [30, 40]]);
    expect(hull).toHaveLength(4);
    expect(areaOf(hull)).toBe(6400);
    expect(hullOf([[1, 1], [2, 2], [3, 3]]).length).toBeLessThan(3);
  });

  it("finds that 7 of 8 lie in one small patch", () => {
    const patch = [[20, 20], [22, 25], [25, 21], [18, 24], [24, 27], [27, 22], [21, 29]];
    const cover = matchCover([...patch, [90, 80]], square);
    expect(cover).toMatchObject({ inPatch: 7, matches: 8, isOnePatch: true });
    expect(cover && describeCover(cover)).toMatch(/^7 of the 8 matches lie in one small patch/);
  });

  it("says of matches all over the object how much they span", () => {
    const all = Array.from({ length: 25 }, (_, i) => [10 + 20 * (i % 5), 10 + 20 * Math.floor(i / 5)]);
    const cover = matchCover(all, square);
    expect(cover).toMatchObject({ isOnePatch: false, part: 0.64 });
    expect(cover && describeCover(cover)).toBe("The matches span 64 % of the object.");
  });

  it("says nothing of three matches beside each other, nor without an outline", () => {
    expect(matchCover([[1, 1], [2, 2], [3, 1]], square)?.isOnePatch).toBe(false);
    expect(matchCover([], square)).toBeNull();
    expect(matchCover([[1, 1]], [])).toBeNull();
  });
});
