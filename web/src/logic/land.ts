// Countries as world-atlas has them, for a flat map: their rings jump from 180° to -180°, which a map draws as lines from
// edge to edge.
import type { FeatureCollection, Position } from "geojson";

/** °; beyond it, a ring is the pole itself. */
const POLE = 89;

/** A ring that crosses the antimeridian goes on beyond ±180°; one around a pole is closed along it. */
export function unwrapRing(ring: readonly Position[]): Position[] {
  let turn = 0;
  const unwrapped = ring.map(([longitude = 0, latitude = 0], i): Position => {
    const step = longitude - (ring[i - 1]?.[0] ?? longitude);
    if (Math.abs(step) > 180) turn -= 360 * Math.sign(step);
    return [longitude + turn, latitude];
  });
  const [first, last] = [unwrapped[0], unwrapped.at(-1)];
  if (turn === 0 || !first || !last) return unwrapped;
  const pole = POLE * Math.sign(first[1] ?? 0);
  return [...unwrapped, [last[0] ?? 0, pole], [first[0] ?? 0, pole], first];
}

const unwrapPolygon = (rings: readonly Position[][]) =>
  rings.filter((ring) => ring.some(([, latitude = 0]) => Math.abs(latitude) < POLE)).map(unwrapRing);

export function unwrapLand(land: FeatureCollection): FeatureCollection {
  const features = land.features.map((one) => {
    const { geometry } = one;
    if (geometry.type === "Polygon") return { ...one, geometry: { ...geometry, coordinates: unwrapPolygon(geometry.coordinates) } };
    if (geometry.type === "MultiPolygon") return { ...one, geometry: { ...geometry, coordinates: geometry.coordinates.map(unwrapPolygon) } };
    return one;
  });
  return { ...land, features };
}
