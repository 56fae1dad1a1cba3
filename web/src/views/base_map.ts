// The base map that the server was given: its source and its layers below all that the page draws.
import type { LayerSpecification, RasterSourceSpecification, VectorSourceSpecification } from "maplibre-gl";

import { BASE_MAP_URL } from "../api/client";
import type { Project } from "../api/types";
import { type BaseKind, attributionOf, drawnLayers, layerNames } from "../logic/base_map";
import type { Position } from "../logic/geo";

export interface BaseMap {
  source: RasterSourceSpecification | VectorSourceSpecification;
  /** Of vector tiles. */
  layers: { name: string; kind: BaseKind }[];
  /** What the tiles cover; null: the world. */
  area: Position[] | null;
  attribution: string;
}

type Described = NonNullable<Project["base_map"]>;
type AddProtocol = typeof import("maplibre-gl").addProtocol;

export async function loadBaseMap(described: Described, addProtocol: AddProtocol): Promise<BaseMap> {
  if (described.url !== null) {
    const source: RasterSourceSpecification = { type: "raster", tiles: [described.url], tileSize: 256, maxzoom: described.max_zoom };
    return { source, layers: [], area: null, attribution: described.attribution ?? "" };
  }
  const { PMTiles, Protocol } = await import("pmtiles");
  const archive = new PMTiles(location.origin + BASE_MAP_URL);
  const [header, metadata] = await Promise.all([archive.getHeader(), archive.getMetadata()]);
  const protocol = new Protocol();
  protocol.add(archive);
  addProtocol("pmtiles", protocol.tile);
  const bounds: [number, number, number, number] = [header.minLon, header.minLat, header.maxLon, header.maxLat];
  const [west, south, east, north] = bounds;
  const tiles = {
    tiles: [`pmtiles://${location.origin}${BASE_MAP_URL}/{z}/{x}/{y}`],
    minzoom: header.minZoom,
    maxzoom: header.maxZoom,
    bounds,
  };
  return {
    source: described.is_vector ? { type: "vector", ...tiles } : { type: "raster", tileSize: 256, ...tiles },
    layers: described.is_vector ? drawnLayers(layerNames(metadata)) : [],
    area: [[west, south], [east, south], [east, north], [west, north]],
    attribution: described.attribution ?? attributionOf(metadata),
  };
}

/** @param token  the value of a colour of tokens.css */
export function baseLayers(base: BaseMap, token: (name: string) => string, isDark: boolean): LayerSpecification[] {
  if (base.source.type === "raster") {
    // In the dark theme images are dimmed, so that objects stand out.
    const paint = { "raster-fade-duration": 0, "raster-brightness-max": isDark ? 0.6 : 1, "raster-saturation": isDark ? -0.4 : 0 };
    return [{ id: "base", type: "raster", source: "base", paint }];
  }
  const colours: Record<BaseKind, string> = {
    land: token("--land"), green: token("--map-green"), water: token("--map-water"), building: token("--map-building"), boundary: token("--border-line"), road: token("--map-road"),
  };
  const layers: LayerSpecification[] = [{ id: "base-area", type: "fill", source: "base-area", paint: { "fill-color": token("--land") } }];
  for (const { name, kind } of base.layers) {
    const common = { source: "base", "source-layer": name };
    const colour = colours[kind];
    if (kind !== "road" && kind !== "boundary") {
      layers.push({ id: `base-fill-${name}`, type: "fill", ...common, filter: ["==", ["geometry-type"], "Polygon"], paint: { "fill-color": colour } });
    }
    if (kind === "land" || kind === "green" || kind === "building") continue;
    const width = kind === "road" ? ["interpolate", ["exponential", 1.6], ["zoom"], 6, 0.4, 12, 1, 16, 4, 20, 16] : 1;
    layers.push({
      id: `base-line-${name}`,
      type: "line",
      ...common,
      filter: ["==", ["geometry-type"], "LineString"],
      layout: { "line-cap": "round", "line-join": "round" },
      paint: { "line-color": colour, "line-width": width as number, ...(kind === "boundary" ? { "line-dasharray": [3, 2] } : {}) },
    });
  }
  return layers;
}
