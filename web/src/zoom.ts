// How the frame is looked at: zoomed in to a part of it, enlarged under the pointer, brighter or with more contrast,
// alone on the screen. What is drawn over the frame follows; nothing of it changes what is stored.
import { computed, effect, signal } from "@preact/signals";

import { type Size, STEP, type Zoom, lensAt, panBy, place, zoomBy, zoomTo } from "./logic/zoom";
import { frameCanvas, pictureVersion } from "./player";
import * as state from "./state";

export const zoom = signal<Zoom>(null);
/** Of the area that shows the frame, CSS px. */
export const area = signal<Size>({ width: 0, height: 0 });
/** Factors; 1: as filmed. */
export const brightness = signal(1);
export const contrast = signal(1);
export const hasLens = signal(false);
/** Where the pointer is in the area; null: elsewhere. */
export const pointer = signal<readonly [number, number] | null>(null);
/** The video has all of the page. */
export const isFull = signal(false);

/** px; of the lens */
export const LENS_RADIUS = 110;
const MIN_LENS = 2.5;
/** px of the area per px of the frame */
const MIN_LENS_SCALE = 2;

/** Sightings are in the pixels of the video as indexed, which a browser may deliver in another size. */
export const frame = computed((): Size => {
  const video = state.video.value;
  void pictureVersion.value;
  return { width: video?.width_px ?? frameCanvas.width, height: video?.height_px ?? frameCanvas.height };
});

export const at = computed(() => place(frame.value, area.value, zoom.value));

/** px of the screen per px of the frame */
export const screenScale = computed(() => at.value.scale * (window.devicePixelRatio || 1));

/** Where the lens draws the frame; null: there is none. */
export const lens = computed(() => {
  const point = pointer.value;
  if (!hasLens.value || point === null) return null;
  const factor = Math.max(MIN_LENS, MIN_LENS_SCALE / at.value.scale);
  return { point, at: lensAt(at.value, point, factor) };
});

/** Of a canvas; "none": as filmed. */
export const filter = computed(() =>
  brightness.value === 1 && contrast.value === 1 ? "none" : `brightness(${brightness.value}) contrast(${contrast.value})`,
);

const middle = (): [number, number] => [area.peek().width / 2, area.peek().height / 2];
const here = () => pointer.peek() ?? middle();

export const zoomIn = (point = here()) => (zoom.value = zoomBy(zoom.peek(), STEP * STEP, point, frame.peek(), area.peek()));
export const zoomOut = (point = here()) => (zoom.value = zoomBy(zoom.peek(), 1 / (STEP * STEP), point, frame.peek(), area.peek()));
export const zoomAt = (point: readonly [number, number], factor: number) => (zoom.value = zoomBy(zoom.peek(), factor, point, frame.peek(), area.peek()));
export const pan = (right: number, down: number) => (zoom.value = panBy(zoom.peek(), right, down, frame.peek(), area.peek()));
export const showWhole = () => (zoom.value = null);

/** One pixel of the video as one of the screen; a video smaller than that is enlarged. */
export function showNative(point = here()) {
  const native = 1 / (window.devicePixelRatio || 1);
  const whole = place(frame.peek(), area.peek(), null).scale;
  zoom.value = zoomTo(zoom.peek(), native > whole ? native : whole * 2, point, frame.peek(), area.peek());
}

/** Zooms in to a box of the frame, px, with what lies around it. */
export function showBox(box: readonly number[]) {
  const [x = 0, y = 0, width = 1, height = 1] = box;
  const { width: across, height: down } = area.peek();
  const scale = Math.min(across / width, down / height) / 2;
  const whole = place(frame.peek(), area.peek(), null).scale;
  zoom.value = scale <= whole ? null : zoomTo({ scale, centre: [x + width / 2, y + height / 2] }, scale, middle(), frame.peek(), area.peek());
}

/** Moves the frame so far that a box of it is seen. */
export function bringIntoView(box: readonly number[]) {
  const shown = zoom.peek();
  if (shown === null) return;
  const [x = 0, y = 0, width = 0, height = 0] = box;
  const centre = [x + width / 2, y + height / 2] as const;
  const { x: left, y: top, scale } = at.peek();
  const [right, down] = [left + centre[0] * scale, top + centre[1] * scale];
  if (right >= 0 && down >= 0 && right <= area.peek().width && down <= area.peek().height) return;
  zoom.value = zoomTo({ scale: shown.scale, centre }, shown.scale, middle(), frame.peek(), area.peek());
}

export function setFull(isWanted: boolean) {
  isFull.value = isWanted;
  // Where the browser refuses it, the video fills the page.
  if (isWanted && document.fullscreenEnabled) document.documentElement.requestFullscreen().catch(() => undefined);
  else if (document.fullscreenElement) document.exitFullscreen().catch(() => undefined);
}

document.addEventListener("fullscreenchange", () => {
  if (!document.fullscreenElement) isFull.value = false;
});

effect(() => {
  void state.videoId.value;
  zoom.value = null;
});
