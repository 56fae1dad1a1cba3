// Drawing an area on the map, by mouse or by coordinates: corners by clicks, or a rectangle by dragging.
import { computed, effect, signal } from "@preact/signals";
import type { FeatureCollection } from "geojson";
import type { Map as MapLibre, MapMouseEvent } from "maplibre-gl";
import { useLayoutEffect, useRef, useState } from "preact/hooks";

import { type Area, MAX_CORNERS, formatArea, isArea, nearestCorner, onOneGlobe, parseArea, rectangle } from "../logic/area";
import { parseQuery } from "../logic/filters";
import { type Position, circleRing } from "../logic/geo";
import * as state from "../state";
import { Icon } from "./icons";
import { EMPTY, collection, feature, polygon } from "./map_style";

/** Corners of the area that is being drawn. */
const draft = signal<Area>([]);
/** px */
const NEAR = 8;
/** What the search field asks for. */
const searchedCircle = computed(() => parseQuery(state.filters.value.text).near);
/** Not for each digit that is typed. */
const SHOW_CIRCLE_MS = 500;

const distance = (a: { x: number; y: number }, b: { x: number; y: number }) => Math.hypot(a.x - b.x, a.y - b.y);

export function toggleDrawing() {
  state.isDrawingArea.value = !state.isDrawingArea.value;
}

function finish(area: Area) {
  if (isArea(area)) state.setFilters({ area: onOneGlobe(area) });
  state.isDrawingArea.value = false;
}

/** Listens to the mouse while an area is drawn. */
export function connectArea(map: MapLibre, setData: (source: string, data: FeatureCollection) => void): (() => void)[] {
  let pressed: { at: { x: number; y: number }; position: Position } | null = null;
  let isDragged = false;
  const positionOf = (event: MapMouseEvent): Position => [event.lngLat.lng, event.lngLat.lat];

  map.on("mousedown", (event) => {
    if (!state.isDrawingArea.value || event.originalEvent.button !== 0) return;
    event.preventDefault(); // the map stays where it is
    pressed = { at: event.point, position: positionOf(event) };
    isDragged = false;
  });
  map.on("mousemove", (event) => {
    if (!pressed || draft.value.length > (isDragged ? 4 : 0)) return;
    isDragged ||= distance(pressed.at, event.point) > NEAR;
    if (isDragged) draft.value = rectangle(pressed.position, nearestCorner(pressed.position, positionOf(event)));
  });
  // Also where the mouse has left the map.
  const release = () => {
    if (!pressed || !isDragged) return;
    pressed = null;
    finish(draft.value);
  };
  window.addEventListener("mouseup", release);
  map.on("mouseup", (event) => {
    if (!pressed || isDragged) return;
    pressed = null;
    const [first, last] = [draft.value[0], draft.value.at(-1)];
    const isOn = (corner: Position | undefined) => corner !== undefined && distance(map.project(corner), event.point) < NEAR;
    // On the first corner, or twice at one place: that was the last one.
    if (draft.value.length >= 3 && (isOn(first) || isOn(last))) return finish(draft.value);
    if (!isOn(last) && draft.value.length < MAX_CORNERS) draft.value = [...draft.value, nearestCorner(first, positionOf(event))];
  });
  const keys = (event: KeyboardEvent) => {
    if (!state.isDrawingArea.value || event.target instanceof HTMLInputElement) return;
    if (event.key === "Enter" && isArea(draft.value)) finish(draft.value);
    else if (event.key === "Backspace") draft.value = draft.value.slice(0, -1);
    else return;
    event.preventDefault();
  };
  window.addEventListener("keydown", keys);
  return [
    () => {
      window.removeEventListener("keydown", keys);
      window.removeEventListener("mouseup", release);
    },
    effect(() => {
      if (state.isDrawingArea.value || state.isMeasuring.value) map.doubleClickZoom.disable();
      else map.doubleClickZoom.enable();
      draft.value = [];
      pressed = null;
    }),
    effect(() => {
      const near = searchedCircle.value;
      if (near === null) return;
      const timer = setTimeout(() => {
        const ring = circleRing([near.longitude, near.latitude], near.metres, 4);
        const [north, east, south, west] = ring;
        if (!north || !east || !south || !west || map.getBounds().contains([near.longitude, near.latitude])) return;
        map.fitBounds([[west[0], south[1]], [east[0], north[1]]], { padding: 40, maxZoom: 18, duration: 0 });
      }, SHOW_CIRCLE_MS);
      return () => clearTimeout(timer);
    }),
    effect(() => {
      const isDrawing = state.isDrawingArea.value;
      const area = isDrawing ? draft.value : (state.filters.value.area ?? []);
      const near = isDrawing ? null : searchedCircle.value;
      const circle = near ? [feature(polygon(circleRing([near.longitude, near.latitude], near.metres)))] : [];
      if (area.length === 0) return setData("area", circle.length > 0 ? collection(circle) : EMPTY);
      const corners = area.map((one) => feature({ type: "Point", coordinates: one }));
      const shape = area.length > 2 ? polygon([...area]) : { type: "LineString" as const, coordinates: [...area] };
      setData("area", collection(isDrawing ? [feature(shape), ...corners] : [feature(shape), ...circle]));
    }),
  ];
}

/** What to do, and the coordinates, for those who have no mouse or know them. */
export function AreaPanel() {
  const isDrawing = state.isDrawingArea.value;
  const area = state.filters.value.area;
  const [text, setText] = useState("");
  const field = useRef<HTMLInputElement>(null);
  // At once: an effect after the next frame would overwrite what is typed until then.
  useLayoutEffect(() => {
    setText(area ? formatArea(area) : "");
    // Zoomed, the map may stand far below what is shown.
    field.current?.closest(".map")?.scrollIntoView({ block: "nearest" });
    field.current?.focus({ preventScroll: true });
  }, [isDrawing]);
  if (!isDrawing) return null;
  const typed = parseArea(text);
  const isWrong = text.trim() !== "" && typed === null;
  return (
    <form
      class="area"
      aria-label="Area"
      onSubmit={(event) => {
        event.preventDefault();
        finish(draft.value.length >= 3 ? draft.value : (typed ?? []));
      }}
      onKeyDown={(event) => {
        if (event.key !== "Escape") return;
        event.preventDefault();
        toggleDrawing();
      }}
    >
      <span>Drag a rectangle, or click corners (the last twice)</span>
      <label class="hidden" for="area-corners">
        Corners as latitude and longitude, MGRS or UTM; two make a rectangle
      </label>
      <div class="corners">
        <input
          id="area-corners"
          ref={field}
          class="field"
          autocomplete="off"
          spellcheck={false}
          placeholder="or 52.51,13.37 52.52,13.39"
          title="Corners as the page copies them: degrees, MGRS or UTM; two make a rectangle"
          aria-invalid={isWrong}
          value={text}
          onInput={(event) => setText(event.currentTarget.value)}
        />
        <button class="button primary" type="submit" disabled={!isArea(draft.value) && typed === null}>
          Use
        </button>
        <button class="button icon plain" type="button" aria-label="Cancel" title="Cancel (Esc)" onClick={toggleDrawing}>
          <Icon name="close" />
        </button>
      </div>
    </form>
  );
}
