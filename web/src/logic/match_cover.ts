// How the matches of a sighting cover the object. Matches that agree on a pose, but lie in one small patch, are those
// of something that looks like a part of the object: a grille, a window, a sign.
type Point = readonly number[];

export interface MatchCover {
  /** Of the object's outline in the view that the hull of the matches covers, 0 to 1. */
  part: number;
  /** Corners of the hull, px of the view. */
  hull: Point[];
  /** The most matches that lie in one small patch. */
  inPatch: number;
  matches: number;
  /** Nearly all lie in one small patch. */
  isOnePatch: boolean;
}

/** Of the object's area. */
const PATCH = 0.1;
const NEARLY_ALL = 0.8;
/** Of fewer, most lie near each other anyway. */
const MIN_MATCHES = 4;

const x = (one: Point) => one[0] ?? 0;
const y = (one: Point) => one[1] ?? 0;

export function areaOf(corners: readonly Point[]): number {
  const last = corners.at(-1);
  let [sum, before] = [0, last];
  for (const corner of corners) {
    if (before) sum += x(before) * y(corner) - x(corner) * y(before);
    before = corner;
  }
  return Math.abs(sum) / 2;
}

/** Andrew's monotone chain. */
export function hullOf(points: readonly Point[]): Point[] {
  const sorted = [...points].sort((a, b) => x(a) - x(b) || y(a) - y(b));
  const turn = (a: Point, b: Point, c: Point) => (x(b) - x(a)) * (y(c) - y(a)) - (y(b) - y(a)) * (x(c) - x(a));
  const half = (all: readonly Point[]) => {
    const chain: Point[] = [];
    for (const point of all) {
      while (chain.length > 1 && turn(chain.at(-2) ?? point, chain.at(-1) ?? point, point) <= 0) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}

/** @param points  of the matches that agree, in the view; @param outline  of the object there. Null: nothing to say. */
export function matchCover(points: readonly Point[], outline: readonly Point[]): MatchCover | null {
  const area = areaOf(outline);
  if (points.length === 0 || area <= 0) return null;
  const radius = Math.sqrt((PATCH * area) / Math.PI);
  const near = (one: Point) => points.filter((other) => Math.hypot(x(one) - x(other), y(one) - y(other)) <= radius).length;
  const inPatch = Math.max(...points.map(near));
  const hull = hullOf(points);
  return {
    hull,
    inPatch,
    matches: points.length,
    part: Math.min(areaOf(hull) / area, 1),
    isOnePatch: points.length >= MIN_MATCHES && inPatch >= NEARLY_ALL * points.length,
  };
}

export function describeCover({ part, inPatch, matches, isOnePatch }: MatchCover): string {
  const percent = part > 0 && part < 0.01 ? "less than 1" : String(Math.round(100 * part));
  if (!isOnePatch) return `The matches span ${percent} % of the object.`;
  const which = inPatch === matches ? `All ${matches} matches` : `${inPatch} of the ${matches} matches`;
  return `${which} lie in one small patch of the object, which something else may have, too: that speaks against it.`;
}
