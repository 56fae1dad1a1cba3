// The map: objects with their 90 % ellipses, the camera's path, what it shows of the ground now and what it has shown.
// It needs no internet: land from world-atlas, a metric grid, and the frame itself laid on the ground.
import "maplibre-gl/dist/maplibre-gl.css";

import { effect, signal, untracked } from "@preact/signals";
import type { FeatureCollection } from "geojson";
import type { GeometryCollection, Topology } from "topojson-specification";
import type { CanvasSource, GeoJSONSource, LngLatBoundsLike, Map as MapLibre, VectorTileSource } from "maplibre-gl";
import { useEffect, useRef } from "preact/hooks";
import atlasUrl from "world-atlas/countries-50m.json?url";

import { tilesUrl } from "../api/client";
import type { CameraPath, FoundObject, Project } from "../api/types";
import { askToSearchAgain, canAdd } from "../jobs";
import { forReaders, messageOf } from "../logic/errors";
import { filterParams } from "../logic/filters";
import { baseName, formatMetres, formatPosition, formatTime } from "../logic/format";
import { drawNorthAndScale, scaleBar } from "../logic/map_picture";
import { type Position, cameraAt, ellipseRing, gridLines, gridSpacing } from "../logic/geo";
import { unwrapLand } from "../logic/land";
import { me } from "../me";
import { lastReview, objectOf, videoObjects } from "../objects";
import { seenAt, showPlace } from "../places";
import { frameCanvas, pictureVersion } from "../player";
import { setMapPicture } from "../print";
import * as notices from "../notices";
import * as searched from "../searched";
import * as selection from "../selection";
import * as state from "../state";
import { type BaseMap, loadBaseMap } from "./base_map";
import { Icon } from "./icons";
import { AreaPanel, connectArea, toggleDrawing } from "./map_area";
import { type LineMoment, lineAt, nowFeatures, trackFeatures } from "./map_lines";
import { MeasurePanel, connectMeasure, toggleMeasuring } from "./map_measure";
import { EMPTY, OBJECT_LAYERS, addImages, collection, countImage, feature, makeStyle, nameImage, polygon } from "./map_style";

const isDraped = signal(true);
const isFollowing = signal(false);
const isReady = signal(false);
const pointer = signal<Position | null>(null);
const spacing = signal<number | null>(null);
/** What lies under the pointer of the lines that have a time. */
const hover = signal<(LineMoment & { x: number; y: number }) | null>(null);
const failure = signal<string | null>(null);
const baseMap = signal<BaseMap | null>(null);

/** The base map that the server has, once the server has said so. */
function describedBaseMap(): Promise<Project["base_map"]> {
  return new Promise((resolve) => {
    const stop = effect(() => {
      const project = state.project.value;
      if (project.state !== "ready") return;
      resolve(project.value.base_map);
      queueMicrotask(() => stop());
    });
  });
}

// The picture that is laid on the ground; small, because the map only hints at it.
const drape = document.createElement("canvas");
drape.width = 512;
drape.height = 384;

const tileAddress = () => {
  const params = filterParams(state.filters.value, me.value);
  if (state.indexVersion.value > 0) params.set("v", String(state.indexVersion.value));
  return tilesUrl(params);
};

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
  // What the camera saw is known by its objects alone.
  if (!path?.points.some((point) => point.footprint)) {
    for (const id of videoObjects.peek()?.ids ?? []) {
      const place = objectOf(id)?.place;
      if (place) all.push([place.longitude_deg, place.latitude_deg]);
    }
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

/** px at the edges of the map that are left free: its controls stand there. A small map has no room for that. */
function besideControls(map: MapLibre) {
  const { clientWidth: width, clientHeight: height } = map.getContainer();
  return { top: Math.min(52, height / 5), bottom: Math.min(64, height / 5), left: Math.min(28, width / 10), right: Math.min(90, width / 4) };
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
  map.getSource<GeoJSONSource>("land")?.setData(unwrapLand(land));
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
      const [{ default: maplibre }, described] = await Promise.all([import("maplibre-gl"), describedBaseMap()]);
      if (described) {
        try {
          baseMap.value = await loadBaseMap(described, maplibre.addProtocol);
        } catch (error) {
          notices.notify(`The base map cannot be shown: ${messageOf(error)}`, "error");
        }
      }
      if (isGone || !container.current) return;
      const shown = new maplibre.Map({
        container: container.current,
        style: makeStyle(tileAddress(), baseMap.value),
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
      // Before the first tile, whose symbols ask for them.
      shown.on("style.load", () => addImages(shown));
      shown.on("load", () => {
        stops.push(...connect(shown));
        isReady.value = true;
        addLand(shown).catch(() => notices.notify("The base map could not be loaded.", "error"));
      });
    };
    start().catch((error: unknown) => {
      // MapLibre says it as JSON.
      const why = /"statusMessage":"([^"]+)"/.exec(messageOf(error))?.[1];
      failure.value = `The map needs WebGL, which this browser does not offer${why ? `: ${why}` : ""}.`;
    });
    return () => {
      isGone = true;
      for (const stop of stops) stop();
      map?.remove();
    };
  }, []);
  return container;
}

