import { describe, expect, it } from "vitest";

import type { Sighting } from "../api/types";
import { inHalves } from "./halves";

const at = (time: number, object = 1) => ({ object_id: object, time_s: time }) as Sighting;

/** A server that has these sightings and gives at most `limit`. */
const server = (all: readonly Sighting[], limit: number) => {
  const asked: [number, number][] = [];
  const fetch = (from: number, to: number) => {
    asked.push([from, to]);
    const found = all.filter((one) => one.time_s >= from && one.time_s <= to);
    return Promise.resolve({ sightings: found.slice(0, limit), truncated: found.length > limit });
  };
  return { fetch, asked };
};

describe("more sightings than fit in one answer", () => {
  it("takes one answer if it holds all", async () => {
    const { fetch, asked } = server([at(0), at(1)], 10);
    expect(await inHalves(fetch, 0, 1)).toEqual({ sightings: [at(0), at(1)], truncated: false });
    expect(asked).toEqual([[0, 1]]);
  });

  it("has each sighting once, also those on a middle", async () => {
    const all = Array.from({ length: 1001 }, (_, i) => at(i / 10));
    const { sightings, truncated } = await inHalves(server(all, 7).fetch, 0, 100);
    expect(truncated).toBe(false);
    expect(sightings.map((one) => one.time_s)).toEqual(all.map((one) => one.time_s));
  });

  it("says so where too many lie at one time", async () => {
    const all = [...Array.from({ length: 5 }, (_, i) => at(2, i)), at(3)];
    const { sightings, truncated } = await inHalves(server(all, 3).fetch, 0, 4);
    expect(truncated).toBe(true);
    expect(sightings.filter((one) => one.time_s === 2)).toHaveLength(3);
    expect(sightings.at(-1)).toEqual(at(3));
  });
});
