// How the map looks: its sources and layers, and the marks and letters that are drawn here, so that no font is fetched.
import type { Feature, FeatureCollection, Geometry } from "geojson";
import type { ExpressionSpecification, Map as MapLibre, StyleSpecification } from "maplibre-gl";

import type { Position } from "../logic/geo";
import * as state from "../state";
import { type BaseMap, baseLayers } from "./base_map";

export const EMPTY: FeatureCollection = { type: "FeatureCollection", features: [] };
export const collection = (features: Feature[]): FeatureCollection => ({ type: "FeatureCollection", features });
export const feature = (geometry: Geometry, properties: Record<string, unknown> = {}): Feature => ({ type: "Feature", geometry, properties });
export const polygon = (ring: Position[]): Geometry => ({ type: "Polygon", coordinates: [[...ring, ring[0] ?? [0, 0]]] });

const token = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const LAST_TILE_ZOOM = 18;
export const OBJECT_LAYERS = ["chosen", "objects", "names", "clusters"];

/** A text or a colour for each model's id. */
function byModel(value: (name: string) => string, otherwise: string): ExpressionSpecification | string {
  const models = state.project.value.state === "ready" ? state.project.value.value.models : [];
  if (models.length === 0) return otherwise;
  const cases = models.flatMap((one) => [one.id, value(one.name)] as const);
  return ["match", ["get", "model"], ...cases, otherwise] as unknown as ExpressionSpecification;
}

/**
 * @param tiles  the address of the objects' tiles
 * @param base  below all that the page draws; null: its own land alone
 */
