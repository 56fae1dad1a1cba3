import { describe, expect, it } from "vitest";

import { attributionOf, drawnLayers, layerNames } from "./base_map";

describe("a base map of vector tiles", () => {
  it("draws the layers of common makers, in an order of its own", () => {
    const drawn = (names: string[]) => drawnLayers(names).map((one) => `${one.kind} ${one.name}`);
    expect(drawn(["boundaries", "buildings", "earth", "landcover", "landuse", "places", "pois", "roads", "water"])).toEqual([
      "land earth", "green landcover", "green landuse", "water water", "building buildings", "boundary boundaries", "road roads",
    ]);
    expect(drawn(["water", "waterway", "landcover", "park", "boundary", "transportation", "transportation_name", "building", "water_name", "place", "poi"])).toEqual([
      "green landcover", "green park", "water water", "water waterway", "building building", "boundary boundary", "road transportation",
    ]);
    expect(drawn(["something", "street_labels"])).toEqual([]);
  });

  it("reads what archives say, and takes anything", () => {
    expect(layerNames({ vector_layers: [{ id: "water" }, { id: 3 }, null, "x"] })).toEqual(["water"]);
    for (const metadata of [null, undefined, 3, "x", {}, { vector_layers: 3 }]) expect(layerNames(metadata)).toEqual([]);
    expect(attributionOf({ attribution: '<a href="https://x.org">&copy; OpenStreetMap</a>  contributors' })).toBe("© OpenStreetMap contributors");
    for (const metadata of [null, {}, { attribution: 3 }]) expect(attributionOf(metadata)).toBe("");
  });
});
