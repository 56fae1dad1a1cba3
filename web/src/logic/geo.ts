// Geometry on the map: ellipses, footprints, the grid.
import type { CameraPath, Place } from "../api/types";

export type Position = [longitude: number, latitude: number];

const METRES_PER_DEGREE = 111_320;

/** The point that lies east and north of a position, m; flat within some kilometres. */
export function offset([longitude, latitude]: Position, east: number, north: number): Position {
  const shrink = Math.max(Math.cos((latitude * Math.PI) / 180), 1e-6);
  return [longitude + east / (METRES_PER_DEGREE * shrink), latitude + north / METRES_PER_DEGREE];
}

/** The border of the 90 % ellipse, closed; null if it is unknown. */
export function ellipseRing(place: Place, corners = 48): Position[] | null {
  const { semi_major_m: major, semi_minor_m: minor, azimuth_deg: azimuth } = place.ellipse;
  if (major === null || minor === null || azimuth === null) return null;
  const turn = (azimuth * Math.PI) / 180;
  return Array.from({ length: corners + 1 }, (_, i) => {
    const angle = (2 * Math.PI * (i % corners)) / corners;
    const along = major * Math.cos(angle);
    const across = minor * Math.sin(angle);
    return offset(
      [place.longitude_deg, place.latitude_deg],
      along * Math.sin(turn) + across * Math.cos(turn),
      along * Math.cos(turn) - across * Math.sin(turn),
    );
  });
}

/** A circle on the ground, closed; m. */
export const circleRing = (centre: Position, radius: number, corners = 64): Position[] =>
  Array.from({ length: corners + 1 }, (_, i) => {
    const angle = (2 * Math.PI * (i % corners)) / corners;
    return offset(centre, radius * Math.sin(angle), radius * Math.cos(angle));
  });

export interface CameraMoment {
  position: Position;
  yaw: number | null;
  footprint: Position[] | null;
}

const mix = (a: number, b: number, t: number) => a + (b - a) * t;
const mixPosition = (a: number[], b: number[], t: number): Position => [
  mix(a[0] ?? 0, b[0] ?? 0, t),
  mix(a[1] ?? 0, b[1] ?? 0, t),
];

/** The camera at a time, between the points of its path; null beyond its ends and in gaps. */
export function cameraAt(path: CameraPath, time: number, maxGap = 2): CameraMoment | null {
  const points = path.points;
  let low = 0;
  let high = points.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((points[middle]?.time_s ?? Infinity) <= time) low = middle;
    else high = middle - 1;
  }
  const before = points[low];
  if (before === undefined) return null;
  const after = points[low + 1];
  const here = (point: typeof before): CameraMoment => ({
    position: point.position as Position,
    yaw: point.yaw_deg,
    footprint: (point.footprint as Position[] | null) ?? null,
  });
  const span = after === undefined ? 0 : after.time_s - before.time_s;
  if (after === undefined || time <= before.time_s || span > maxGap) {
    return Math.abs(time - before.time_s) <= maxGap ? here(before) : null;
  }
  const t = (time - before.time_s) / span;
  const turn = before.yaw_deg === null || after.yaw_deg === null ? null : ((after.yaw_deg - before.yaw_deg + 540) % 360) - 180;
  return {
    position: mixPosition(before.position, after.position, t),
    yaw: turn === null || before.yaw_deg === null ? null : before.yaw_deg + turn * t,
    footprint:
      before.footprint && after.footprint
        ? before.footprint.map((corner, i) => mixPosition(corner, after.footprint?.[i] ?? corner, t))
        : null,
  };
}

export function contains(ring: readonly Position[], [x, y]: Position): boolean {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi] = ring[i] as Position;
    const [xj, yj] = ring[j] as Position;
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

/** The time at which a place is nearest to the middle of the frame; null if no frame shows it. */
export function whenSeen(path: CameraPath, place: Position): number | null {
  let best: { time: number; distance: number } | null = null;
  for (const point of path.points) {
    const ring = point.footprint as Position[] | null;
    if (ring === null || !contains(ring, place)) continue;
    const x = ring.reduce((sum, corner) => sum + corner[0], 0) / ring.length;
    const y = ring.reduce((sum, corner) => sum + corner[1], 0) / ring.length;
    const distance = Math.hypot((x - place[0]) * Math.cos((y * Math.PI) / 180), y - place[1]);
    if (best === null || distance < best.distance) best = { time: point.time_s, distance };
  }
  return best?.time ?? null;
}

/** The spacing of a grid with about `lines` lines over a width, m: 1, 2 or 5 times a power of ten. */
export function gridSpacing(width: number, lines: number): number {
  const raw = width / Math.max(lines, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((one) => one * power >= raw) ?? 10;
  return step * power;
}

/** Lines of a metric grid over a region, aligned to its south-west corner's multiples of the spacing. */
export function gridLines(west: number, south: number, east: number, north: number, spacing: number): Position[][] {
  const middle = (south + north) / 2;
  const stepNorth = spacing / METRES_PER_DEGREE;
  const stepEast = stepNorth / Math.max(Math.cos((middle * Math.PI) / 180), 1e-6);
  const lines: Position[][] = [];
  if ((east - west) / stepEast > 200 || (north - south) / stepNorth > 200) return lines;
  for (let x = Math.ceil(west / stepEast) * stepEast; x <= east; x += stepEast) lines.push([[x, south], [x, north]]);
  for (let y = Math.ceil(south / stepNorth) * stepNorth; y <= north; y += stepNorth) lines.push([[west, y], [east, y]]);
  return lines;
}
