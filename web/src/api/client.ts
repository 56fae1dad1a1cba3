// The API of `victorious serve` as functions. A failed call throws ApiFailure, whose message is fit to be shown.
import type { components } from "./schema";
import type { ApiErrorBody, CameraPath, Cluster, Counts, Coverage, Evidence, Job, ModelViews, NewJob, ObjectDetail, Project, Review, ReviewedObject, Session, ThresholdList, Verdict } from "./types";
import { withoutField } from "../logic/errors";
import { KeepaliveBudget } from "../logic/keepalive";
import { type SightingPages, inHalves } from "../logic/halves";

const ROOT = "/api/v1";

export class ApiFailure extends Error {
  constructor(
    message: string,
    /** HTTP status; 0: the server does not answer. */
    readonly status: number,
  ) {
    super(message);
  }
}

let tellUnauthenticated = () => {};

/** Calls back when the server asks for a log-in: there was no session, or it has ended. */
export function onUnauthenticated(handler: () => void) {
  tellUnauthenticated = handler;
}

let tellUnreachable = () => {};

/** Calls back when the server does not answer, be it gone or hung. */
export function onUnreachable(handler: () => void) {
  tellUnreachable = handler;
}

/** An answer may take long, of a server that is busy with it; a server that hangs does not answer this either. */
const SILENT_MS = 4000;
const ALIVE_MS = 4000;

/** Whether the server answers anything in time. */
export async function isAlive(): Promise<boolean> {
  const abort = new AbortController();
  const timer = setTimeout(() => abort.abort(), ALIVE_MS);
  try {
    await fetch(`${ROOT}/session`, { signal: abort.signal, cache: "no-store" });
    return true;
  } catch {
    return false;
  } finally {
    clearTimeout(timer);
  }
}

const unreachable = () => {
  tellUnreachable();
  return new ApiFailure("The server does not answer.", 0);
};

async function ask<T>(path: string, init: RequestInit | undefined, read: (response: Response) => Promise<T>): Promise<T> {
  const abort = new AbortController();
  const cancel = () => abort.abort();
  init?.signal?.addEventListener("abort", cancel);
  if (init?.signal?.aborted) cancel();
  let [isHung, isDone] = [false, false];
  let timer: ReturnType<typeof setTimeout>;
  const watch = async () => {
    const lives = await isAlive();
    if (isDone) return;
    isHung = !lives;
    if (isHung) cancel();
    else timer = setTimeout(() => void watch(), SILENT_MS);
  };
  timer = setTimeout(() => void watch(), SILENT_MS);
  try {
    const response = await fetch(ROOT + path, { ...init, signal: abort.signal });
    if (response.ok) return await read(response);
    const body = (await response.json().catch(() => null)) as ApiErrorBody | null;
    if (response.status === 401 && path !== "/session") tellUnauthenticated();
    throw new ApiFailure(body ? withoutField(body) : `The server answers ${response.status}.`, response.status);
  } catch (error) {
    // The browser says a failed connection as a TypeError.
    if (isHung || error instanceof TypeError) throw unreachable();
    throw error;
  } finally {
    isDone = true;
    clearTimeout(timer);
    init?.signal?.removeEventListener("abort", cancel);
  }
}

const request = <T>(path: string, init?: RequestInit) => ask(path, init, (response) => response.json() as Promise<T>);

const send = <T>(path: string, method: "POST" | "PUT", body: unknown, more: RequestInit = {}) =>
  request<T>(path, { method, headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), ...more });

export const getSession = () => request<Session>("/session");
export const postLogIn = (name: string, password: string) => send<Session>("/session", "POST", { name, password });
export const postLogOut = () => send<Session>("/session/end", "POST", {});

export const getProject = () => request<Project>("/project");

export const listVideos = async () =>
  (await request<components["schemas"]["VideoList"]>("/videos")).videos;

/** Those whose camera may have shown a place. */
export const listVideosShowing = async (latitude: number, longitude: number) =>
  (await request<components["schemas"]["VideoList"]>(`/videos?shows=${latitude},${longitude}`)).videos;

export const listObjects = (params: URLSearchParams, signal?: AbortSignal) =>
  request<components["schemas"]["ObjectList"]>(`/objects?${params}`, signal ? { signal } : undefined);

/** A GeoPackage. */
export const getObjectPackage = (params: URLSearchParams) => ask(`/objects/geopackage?${params}`, undefined, (response) => response.blob());

export const countObjects = (params: URLSearchParams, signal?: AbortSignal) =>
  request<Counts>(`/objects/counts?${params}`, signal ? { signal } : undefined);

export const getObject = (id: number, signal: AbortSignal) => request<ObjectDetail>(`/objects/${id}`, { signal });

export const getTimes = async (video: number, signal: AbortSignal) =>
  (await request<components["schemas"]["FrameTimes"]>(`/videos/${video}/times`, { signal })).times_s;

const getSightings = (path: string) => (from: number, to: number) =>
  request<components["schemas"]["SightingList"]>(`${path}/sightings?from=${from}&to=${to}&limit=10000`);

/** By time, at most 10,000 in each request. */
export const listSightings = (video: number, from: number, to: number) => inHalves(getSightings(`/videos/${video}`), from, to);

/** Of one object, seen from `from` to `to`, by video and frame. */
export const listObjectSightings = async (object: number, from: number, to: number): Promise<SightingPages> => {
  const { sightings, truncated } = await inHalves(getSightings(`/objects/${object}`), from, to);
  return { sightings: sightings.sort((a, b) => a.video_id - b.video_id || a.frame - b.frame), truncated };
};

