// An area drawn on the map: a polygon whose edges are straight in latitude and longitude.
import { readPosition } from "./coordinates";
import type { Position } from "./geo";

/** Corners in order, without the first one again. */
export type Area = readonly Position[];

export const MAX_CORNERS = 100;

/**
 * Degrees of longitude from the first corner to another one, at most: farther, which way round an edge goes would be a
 * guess, and the server refuses it. A little less than its limit, as coordinates are rounded.
 */
const MAX_SPAN = 89.999;

const turn = (degrees: number) => degrees - 360 * Math.round(degrees / 360);

/** The rectangle between two opposite corners. */
export function rectangle([x1, y1]: Position, [x2, y2]: Position): Area {
  return [[x1, y1], [x1, y2], [x2, y2], [x2, y1]];
}

/** The corner nearest to a point of the map that an area may have that begins at `first`. */
export function nearestCorner(first: Position | undefined, [x, y]: Position): Position {
  const from = first?.[0] ?? x;
  return [Math.min(Math.max(x, from - MAX_SPAN), from + MAX_SPAN), Math.min(Math.max(y, -90), 90)];
}

/** The same area where longitudes begin at -180: the map shows the globe side by side several times. */
export function onOneGlobe(area: Area): Area {
  const [first] = area;
  if (!first) return area;
  const shift = turn(first[0]) - first[0];
  return area.map(([x, y]): Position => [x + shift, y]);
}

/** The same rule as the server's, also across the antimeridian. */
export function isInArea(area: Area, [longitude, latitude]: Position): boolean {
  const origin = area[0]?.[0] ?? 0;
  const x = turn(longitude - origin);
  let before = area.at(-1);
  let inside = false;
  for (const corner of area) {
    if (before && before[1] > latitude !== corner[1] > latitude) {
      const [x1, x2] = [turn(before[0] - origin), turn(corner[0] - origin)];
      const part = (latitude - before[1]) / (corner[1] - before[1]);
      if (x < x1 + part * (x2 - x1)) inside = !inside;
    }
    before = corner;
  }
  return inside;
}

/** "latitude,longitude,latitude,longitude,…", to a decimetre: as in the address bar and for the server. */
export const formatArea = (area: Area): string =>
  area.map(([longitude, latitude]) => `${Number(latitude.toFixed(6))},${Number(longitude.toFixed(6))}`).join(",");

/** All positions of a text; null: it has something else, too. */
export function readCorners(text: string): Position[] | null {
  const corners: Position[] = [];
  for (let rest = text.trim(); rest !== ""; ) {
    const found = readPosition(rest);
    if (found === null || corners.length === MAX_CORNERS) return null;
    corners.push([found.longitude, found.latitude]);
    rest = found.rest.replace(/^[\s,;]+/, "");
  }
  return corners;
}

/**
 * Reads corners with commas, semicolons or spaces between, each as the page writes positions. Two corners are opposite ones
 * of a rectangle. Null: it is no area.
 */
export function parseArea(text: string): Area | null {
  const corners = readCorners(text);
  if (corners === null || corners.length < 2) return null;
  const [first, second] = corners as [Position, Position];
  const isValid = corners.every(([x, y]) => Math.abs(x) <= 360 && Math.abs(y) <= 90 && Math.abs(turn(x - first[0])) <= 90);
  if (!isValid) return null;
  if (corners.length > 2) return corners;
  return first[0] === second[0] || first[1] === second[1] ? null : rectangle(first, second);
}

/** An area without size is none. */
export function isArea(area: Area): boolean {
  const [xs, ys] = [area.map((one) => one[0]), area.map((one) => one[1])];
  return area.length >= 3 && Math.min(...xs) < Math.max(...xs) && Math.min(...ys) < Math.max(...ys);
}
