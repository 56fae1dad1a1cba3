import type { FeatureCollection, Position } from "geojson";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { feature } from "topojson-client";
import type { GeometryCollection, Topology } from "topojson-specification";
import { describe, expect, it } from "vitest";

import { unwrapLand, unwrapRing } from "./land";

describe("land on a flat map", () => {
  it("lets a ring go on beyond 180°, and back", () => {
    const ring = [[170, 60], [179, 61], [-179, 62], [-170, 60], [179, 59], [170, 60]];
    expect(unwrapRing(ring)).toEqual([[170, 60], [179, 61], [181, 62], [190, 60], [179, 59], [170, 60]]);
  });

  it("closes a ring around a pole along it", () => {
    const ring = [[-180, -70], [0, -72], [179, -71], [-180, -70]];
    expect(unwrapRing(ring)).toEqual([[-180, -70], [0, -72], [179, -71], [180, -70], [180, -89], [-180, -89], [-180, -70]]);
  });

  it("leaves no line across the map", () => {
    const path = createRequire(import.meta.url).resolve("world-atlas/countries-50m.json");
    const topology = JSON.parse(readFileSync(path, "utf8")) as Topology<{ countries: GeometryCollection }>;
    const land: FeatureCollection = feature(topology, topology.objects.countries);
    const crossing = (rings: Position[][]) =>
      rings.filter((ring) => ring.some(([x = 0, y = 0], i) => Math.abs(x - (ring[i - 1]?.[0] ?? x)) > 180 && Math.abs(y) < 89)).length;
    const count = (all: FeatureCollection) =>
      all.features.reduce((sum, { geometry }) => sum + (geometry.type === "MultiPolygon" ? geometry.coordinates : []).reduce((one, rings) => one + crossing(rings), 0), 0);
    expect(count(land)).toBe(4);
    expect(count(unwrapLand(land))).toBe(0);
  });
});
