// Where an object was over time, on flat ground: its boxes are laid on the ground that the frame shows. And the time at
// a point of a line on the map.
import type { CameraPath, FoundObject } from "../api/types";
import { type Position, cameraAt } from "./geo";

export interface TrackPoint {
  /** s */
  time: number;
  position: Position;
}

/** Points that a line on the map may have. */
const MAX_POINTS = 500;
/** s; a longer time without a sighting ends a piece of the track. */
const MAX_GAP = 3;

/**
 * The place on the ground of a point of the frame (0 to 1 from the left top), by the plane projective map that takes the
 * frame's corners to those of the footprint, clockwise from the left top. Null: they have no area, or the point lies
 * beyond the horizon.
 */
export function onGround(footprint: readonly Position[], u: number, v: number): Position | null {
  const [a, b, c, d] = footprint;
  if (!a || !b || !c || !d) return null;
  // Heckbert's unit square to quadrilateral, relative to the first corner: degrees are large beside their differences.
  const [x1, y1, x2, y2, x3, y3] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1], d[0] - a[0], d[1] - a[1]];
  const [sx, sy] = [-x1 + x2 - x3, -y1 + y2 - y3];
  const [dx1, dy1, dx2, dy2] = [x1 - x2, y1 - y2, x3 - x2, y3 - y2];
  const area = dx1 * dy2 - dx2 * dy1;
  if (Math.abs(area) < 1e-18) return null;
  const g = (sx * dy2 - dx2 * sy) / area;
  const h = (dx1 * sy - sx * dy1) / area;
  const w = g * u + h * v + 1;
  if (w <= 0) return null;
  const x = ((x1 + g * x1) * u + (x3 + h * x3) * v) / w;
  const y = ((y1 + g * y1) * u + (y3 + h * y3) * v) / w;
  return [a[0] + x, a[1] + y];
}

/** Differs when an object was seen more, or less, in a video than before. */
export const momentsKey = (object: Pick<FoundObject, "moments">, video: number): string =>
  object.moments
    .filter((one) => one.video_id === video)
    .map((one) => `${one.id} ${one.first_time_s} ${one.last_time_s} ${one.frames}`)
    .join();

/** The middle of each box on the ground, by time; pieces where the object was lost in between. */
export function groundTrack(
  sightings: readonly { time_s: number; box: readonly number[] }[],
  path: CameraPath,
  frame: { width: number; height: number },
): TrackPoint[][] {
  const step = Math.max(1, Math.ceil(sightings.length / MAX_POINTS));
  const pieces: TrackPoint[][] = [];
  let before = -Infinity;
  sightings.forEach((one, i) => {
    if (i % step !== 0 && i !== sightings.length - 1) return;
    const footprint = cameraAt(path, one.time_s)?.footprint;
    const [left = 0, top = 0, width = 0, height = 0] = one.box;
    const position = footprint ? onGround(footprint, (left + width / 2) / frame.width, (top + height / 2) / frame.height) : null;
    if (position === null) return;
    const point = { time: one.time_s, position };
    if (one.time_s - before > MAX_GAP) pieces.push([point]);
    else pieces.at(-1)?.push(point);
    before = one.time_s;
  });
  return pieces;
}

/** Where it is at a time; null outside of all pieces. */
export function placeAt(pieces: readonly (readonly TrackPoint[])[], time: number): Position | null {
  for (const piece of pieces) {
    const [first, last] = [piece[0], piece.at(-1)];
    if (!first || !last || time < first.time || time > last.time) continue;
    const next = piece.findIndex((one) => one.time >= time);
    const [a, b] = [piece[Math.max(next - 1, 0)] ?? first, piece[next] ?? last];
    const part = b.time > a.time ? (time - a.time) / (b.time - a.time) : 0;
    return [a.position[0] + part * (b.position[0] - a.position[0]), a.position[1] + part * (b.position[1] - a.position[1])];
  }
  return null;
}

/** The time at the point of a line that is nearest to a pointer, all on the screen; null: the line has no point. */
export function timeOnLine(line: readonly { time: number; x: number; y: number }[], x: number, y: number) {
  let best: { time: number; distance: number } | null = null;
  line.forEach((b, i) => {
    const a = line[i - 1] ?? b;
    const [dx, dy] = [b.x - a.x, b.y - a.y];
    const length = dx * dx + dy * dy;
    const part = length > 0 ? Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / length, 0), 1) : 0;
    const distance = Math.hypot(a.x + part * dx - x, a.y + part * dy - y);
    if (best === null || distance < best.distance) best = { time: a.time + part * (b.time - a.time), distance };
  });
  return best as { time: number; distance: number } | null;
}
