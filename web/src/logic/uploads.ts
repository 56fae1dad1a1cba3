// What dropped files are, what is to be done with them, and how far that is.
import type { Job } from "../api/types";

const VIDEO = ["mp4", "m4v", "mov", "mkv", "webm", "avi", "ts", "m2ts", "mts", "mpg", "mpeg", "wmv", "flv"];
const CAD = ["glb", "gltf", "obj", "ac", "dae", "3ds", "ply", "stl"];
const PHOTO = ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "webp", "ppm"];
const TELEMETRY = ["csv", "srt", "klv"];

export type FileKind = "video" | "cad" | "photo" | "telemetry" | "other";

export function kindOf(name: string): FileKind {
  const ending = /\.([^.]+)$/.exec(name.toLowerCase())?.[1] ?? "";
  if (VIDEO.includes(ending)) return "video";
  if (CAD.includes(ending)) return "cad";
  if (PHOTO.includes(ending)) return "photo";
  if (TELEMETRY.includes(ending)) return "telemetry";
  return "other";
}

export interface Plan<F> {
  /** Each is searched; telemetry only beside a single video. */
  videos: { file: F; telemetry: F | null }[];
  /** Files of one model. */
  model: F[];
  /** Why files are left out. */
  problems: string[];
}

/** Sorts files that were dropped together. */
export function planFiles<F extends { name: string }>(files: readonly F[]): Plan<F> {
  const of = (kind: FileKind) => files.filter((one) => kindOf(one.name) === kind);
  const [videos, telemetry, cad, photos, others] = [of("video"), of("telemetry"), of("cad"), of("photo"), of("other")];
  const problems = others.map((one) => `${one.name}: neither a video, nor a photo, nor a CAD file.`);
  const isPaired = videos.length === 1 && telemetry.length === 1;
  if (telemetry.length > 0 && !isPaired) {
    problems.push("Telemetry is taken with one video at a time: drop each video together with its own file.");
  }
  if (cad.length > 1 || (cad.length > 0 && photos.length > 0)) {
    problems.push("A model is made from photos or from one CAD file: drop one model at a time.");
  }
  const isModel = cad.length === 1 ? photos.length === 0 : cad.length === 0 && photos.length > 0;
  return {
    videos: videos.map((file) => ({ file, telemetry: isPaired ? (telemetry[0] ?? null) : null })),
    model: isModel ? [...cad, ...photos] : [],
    problems,
  };
}

/** What a server takes as the name of a model, of what was typed: accents go, other characters become dashes. */
export function cleanModelName(text: string): string {
  const plain = text.replaceAll("ß", "ss").normalize("NFKD").replace(/\p{M}/gu, "");
  return plain.replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[-._]+/, "");
}

/** A name for a model, from the name of a file. */
export function modelNameOf(file: string): string {
  return cleanModelName(file.replace(/\.[^.]+$/, "").toLowerCase()).replace(/[-.]+$/, "") || "model";
}

function short(seconds: number): string {
  if (seconds < 60) return `${Math.max(1, Math.round(seconds))} s`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

/** A time that is left, short. */
export const formatLeft = (seconds: number) => `${short(seconds)} left`;

/** A search that is less than this behind its source keeps up with it. */
const KEEPS_UP_S = 1;

/** How far the search of a live source is behind it at most; null: it keeps up, does not run, or it is not known. */
export function formatBehind(job: Pick<Job, "kind" | "state" | "behind_s">): string | null {
  const isRunning = job.kind === "live" && job.state === "running";
  return isRunning && job.behind_s !== null && job.behind_s > KEEPS_UP_S ? `up to ${short(Math.ceil(job.behind_s))} behind` : null;
}
