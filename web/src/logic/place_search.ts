// Looks for a video that shows a place of the ground.
import type { CameraPath } from "../api/types";
import { type Position, whenSeen } from "./geo";

/** Videos that are looked through: each costs a request. */
export const MAX_VIDEOS = 100;

/**
 * The first of some videos whose camera showed a place, and when; null: none of them.
 * @param load  the path of a video's camera; one that cannot be had is passed over
 * @param isWanted  false ends the search
 */
export async function findPlace(
  videos: readonly number[],
  load: (video: number) => Promise<CameraPath>,
  place: Position,
  isWanted: () => boolean,
): Promise<{ video: number; time: number } | null> {
  for (const video of videos.slice(0, MAX_VIDEOS)) {
    if (!isWanted()) return null;
    const path = await load(video).catch(() => null);
    const time = path && whenSeen(path, place);
    if (time !== null) return { video, time };
  }
  return null;
}
