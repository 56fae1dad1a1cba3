// Filters of the list: they grey objects out, and say what a threshold costs.
import type { FoundObject, Verdict } from "../api/types";

export interface Circle {
  latitude: number;
  longitude: number;
  metres: number;
}

export interface Filters {
  /** Words of the model's name, or "near 52.52,13.40 200 m". */
  text: string;
  /** Names of models; empty: all. */
  models: readonly string[];
  /** null: all */
  video: number | null;
  review: "all" | "none" | Exclude<Verdict, null>;
  minScore: number;
}

export const NO_FILTERS: Filters = { text: "", models: [], video: null, review: "all", minScore: 0 };

const NEAR = /\bnear\s+(-?\d+(?:\.\d+)?)\s*,\s*(-?\d+(?:\.\d+)?)\s*,?\s+(\d+(?:\.\d+)?)\s*(km|m)?\b/i;

/** Splits a query into words and a circle. */
export function parseQuery(text: string): { words: string[]; near: Circle | null } {
  const match = NEAR.exec(text);
  const near = match
    ? {
        latitude: Number(match[1]),
        longitude: Number(match[2]),
        metres: Number(match[3]) * (match[4]?.toLowerCase() === "km" ? 1000 : 1),
      }
    : null;
  const words = text
    .replace(NEAR, " ")
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== "");
  return { words, near };
}

/** Distance on the ground, m; flat within some kilometres. */
export function metresBetween(a: { latitude: number; longitude: number }, b: { latitude: number; longitude: number }) {
  const radians = Math.PI / 180;
  const radius = 6_371_000;
  const half = ((b.latitude - a.latitude) * radians) / 2;
  const halfEast = ((b.longitude - a.longitude) * radians) / 2;
  const h =
    Math.sin(half) ** 2 +
    Math.cos(a.latitude * radians) * Math.cos(b.latitude * radians) * Math.sin(halfEast) ** 2;
  return 2 * radius * Math.asin(Math.min(1, Math.sqrt(h)));
}

export function makeMatcher(filters: Filters): (object: FoundObject) => boolean {
  const { words, near } = parseQuery(filters.text);
  return (object) => {
    if (object.score < filters.minScore) return false;
    if (filters.models.length > 0 && !filters.models.includes(object.model)) return false;
    if (filters.video !== null && !object.moments.some((one) => one.video_id === filters.video)) return false;
    if (filters.review !== "all" && (object.review?.verdict ?? "none") !== filters.review) return false;
    const name = `${object.model} ${object.id} ${object.review?.note ?? ""}`.toLowerCase();
    if (!words.every((word) => name.includes(word))) return false;
    if (near === null) return true;
    if (object.place === null) return false;
    const { latitude_deg: latitude, longitude_deg: longitude } = object.place;
    return metresBetween({ latitude, longitude }, near) <= near.metres;
  };
}

export function isFiltered(filters: Filters): boolean {
  return (
    filters.text.trim() !== "" ||
    filters.models.length > 0 ||
    filters.video !== null ||
    filters.review !== "all" ||
    filters.minScore > 0
  );
}

/** What a threshold costs. A score is the probability that an object is real. */
export function thresholdCost(objects: readonly FoundObject[], minScore: number) {
  let falseAlarms = 0;
  let misses = 0;
  for (const { score } of objects) {
    if (score >= minScore) falseAlarms += 1 - score;
    else misses += score;
  }
  return { falseAlarms, misses };
}

/** Unreviewed objects first, each group by rank. */
export function queueOrder(objects: readonly FoundObject[]): FoundObject[] {
  const isDone = (object: FoundObject) => (object.review?.verdict ? 1 : 0);
  return [...objects].sort((a, b) => isDone(a) - isDone(b) || a.rank - b.rank);
}
