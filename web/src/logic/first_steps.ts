// The way from nothing to the first finds: an object, a video, the search.
import type { Job, Project } from "../api/types";
import { plural } from "./format";
import { formatLeft } from "./uploads";

/** open: waits for the reader. waits: comes after the others. */
export type StepState = "open" | "waits" | "runs" | "done";

export interface Steps {
  object: StepState;
  video: StepState;
  finds: StepState;
  /** What runs now, in words; empty: nothing. */
  progress: string;
  /** Why what was tried last failed; empty: it did not. */
  failure: string;
}

const isActive = (job: Job) => job.state === "queued" || job.state === "running";

function describe(job: Job | undefined): string {
  if (job === undefined) return "";
  if (job.state === "queued") return "waits for its turn";
  if (job.done === 0) return "begins";
  const of = job.total === null ? plural(job.done, job.unit.replace(/s$/, "")) : `${job.done.toLocaleString("en")} of ${job.total.toLocaleString("en")} ${job.unit}`;
  return job.left_s === null ? of : `${of}, ${formatLeft(job.left_s)}`;
}

/** @param uploads  files that are being sent */
export function stepsOf(project: Pick<Project, "has_targets" | "videos">, jobs: readonly Job[], uploads: number): Steps {
  const active = jobs.filter(isActive);
  const [model, sample, search] = [["model"], ["sample"], ["index", "live"]].map((kinds) => active.find((one) => kinds.includes(one.kind)));
  const ended = jobs.filter((one) => ["model", "sample", "index", "live"].includes(one.kind) && !isActive(one)).sort((a, b) => b.id - a.id)[0];
  const object = project.has_targets ? "done" : model ? "runs" : "open";
  const video = project.videos > 0 ? "done" : sample || search || uploads > 0 ? "runs" : object === "open" ? "waits" : "open";
  const running = active.find((one) => one.state === "running") ?? model ?? sample ?? search;
  return {
    object,
    video,
    finds: search && video === "done" ? "runs" : "waits",
    progress: running ? describe(running) : uploads > 0 ? "is sent" : "",
    failure: active.length === 0 && ended?.state === "failed" ? ended.message : "",
  };
}
