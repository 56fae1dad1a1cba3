// The lines on the map that have a time: the camera's path, and tracks. Hovering shows the time, a click goes there.
import type { Feature } from "geojson";
import type { Map as MapLibre, PointLike } from "maplibre-gl";

import { formatTime } from "../logic/format";
import type { Position } from "../logic/geo";
import { placeAt, timeOnLine } from "../logic/ground_track";
import * as state from "../state";
import { tracks } from "../tracks";
import { feature } from "./map_style";

/** px from the pointer */
const REACH = 6;

export interface LineMoment {
  time: number;
  /** What was there then. */
  text: string;
  object: number | null;
}

export function trackFeatures(): Feature[] {
  return tracks.value.flatMap((track) =>
    track.pieces
      .filter((piece) => piece.length > 1)
      .map((piece) =>
        feature(
          { type: "LineString", coordinates: piece.map((one) => one.position) },
          { key: track.key, colour: track.colour, chosen: track.object === state.selectedId.value },
        ),
      ),
  );
}

/** Where each track is at the time that is shown. */
export function nowFeatures(): Feature[] {
  const time = state.shownTime.value;
  if (time === null) return [];
  return tracks.value.flatMap((track) => {
    const place = placeAt(track.pieces, time);
    return place ? [feature({ type: "Point", coordinates: place }, { colour: track.colour })] : [];
  });
}

/** The line under the pointer and the time of its nearest point; null: there is none. */
export function lineAt(map: MapLibre, x: number, y: number): LineMoment | null {
  const around: [PointLike, PointLike] = [[x - REACH, y - REACH], [x + REACH, y + REACH]];
  const found = map.queryRenderedFeatures(around, { layers: ["tracks", "path"] })[0];
  if (!found) return null;
  const onScreen = (points: readonly { time: number; position: Position }[]) =>
    points.map(({ time, position }) => {
      const { x, y } = map.project(position);
      return { time, x, y };
    });
  if (found.layer.id === "path") {
    const points = (state.cameraPath.peek()?.points ?? []).map((one) => ({ time: one.time_s, position: one.position as Position }));
    const at = timeOnLine(onScreen(points), x, y);
    return at && { time: at.time, text: `camera at ${formatTime(at.time)}`, object: null };
  }
  const track = tracks.peek().find((one) => one.key === found.properties["key"]);
  if (!track) return null;
  // The pieces are separate lines: the nearest point of all counts.
  const times = track.pieces.flatMap((piece) => timeOnLine(onScreen(piece), x, y) ?? []);
  const at = times.reduce<(typeof times)[number] | null>((best, one) => (best === null || one.distance < best.distance ? one : best), null);
  return at && { time: at.time, text: `${track.name} at ${formatTime(at.time)}`, object: track.object };
}