export const getCameraPath = (video: number, signal: AbortSignal) =>
  request<CameraPath>(`/videos/${video}/camera`, { signal });

const keepalive = new KeepaliveBudget();

/** Of a few, sent also if the page is left meanwhile. */
export async function putReview(object: number, verdict: Verdict, note: string, reviewer: string): Promise<ReviewedObject> {
  const body = { verdict, note, reviewer };
  const bytes = new TextEncoder().encode(JSON.stringify(body)).length;
  const isKept = keepalive.take(bytes);
  try {
    return await send<ReviewedObject>(`/objects/${object}/review`, "PUT", body, { keepalive: isKept });
  } finally {
    if (isKept) keepalive.give(bytes);
  }
}

/** Of all persons. */
export const listDecisions = async (object: number, signal?: AbortSignal): Promise<Review[]> =>
  (await request<components["schemas"]["DecisionList"]>(`/objects/${object}/decisions`, signal ? { signal } : undefined)).decisions;

/**
 * Moments of a group are one object, those of different groups different ones.
 * @param undo  a correction that is taken back instead
 */
export const regroupObjects = (groups: readonly (readonly number[])[], undo?: number) =>
  send<components["schemas"]["RegroupedObjects"]>("/objects/regroup", "POST", undo === undefined ? { groups } : { groups, undo });

export const getThresholds = () => request<ThresholdList>("/thresholds");
/** For the team; null: none any more. */
export const putThreshold = (model: number, min_score: number | null, reviewer: string) =>
  send<ThresholdList>(`/models/${model}/threshold`, "PUT", { min_score, reviewer });

export const videoFileUrl = (video: number) => `${ROOT}/videos/${video}/file`;
export const videoCopyUrl = (video: number) => `${ROOT}/videos/${video}/copy`;
export const frameUrl = (video: number, frame: number) => `${ROOT}/videos/${video}/frames/${frame}`;
/** @param look  another one is another address: a browser shows an image that it has, whatever the server would send */
export const thumbnailUrl = (object: number, width: number, look?: string) =>
  `${ROOT}/objects/${object}/thumbnail?width=${width}${look === undefined ? "" : `&v=${look}`}`;
/** Of one frame; null: of the object's best sighting. */
export const getEvidence = (object: number, at: { video: number; frame: number } | null, signal: AbortSignal) =>
  request<Evidence>(`/objects/${object}/evidence${at === null ? "" : `?video=${at.video}&frame=${at.frame}`}`, { signal });

/** How well the ground of a video was searched for a model. */
export const getCoverage = (model: number, video: number, signal: AbortSignal) =>
  request<Coverage>(`/models/${model}/coverage?video=${video}`, { signal });
export const getModelViews = (model: number, signal: AbortSignal) => request<ModelViews>(`/models/${model}/views`, { signal });
/** All pixels that the model has of a view. */
export const fullViewUrl = (model: number, view: number) => `${viewUrl(model, view)}?size=full`;
export const viewUrl = (model: number, view: number) => `${ROOT}/models/${model}/views/${view}`;
/** What workers do that share the videos of an index in a database. */
export const getCluster = () => request<Cluster>("/cluster");
export const listJobs = async () => (await request<components["schemas"]["JobList"]>("/jobs")).jobs;

export const postJob = (job: NewJob) => send<Job>("/jobs", "POST", job);
export const jobFileUrl = (job: number, name: string) => `${ROOT}/jobs/${job}/files/${name}`;
export const cancelJob = (job: number) => send<Job>(`/jobs/${job}/cancel`, "POST", {});
export const retryJob = (job: number) => send<Job>(`/jobs/${job}/retry`, "POST", {});
export const removeJob = (job: number) => request<unknown>(`/jobs/${job}`, { method: "DELETE" });

/** Sends a file. Not by fetch, which does not say how far it is. */
export function uploadFile(file: File, progress: (done: number) => void, signal: AbortSignal) {
  return new Promise<components["schemas"]["Upload"]>((resolve, reject) => {
    const sender = new XMLHttpRequest();
    sender.open("POST", `${ROOT}/uploads?name=${encodeURIComponent(file.name)}`);
    sender.setRequestHeader("Content-Type", "application/octet-stream");
    sender.responseType = "json";
    sender.upload.onprogress = (event) => progress(event.total > 0 ? event.loaded / event.total : 0);
    sender.onload = () => {
      if (sender.status === 200) return resolve(sender.response as components["schemas"]["Upload"]);
      const body = sender.response as ApiErrorBody | null;
      if (sender.status === 401) tellUnauthenticated();
      reject(new ApiFailure(body?.message ?? `The server answers ${sender.status}.`, sender.status));
    };
    sender.onerror = () => reject(new ApiFailure(`${file.name}: the server broke off the upload.`, 0));
    sender.onabort = () => reject(new DOMException("cancelled", "AbortError"));
    signal.addEventListener("abort", () => sender.abort());
    sender.send(file);
  });
}

/** The PMTiles file of the base map. */
export const BASE_MAP_URL = `${ROOT}/base_map`;

/** An address of MapLibre's tiles. */
export const tilesUrl = (params: URLSearchParams) => `${location.origin}${ROOT}/tiles/{z}/{x}/{y}?${params}`;
