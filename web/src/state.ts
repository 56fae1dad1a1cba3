// The state of the page: what the server has, what the user chose, and what follows from both. One selection rules list,
// video and map. Views read these signals; load.ts, selection.ts and reviews.ts change them.
import { computed, effect, signal } from "@preact/signals";

import type { CameraPath, FoundObject, ObjectDetail, Project, Video } from "./api/types";
import { NO_FILTERS, type Filters, makeMatcher } from "./logic/filters";
import { COORDINATE_STYLES, type CoordinateStyle, baseName, formatTime } from "./logic/format";
import { type Mark, markAt } from "./logic/marks";
import { type SeenIn, seenIn } from "./logic/moments";
import type { FrameTable } from "./logic/frame_table";
import { me } from "./me";
import * as objects from "./objects";

export type Load<T> = { state: "loading" } | { state: "ready"; value: T } | { state: "failed"; message: string };

// ---- what the server has

export const project = signal<Load<Project>>({ state: "loading" });
export const videos = signal<Video[]>([]);
export const isConnected = signal(true);
/** Changes with the index that the server shows. */
export const indexVersion = signal(0);

// ---- what the user chose

export const filters = signal<Filters>(NO_FILTERS);
/** The list leaves out what the filters exclude; else it greys that out. */
export const isOnlyMatching = signal(true);
export const sort = signal<objects.Sort>("queue");
export const selectedId = signal<number | null>(null);
export const videoId = signal<number | null>(null);
/** The frame that the video shows; null before it shows one. */
export const shownFrame = signal<number | null>(null);
export const isPlaying = signal(false);
export const isOverlayHidden = signal(false);
/** The next drag over the frame boxes an object. */
export const isBoxing = signal(false);
/** An area of the map is being drawn. */
export const isDrawingArea = signal(false);
/** A click on the map measures to there. */
export const isMeasuring = signal(false);
/** The reader has decided about the selected object, and nothing is left to decide. */
export const isQueueDone = signal(false);
export const isHelpOpen = signal(false);
export const coordinateStyle = signal<CoordinateStyle>(
  COORDINATE_STYLES.find((one) => one === localStorage.getItem("coordinates")) ?? "decimal",
);
export type Theme = "system" | "dark" | "light";
export const theme = signal<Theme>((localStorage.getItem("theme") as Theme | null) ?? "system");

const lightSystem = window.matchMedia("(prefers-color-scheme: light)");
const isSystemLight = signal(lightSystem.matches);
lightSystem.addEventListener("change", (event) => (isSystemLight.value = event.matches));
/** The colours shown: the chosen ones, or the system's. */
export const colours = computed(() => (theme.value === "system" ? (isSystemLight.value ? "light" : "dark") : theme.value));

/** Where the video should go. Each request is a new object, also to the same frame. */
export const seekRequest = signal<{ video: number; time: number } | null>(null);

// ---- what follows from both

export const matcher = computed(() => makeMatcher(filters.value, me.value));
export const selected = computed(() => (selectedId.value === null ? null : (objects.objectOf(selectedId.value) ?? null)));
export const video = computed(() => videos.value.find((one) => one.id === videoId.value) ?? null);
export const canReview = computed(() => project.value.state === "ready" && project.value.value.can_review);
export const models = computed(() => (project.value.state === "ready" ? project.value.value.models : []));
export const modelNames = computed(() => models.value.map((one) => one.name));
export const categoryNames = computed(
  () => new Set(models.value.filter((one) => one.kind === "category" || one.kind === "boxed").map((one) => one.name)),
);
const modelById = computed(() => new Map(models.value.map((one) => [one.id, one.name])));
export const modelName = (id: number) => modelById.value.get(id) ?? "";

export const frameTable = signal<Load<FrameTable>>({ state: "loading" });
export const cameraPath = signal<CameraPath | null>(null);
export const detail = signal<Load<ObjectDetail> | null>(null);
export const shownTime = computed(() =>
  shownFrame.value !== null && frameTable.value.state === "ready" ? frameTable.value.value.timeOf(shownFrame.value) : null,
);

export const markOf = (model: string): Mark => markAt(modelNames.value.indexOf(model));
export const colourOf = (model: string) => markOf(model).colour;

/** A time of a video, with its name where there are several. */
export function describeTime(video: number, time: number): string {
  const name = videos.value.length > 1 ? videos.value.find((one) => one.id === video)?.name : undefined;
  return name === undefined ? formatTime(time) : `${formatTime(time)} in ${baseName(name)}`;
}

/** When each video shows an object. */
export const seenOf = (object: FoundObject): SeenIn[] => seenIn(object, videos.value);

export function setFilters(change: Partial<Filters>) {
  filters.value = { ...filters.value, ...change };
}

// ---- what the browser keeps

effect(() => localStorage.setItem("coordinates", coordinateStyle.value));

effect(() => {
  localStorage.setItem("theme", theme.value);
  document.documentElement.dataset["theme"] = colours.value;
});
