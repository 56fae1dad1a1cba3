// What the server works on: uploads of this page, and the jobs of all users.
import { computed, effect, signal } from "@preact/signals";

import { ApiFailure, cancelJob, listJobs, postJob, removeJob, retryJob, uploadFile } from "./api/client";
import type { FoundObject, Job, NewJob, Video } from "./api/types";
import { onEvent } from "./events";
import { forReaders } from "./logic/errors";
import { describeFailed } from "./logic/job_words";
import { type Plan, formatBehind, planFiles } from "./logic/uploads";
import { baseName, plural } from "./logic/format";
import { account } from "./session";
import * as confirm from "./confirm";
import * as load from "./load";
import * as notices from "./notices";
import * as state from "./state";

export interface Upload {
  id: number;
  name: string;
  /** 0 to 1 */
  done: number;
  abort: () => void;
}

export const jobs = signal<readonly Job[]>([]);
export const uploads = signal<readonly Upload[]>([]);
export const isOpen = signal(false);
/** What a model is made from: files, or an object that was boxed in a frame (x, y, width, height in the video's pixels). */
export type ModelSource = { files: readonly File[]; boxes?: number[][] | null } | { video: number; frame: number; box: number[] };
/** The source of a model whose name is asked for. */
export const askedModel = signal<ModelSource | null>(null);
/** Jobs of models for which all videos are searched once they are made. */
const searchAfter = new Set<number>();
/** How far the search of the live source that is shown is behind it; null: it keeps up, or is none. */
export const behind = computed(() => {
  const shown = state.video.value;
  // A source that is searched anew is another video of the same name, the latest one.
  if (shown === null || state.videos.value.some((one) => one.name === shown.name && one.id > shown.id)) return null;
  const job = jobs.value.find((one) => one.kind === "live" && one.state === "running" && one.title === shown.name);
  return job ? formatBehind(job) : null;
});
export const active = computed(() => jobs.value.filter((one) => one.state === "queued" || one.state === "running"));

let nextUpload = 0;

/** Queues a job that has failed or was cancelled again. */
export function retry(job: Job) {
  retryJob(job.id).catch(notices.notifyError);
}

/** Removes an ended job from the list, for everybody. */
export function remove(job: Job) {
  removeJob(job.id).catch(notices.notifyError);
}

export const canAdd = computed(() => state.project.value.state === "ready" && state.project.value.value.has_jobs);

/** For the case that `canAdd` is not set: what is missing. */
export const whyNotAdd = () =>
  account.value?.role === "viewer"
    ? "You may look, but not add or search: that needs the role analyst."
    : "This server neither adds nor searches: it has no folder for models, or its index cannot be written. Who runs it can change that.";

const READY = {
  model: (title: string) => `The model ${title} is ready.`,
  index: (title: string) => `${title} is searched.`,
  live: (title: string) => `${title} has ended.`,
  sample: (title: string) => `The ${title} is made; it is searched next.`,
  track: (title: string) => `${title} was followed: it is an object of the list.`,
  refine: (title: string) => `${title} is refined: the new file and what it changes are under Add.`,
  remove: (title: string) => `${title} is no longer in the index.`,
  clip: (title: string) => `The clip ${title} is ready: it is under Add.`,
};

function take(list: readonly Job[]) {
  const before = new Map(jobs.value.map((one) => [one.id, one.state]));
  for (const job of list) {
    const was = before.get(job.id);
    if (was === undefined || was === job.state) continue;
    if (job.state === "done" && job.kind in READY) notices.notify(READY[job.kind as keyof typeof READY](job.title));
    if (job.state === "done" && searchAfter.delete(job.id)) void searchAll();
    // The open panel says it.
    if (job.state === "failed" && !isOpen.value) notices.notify(`${job.title}: ${forReaders(describeFailed(job))}`, "error");
    if (job.state === "done") void load.refresh();
  }
  jobs.value = list;
}

export function startJobs() {
  onEvent("jobs", (data) => take((data as { jobs: Job[] }).jobs));
  listJobs()
    .then(take)
    .catch(notices.notifyError);
}

async function send(file: File): Promise<string> {
  const id = nextUpload++;
  const abort = new AbortController();
  const change = (next: Partial<Upload>) =>
    (uploads.value = uploads.value.map((one) => (one.id === id ? { ...one, ...next } : one)));
  uploads.value = [...uploads.value, { id, name: file.name, done: 0, abort: () => abort.abort() }];
  try {
    return (await uploadFile(file, (done) => change({ done }), abort.signal)).id;
  } finally {
    uploads.value = uploads.value.filter((one) => one.id !== id);
  }
}

/** Resolves once no dialog asks about a model, and the one that it was about is queued. */
async function modelIsQueued() {
  await new Promise<void>((resolve) => {
    const stop = effect(() => {
      if (askedModel.value !== null) return;
      resolve();
      queueMicrotask(() => stop());
    });
  });
  await addedModel;
}

async function addVideo({ file, telemetry }: Plan<File>["videos"][number]) {
  const upload = await send(file);
  const job: NewJob = { kind: "index", upload };
  if (telemetry) job.telemetry = await send(telemetry);
  // Searches and new models are worked off in the order in which they are queued: a model that was dropped with the
  // video is searched for in it.
  await modelIsQueued();
  await postJob(job);
}

/** Makes the sample: a model, a flight, and its search. */
export async function trySample() {
  try {
    await postJob({ kind: "sample" });
  } catch (error) {
    notices.notifyError(error);
  }
}

/** Whether there is something to search for, or soon will be. */
const hasTargets = () =>
  (state.project.value.state === "ready" && state.project.value.value.has_targets) || active.value.some((one) => one.kind === "model");