/** Other colours: another style with the same data. */
function paint(map: MapLibre) {
  const style = makeStyle("", baseMap.peek());
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
}

/** As it is now, in the colours of the light, with north and scale. The colours of the page are set back at once. */
function pictureOf(map: MapLibre): string | null {
  const { dataset } = document.documentElement;
  const theme = dataset["theme"];
  const picture = document.createElement("canvas");
  const context = picture.getContext("2d");
  if (!context) return null;
  try {
    dataset["theme"] = "light";
    untracked(() => paint(map));
    map.redraw();
    const drawn = map.getCanvas();
    [picture.width, picture.height] = [drawn.width, drawn.height];
    context.drawImage(drawn, 0, 0);
  } finally {
    if (theme === undefined) delete dataset["theme"];
    else dataset["theme"] = theme;
    untracked(() => paint(map));
  }
  // In the middle: of a map of half the world, the way between its edges is shorter than the map.
  const { clientWidth: width, clientHeight: height } = map.getContainer();
  const [x, y] = [width / 2, height / 2];
  const metres = (width / 100) * map.unproject([x - 50, y]).distanceTo(map.unproject([x + 50, y]));
  if (!(metres > 0)) return null;
  drawNorthAndScale(context, scaleBar(picture.width, metres), map.getBearing(), picture.width / width);
  return picture.toDataURL("image/jpeg", 0.92);
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

  let isBaseMissed = false;
  map.on("error", ({ error, sourceId }: { error: Error & { status?: number }; sourceId?: string }) => {
    if (sourceId === "base") {
      // A tile that the server does not have is no failure; any other is reported once.
      if (error.status !== 404 && !isBaseMissed) notices.notify(`The base map has gaps: ${messageOf(error)}`, "error");
      isBaseMissed ||= error.status !== 404;
      return;
    }
    // A tile for which the session had ended is asked for again after the log-in (load.ts).
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
      const { x, y } = event.point;
      const isOver = map.queryRenderedFeatures(event.point, { layers: OBJECT_LAYERS }).length > 0;
      const moment = isOver || state.isDrawingArea.value || state.isMeasuring.value ? null : lineAt(map, x, y);
      hover.value = moment && { ...moment, x, y };
      map.getCanvas().style.cursor = !state.isMeasuring.value && (isOver || moment) ? "pointer" : "crosshair";
    });
  });
  map.on("mouseout", () => (pointer.value = hover.value = null));
  // Before the click below: the click that ends an area selects nothing.
  let isForArea = false;
  map.on("mousedown", () => (isForArea = state.isDrawingArea.value || state.isMeasuring.value));
  map.on("click", (event) => {
    if (isForArea) return;
    const { x, y } = event.point;
    const near: [[number, number], [number, number]] = [[x - 4, y - 4], [x + 4, y + 4]];
    const found = map.queryRenderedFeatures(near, { layers: OBJECT_LAYERS })[0];
    if (found?.layer.id === "clusters" && found.geometry.type === "Point") {
      return map.easeTo({ center: found.geometry.coordinates as Position, zoom: map.getZoom() + 2, duration: calm });
    }
    const id = Number(found?.properties["id"]);
    if (found && Number.isInteger(id)) return selection.select(id, { push: true });
    const video = state.videoId.value;
    const moment = lineAt(map, x, y);
    if (moment && video !== null) {
      if (moment.object !== null) selection.select(moment.object, { seek: false, push: true });
      return selection.showTime(video, moment.time);
    }
    void showPlace([event.lngLat.lng, event.lngLat.lat]);
  });

  setMapPicture(() => pictureOf(map));
  return [
    () => setMapPicture(() => null),
    ...connectArea(map, setData),
    ...connectMeasure(map, setData),
    effect(() => {
      const lines = trackFeatures();
      setData("tracks", lines.length > 0 ? collection(lines) : EMPTY);
    }),
    effect(() => {
      const points = nowFeatures();
      setData("tracks-now", points.length > 0 ? collection(points) : EMPTY);
    }),
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
    }),
    effect(() => {
      const shown = searched.coverage.value;
      setData("searched", shown?.state === "ready" ? (shown.value as unknown as FeatureCollection) : EMPTY);
    }),
    effect(() => {
      const [path, video] = [state.cameraPath.value, state.videoId.value];
      if (!path || video === fittedVideo || videoObjects.value?.video !== video) return;
      const bounds = untracked(() => boundsOf(path));
      if (!bounds) return;
      fittedVideo = video;
      map.fitBounds(bounds, { padding: besideControls(map), maxZoom: 20, duration: 0 });
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
      void state.colours.value;
      paint(map);
    }),
    effect(() => {
      const show = () => {
        const bounds = boundsOf(state.cameraPath.peek());
        if (bounds) map.fitBounds(bounds, { padding: besideControls(map), maxZoom: 20, duration: calm });
      };
      if (fitRequest.value > 0) show();
    }),
  ];
}

