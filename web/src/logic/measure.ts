// Distances and areas on the ground, of positions on the map: on a sphere of the ellipsoid's mean radius, within 0.6 %.
import type { Position } from "./geo";

/** m; of WGS 84 */
const RADIUS = 6_371_008.8;
const rad = (degrees: number) => (degrees * Math.PI) / 180;

/** Along the great circle, m (haversine). */
export function distance([x1, y1]: Position, [x2, y2]: Position): number {
  const half = Math.sin(rad(y2 - y1) / 2) ** 2 + Math.cos(rad(y1)) * Math.cos(rad(y2)) * Math.sin(rad(x2 - x1) / 2) ** 2;
  return 2 * RADIUS * Math.asin(Math.min(1, Math.sqrt(half)));
}

/** m; `isClosed`: with the way from the last corner to the first. */
export const lengthOf = (line: readonly Position[], isClosed = false): number =>
  line.reduce((sum, corner, i) => {
    const before = line[i - 1] ?? (isClosed ? line.at(-1) : undefined);
    return before === undefined ? sum : sum + distance(before, corner);
  }, 0);

/** Of a polygon whose edges do not cross, m²: by the excess of spherical trapezoids. */
export function areaOf(ring: readonly Position[]): number {
  const sum = ring.reduce((all, [x2, y2], i) => {
    const [x1, y1] = ring[(i + ring.length - 1) % ring.length] ?? [x2, y2];
    const turn = rad(x2 - x1 - 360 * Math.round((x2 - x1) / 360));
    return all + turn * (2 + Math.sin(rad(y1)) + Math.sin(rad(y2)));
  }, 0);
  return Math.abs((sum * RADIUS * RADIUS) / 2);
}

/** Clockwise from north, degrees from 0 on. */
export function bearing([x1, y1]: Position, [x2, y2]: Position): number {
  const turn = rad(x2 - x1);
  const east = Math.sin(turn) * Math.cos(rad(y2));
  const north = Math.cos(rad(y1)) * Math.sin(rad(y2)) - Math.sin(rad(y1)) * Math.cos(rad(y2)) * Math.cos(turn);
  return ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360;
}

export function formatDistance(metres: number): string {
  if (metres < 100) return `${metres.toFixed(1)} m`;
  return metres < 10_000 ? `${Math.round(metres).toLocaleString("en")} m` : `${(metres / 1000).toFixed(metres < 100_000 ? 2 : 0)} km`;
}

export function formatSquare(metres: number): string {
  if (metres < 10_000) return `${metres < 100 ? metres.toFixed(1) : Math.round(metres).toLocaleString("en")} m²`;
  return metres < 1e6 ? `${(metres / 10_000).toFixed(2)} ha` : `${(metres / 1e6).toFixed(2)} km²`;
}
