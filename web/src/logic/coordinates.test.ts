import { describe, expect, it } from "vitest";

import { parseArea } from "./area";
import { isPosition, readPosition } from "./coordinates";
import { parseQuery } from "./filters";
import { COORDINATE_STYLES, formatPosition } from "./format";
import { positionOfUtm, utmOf } from "./mgrs";

/** Both hemispheres, the borders of zones and bands, and the zones that Norway widens. */
const PLACES = [
  [52.52, 13.405], [-33.8568, 151.2153], [0.00001, -0.00001], [60.39, 5.32], [78.22, 15.65], [-54.8019, -68.303],
  [71.99999, 26], [83.9, -30], [-79.9, 179.9], [47.99999, 11.99999], [48, 12], [19.43, -99.13], [-0.5, 36.9],
] as const;

describe("positions", () => {
  it("are read in every style in which they are copied", () => {
    for (const [latitude, longitude] of PLACES) {
      for (const style of COORDINATE_STYLES) {
        const text = formatPosition(latitude, longitude, style);
        const found = readPosition(text);
        const place = `${style} ${text}`;
        expect(found?.rest, place).toBe("");
        // MGRS names a square of 1 m, a degree of longitude is 111 km at most.
        expect(Math.abs((found?.latitude ?? NaN) - latitude), place).toBeLessThan(1e-5);
        expect(Math.abs((found?.longitude ?? NaN) - longitude) * Math.cos((latitude * Math.PI) / 180), place).toBeLessThan(1e-5);
      }
    }
  });

  it("come back from UTM to less than a millimetre", () => {
    for (const [latitude, longitude] of PLACES) {
      const utm = utmOf(latitude, longitude);
      const back = utm && positionOfUtm(utm);
      expect(Math.abs((back?.latitude ?? NaN) - latitude)).toBeLessThan(1e-8);
      expect(Math.abs((back?.longitude ?? NaN) - longitude)).toBeLessThan(1e-8);
    }
  });

  it("are read as others write them", () => {
    const place = { latitude: 52.52, longitude: 13.4 };
    for (const text of ["52.52 13.4", "52.52;13.4", "52.52°, 13.4°", "52.52N 13.4E", "52.52° N, 13.4° E", "52°31'12\"N 13°24'0\"E", "52° 31.2' N 13° 24' E"]) {
      const found = readPosition(text);
      expect(found?.latitude, text).toBeCloseTo(place.latitude, 9);
      expect(found?.longitude, text).toBeCloseTo(place.longitude, 9);
    }
    expect(readPosition("33°51'24\"S 70°W")).toMatchObject({ longitude: -70 });
    const [spaced, joined, lower] = ["33U UU 91390 17855", "33UUU9139017855", "33u uu 91390 17855"].map(readPosition);
    expect([joined, lower]).toEqual([spaced, spaced]);
    for (const text of ["jeep", "52", "61U UU 1 1", "33I UU 1 1", "33U IU 11 11", "33U 390842", "", "-"]) expect(readPosition(text), text).toBeNull();
  });

  it("are a search by themselves, or after near, with a radius", () => {
    for (const style of COORDINATE_STYLES) {
      const text = formatPosition(52.52, 13.405, style);
      for (const [query, metres] of [[text, 200], [`near ${text}`, 200], [`near ${text} 2 km`, 2000], [`${text} 50 m`, 50]] as const) {
        const { near, words } = parseQuery(query);
        expect(near?.latitude, query).toBeCloseTo(52.52, 4);
        expect(near?.longitude, query).toBeCloseTo(13.405, 4);
        expect([near?.metres, words], query).toEqual([metres, []]);
      }
    }
    expect(parseQuery("jeep near 33U UU 91390 17855 50 m").words).toEqual(["jeep"]);
    expect(parseQuery("jeep near 33U UU 91").near).toMatchObject({ metres: 200 });
    // Numbers of objects are words.
    for (const text of ["12 13", "jeep 12.5 13.5", "9001"]) expect(parseQuery(text), text).toMatchObject({ near: null, words: text.split(" ") });
    expect([isPosition("12 13"), isPosition("12.5 13.5")]).toEqual([false, true]);
  });

  it("are corners of an area", () => {
    const corners = COORDINATE_STYLES.map((style) => `${formatPosition(52.51, 13.37, style)} ${formatPosition(52.52, 13.39, style)}`);
    for (const text of corners) {
      const area = parseArea(text);
      expect(area?.length, text).toBe(4);
      expect(area?.[0]?.[1], text).toBeCloseTo(52.51, 4);
      expect(area?.[2]?.[0], text).toBeCloseTo(13.39, 4);
    }
    expect(parseArea("52.51,13.37,52.52,13.39")?.length).toBe(4);
    expect(parseArea("52.51,13.37 the barn")).toBeNull();
  });
});
