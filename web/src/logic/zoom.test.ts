import { describe, expect, it } from "vitest";

import { lensAt, panBy, place, shownPart, zoomBy, zoomTo } from "./zoom";

const frame = { width: 1920, height: 1080 };
const area = { width: 640, height: 480 };
const under = (at: { x: number; y: number; scale: number }, [x, y]: readonly [number, number]) => [(x - at.x) / at.scale, (y - at.y) / at.scale];

describe("zoom", () => {
  it("keeps what lies under the pointer", () => {
    const point = [200, 200] as const;
    const before = under(place(frame, area, null), point);
    let zoom = null;
    for (let i = 0; i < 9; i++) zoom = zoomBy(zoom, 1.5, point, frame, area);
    const after = under(place(frame, area, zoom), point);
    expect(after[0]).toBeCloseTo(before[0] ?? 0, 6);
    expect(after[1]).toBeCloseTo(before[1] ?? 0, 6);
  });

  it("ends with all of the frame, in the middle", () => {
    const zoom = zoomBy(zoomBy(null, 4, [10, 100], frame, area), 0.2, [600, 400], frame, area);
    expect(zoom).toBeNull();
    expect(place(frame, area, zoom)).toEqual({ scale: 1 / 3, x: 0, y: 60 });
  });

  it("shows one pixel of the video as one of the screen", () => {
    expect(place(frame, area, zoomTo(null, 1, [320, 240], frame, area)).scale).toBe(1);
  });

  it("does not leave the frame", () => {
    const zoom = panBy(zoomTo(null, 2, [320, 240], frame, area), 1e6, -1e6, frame, area);
    expect(shownPart(frame, area, place(frame, area, zoom))).toEqual([0, 840, 320, 240]);
    expect(panBy(null, 10, 10, frame, area)).toBeNull();
  });

  it("ends at a scale that shows nothing new", () => {
    const zoom = zoomTo(null, 1e9, [320, 240], frame, area);
    expect(place(frame, area, zoom).scale).toBe(32);
  });

  it("keeps the middle of a lens where it is", () => {
    const at = place(frame, area, null);
    expect(under(lensAt(at, [300, 200], 4), [300, 200])).toEqual(under(at, [300, 200]));
    expect(lensAt(at, [300, 200], 4).scale).toBeCloseTo(4 / 3);
  });
});
