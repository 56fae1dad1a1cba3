// A model that turns: which of its views is seen from a direction, and where the views lie on the disc of directions.
import type { Sighting } from "../api/types";

/** From where the model is seen: 0° behind it, 90° on its left; 0° straight above. */
export interface Direction {
  azimuth_deg: number;
  off_nadir_deg: number;
}

export interface View extends Direction {
  /** A sighting's view_index. */
  index: number;
}

interface ListedView {
  azimuth_deg: number | null;
  off_nadir_deg: number | null;
  has_image: boolean;
}

/** The views that can be shown. Photos have no direction: they are laid out in a row, a full turn wide. */
export function viewsOf(listed: readonly ListedView[]): { views: View[]; isTurntable: boolean } {
  const isTurntable = listed.some((one) => one.azimuth_deg !== null);
  const views = listed.flatMap((one, index) => {
    if (!one.has_image) return [];
    if (!isTurntable) return [{ index, azimuth_deg: (360 * index) / listed.length, off_nadir_deg: 90 }];
    if (one.azimuth_deg === null || one.off_nadir_deg === null) return [];
    return [{ index, azimuth_deg: one.azimuth_deg, off_nadir_deg: one.off_nadir_deg }];
  });
  return { views, isTurntable };
}

const RADIANS = Math.PI / 180;

/** The angle between two directions, degrees. */
export function angleBetween(a: Direction, b: Direction): number {
  const [ta, tb] = [a.off_nadir_deg * RADIANS, b.off_nadir_deg * RADIANS];
  const cosine = Math.cos(ta) * Math.cos(tb) + Math.sin(ta) * Math.sin(tb) * Math.cos((a.azimuth_deg - b.azimuth_deg) * RADIANS);
  return Math.acos(Math.max(-1, Math.min(1, cosine))) / RADIANS;
}

/** The views by their angle to a direction, the nearest first. */
export function byNearness(views: readonly View[], to: Direction): View[] {
  return views
    .map((view) => ({ view, angle: angleBetween(view, to) }))
    .sort((a, b) => a.angle - b.angle || a.view.index - b.view.index)
    .map(({ view }) => view);
}

export function nearest(views: readonly View[], to: Direction): View | null {
  let [best, least] = [null as View | null, Infinity];
  for (const view of views) {
    const angle = angleBetween(view, to);
    if (angle < least - 1e-9) [best, least] = [view, angle];
  }
  return best;
}

/**
 * The direction after a drag, as if the near side of the model were held: dragged to the right, it turns to the right, and
 * the viewer comes round its left side.
 */
export function turn(from: Direction, rightPx: number, downPx: number, views: readonly View[]): Direction {
  const DEGREES_PER_PX = 0.5;
  const lowest = views.reduce((most, one) => Math.max(most, one.off_nadir_deg), 0);
  const highest = views.reduce((least, one) => Math.min(least, one.off_nadir_deg), 180);
  return {
    azimuth_deg: (((from.azimuth_deg + DEGREES_PER_PX * rightPx) % 360) + 360) % 360,
    off_nadir_deg: Math.max(highest, Math.min(lowest, from.off_nadir_deg - DEGREES_PER_PX * downPx)),
  };
}

/** The smallest step from a ring of views to the next, and within the ring of a view, degrees. */
export function stepsAt(views: readonly View[], at: View): { azimuth: number; offNadir: number } {
  const gaps = (values: number[]) => {
    const sorted = [...new Set(values)].sort((a, b) => a - b);
    const steps = sorted.slice(1).map((value, i) => value - (sorted[i] ?? 0));
    return steps.length === 0 ? 10 : Math.min(...steps);
  };
  const ring = views.filter((one) => Math.abs(one.off_nadir_deg - at.off_nadir_deg) < 1e-6);
  return { azimuth: gaps(ring.map((one) => one.azimuth_deg)), offNadir: gaps(views.map((one) => one.off_nadir_deg)) };
}

/**
 * Where a direction lies on a disc of radius 1: the model from above with its front up, the middle straight above it, the
 * rim as far from there as any view.
 */
export function onDisc(direction: Direction, rim_deg: number): [number, number] {
  const radius = rim_deg > 0 ? direction.off_nadir_deg / rim_deg : 0;
  return [-radius * Math.sin(direction.azimuth_deg * RADIANS), radius * Math.cos(direction.azimuth_deg * RADIANS)];
}

/** The direction of a place on the disc. */
export function fromDisc([x, y]: readonly [number, number], rim_deg: number): Direction {
  return { azimuth_deg: ((Math.atan2(-x, y) / RADIANS) % 360 + 360) % 360, off_nadir_deg: Math.min(1, Math.hypot(x, y)) * rim_deg };
}

/** Where the model is seen from, in words. */
export function describeDirection({ azimuth_deg, off_nadir_deg }: Direction): string {
  const height = off_nadir_deg < 1 ? "straight from above" : `${off_nadir_deg.toFixed(0)}° off straight above`;
  if (off_nadir_deg < 1) return height;
  const sides = ["from behind", "from behind left", "from the left", "from the front left", "from the front", "from the front right", "from the right", "from behind right"];
  return `${sides[Math.round(azimuth_deg / 45) % 8]} (${azimuth_deg.toFixed(0)}°), ${height}`;
}

export interface MatchedView {
  view: number;
  /** Of the object that is looked at, then of others; of each the one with most matches first. */
  sightings: Sighting[];
}

/** The views that matched, those of the object first, then by the number of matches; each object once a view. */
export function matchedViews(own: readonly Sighting[], others: readonly Sighting[], object: number | null): MatchedView[] {
  const byView = new Map<number, Map<number, Sighting>>();
  for (const one of [...own, ...others]) {
    if (one.source !== "recognised") continue;
    const ofView = byView.get(one.view_index) ?? new Map<number, Sighting>();
    byView.set(one.view_index, ofView);
    const before = ofView.get(one.object_id);
    if (!before || one.matches > before.matches) ofView.set(one.object_id, one);
  }
  const isOwn = (one: Sighting | undefined) => Number(one?.object_id === object);
  const order = (a: Sighting | undefined, b: Sighting | undefined) => isOwn(b) - isOwn(a) || (b?.matches ?? 0) - (a?.matches ?? 0);
  return [...byView]
    .map(([view, ofView]) => ({ view, sightings: [...ofView.values()].sort(order) }))
    .sort((a, b) => order(a.sightings[0], b.sightings[0]) || a.view - b.view);
}