export function makeStyle(tiles: string, base: BaseMap | null): StyleSpecification {
  const colour = byModel(state.colourOf, "#e69f00");
  const opacity: ExpressionSpecification = ["case", ["to-boolean", ["get", "matches"]], 1, 0.25];
  const isRejected: ExpressionSpecification = ["==", ["coalesce", ["feature-state", "verdict"], ["get", "verdict"]], "rejected"];
  // The arrow of the heading stands there: the name gives way.
  const heading: ExpressionSpecification = ["%", ["+", ["coalesce", ["get", "heading"], 270], 360], 360];
  const pointsEast: ExpressionSpecification = ["all", [">", heading, 40], ["<", heading, 140]];
  const geojson = () => ({ type: "geojson" as const, data: EMPTY });
  return {
    version: 8,
    // Other colours at once: the picture for paper does not wait.
    transition: { duration: 0, delay: 0 },
    sources: {
      ...(base && { base: base.source, "base-area": base.area ? { type: "geojson" as const, data: feature(polygon(base.area)) } : geojson() }),
      land: geojson(),
      grid: geojson(),
      coverage: geojson(),
      searched: geojson(),
      footprint: geojson(),
      path: geojson(),
      tracks: geojson(),
      "tracks-now": geojson(),
      area: geojson(),
      measure: geojson(),
      camera: geojson(),
      objects: { type: "vector", tiles: [tiles], minzoom: 0, maxzoom: LAST_TILE_ZOOM },
      chosen: geojson(),
    },
    layers: [
      { id: "water", type: "background", paint: { "background-color": token("--water") } },
      { id: "land", type: "fill", source: "land", paint: { "fill-color": token("--land") } },
      { id: "borders", type: "line", source: "land", paint: { "line-color": token("--border-line"), "line-width": 0.7 } },
      ...(base ? baseLayers(base, token, document.documentElement.dataset["theme"] === "dark") : []),
      { id: "grid", type: "line", source: "grid", paint: { "line-color": token("--grid"), "line-width": 1 } },
      {
        id: "coverage",
        type: "fill",
        source: "coverage",
        paint: { "fill-color": token("--accent"), "fill-opacity": 0.012, "fill-antialias": false },
      },
      {
        id: "searched",
        type: "fill",
        source: "searched",
        filter: ["==", ["get", "kind"], "probability"],
        paint: { "fill-color": token("--accent"), "fill-opacity": ["*", 0.6, ["get", "min_probability"]], "fill-antialias": false },
      },
      {
        id: "searched-gaps",
        type: "line",
        source: "searched",
        filter: ["==", ["get", "kind"], "gap"],
        paint: { "line-color": token("--warning"), "line-width": 1.5 },
      },
      {
        id: "path",
        type: "line",
        source: "path",
        layout: { "line-cap": "round", "line-join": "round" },
        paint: { "line-color": token("--accent"), "line-width": 2, "line-opacity": 0.8 },
      },
      {
        id: "tracks",
        type: "line",
        source: "tracks",
        layout: { "line-cap": "round", "line-join": "round" },
        paint: {
          "line-color": ["get", "colour"],
          "line-width": ["case", ["get", "chosen"], 4, 2.5],
          "line-opacity": ["case", ["get", "chosen"], 1, 0.7],
        },
      },
      {
        id: "tracks-now",
        type: "circle",
        source: "tracks-now",
        paint: {
          "circle-color": token("--text"),
          "circle-radius": 4,
          "circle-stroke-width": 2.5,
          "circle-stroke-color": ["get", "colour"],
        },
      },
      {
        id: "area",
        type: "fill",
        source: "area",
        filter: ["==", ["geometry-type"], "Polygon"],
        paint: { "fill-color": token("--accent"), "fill-opacity": 0.1 },
      },
      {
        id: "area-border",
        type: "line",
        source: "area",
        paint: { "line-color": token("--accent"), "line-width": 2 },
      },
      {
        id: "area-corners",
        type: "circle",
        source: "area",
        filter: ["==", ["geometry-type"], "Point"],
        paint: { "circle-color": token("--text"), "circle-radius": 4, "circle-stroke-color": token("--accent"), "circle-stroke-width": 2 },
      },
      {
        id: "measure",
        type: "fill",
        source: "measure",
        filter: ["==", ["geometry-type"], "Polygon"],
        paint: { "fill-color": token("--warning"), "fill-opacity": 0.15 },
      },
      {
        id: "measure-line",
        type: "line",
        source: "measure",
        filter: ["==", ["geometry-type"], "LineString"],
        paint: { "line-color": token("--warning"), "line-width": 2.5 },
      },
      {
        id: "measure-points",
        type: "circle",
        source: "measure",
        filter: ["==", ["geometry-type"], "Point"],
        paint: { "circle-color": token("--surface"), "circle-radius": 4, "circle-stroke-color": token("--warning"), "circle-stroke-width": 2 },
      },
      {
        id: "footprint",
        type: "line",
        source: "footprint",
        paint: { "line-color": token("--accent"), "line-width": 1.5, "line-dasharray": [3, 2] },
      },
      {
        id: "ellipses",
        type: "fill",
        source: "objects",
        "source-layer": "ellipses",
        paint: { "fill-color": colour, "fill-opacity": ["*", 0.22, opacity] },
      },
      {
        id: "ellipse-borders",
        type: "line",
        source: "objects",
        "source-layer": "ellipses",
        paint: { "line-color": colour, "line-width": 1, "line-opacity": opacity },
      },
      {
        id: "chosen-ellipse",
        type: "line",
        source: "chosen",
        filter: ["==", ["geometry-type"], "Polygon"],
        paint: { "line-color": colour, "line-width": 2.5 },
      },
      {
        id: "camera",
        type: "symbol",
        source: "camera",
        layout: {
          "icon-image": "camera",
          "icon-rotate": ["get", "yaw"],
          "icon-rotation-alignment": "map",
          "icon-allow-overlap": true,
        },
      },
      {
        id: "clusters",
        type: "circle",
        source: "objects",
        "source-layer": "clusters",
        paint: {
          "circle-color": token("--surface"),
          "circle-radius": ["interpolate", ["linear"], ["log10", ["get", "count"]], 0, 8, 4, 17],
          "circle-opacity": ["case", [">", ["get", "matches"], 0], 0.92, 0.35],
          "circle-stroke-color": token("--accent"),
          "circle-stroke-width": 1.5,
          "circle-stroke-opacity": ["case", [">", ["get", "matches"], 0], 1, 0.35],
        },
      },
      {
        id: "cluster-counts",
        type: "symbol",
        source: "objects",
        "source-layer": "clusters",
        layout: { "icon-image": ["concat", "count:", ["get", "label"]], "icon-allow-overlap": true, "icon-ignore-placement": true },
        paint: { "icon-opacity": ["case", [">", ["get", "matches"], 0], 1, 0.5] },
      },
      {
        id: "objects",
        type: "circle",
        source: "objects",
        "source-layer": "objects",
        paint: {
          "circle-color": ["case", isRejected, "transparent", colour],
          "circle-radius": 5,
          "circle-opacity": opacity,
          "circle-stroke-width": 1.5,
          "circle-stroke-color": ["case", isRejected, colour, token("--bg")],
          "circle-stroke-opacity": opacity,
        },
      },
      {
        id: "headings",
        type: "symbol",
        source: "objects",
        "source-layer": "objects",
        filter: ["has", "heading"],
        layout: {
          "icon-image": "heading",
          "icon-rotate": ["get", "heading"],
          "icon-rotation-alignment": "map",
          "icon-allow-overlap": true,
          "icon-offset": [0, -18],
        },
        paint: { "icon-opacity": opacity },
      },
      {
        id: "names",
        type: "symbol",
        source: "objects",
        "source-layer": "objects",
        layout: {
          "icon-image": ["concat", "name:", byModel((name) => name, "")],
          "icon-anchor": "left",
          "icon-offset": ["case", pointsEast, ["literal", [26, 0]], ["literal", [11, 0]]],
          "icon-padding": 2,
          "symbol-sort-key": ["-", 0, ["get", "score"]],
        },
        paint: { "icon-opacity": opacity },
      },
      {
        id: "chosen",
        type: "circle",
        source: "chosen",
        filter: ["==", ["geometry-type"], "Point"],
        paint: {
          "circle-color": ["case", ["get", "rejected"], "transparent", colour],
          "circle-radius": 8,
          "circle-stroke-width": 3,
          "circle-stroke-color": token("--text"),
        },
      },
    ],
  };
}

