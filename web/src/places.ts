// A click on the map: when was this place seen? In the video that is shown first, then in the others.
import { getCameraPath } from "./api/client";
import type { CameraPath } from "./api/types";
import { type Position, whenSeen } from "./logic/geo";
import { baseName } from "./logic/format";
import { MAX_VIDEOS, findPlace } from "./logic/place_search";
import { notify } from "./notices";
import { showTime } from "./selection";
import { cameraPath, indexVersion, videoId, videos } from "./state";

/** Of the other videos, as long as the index does not change. */
const paths = new Map<number, Promise<CameraPath>>();
let pathsVersion = -1;
let latest = 0;

function load(video: number): Promise<CameraPath> {
  if (pathsVersion !== indexVersion.peek()) paths.clear();
  pathsVersion = indexVersion.peek();
  const known = paths.get(video) ?? getCameraPath(video, new AbortController().signal);
  paths.set(video, known);
  known.catch(() => paths.delete(video)); // the next click asks again
  return known;
}

/** Goes to the moment that shows a place best. */
export async function showPlace(place: Position) {
  const search = ++latest;
  const here = videoId.peek();
  const path = cameraPath.peek();
  const time = path && whenSeen(path, place);
  if (here !== null && time !== null) return showTime(here, time);
  const others = videos.peek().filter((one) => one.id !== here && one.missing === null);
  const found = await findPlace(others.map((one) => one.id), load, place, () => search === latest);
  if (search !== latest) return;
  if (found) {
    showTime(found.video, found.time);
    return notify(`Seen in ${baseName(others.find((one) => one.id === found.video)?.name ?? "")}.`);
  }
  if (others.length > MAX_VIDEOS) return notify(`This place is not in this video, nor in ${MAX_VIDEOS} others; the rest was not looked through.`);
  if (others.length > 0) return notify("No video showed this place.");
  if (path?.points.some((point) => point.footprint)) notify("The camera did not show this place.");
}