/** Follows an object that was boxed in a frame through its video. */
export async function follow(source: Extract<ModelSource, { video: number }>, type: string) {
  isOpen.value = true;
  try {
    const job: NewJob = { kind: "track", video_id: source.video, frame: source.frame, box: source.box };
    if (type.trim() !== "") job.type = type.trim();
    await postJob(job);
  } catch (error) {
    notices.notifyError(error);
  }
}

/** Searches a live source until it ends or is stopped. Throws ApiFailure with a message for the user. */
export async function watch(url: string) {
  await postJob({ kind: "live", url: url.trim() });
}

/** Ends once the model that was asked for last is queued, or could not be. */
let addedModel: Promise<void> = Promise.resolve();

/** @param isSearched  all videos are searched for it then, as long as this page is open */
export function addModel(name: string, source: ModelSource, length: number | null, isSearched: boolean) {
  addedModel = queueModel(name, source, length, isSearched);
}

async function queueModel(name: string, source: ModelSource, length: number | null, isSearched: boolean) {
  isOpen.value = true;
  try {
    const model: NewJob = { kind: "model", name, length_m: length };
    if ("files" in source) {
      model.uploads = [];
      for (const file of source.files) model.uploads.push(await send(file));
      if (source.boxes) model.boxes = source.boxes;
    } else {
      model.video_id = source.video;
      model.frame = source.frame;
      model.box = source.box;
    }
    const job = await postJob(model);
    if (isSearched) searchAfter.add(job.id);
  } catch (error) {
    if (!(error instanceof DOMException && error.name === "AbortError")) notices.notifyError(error);
  }
}

/** Takes files that were dropped or chosen. */
export function addFiles(files: readonly File[]) {
  if (!canAdd.value) {
    notices.notify(whyNotAdd(), "error");
    return;
  }
  const plan = planFiles(files);
  for (const problem of plan.problems) notices.notify(problem, "error");
  if (plan.videos.length > 0 && plan.model.length === 0 && !hasTargets()) {
    notices.notify("First say what is to be found: add photos or a CAD file of an object, alone or together with the video.", "error");
    return;
  }
  if (plan.videos.length > 0) isOpen.value = true;
  for (const video of plan.videos) {
    addVideo(video).catch((error: unknown) => {
      if (!(error instanceof DOMException && error.name === "AbortError")) notices.notifyError(error);
    });
  }
  if (plan.model.length > 0) askedModel.value = { files: plan.model };
}

/** Has a copy made of a video that this browser cannot play. Returns whether there will be one. */
export async function askForCopy(video: number): Promise<boolean> {
  if (!canAdd.value) return false;
  try {
    await postJob({ kind: "copy", video_id: video });
    return true;
  } catch (error) {
    // Made meanwhile, by another viewer.
    if (error instanceof ApiFailure && error.status === 409) void load.refresh();
    else notices.notifyError(error);
    return error instanceof ApiFailure && error.status === 409;
  }
}

/** Has a clip made of what a video shows of an object: of the moment that is shown, else of all. */
export async function askForClip(object: FoundObject) {
  const shown = state.shownTime.value;
  const here = object.moments.filter((one) => one.video_id === state.videoId.value);
  const now = here.find((one) => shown !== null && one.first_time_s <= shown && shown <= one.last_time_s);
  const clip: NewJob = { kind: "clip", object_id: object.id };
  const video = now?.video_id ?? here[0]?.video_id ?? object.moments[0]?.video_id;
  if (video !== undefined) clip.video_id = video;
  if (now && here.length > 1) {
    clip.from_s = now.first_time_s;
    clip.to_s = now.last_time_s;
  }
  isOpen.value = true;
  try {
    await postJob(clip);
  } catch (error) {
    notices.notifyError(error);
  }
}

/** Searches all videos again, for models that are new. */
export async function searchAll() {
  try {
    for (const video of state.videos.value) if (video.missing === null) await postJob({ kind: "index", video_id: video.id });
  } catch (error) {
    notices.notifyError(error);
  }
}

/** The video of the index that a job has searched; null: it is not there any more, has another name, or shares its name. */
export function videoOf(job: Job) {
  const videos = state.videos.value;
  if (job.video_id !== null) return videos.find((one) => one.id === job.video_id) ?? null;
  const named = videos.filter((one) => [one.name, baseName(one.name)].includes(job.title));
  return named.length === 1 ? (named[0] ?? null) : null;
}

/**
 * Asks whether to delete what was found in a video and to search it from the beginning; with telemetry, if it is given.
 * Reviews stay.
 */
export function askToSearchAgain(video: Video, telemetry: File | null = null) {
  const found = video.objects === 0 ? "" : `Its ${plural(video.objects, "object")} are found anew, which takes as long as the first search. `;
  confirm.ask({
    title: `Search ${baseName(video.name)} from the beginning${telemetry ? ` with ${telemetry.name}` : ""}?`,
    text: `What was found in it is deleted first. ${found}Reviews stay.`,
    label: "Search again",
    run: () => void searchFromBeginning(video.id, telemetry),
  });
}

async function searchFromBeginning(video: number, telemetry: File | null) {
  isOpen.value = true;
  try {
    const job: NewJob = { kind: "index", video_id: video, redo: true };
    if (telemetry) job.telemetry = await send(telemetry);
    await postJob(job);
  } catch (error) {
    if (!(error instanceof DOMException && error.name === "AbortError")) notices.notifyError(error);
  }
}

/** Refines the category model by what was accepted and rejected. */
export async function refineCategories() {
  isOpen.value = true;
  try {
    await postJob({ kind: "refine" });
  } catch (error) {
    notices.notifyError(error);
  }
}

export function cancel(job: Job) {
  cancelJob(job.id).catch(notices.notifyError);
}
