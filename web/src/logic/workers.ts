// What is said of workers and their tasks.
import type { Cluster, ClusterSource, ClusterTask } from "../api/types";
import { plural } from "./format";

/** A worker says four times in its lease, 60 s by default, that it is alive. */
const LATE_S = 30;

export const isLate = (task: Pick<ClusterTask, "silent_s">) => task.silent_s !== null && task.silent_s >= LATE_S;

export function formatSilence(seconds: number | null): string {
  if (seconds === null) return "";
  if (seconds < 1.5) return "alive 1 s ago";
  return seconds < 120 ? `alive ${Math.round(seconds)} s ago` : `alive ${Math.round(seconds / 60)} min ago`;
}

/** What part of the video a task is for. */
export function describePart(task: Pick<ClusterTask, "segment" | "searched_frames">): string {
  if (task.segment) return formatFrames(task.segment);
  return task.searched_frames === null ? "begins" : `${plural(task.searched_frames, "frame")} searched`;
}

export function formatFrames([from, to]: readonly number[]): string {
  return `frames ${(from ?? 0).toLocaleString("en")} to ${((to ?? 1) - 1).toLocaleString("en")}`;
}

/** How far a live source is searched. */
export function describeBehind({ behind_s }: Pick<ClusterSource, "behind_s">): string {
  return behind_s === null ? "nothing searched yet" : `${formatDuration(behind_s)} behind`;
}

/** A time of a live source that was not searched: when, in UTC, and how long. */
export function formatUtcGap({ from_utc_us, to_utc_us }: ClusterSource["gaps"][number]): string {
  return `${new Date(from_utc_us / 1000).toISOString().slice(0, 19).replace("T", " ")} UTC (${formatDuration((to_utc_us - from_utc_us) / 1e6)})`;
}

function formatDuration(seconds: number): string {
  if (seconds < 120) return `${Math.round(seconds)} s`;
  return seconds < 7200 ? `${Math.round(seconds / 60)} min` : `${Math.round(seconds / 3600)} h`;
}

/** What the workers do in an hour, at the rate of the last tasks; null: not known. */
export function describeRate({ videos, segments, video_s, segment_s }: Cluster): string | null {
  const perHour = (running: number, mean_s: number, noun: string) => {
    const count = (3600 * running) / mean_s;
    return `about ${count < 10 ? count.toFixed(1) : Math.round(count).toLocaleString("en")} ${noun} an hour`;
  };
  if (segments.running > 0 && segment_s) return perHour(segments.running, segment_s, "segments");
  if (videos.running > 0 && video_s) return perHour(videos.running, video_s, "videos");
  return null;
}
