// When an object was seen: times belong to a video, and those of different videos have nothing in common but UTC.
import type { FoundObject, Video } from "../api/types";
import { baseName, formatSpan } from "./format";

type Named = Pick<Video, "id" | "name" | "start_utc_us">;

/** An object in one video, from its first to its last sighting there. */
export interface SeenIn {
  video_id: number;
  video: string;
  first_time_s: number;
  last_time_s: number;
  /** ISO 8601; null: the video has no telemetry or clock that tells it. */
  first_utc: string | null;
  last_utc: string | null;
  frames: number;
}

function utcOf(video: Named | undefined, time_s: number): string | null {
  if (video === undefined || video.start_utc_us === null) return null;
  return new Date(video.start_utc_us / 1000 + time_s * 1000).toISOString();
}

/** By the order in which the videos were added. */
export function seenIn(object: Pick<FoundObject, "moments">, videos: readonly Named[]): SeenIn[] {
  const byVideo = new Map<number, SeenIn>();
  for (const { video_id, first_time_s, last_time_s, frames } of object.moments) {
    const before = byVideo.get(video_id);
    byVideo.set(video_id, {
      video_id,
      video: videos.find((one) => one.id === video_id)?.name ?? String(video_id),
      first_time_s: Math.min(first_time_s, before?.first_time_s ?? Infinity),
      last_time_s: Math.max(last_time_s, before?.last_time_s ?? -Infinity),
      first_utc: null,
      last_utc: null,
      frames: frames + (before?.frames ?? 0),
    });
  }
  return [...byVideo.values()]
    .sort((a, b) => a.video_id - b.video_id)
    .map((one) => {
      const video = videos.find(({ id }) => id === one.video_id);
      return { ...one, first_utc: utcOf(video, one.first_time_s), last_utc: utcOf(video, one.last_time_s) };
    });
}

/** "a.mp4 3.0 – 5.1 s". */
export const describeSeen = (one: SeenIn): string => `${baseName(one.video)} ${formatSpan(one.first_time_s, one.last_time_s)}`;

/** "2023-11-14 22:13:23 – 22:13:25 UTC". */
export function formatUtcSpan(first: string, last: string): string {
  const [from, to] = [first, last].map((one) => ({ day: one.slice(0, 10), time: one.slice(11, 19) }));
  if (from === undefined || to === undefined) return "";
  return `${from.day} ${from.time} – ${from.day === to.day ? "" : `${to.day} `}${to.time} UTC`;
}

/** What a row has room for. @param here  the video that is shown: its times are meant then */
export function summarizeSeen(seen: readonly SeenIn[], here: number | null): string {
  const [first] = seen;
  if (first === undefined) return "";
  if (seen.length === 1) return formatSpan(first.first_time_s, first.last_time_s);
  const shown = seen.find((one) => one.video_id === here);
  return shown === undefined ? `in ${seen.length} videos` : `${formatSpan(shown.first_time_s, shown.last_time_s)} here`;
}
