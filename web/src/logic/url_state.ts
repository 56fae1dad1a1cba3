// The selection and the area of the map in the address bar, so that a find can be sent to a colleague and Back works.

import { type Area, formatArea, parseArea } from "./area";

export interface UrlState {
  /** The object's key, which outlives a new search; its id, as in older links, where it has none. */
  object: string | number | null;
  video: number | null;
  /** s */
  time: number | null;
  area: Area | null;
}

function number(text: string | null): number | null {
  if (text === null || text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) && value >= 0 ? value : null;
}

export function parseUrl(search: string): UrlState {
  const query = new URLSearchParams(search);
  const whole = (name: string) => {
    const value = number(query.get(name));
    return value !== null && Number.isInteger(value) ? value : null;
  };
  // A key has dots.
  const key = query.get("object");
  const object = whole("object") ?? (key !== null && key.includes(".") ? key : null);
  return { object, video: whole("video"), time: number(query.get("t")), area: parseArea(query.get("area") ?? "") };
}

export function formatUrl(state: UrlState): string {
  const query = new URLSearchParams();
  if (state.object !== null) query.set("object", String(state.object));
  if (state.video !== null) query.set("video", String(state.video));
  if (state.time !== null) query.set("t", state.time.toFixed(3).replace(/\.?0+$/, ""));
  // Commas need no escape, and an area has many.
  const area = state.area === null ? "" : `${query.size > 0 ? "&" : ""}area=${formatArea(state.area)}`;
  const text = query.toString() + area;
  return text === "" ? "" : `?${text}`;
}
