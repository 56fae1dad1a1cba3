import { describe, expect, it } from "vitest";

import { scaleBar } from "./map_picture";

describe("the scale of a printed map", () => {
  it("is a round length of a fifth to a half of the width", () => {
    expect(scaleBar(1000, 1000)).toEqual({ px: 200, label: "200 m" });
    expect(scaleBar(1000, 1100)).toEqual({ px: expect.closeTo(500 / 1.1) as number, label: "500 m" });
    expect(scaleBar(800, 8_000_000).label).toBe("2000 km");
    for (let width = 3; width < 1e6; width *= 1.3) {
      const { px } = scaleBar(600, width);
      expect(px).toBeGreaterThanOrEqual(119.9);
      expect(px).toBeLessThanOrEqual(301);
    }
  });
});
