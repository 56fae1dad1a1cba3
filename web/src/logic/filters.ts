// Filters of the list: they leave objects out, or grey them out.
import type { FoundObject, Verdict } from "../api/types";
import { type Area, formatArea, isInArea } from "./area";
import { isPosition, readPosition } from "./coordinates";
import { ownDecision } from "./decisions";

export interface Circle {
  latitude: number;
  longitude: number;
  metres: number;
}

/**
 * none, accepted, rejected: of the team; own, not_own: whether the reader has decided; disputed: some accepted it, some rejected it.
 */
export type ReviewFilter = "all" | "none" | Exclude<Verdict, null> | "own" | "not_own" | "disputed";

export interface Filters {
  /** Words of the model's name, "near 52.52,13.40 200 m", or a position alone. */
  text: string;
  /** Names of models; empty: all. */
  models: readonly string[];
  /** null: all */
  video: number | null;
  review: ReviewFilter;
  minScore: number;
  /** Drawn on the map; null: everywhere. */
  area: Area | null;
  /** In force for the team: the least score, by the model's name. Asked of what nobody has decided. */
  thresholds: ReadonlyMap<string, number>;
}

export const NO_FILTERS: Filters = { text: "", models: [], video: null, review: "all", minScore: 0, area: null, thresholds: new Map() };

const NEAR = /\bnear\s+(?=\S)/i;
const RADIUS = /^\s*,?\s+(\d+(?:\.\d+)?)\s*(km|m)?(?!\w)/i;
/** A place that is not complete, as while it is typed. */
const NEAR_PART = /\bnear\s+-?\d.*$/i;
/** m, of a place without a radius */
const NEAR_RADIUS = 200;

/** The place that a text names, after "near" or as all of it, and what is left of the text. */
function takePlace(text: string): { place: { latitude: number; longitude: number }; radius: RegExpExecArray | null; words: string } | null {
  const near = NEAR.exec(text);
  const isBare = near === null && isPosition(text.replace(/\s+\d+(?:\.\d+)?\s*k?m\s*$/i, ""));
  if (near === null && !isBare) return null;
  const place = readPosition(near ? text.slice(near.index + near[0].length) : text.trim());
  if (place === null) return null;
  const radius = RADIUS.exec(place.rest);
  const after = place.rest.slice(radius?.[0].length ?? 0);
  // A bare place stands alone.
  if (near === null && after.trim() !== "") return null;
  return { place, radius, words: `${near ? text.slice(0, near.index) : ""} ${after}` };
}

/** Splits a query into words and a circle. `hint`: what is taken for granted, or what is missing. */
export function parseQuery(text: string): { words: string[]; near: Circle | null; hint: string | null } {
  const found = takePlace(text);
  const radius = found?.radius ?? null;
  const { latitude, longitude } = found?.place ?? { latitude: NaN, longitude: NaN };
  const isOnEarth = Math.abs(latitude) <= 90 && Math.abs(longitude) <= 180;
  const metres = radius === null ? NEAR_RADIUS : Number(radius[1]) * (radius[2]?.toLowerCase() === "km" ? 1000 : 1);
  const near = found && isOnEarth ? { latitude, longitude, metres } : null;
  const hintOf = () => {
    if (found && !isOnEarth) return "near: a latitude lies between −90 and 90, a longitude between −180 and 180.";
    if (found) return radius === null ? `Within ${NEAR_RADIUS} m, as no radius is given.` : null;
    return NEAR_PART.test(text) ? "near takes latitude and longitude, MGRS or UTM: near 52.52,13.40 200 m" : null;
  };
  const words = (found?.words ?? text.replace(NEAR_PART, " "))
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== "");
  return { words, near, hint: hintOf() };
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

function matchesReview(object: FoundObject, wanted: ReviewFilter, me: string): boolean {
  switch (wanted) {
    case "all":
      return true;
    case "own":
    case "not_own":
      return ((ownDecision(object, me)?.verdict ?? null) !== null) === (wanted === "own");
    case "disputed":
      return object.is_disputed;
    default:
      return (object.review?.verdict ?? "none") === wanted;
  }
}

/** What the reader goes on to after a decision: what the filter is for, else what nobody has decided. */
export const nextReview = (shown: ReviewFilter): ReviewFilter =>
  shown === "own" || shown === "not_own" || shown === "disputed" ? shown : "none";

/** @param me whose decisions `own` and `not_own` mean */
export function makeMatcher(filters: Filters, me: string): (object: FoundObject) => boolean {
  const { words, near } = parseQuery(filters.text);
  return (object) => {
    if (object.score < filters.minScore) return false;
    const isDecided = (object.review?.verdict ?? null) !== null;
    if (!isDecided && object.score < (filters.thresholds.get(object.model) ?? 0)) return false;
    if (filters.models.length > 0 && !filters.models.includes(object.model)) return false;
    if (filters.video !== null && !object.moments.some((one) => one.video_id === filters.video)) return false;
    if (!matchesReview(object, filters.review, me)) return false;
    const name = `${object.model} ${object.id} ${object.review?.note ?? ""}`.toLowerCase();
    if (!words.every((word) => name.includes(word))) return false;
    if (near === null && filters.area === null) return true;
    if (object.place === null) return false;
    const { latitude_deg: latitude, longitude_deg: longitude } = object.place;
    if (filters.area !== null && !isInArea(filters.area, [longitude, latitude])) return false;
    return near === null || metresBetween({ latitude, longitude }, near) <= near.metres;
  };
}

/** Whether anything is left out. */
export const isFiltered = (filters: Filters) => isChosen(filters) || filters.thresholds.size > 0;

/** Whether the reader has chosen a filter; thresholds are the team's. */
export function isChosen(filters: Filters): boolean {
  return (
    filters.text.trim() !== "" ||
    filters.models.length > 0 ||
    filters.video !== null ||
    filters.review !== "all" ||
    filters.minScore > 0 ||
    filters.area !== null
  );
}

/** The filters as parameters of the API, for what the page has not loaded. The same meaning as makeMatcher's. */
export function filterParams(filters: Filters, me: string): URLSearchParams {
  const { words, near } = parseQuery(filters.text);
  const params = new URLSearchParams();
  if (filters.models.length > 0) params.set("model", filters.models.join(","));
  if (filters.video !== null) params.set("video", String(filters.video));
  if (filters.review !== "all") params.set("review", filters.review);
  if (filters.review === "own" || filters.review === "not_own") params.set("reviewer", me);
  if (filters.minScore > 0) params.set("min_score", String(filters.minScore));
  if (near !== null) params.set("near", `${near.latitude},${near.longitude},${near.metres}`);
  if (filters.area !== null) params.set("area", formatArea(filters.area));
  if (filters.thresholds.size > 0) params.set("thresholds", "applied");
  if (words.length > 0) params.set("q", words.slice(0, 16).join(" "));
  return params;
}