function drawImage(width: number, height: number, paint: (context: CanvasRenderingContext2D) => void) {
  const canvas = document.createElement("canvas");
  canvas.width = width * 2;
  canvas.height = height * 2;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("no canvas");
  context.scale(2, 2);
  paint(context);
  return context.getImageData(0, 0, canvas.width, canvas.height);
}

export function nameImage(name: string) {
  const font = "600 12px system-ui, sans-serif";
  const measure = document.createElement("canvas").getContext("2d");
  if (!measure) throw new Error("no canvas");
  measure.font = font;
  const width = Math.ceil(measure.measureText(name).width) + 6;
  return drawImage(width, 18, (context) => {
    context.font = font;
    context.lineJoin = "round";
    context.lineWidth = 3;
    context.strokeStyle = token("--bg");
    context.strokeText(name, 3, 13);
    context.fillStyle = token("--text");
    context.fillText(name, 3, 13);
  });
}

export function countImage(count: string) {
  return drawImage(32, 16, (context) => {
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.fillStyle = token("--text");
    context.fillText(count, 16, 12);
  });
}

export function addImages(map: MapLibre) {
  map.on("styleimagemissing", ({ id }) => {
    if (map.hasImage(id)) return;
    if (id.startsWith("name:")) map.addImage(id, nameImage(id.slice(5)), { pixelRatio: 2 });
    if (id.startsWith("count:")) map.addImage(id, countImage(id.slice(6)), { pixelRatio: 2 });
  });
  const stroke = (context: CanvasRenderingContext2D, colour: string) => {
    context.lineJoin = "round";
    context.lineWidth = 2;
    context.strokeStyle = token("--bg");
    context.stroke();
    context.fillStyle = colour;
    context.fill();
  };
  map.addImage(
    "camera",
    drawImage(24, 24, (context) => {
      context.beginPath();
      for (const [x, y] of [[12, 3], [20, 20], [12, 16], [4, 20]] as const) context.lineTo(x, y);
      context.closePath();
      stroke(context, token("--accent"));
    }),
    { pixelRatio: 2 },
  );
  map.addImage(
    "heading",
    drawImage(12, 10, (context) => {
      context.beginPath();
      for (const [x, y] of [[6, 1], [11, 9], [1, 9]] as const) context.lineTo(x, y);
      context.closePath();
      stroke(context, token("--text"));
    }),
    { pixelRatio: 2 },
  );
}
