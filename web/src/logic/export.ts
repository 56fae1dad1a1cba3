// The objects of the list as files: a table, and points for a map.
import type { FeatureCollection, Point } from "geojson";

import type { FoundObject } from "../api/types";

/** Of all persons: "rejected by bob; accepted by ann". */
const listDecisions = (object: FoundObject) =>
  object.decisions.flatMap((one) => (one.verdict === null ? [] : [one.reviewer === "" ? one.verdict : `${one.verdict} by ${one.reviewer}`])).join("; ");

const COLUMNS: [string, (object: FoundObject) => string | number | null][] = [
  ["object_id", (one) => one.id],
  ["model", (one) => one.model],
  ["score", (one) => one.score],
  ["frames", (one) => one.frames],
  ["first_time_s", (one) => one.first_time_s],
  ["last_time_s", (one) => one.last_time_s],
  ["latitude_deg", (one) => one.place?.latitude_deg ?? null],
  ["longitude_deg", (one) => one.place?.longitude_deg ?? null],
  ["altitude_m", (one) => one.place?.altitude_m ?? null],
  ["ce90_m", (one) => one.place?.ce90_m ?? null],
  ["le90_m", (one) => one.place?.le90_m ?? null],
  ["heading_deg", (one) => one.heading_deg],
  ["speed_m_s", (one) => one.speed_m_s],
  ["verdict", (one) => one.review?.verdict ?? null],
  ["reviewer", (one) => one.review?.reviewer ?? null],
  ["note", (one) => one.review?.note ?? null],
  ["is_disputed", (one) => (one.is_disputed ? 1 : 0)],
  ["decisions", (one) => listDecisions(one) || null],
];

function cell(value: string | number | null): string {
  if (value === null) return "";
  const text = String(value);
  // A spreadsheet takes a text that begins so for a formula.
  const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/** RFC 4180; what is unknown is an empty cell. */
export function toCsv(objects: readonly FoundObject[]): string {
  const rows = objects.map((one) => COLUMNS.map(([, read]) => cell(read(one))).join(","));
  return [COLUMNS.map(([name]) => name).join(","), ...rows, ""].join("\r\n");
}

/** RFC 7946; objects without a place are left out. */
export function toGeoJson(objects: readonly FoundObject[]): FeatureCollection<Point> {
  return {
    type: "FeatureCollection",
    features: objects.flatMap((one) => {
      if (one.place === null) return [];
      const { longitude_deg, latitude_deg, altitude_m } = one.place;
      return [
        {
          type: "Feature" as const,
          id: one.id,
          geometry: { type: "Point" as const, coordinates: [longitude_deg, latitude_deg, altitude_m] },
          properties: Object.fromEntries(COLUMNS.map(([name, read]) => [name, read(one)])),
        },
      ];
    }),
  };
}
