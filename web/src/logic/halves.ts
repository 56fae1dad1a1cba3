// More sightings than fit in one answer of the server: in halves of the time, each in halves again where it is needed.
import type { Sighting } from "../api/types";

export interface SightingPages {
  sightings: Sighting[];
  /** Not even the shortest range could be had whole. */
  truncated: boolean;
}

/** s; shorter than any frame lasts. */
const SHORTEST = 1e-3;

/** @param fetch  the sightings of a range of times, both ends included, or a part of them and `truncated` */
export async function inHalves(
  fetch: (from: number, to: number) => Promise<SightingPages>,
  from: number,
  to: number,
): Promise<SightingPages> {
  const found = await fetch(from, to);
  if (!found.truncated || to - from < SHORTEST) return found;
  const middle = (from + to) / 2;
  const [first, second] = await Promise.all([inHalves(fetch, from, middle), inHalves(fetch, middle, to)]);
  return {
    // The middle belongs to both.
    sightings: [...first.sightings, ...second.sightings.filter((one) => one.time_s > middle)],
    truncated: first.truncated || second.truncated,
  };
}
