// Looks for a video that shows a place of the ground.
import type { CameraPath } from "../api/types";
import { type Position, whenSeen } from "./geo";

/** Paths that are loaded at a time: a browser keeps other requests waiting beyond. */
export const AT_ONCE = 4;

export interface PlaceSearch {
  /** The first of the videos whose camera showed the place, and when; null: none of them. */
  found: { video: number; time: number } | null;
  /** Videos that were looked through. */
  searched: number;
  /** Videos among them whose path could not be had. */
  failed: number;
}

/**
 * @param load  the path of a video's camera
 * @param report  receives the number of videos that have been searched; false ends the search
 */
export async function findPlace(
  videos: readonly number[],
  load: (video: number) => Promise<CameraPath>,
  place: Position,
  report: (searched: number) => boolean,
): Promise<PlaceSearch> {
  let failed = 0;
  let searched = 0;
  for (; searched < videos.length && report(searched); searched += AT_ONCE) {
    const some = videos.slice(searched, searched + AT_ONCE);
    const times = await Promise.all(
      some.map((video) =>
        load(video).then(
          (path) => whenSeen(path, place),
          () => (failed++, null),
        ),
      ),
    );
    const at = times.findIndex((time) => time !== null);
    const [video, time] = [some[at], times[at]];
    if (video !== undefined && typeof time === "number") return { found: { video, time }, searched: searched + at + 1, failed };
  }
  return { found: null, searched: Math.min(searched, videos.length), failed };
}
