// Numbers as texts. Unknown is a dash.

import { formatMgrs, formatUtm } from "./mgrs";

export const DASH = "–";

/** m:ss.cc, with hours from one hour on. */
export function formatTime(seconds: number): string {
  const centis = Math.round(Math.max(0, seconds) * 100);
  const hours = Math.floor(centis / 360_000);
  const minutes = Math.floor(centis / 6000) % 60;
  const rest = ((centis % 6000) / 100).toFixed(2).padStart(5, "0");
  return hours > 0 ? `${hours}:${String(minutes).padStart(2, "0")}:${rest}` : `${minutes}:${rest}`;
}

/** Both ends of an interval, short. */
export function formatSpan(first: number, last: number): string {
  if (last < 60) return `${first.toFixed(1)} – ${last.toFixed(1)} s`;
  const short = (time: number) => formatTime(Math.floor(time)).replace(/\.00$/, "");
  return `${short(first)} – ${short(last)}`;
}

export function formatMetres(metres: number | null | undefined): string {
  if (metres === null || metres === undefined || !Number.isFinite(metres)) return DASH;
  if (metres >= 10_000) return `${(metres / 1000).toFixed(0)} km`;
  if (metres >= 1000) return `${(metres / 1000).toFixed(1)} km`;
  return metres >= 100 ? `${metres.toFixed(0)} m` : `${metres.toFixed(1)} m`;
}

export function formatAngle(degrees: number | null): string {
  return degrees === null ? DASH : `${((Math.round(degrees) % 360) + 360) % 360}°`;
}

export const COORDINATE_STYLES = ["decimal", "dms", "mgrs", "utm"] as const;
export type CoordinateStyle = (typeof COORDINATE_STYLES)[number];

function dms(degrees: number, positive: string, negative: string): string {
  const hundredths = Math.round(Math.abs(degrees) * 360_000);
  const whole = Math.floor(hundredths / 360_000);
  const minutes = Math.floor(hundredths / 6000) % 60;
  const seconds = ((hundredths % 6000) / 100).toFixed(2).padStart(5, "0");
  return `${whole}°${String(minutes).padStart(2, "0")}′${seconds}″${degrees < 0 ? negative : positive}`;
}

export function formatPosition(latitude: number, longitude: number, style: CoordinateStyle): string {
  const decimal = `${latitude.toFixed(6)}, ${longitude.toFixed(6)}`;
  switch (style) {
    case "decimal":
      return decimal;
    case "dms":
      return `${dms(latitude, "N", "S")} ${dms(longitude, "E", "W")}`;
    case "mgrs":
      return formatMgrs(latitude, longitude) ?? `${decimal} (no MGRS there)`;
    case "utm":
      return formatUtm(latitude, longitude) ?? `${decimal} (no UTM there)`;
  }
}

/** A probability. What is less than 1 is not shown as 1: it lies below a threshold of 1. */
export function formatScore(score: number, digits = 2): string {
  const text = score.toFixed(digits);
  return score < 1 && Number(text) === 1 ? `>${(1 - 10 ** -digits).toFixed(digits)}` : text;
}

/** Of 100 objects with such a score, how many are real. */
export function explainScore(score: number): string {
  if (score < 1 && score > 0.99) return "Of 100 objects with this score, more than 99 are real";
  return `Of 100 objects with this score, about ${Math.round(score * 100)} are real`;
}

/** An expected number of objects. */
export function formatExpected(count: number): string {
  return count >= 100 ? Math.round(count).toLocaleString("en") : count.toFixed(1);
}

/** The last part of a path, or of an address without its parameters. */
export function baseName(path: string): string {
  const name = path.includes("://") ? (path.split("?")[0] ?? path) : path;
  return name.split("/").filter(Boolean).pop() ?? path;
}

/** What a sighting rests on: the matches that agree on its pose, or its edges, which leave none to count. */
export const describeMatches = (matches: number) => (matches === 0 ? "by shape" : plural(matches, "match", "matches"));

export function plural(count: number, noun: string, many = `${noun}s`): string {
  return `${count.toLocaleString("en")} ${count === 1 ? noun : many}`;
}
