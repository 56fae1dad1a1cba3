// Which other models explain a sighting: at the same part of the frame, or objects at the same place.
import type { FoundObject, Place, Sighting } from "../api/types";

export interface Rival {
  object: number;
  model: string;
  score: number;
  /** Whether the frame shows it there, too; else it stands at the same place. */
  isInFrame: boolean;
}

/** Boxes that share less of what both cover show two things beside each other. */
const MIN_OVERLAP = 0.3;
const MAX_RIVALS = 5;

type Box = readonly number[];

/** Intersection over union. */
export function overlapOf([ax = 0, ay = 0, aw = 0, ah = 0]: Box, [bx = 0, by = 0, bw = 0, bh = 0]: Box): number {
  const width = Math.min(ax + aw, bx + bw) - Math.max(ax, bx);
  const height = Math.min(ay + ah, by + bh) - Math.max(ay, by);
  if (width <= 0 || height <= 0) return 0;
  const both = width * height;
  return both / (aw * ah + bw * bh - both);
}

/** Of the 90 % ellipse, as a matrix: east-east, east-north, north-north, m²; null: no error is known. */
function shapeOf({ ellipse, ce90_m: radius }: Place): readonly [number, number, number] | null {
  const { semi_major_m: major, semi_minor_m: minor, azimuth_deg: azimuth } = ellipse;
  if (major === null || minor === null || azimuth === null) return radius === null ? null : [radius ** 2, 0, radius ** 2];
  const [east, north] = [Math.sin((azimuth * Math.PI) / 180), Math.cos((azimuth * Math.PI) / 180)];
  const [along, across] = [major ** 2, minor ** 2];
  return [along * east ** 2 + across * north ** 2, (along - across) * east * north, along * north ** 2 + across * east ** 2];
}

/** Whether two places may be one: their difference lies in the 90 % ellipse of the difference of two independent places. */
export function agree(a: Place, b: Place): boolean {
  const [one, other] = [shapeOf(a), shapeOf(b)];
  if (!one || !other) return false;
  const [ee, en, nn] = [one[0] + other[0], one[1] + other[1], one[2] + other[2]];
  const turn = b.longitude_deg - a.longitude_deg;
  const east = 111_320 * (turn - 360 * Math.round(turn / 360)) * Math.cos((a.latitude_deg * Math.PI) / 180);
  const north = 111_320 * (b.latitude_deg - a.latitude_deg);
  const determinant = ee * nn - en ** 2;
  // Without errors, only the same place.
  if (!(determinant > 0)) return east === 0 && north === 0;
  return (nn * east ** 2 - 2 * en * east * north + ee * north ** 2) / determinant <= 1;
}

/** What moves is elsewhere at another time: its place says nothing. */
const stands = (object: FoundObject) => object.speed_m_s === null || object.speed_m_s === 0;

/**
 * Objects of other models that explain a sighting, too, best first; without those that are rejected.
 * @param sightings  of its video, this frame among them
 * @param objects    those of these sightings, and those near the place of the sighting's object
 */
export function rivalsOf(sighting: Sighting, own: FoundObject | null, sightings: readonly Sighting[], objects: readonly FoundObject[]): Rival[] {
  const here = new Map<number, number>();
  for (const one of sightings) {
    if (one.video_id !== sighting.video_id || one.frame !== sighting.frame) continue;
    if (overlapOf(one.box, sighting.box) >= MIN_OVERLAP) here.set(one.object_id, one.score);
  }
  const found = new Map<number, Rival>();
  for (const one of objects) {
    if (one.id === sighting.object_id || one.model_id === sighting.model_id || one.review?.verdict === "rejected") continue;
    const score = here.get(one.id);
    const isAtPlace = own !== null && own.place !== null && one.place !== null && stands(own) && stands(one) && agree(own.place, one.place);
    if (score === undefined && !isAtPlace) continue;
    found.set(one.id, { object: one.id, model: one.model, score: score ?? one.score, isInFrame: score !== undefined });
  }
  return [...found.values()].sort((a, b) => b.score - a.score || a.object - b.object).slice(0, MAX_RIVALS);
}

/** m; where objects are asked for whose places may agree with one. Those with larger errors of their own may be missed. */
export const reachOf = ({ ce90_m: radius, ellipse }: Place): number => Math.ceil(2 * Math.max(radius ?? 0, ellipse.semi_major_m ?? 0) + 20);
