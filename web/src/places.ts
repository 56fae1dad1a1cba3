// A click on the map: when was this place seen? In the video that is shown first, then in those of the others whose camera
// may have shown it.
import { getCameraPath, listVideosShowing } from "./api/client";
import type { CameraPath } from "./api/types";
import { type Position, whenSeen } from "./logic/geo";
import { baseName, plural } from "./logic/format";
import { findPlace } from "./logic/place_search";
import { notify, notifyError } from "./notices";
import { showTime } from "./selection";
import { cameraPath, indexVersion, videoId, videos } from "./state";

/** Of the other videos, as long as the index does not change. */
const paths = new Map<number, Promise<CameraPath>>();
/** Of the videos that a search led to. */
const known = new Map<number, CameraPath>();
const SILENT_MS = 400;
const PROGRESS = "place";
let pathsVersion = -1;
let latest = 0;

function load(video: number): Promise<CameraPath> {
  if (pathsVersion !== indexVersion.peek()) {
    paths.clear();
    known.clear();
  }
  pathsVersion = indexVersion.peek();
  const path = paths.get(video) ?? getCameraPath(video, new AbortController().signal);
  paths.set(video, path);
  path.catch(() => paths.delete(video)); // the next click asks again
  return path;
}

/** Goes to the moment that shows a place best. */
export async function showPlace(place: Position) {
  const search = ++latest;
  const here = videoId.peek();
  const path = cameraPath.peek();
  const time = path && whenSeen(path, place);
  if (here !== null && time !== null) return showTime(here, time);
  const others = await listVideosShowing(place[1], place[0]).then(
    (all) => all.filter((one) => one.id !== here && one.missing === null),
    (error: unknown) => notifyError(error),
  );
  if (!others || search !== latest) return;
  const begun = Date.now();
  const report = (searched: number) => {
    if (search === latest && Date.now() - begun > SILENT_MS) {
      notify(`Looking for this place: ${searched.toLocaleString("en")} of ${plural(others.length, "video")}`, "info", PROGRESS);
    }
    return search === latest;
  };
  const { found, failed } = await findPlace(others.map((one) => one.id), load, place, report);
  if (search !== latest) return;
  if (found) {
    known.set(found.video, await load(found.video));
    showTime(found.video, found.time);
    return notify(`Seen in ${baseName(others.find((one) => one.id === found.video)?.name ?? "")}.`, "info", PROGRESS);
  }
  const unread = failed > 0 ? ` ${plural(failed, "path")} could not be read.` : "";
  if (videos.peek().length > 1) return notify(`No video showed this place.${unread}`, "info", PROGRESS);
  if (path?.points.some((point) => point.footprint)) notify("The camera did not show this place.", "info", PROGRESS);
}

/** When a place was shown best, by the video that is shown, else by one whose path is known already; null: not known. */
export function seenAt(place: Position): { video: number; time: number } | null {
  const [here, path] = [videoId.value, cameraPath.value];
  const time = path && whenSeen(path, place);
  if (here !== null && time !== null) return { video: here, time };
  for (const [video, other] of known) {
    const at = video === here ? null : whenSeen(other, place);
    if (at !== null) return { video, time: at };
  }
  return null;
}
