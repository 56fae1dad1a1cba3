// The map: objects with their 90 % ellipses, the camera's path, what it shows of the ground now and what it has shown.
// It needs no internet: land from world-atlas, a metric grid, and the frame itself laid on the ground.
import "maplibre-gl/dist/maplibre-gl.css";

import { effect, signal } from "@preact/signals";
import type { Feature, FeatureCollection, Geometry } from "geojson";
import type { GeometryCollection, Topology } from "topojson-specification";
import type {
  CanvasSource, ExpressionSpecification, GeoJSONSource, LngLatBoundsLike, Map as MapLibre, StyleSpecification, VectorTileSource,
} from "maplibre-gl";
import { useEffect, useRef } from "preact/hooks";
import atlasUrl from "world-atlas/countries-50m.json?url";

import { tilesUrl } from "../api/client";
import type { CameraPath, FoundObject } from "../api/types";
import { messageOf } from "../logic/errors";
import { filterParams } from "../logic/filters";
import { formatMetres, formatPosition } from "../logic/format";
import { type Position, cameraAt, ellipseRing, gridLines, gridSpacing, whenSeen } from "../logic/geo";
import { lastReview } from "../objects";
import { frameCanvas, pictureVersion } from "../player";
import * as notices from "../notices";
import * as selection from "../selection";
import * as state from "../state";
import { Icon } from "./icons";

const isDraped = signal(true);
const isFollowing = signal(false);
const isReady = signal(false);
const pointer = signal<Position | null>(null);
const spacing = signal<number | null>(null);
const failure = signal<string | null>(null);

const EMPTY: FeatureCollection = { type: "FeatureCollection", features: [] };
const collection = (features: Feature[]): FeatureCollection => ({ type: "FeatureCollection", features });
const feature = (geometry: Geometry, properties: Record<string, unknown> = {}): Feature => ({ type: "Feature", geometry, properties });
const polygon = (ring: Position[]): Geometry => ({ type: "Polygon", coordinates: [[...ring, ring[0] ?? [0, 0]]] });

const token = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// The picture that is laid on the ground; small, because the map only hints at it.
const drape = document.createElement("canvas");
drape.width = 512;
drape.height = 384;

/** A text or a colour for each model's id. */
function byModel(value: (name: string) => string, otherwise: string): ExpressionSpecification | string {
  const models = state.project.value.state === "ready" ? state.project.value.value.models : [];
  if (models.length === 0) return otherwise;
  const cases = models.flatMap((one) => [one.id, value(one.name)] as const);
  return ["match", ["get", "model"], ...cases, otherwise] as unknown as ExpressionSpecification;
}

const LAST_TILE_ZOOM = 18;
const OBJECT_LAYERS = ["chosen", "objects", "names", "clusters"];

const tileAddress = () => {
  const params = filterParams(state.filters.value);
  if (state.indexVersion.value > 0) params.set("v", String(state.indexVersion.value));
  return tilesUrl(params);
};

