import { describe, expect, it } from "vitest";

import { formatArea, isArea, isInArea, nearestCorner, onOneGlobe, parseArea, rectangle } from "./area";

describe("an area of the map", () => {
  const notched = parseArea("0 0, 10 0, 10 5, 3 6, 10 7, 10 12, 0 12");

  it("holds what lies inside, also of a concave one", () => {
    expect(notched && isInArea(notched, [2, 8])).toBe(true);
    expect(notched && isInArea(notched, [6, 8])).toBe(false);
    expect(notched && isInArea(notched, [6, 2])).toBe(true);
    expect(notched && isInArea(notched, [13, 2])).toBe(false);
  });

  it("may cross the antimeridian", () => {
    const pacific = rectangle([179, -1], [-179, 1]);
    expect(isInArea(pacific, [179.5, 0])).toBe(true);
    expect(isInArea(pacific, [-179.5, 0])).toBe(true);
    expect(isInArea(pacific, [0, 0])).toBe(false);
  });

  it("is the same after it was written and read", () => {
    const area = rectangle([13.4, 52.5], [13.5, 52.6]);
    expect(formatArea(area)).toBe("52.5,13.4,52.6,13.4,52.6,13.5,52.5,13.5");
    expect(parseArea(formatArea(area))).toEqual(area);
  });

  it("takes two corners as those of a rectangle", () => {
    expect(parseArea("52.5, 13.4; 52.6, 13.5")).toEqual(rectangle([13.4, 52.5], [13.5, 52.6]));
  });

  it.each(["", "52.5", "1,2,3", "1,2,3,4,5", "1,2,1,4", "91,0,1,1", "a,b,c,d", "0,0,0,100,1,0"])("refuses %j", (text) => {
    expect(parseArea(text)).toBeNull();
  });

  it("is drawn as far as the server takes it", () => {
    const sent = (area: ReturnType<typeof rectangle>) => parseArea(formatArea(onOneGlobe(area)));
    for (const far of [[200, 95], [-170, -95], [13.4000004 + 90, 0], [50, 50]] as const) {
      const area = rectangle([13.4000004, 52], nearestCorner([13.4000004, 52], [far[0], far[1]]));
      expect(sent(area)).not.toBeNull();
      expect(isInArea(area, [13.5 + Math.sign(far[0] - 13) * 0.2, 52 + Math.sign(far[1] - 52) * 0.2])).toBe(true);
    }
    expect(nearestCorner(undefined, [400, 91])).toEqual([400, 90]);
    expect(onOneGlobe([[733, 52], [734, 52], [734, 53]])).toEqual([[13, 52], [14, 52], [14, 53]]);
    expect(sent([[179, 0], [181, 0], [181, 1]])).toEqual([[179, 0], [181, 0], [181, 1]]);
  });

  it("has a size", () => {
    expect(isArea(rectangle([0, 0], [1, 1]))).toBe(true);
    expect(isArea(rectangle([0, 0], [0, 1]))).toBe(false);
    expect(isArea([[0, 0], [1, 1]])).toBe(false);
  });
});
