// What was searched of a video, as bands of a time line and in words.
import type { LeftOutTime, Video } from "../api/types";
import { formatTime } from "./format";

export type Searched = Pick<Video, "is_searched" | "searched" | "left_out">;

/** A time of the video in which the same was searched. */
export interface Band {
  from: number;
  to: number;
  /** whole: for every model. part: for some models, or less often than it should be. none: for no model. */
  state: "whole" | "part" | "none";
  leftOut: LeftOutTime[];
}

const REASONS: Record<LeftOutTime["reason"], string> = {
  not_begun: "not searched",
  not_yet: "not searched yet",
  not_wanted: "outside of --from and --to",
  thinned: "searched in part only, to keep the pace",
  damaged: "no frames: the video is damaged, or none were sent",
  failed: "its search failed",
};

const MAX_NAMES = 3;

/** "0:02.00 to the end: not searched for jet". @param nameOf  of a model */
export function describeLeftOut(one: LeftOutTime, nameOf: (model: number) => string): string {
  const names = one.model_ids?.slice(0, MAX_NAMES).map(nameOf) ?? [];
  const more = (one.model_ids?.length ?? 0) - names.length;
  const models = names.length === 0 ? "" : `${names.join(", ")}${more > 0 ? ` and ${more} more` : ""}`;
  const isOfSearch = one.reason === "not_begun" || one.reason === "not_yet";
  const what = models === "" ? REASONS[one.reason] : isOfSearch ? `${REASONS[one.reason]} for ${models}` : `${models}: ${REASONS[one.reason]}`;
  if (one.from_s === 0 && one.to_s === null) return what;
  return `${formatTime(one.from_s)} to ${one.to_s === null ? "the end" : formatTime(one.to_s)}: ${what}`;
}

/**
 * @param length  of the time line, s
 * @param models  their number
 */
export function bandsOf(video: Searched, length: number, models: number): Band[] {
  const ends = [0, length];
  for (const { from_s, to_s } of [...video.searched, ...video.left_out]) ends.push(Math.min(from_s, length), Math.min(to_s ?? length, length));
  const times = [...new Set(ends)].sort((a, b) => a - b);
  const bands: Band[] = [];
  for (const [i, from] of times.entries()) {
    const to = times[i + 1];
    if (to === undefined) break;
    const middle = (from + to) / 2;
    const leftOut = video.left_out.filter((one) => one.from_s <= middle && middle <= (one.to_s ?? Infinity));
    const isWhole = leftOut.length === 0;
    const without = leftOut.filter((one) => one.reason !== "thinned");
    const isNone = without.some((one) => one.model_ids === null) || new Set(without.flatMap((one) => one.model_ids ?? [])).size >= models;
    bands.push({ from, to, state: isWhole ? "whole" : isNone ? "none" : "part", leftOut });
  }
  return bands;
}

/** The times that are left out in one line, the first ones by name; null: none are. */
export function describeCoverage(video: Searched, nameOf: (model: number) => string): string | null {
  const [first, ...others] = video.left_out;
  if (first === undefined) return null;
  return `${describeLeftOut(first, nameOf)}${others.length > 0 ? `; and ${others.length} more` : ""}`;
}

/** All of them, one a line. */
export const listLeftOut = (times: readonly LeftOutTime[], nameOf: (model: number) => string): string =>
  times.map((one) => describeLeftOut(one, nameOf)).join("\n");

/** Until when the time line shows the video: the end of its frames, or of what is missing after them. */
export const endOf = (frames: number, video: Searched | null): number =>
  (video?.left_out ?? []).reduce((end, one) => (one.reason === "damaged" ? Math.max(end, one.to_s ?? 0) : end), frames);

/** Hours of video that were searched for a model. */
export const searchedHours = (videos: readonly Pick<Video, "searched_s">[]): number =>
  videos.reduce((hours, one) => hours + one.searched_s / 3600, 0);