/** @param tiles  the address of the objects' tiles */
function makeStyle(tiles: string): StyleSpecification {
  const colour = byModel(state.colourOf, "#e69f00");
  const opacity: ExpressionSpecification = ["case", ["to-boolean", ["get", "matches"]], 1, 0.25];
  const isRejected: ExpressionSpecification = ["==", ["coalesce", ["feature-state", "verdict"], ["get", "verdict"]], "rejected"];
  const geojson = () => ({ type: "geojson" as const, data: EMPTY });
  return {
    version: 8,
    sources: {
      land: geojson(),
      grid: geojson(),
      coverage: geojson(),
      footprint: geojson(),
      path: geojson(),
      camera: geojson(),
      objects: { type: "vector", tiles: [tiles], minzoom: 0, maxzoom: LAST_TILE_ZOOM },
      chosen: geojson(),
    },
    layers: [
      { id: "water", type: "background", paint: { "background-color": token("--water") } },
      { id: "land", type: "fill", source: "land", paint: { "fill-color": token("--land") } },
      { id: "borders", type: "line", source: "land", paint: { "line-color": token("--border-line"), "line-width": 0.7 } },
      { id: "grid", type: "line", source: "grid", paint: { "line-color": token("--grid"), "line-width": 1 } },
      {
        id: "coverage",
        type: "fill",
        source: "coverage",
        paint: { "fill-color": token("--accent"), "fill-opacity": 0.012, "fill-antialias": false },
      },
      {
        id: "path",
        type: "line",
        source: "path",
        layout: { "line-cap": "round", "line-join": "round" },
        paint: { "line-color": token("--accent"), "line-width": 2, "line-opacity": 0.8 },
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
          "icon-offset": [0, -14],
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
          "icon-offset": [11, 0],
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

// Letters and marks are drawn here, so that no font is fetched.
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

function nameImage(name: string) {
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

function countImage(count: string) {
  return drawImage(32, 16, (context) => {
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.fillStyle = token("--text");
    context.fillText(count, 16, 12);
  });
}

function addImages(map: MapLibre) {
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

/** The selected object, drawn by itself: above all others, at its exact place, with its whole ellipse. */
function chosenFeatures(object: FoundObject | null) {
  if (!object?.place) return EMPTY;
  const properties = { id: object.id, model: object.model_id, rejected: object.review?.verdict === "rejected" };
  const position: Position = [object.place.longitude_deg, object.place.latitude_deg];
  const ring = ellipseRing(object.place);
  const features = [feature({ type: "Point", coordinates: position }, properties)];
  if (ring) features.push(feature({ type: "Polygon", coordinates: [ring] }, properties));
  return collection(features);
}

function boundsOf(path: CameraPath | null): LngLatBoundsLike | null {
  const all: Position[] = [];
  for (const point of path?.points ?? []) {
    all.push(point.position as Position, ...((point.footprint as Position[] | null) ?? []));
  }
  if (all.length === 0) {
    const project = state.project.peek();
    return project.state === "ready" ? (project.value.bounds as [number, number, number, number] | null) : null;
  }
  const xs = all.map((one) => one[0]);
  const ys = all.map((one) => one[1]);
  const min = (values: number[]) => values.reduce((a, b) => Math.min(a, b));
  const max = (values: number[]) => values.reduce((a, b) => Math.max(a, b));
  return [min(xs), min(ys), max(xs), max(ys)];
}

function updateGrid(map: MapLibre) {
  const bounds = map.getBounds();
  const width = (bounds.getEast() - bounds.getWest()) * 111_320 * Math.cos((bounds.getCenter().lat * Math.PI) / 180);
  const isLocal = width < 50_000;
  const step = isLocal ? gridSpacing(width, 7) : null;
  spacing.value = step;
  const lines =
    step === null ? [] : gridLines(bounds.getWest(), bounds.getSouth(), bounds.getEast(), bounds.getNorth(), step);
  map.getSource<GeoJSONSource>("grid")?.setData(collection([feature({ type: "MultiLineString", coordinates: lines })]));
}

async function addLand(map: MapLibre) {
  const [{ feature: fromTopology }, response] = await Promise.all([import("topojson-client"), fetch(atlasUrl)]);
  const topology = (await response.json()) as Topology<{ countries: GeometryCollection }>;
  const land: FeatureCollection = fromTopology(topology, topology.objects.countries);
  map.getSource<GeoJSONSource>("land")?.setData(land);
}

/** Lays the frame on its footprint. */
function updateDrape(map: MapLibre, footprint: Position[] | null) {
  const isShown = isDraped.value && footprint !== null && frameCanvas.width > 1;
  if (!isShown) {
    if (map.getLayer("drape")) map.setLayoutProperty("drape", "visibility", "none");
    return;
  }
  drape.getContext("2d")?.drawImage(frameCanvas, 0, 0, drape.width, drape.height);
  const coordinates = footprint as [Position, Position, Position, Position];
  const source = map.getSource<CanvasSource>("drape");
  if (!source) {
    map.addSource("drape", { type: "canvas", canvas: drape, coordinates, animate: false });
    map.addLayer(
      { id: "drape", type: "raster", source: "drape", paint: { "raster-opacity": 0.9, "raster-fade-duration": 0 } },
      "path",
    );
    return;
  }
  map.setLayoutProperty("drape", "visibility", "visible");
  source.setCoordinates(coordinates);
  source.play();
  source.pause();
}

function useMap() {
  const container = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let map: MapLibre | null = null;
    let isGone = false;
    const stops: (() => void)[] = [];
    const start = async () => {
      const { default: maplibre } = await import("maplibre-gl");
      if (isGone || !container.current) return;
      const shown = new maplibre.Map({
        container: container.current,
        style: makeStyle(tileAddress()),
        attributionControl: false,
        center: [10, 30],
        zoom: 0.5,
        maxZoom: 23,
        maxPitch: 0,
        fadeDuration: 0,
        renderWorldCopies: false,
      });
      map = shown;
      shown.addControl(new maplibre.NavigationControl({ showCompass: false }), "top-right");
      shown.addControl(new maplibre.ScaleControl({ unit: "metric" }), "bottom-left");
      shown.on("load", () => {
        addImages(shown);
        stops.push(...connect(shown));
        isReady.value = true;
        addLand(shown).catch(() => notices.notify("The base map could not be loaded.", "error"));
      });
    };
    start().catch((error: unknown) => {
      failure.value = `The map needs WebGL, which this browser does not offer (${messageOf(error)}).`;
    });
    return () => {
      isGone = true;
      for (const stop of stops) stop();
      map?.remove();
    };
  }, []);
  return container;
}

// Connects the map's layers with the state, both ways.
function connect(map: MapLibre): (() => void)[] {
  const shown = new Map<string, FeatureCollection>();
  const setData = (source: string, data: FeatureCollection) => {
    // Each change draws the whole map again: not for a source that stays empty while a video plays.
    if (data === EMPTY && (shown.get(source) ?? EMPTY) === EMPTY) return;
    shown.set(source, data);
    map.getSource<GeoJSONSource>(source)?.setData(data);
  };
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : 150;
  let fittedVideo: number | null = null;
  let shownTiles = tileAddress();
  let tileTimer: ReturnType<typeof setTimeout> | undefined;

  map.on("error", ({ error }: { error: Error & { status?: number } }) => {
    // A tile for which the session had ended is asked for again after the log-in (state.ts).
    if (error.status !== 401) console.error(error);
  });
  map.on("moveend", () => updateGrid(map));
  updateGrid(map);
  let isHoverDue = false;
  map.on("mousemove", (event) => {
    pointer.value = [event.lngLat.lng, event.lngLat.lat];
    if (isHoverDue) return;
    isHoverDue = true;
    // Once a picture at most: what lies under the pointer is looked for in all tiles.
    requestAnimationFrame(() => {
      isHoverDue = false;
      if (map.isMoving()) return;
      const isOver = map.queryRenderedFeatures(event.point, { layers: OBJECT_LAYERS }).length > 0;
      map.getCanvas().style.cursor = isOver ? "pointer" : "crosshair";
    });
  });
  map.on("mouseout", () => (pointer.value = null));
  map.on("click", (event) => {
    const { x, y } = event.point;
    const near: [[number, number], [number, number]] = [[x - 4, y - 4], [x + 4, y + 4]];
    const found = map.queryRenderedFeatures(near, { layers: OBJECT_LAYERS })[0];
    if (found?.layer.id === "clusters" && found.geometry.type === "Point") {
      return map.easeTo({ center: found.geometry.coordinates as Position, zoom: map.getZoom() + 2, duration: calm });
    }
    const id = Number(found?.properties["id"]);
    if (found && Number.isInteger(id)) return selection.select(id, { push: true });
    const path = state.cameraPath.value;
    const video = state.videoId.value;
    const time = path && whenSeen(path, [event.lngLat.lng, event.lngLat.lat]);
    if (video !== null && time !== null) return selection.showTime(video, time);
    if (path?.points.some((point) => point.footprint)) notices.notify("The camera did not show this place.");
  });

  return [
    effect(() => {
      setData("chosen", chosenFeatures(state.selected.value));
    }),
    effect(() => {
      // Other tiles when the filters change, not for each letter that is typed.
      const address = tileAddress();
      if (address === shownTiles) return;
      clearTimeout(tileTimer);
      tileTimer = setTimeout(() => {
        shownTiles = address;
        map.getSource<VectorTileSource>("objects")?.setTiles([address]);
      }, 200);
    }),
    effect(() => {
      const written = lastReview.value;
      if (!written) return;
      map.setFeatureState({ source: "objects", sourceLayer: "objects", id: written.id }, { verdict: written.review?.verdict ?? "" });
    }),
    effect(() => {
      const path = state.cameraPath.value;
      const points = path?.points ?? [];
      const footprints = points.flatMap((one) => (one.footprint ? [feature(polygon(one.footprint as Position[]))] : []));
      setData("coverage", collection(footprints));
      // Many frames lie on each other: the sum of all should stay faint.
      if (footprints.length > 0) map.setPaintProperty("coverage", "fill-opacity", Math.max(0.006, Math.min(0.08, 1.2 / footprints.length)));
      const line = points.map((one) => one.position as Position);
      setData("path", line.length > 1 ? collection([feature({ type: "LineString", coordinates: line })]) : EMPTY);
      const bounds = boundsOf(path);
      const video = state.videoId.value;
      if (bounds && path && video !== fittedVideo) {
        fittedVideo = video;
        map.fitBounds(bounds, { padding: 40, maxZoom: 20, duration: 0 });
      }
    }),
    effect(() => {
      void pictureVersion.value;
      const path = state.cameraPath.value;
      const time = state.shownTime.value;
      const camera = path && time !== null ? cameraAt(path, time) : null;
      const isKnown = camera !== null;
      setData("camera", isKnown ? collection([feature({ type: "Point", coordinates: camera.position }, { yaw: camera.yaw ?? 0 })]) : EMPTY);
      setData("footprint", camera?.footprint ? collection([feature(polygon(camera.footprint))]) : EMPTY);
      updateDrape(map, camera?.footprint ?? null);
      if (isFollowing.value && camera) map.jumpTo({ center: camera.position });
    }),
    effect(() => {
      const place = state.selected.value?.place;
      if (!place) return;
      const position: Position = [place.longitude_deg, place.latitude_deg];
      if (!map.getBounds().contains(position)) map.easeTo({ center: position, duration: calm });
    }),
    effect(() => {
      // Other colours: another style with the same data.
      void state.colours.value;
      const style = makeStyle("");
      for (const layer of style.layers) {
        for (const [name, value] of Object.entries(layer.paint ?? {})) {
          if (layer.id !== "coverage") map.setPaintProperty(layer.id, name, value);
        }
        if (layer.id === "names") map.setLayoutProperty("names", "icon-image", (layer.layout as { "icon-image": string })["icon-image"]);
      }
      for (const id of map.listImages()) {
        if (id.startsWith("name:")) map.updateImage(id, nameImage(id.slice(5)));
        if (id.startsWith("count:")) map.updateImage(id, countImage(id.slice(6)));
      }
    }),
    effect(() => {
      const show = () => {
        const bounds = boundsOf(state.cameraPath.peek());
        if (bounds) map.fitBounds(bounds, { padding: 40, maxZoom: 20, duration: calm });
      };
      if (fitRequest.value > 0) show();
    }),
  ];
}

const fitRequest = signal(0);

function Nowhere() {
  const path = state.cameraPath.value;
  const hasPlaces = state.project.value.state === "ready" && state.project.value.value.bounds !== null;
  if (path === null || path.source !== null || hasPlaces) return null;
  return (
    <div class="empty">
      <h3>No places</h3>
      <p>
        A map needs the camera's position: KLV in the video, a DJI <code style={{ display: "inline", padding: "0 4px" }}>.SRT</code> beside
        it, or a table:
      </p>
      <code>victorious index VIDEO --telemetry FILE.csv --models DIR --db FILE</code>
    </div>
  );
}

export function MapPane() {
  const container = useMap();
  const at = pointer.value;
  const toggle = (text: string, title: string, value: typeof isDraped) => (
    <button class="button" aria-pressed={value.value} title={title} onClick={() => (value.value = !value.value)}>
      {text}
    </button>
  );
  const path = state.cameraPath.value;
  return (
    <section class="map" aria-label="Map">
      <div class="canvas" ref={container} data-ready={isReady.value} />
      <div class="tools">
        {toggle("Frame", "Lay the frame on the ground that it shows", isDraped)}
        {toggle("Follow", "Keep the camera in the middle", isFollowing)}
        <button class="button" title="Show the whole flight" onClick={() => fitRequest.value++}>
          All
        </button>
      </div>
      <div class="panel">
        {path?.reason && path.source !== null && (
          <div class="readout" title={path.reason}>
            <Icon name="help" /> {path.source === "sightings" ? "camera path from sightings only" : "ground shown is unknown"}
          </div>
        )}
        <div class="readout">
          {at ? formatPosition(at[1], at[0], state.coordinateStyle.value) : "North up"}
          {spacing.value !== null && ` · grid ${formatMetres(spacing.value).replace(/\.0 m$/, " m")}`}
        </div>
      </div>
      {failure.value && (
        <div class="empty" role="alert">
          {failure.value}
        </div>
      )}
      <Nowhere />
    </section>
  );
}