const fitRequest = signal(0);

const hasPlaces = () => state.project.value.state === "ready" && state.project.value.value.bounds !== null;

/** When and by which video the ground under the pointer was shown. */
function Seen() {
  const at = pointer.value;
  const seen = at && seenAt(at);
  if (!seen) return null;
  return (
    <div class="readout seen">
      shown at {formatTime(seen.time)} by {baseName(state.videos.value.find((one) => one.id === seen.video)?.name ?? "")}
    </div>
  );
}

/** What part of the ground was searched well for the model that is chosen. */
function SearchedGround() {
  if (!searched.isShown.value) return null;
  const shown = searched.coverage.value;
  if (shown === null) return <div class="readout">filter by one model, or select an object, to see how well the ground was searched for it</div>;
  if (shown.state === "loading") return <div class="readout">searched ground …</div>;
  if (shown.state === "failed") return <div class="readout">searched ground: {forReaders(shown.message)}</div>;
  const { min_probability: least, models } = shown.value.coverage;
  return (
    <div class="readout">
      {models.map((one) => `${one.model}: ${Math.round(100 * one.searched_fraction)} % of the ground searched with ${least} or more`).join("; ")}
    </div>
  );
}

/** Telemetry that was forgotten, or came later. */
function AttachTelemetry() {
  const input = useRef<HTMLInputElement>(null);
  const video = state.video.value;
  if (!canAdd.value || video === null || video.missing !== null) return null;
  return (
    <>
      <button class="button attach" title="The video is searched again with it; reviews stay" onClick={() => input.current?.click()}>
        Attach its telemetry
      </button>
      <input
        ref={input}
        class="hidden"
        type="file"
        accept=".csv,.srt,.klv"
        tabIndex={-1}
        aria-label="Telemetry of the video"
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          if (file) askToSearchAgain(video, file);
          event.currentTarget.value = "";
        }}
      />
    </>
  );
}

function Nowhere() {
  const path = state.cameraPath.value;
  if (path === null || path.source !== null || hasPlaces()) return null;
  return (
    <div class="empty">
      <h3>No places</h3>
      <p>
        A map needs the camera's position: KLV in the video, or a file of telemetry (a DJI .SRT, or a table).
      </p>
      <AttachTelemetry />
    </div>
  );
}

export function MapPane() {
  const container = useMap();
  const at = pointer.value;
  const toggle = (text: string, title: string, value: typeof isDraped) => (
    <button class="button toggle" aria-pressed={value.value} title={title} onClick={() => (value.value = !value.value)}>
      <span class="tick-box">{value.value && <Icon name="accept" />}</span> {text}
    </button>
  );
  const path = state.cameraPath.value;
  return (
    <section class="map" aria-label="Where the objects are">
      <div class="on-map">
        <div class="canvas" ref={container} data-ready={isReady.value} />
        <div class="tools" role="group" aria-label="Map">
          {toggle("Frame", "Lay the frame on the ground that it shows", isDraped)}
          {toggle("Follow", "Keep the camera in the middle", isFollowing)}
          <button class="button" title="Show the whole flight" onClick={() => fitRequest.value++}>
            <Icon name="fit" /> All
          </button>
          <button class="button" aria-pressed={state.isDrawingArea.value} title="Draw an area to filter by it (D)" onClick={toggleDrawing}>
            <Icon name="area" /> Area
          </button>
          <button
            class="button icon"
            aria-pressed={state.isMeasuring.value}
            title="Measure distances and areas (R)"
            aria-label="Measure"
            onClick={toggleMeasuring}
          >
            <Icon name="measure" />
          </button>
          <button
            class="button icon"
            aria-pressed={searched.isShown.value}
            title="How probably an object of the chosen model would have been found there; lines around what is to be searched again"
            aria-label="Searched ground"
            onClick={() => (searched.isShown.value = !searched.isShown.value)}
          >
            <Icon name="coverage" />
          </button>
        </div>
        {baseMap.value && baseMap.value.attribution !== "" && <div class="attribution">{baseMap.value.attribution}</div>}
        {hover.value && (
          <div class="tip" style={{ left: `${hover.value.x}px`, top: `${hover.value.y}px` }}>
            {hover.value.text}
          </div>
        )}
        <div class="panel">
          {path?.reason && path.source !== null && (
            <div class="readout reason" title={forReaders(path.reason)}>
              <Icon name="help" /> <span>{path.source === "sightings" ? "camera path from sightings only" : "ground shown is unknown"}</span>
            </div>
          )}
          {path !== null && path.source === null && hasPlaces() && (
            <div class="readout reason" title="KLV in the video, a DJI .SRT beside it, or a table of telemetry would give its camera and its objects a place">
              <Icon name="help" /> <span>this video has no telemetry: no camera, no places</span> <AttachTelemetry />
            </div>
          )}
          <Seen />
          <SearchedGround />
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
      </div>
      <AreaPanel />
      <MeasurePanel />
    </section>
  );
}
