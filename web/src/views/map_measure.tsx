// Measuring on the map: distances along a line and the area that it encloses, by clicks or by positions.
import { effect, signal } from "@preact/signals";
import type { FeatureCollection } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { useLayoutEffect, useRef, useState } from "preact/hooks";

import { MAX_CORNERS, readCorners } from "../logic/area";
import { formatAngle } from "../logic/format";
import type { Position } from "../logic/geo";
import { areaOf, bearing, formatDistance, formatSquare, lengthOf } from "../logic/measure";
import * as state from "../state";
import { Icon } from "./icons";
import { EMPTY, collection, feature, polygon } from "./map_style";

const line = signal<readonly Position[]>([]);

export function toggleMeasuring() {
  state.isMeasuring.value = !state.isMeasuring.value;
  if (state.isMeasuring.value) state.isDrawingArea.value = false;
}

export function connectMeasure(map: MapLibre, setData: (source: string, data: FeatureCollection) => void): (() => void)[] {
  map.on("click", (event) => {
    if (state.isMeasuring.value && line.value.length < MAX_CORNERS) line.value = [...line.value, [event.lngLat.lng, event.lngLat.lat]];
  });
  const keys = (event: KeyboardEvent) => {
    if (!state.isMeasuring.value || event.key !== "Backspace" || event.target instanceof HTMLInputElement) return;
    line.value = line.value.slice(0, -1);
    event.preventDefault();
  };
  window.addEventListener("keydown", keys);
  return [
    () => window.removeEventListener("keydown", keys),
    effect(() => {
      if (state.isDrawingArea.value) state.isMeasuring.value = false;
    }),
    effect(() => {
      if (!state.isMeasuring.value) line.value = [];
    }),
    effect(() => {
      const corners = [...line.value];
      if (corners.length === 0) return setData("measure", EMPTY);
      const points = corners.map((one) => feature({ type: "Point", coordinates: one }));
      const way = corners.length > 1 ? [feature({ type: "LineString", coordinates: corners })] : [];
      setData("measure", collection([...(corners.length > 2 ? [feature(polygon(corners))] : []), ...way, ...points]));
    }),
  ];
}

/** What is measured, and positions for those who have no mouse or know them. */
export function MeasurePanel() {
  const isMeasuring = state.isMeasuring.value;
  const [text, setText] = useState("");
  const field = useRef<HTMLInputElement>(null);
  // At once: an effect after the next frame would clear what is typed until then.
  useLayoutEffect(() => {
    setText("");
    if (isMeasuring) field.current?.focus({ preventScroll: true });
  }, [isMeasuring]);
  if (!isMeasuring) return null;
  const corners = line.value;
  const [before, last] = [corners.at(-2), corners.at(-1)];
  const typed = readCorners(text);
  return (
    <form
      class="area measure"
      aria-label="Measure"
      onSubmit={(event) => {
        event.preventDefault();
        if (typed && typed.length > 0) line.value = [...corners, ...typed].slice(0, MAX_CORNERS);
        setText("");
      }}
      onKeyDown={(event) => {
        if (event.key !== "Escape") return;
        event.preventDefault();
        toggleMeasuring();
      }}
    >
      <div class="measured" role="status">
        {before && last ? (
          <>
            <strong>{formatDistance(lengthOf(corners))}</strong>
            <span>
              last {formatDistance(lengthOf([before, last]))}, {formatAngle(bearing(before, last))}
            </span>
            {corners.length > 2 && (
              <span>
                area <strong>{formatSquare(areaOf(corners))}</strong>, around it {formatDistance(lengthOf(corners, true))}
              </span>
            )}
          </>
        ) : (
          <span>Click from place to place; Backspace takes the last one back</span>
        )}
      </div>
      <label class="hidden" for="measure-positions">
        Positions as the page copies them
      </label>
      <div class="corners">
        <input
          id="measure-positions"
          ref={field}
          class="field"
          autocomplete="off"
          spellcheck={false}
          placeholder="or 52.51,13.37 52.52,13.39"
          title="Positions as the page copies them: degrees, MGRS or UTM"
          aria-invalid={text.trim() !== "" && typed === null}
          value={text}
          onInput={(event) => setText(event.currentTarget.value)}
        />
        <button class="button" type="submit" disabled={typed === null || typed.length === 0}>
          Add
        </button>
        <button class="button" type="button" disabled={corners.length === 0} onClick={() => (line.value = [])}>
          New
        </button>
        <button class="button icon plain" type="button" aria-label="Close" title="Close (Esc)" onClick={toggleMeasuring}>
          <Icon name="close" />
        </button>
      </div>
    </form>
  );
}
