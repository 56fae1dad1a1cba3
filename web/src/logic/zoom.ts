// Where the frame lies in the area that shows it: whole, or zoomed in to a part of it.
import { type Fit, fit } from "./overlay";

export interface Size {
  width: number;
  height: number;
}

/** Part of the frame that is zoomed in to; null: all of it. */
export type Zoom = {
  /** px of the area per px of the frame */
  scale: number;
  /** What of the frame lies in the middle of the area, px. */
  centre: readonly [number, number];
} | null;

/** px of the area per px of the frame; more shows nothing new. */
const MAX_SCALE = 32;
export const STEP = 1.25;

const clamp = (value: number, low: number, high: number) => (low > high ? (low + high) / 2 : Math.min(Math.max(value, low), high));

/** The middle stays so that no more than needed of the area is empty. */
function withinFrame(zoom: NonNullable<Zoom>, frame: Size, area: Size): NonNullable<Zoom> {
  const side = (at: number, length: number, room: number) => clamp(at, room / 2 / zoom.scale, length - room / 2 / zoom.scale);
  return { scale: zoom.scale, centre: [side(zoom.centre[0], frame.width, area.width), side(zoom.centre[1], frame.height, area.height)] };
}

/** Where the frame lies in the area. */
export function place(frame: Size, area: Size, zoom: Zoom): Fit {
  const whole = fit(frame.width, frame.height, area.width, area.height);
  if (zoom === null || zoom.scale <= whole.scale) return whole;
  const { scale, centre } = withinFrame(zoom, frame, area);
  return { scale, x: area.width / 2 - centre[0] * scale, y: area.height / 2 - centre[1] * scale };
}

/** Zooms to a scale; what of the frame lies under a point of the area stays there. */
export function zoomTo(zoom: Zoom, scale: number, point: readonly [number, number], frame: Size, area: Size): Zoom {
  const whole = fit(frame.width, frame.height, area.width, area.height);
  const next = Math.min(scale, Math.max(MAX_SCALE, whole.scale));
  if (next <= whole.scale * 1.001) return null;
  const before = place(frame, area, zoom);
  const [x, y] = [(point[0] - before.x) / before.scale, (point[1] - before.y) / before.scale];
  const centre = [x + (area.width / 2 - point[0]) / next, y + (area.height / 2 - point[1]) / next] as const;
  return withinFrame({ scale: next, centre }, frame, area);
}

export function zoomBy(zoom: Zoom, factor: number, point: readonly [number, number], frame: Size, area: Size): Zoom {
  return zoomTo(zoom, place(frame, area, zoom).scale * factor, point, frame, area);
}

/** Moves the frame in the area, px of the area. */
export function panBy(zoom: Zoom, right: number, down: number, frame: Size, area: Size): Zoom {
  if (zoom === null) return null;
  const { scale, centre } = withinFrame(zoom, frame, area);
  return withinFrame({ scale, centre: [centre[0] - right / scale, centre[1] - down / scale] }, frame, area);
}

/** What of the frame the area shows: x, y, width, height, px of the frame. */
export function shownPart(frame: Size, area: Size, at: Fit): [number, number, number, number] {
  const [left, top] = [Math.max(-at.x / at.scale, 0), Math.max(-at.y / at.scale, 0)];
  const [right, bottom] = [Math.min((area.width - at.x) / at.scale, frame.width), Math.min((area.height - at.y) / at.scale, frame.height)];
  return [left, top, right - left, bottom - top];
}

/** How much one sees a point of the area enlarged: a lens of the same picture. */
export function lensAt(at: Fit, point: readonly [number, number], factor: number): Fit {
  return { scale: at.scale * factor, x: point[0] - (point[0] - at.x) * factor, y: point[1] - (point[1] - at.y) * factor };
}
