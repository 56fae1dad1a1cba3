// The objects of the list as files: a table of objects, one of their moments, and points for a map.
import type { FeatureCollection, Point } from "geojson";

import type { FoundObject } from "../api/types";
import { type SeenIn, seenIn } from "./moments";

type Videos = Parameters<typeof seenIn>[1];
type Cell = string | number | null;

/** Of all persons: "rejected by bob; accepted by ann". */
const listDecisions = (object: FoundObject) =>
  object.decisions.flatMap((one) => (one.verdict === null ? [] : [one.reviewer === "" ? one.verdict : `${one.verdict} by ${one.reviewer}`])).join("; ");

/** Times of several videos have nothing in common: they stand in the table of moments. */
const only = (seen: readonly SeenIn[]) => (seen.length === 1 ? (seen[0] ?? null) : null);

const COLUMNS: [string, (object: FoundObject, seen: SeenIn[]) => Cell][] = [
  ["object_id", (one) => one.id],
  ["model", (one) => one.model],
  ["score", (one) => one.score],
  ["frames", (one) => one.frames],
  ["videos", (_, seen) => seen.map((one) => one.video).join("; ")],
  ["first_time_s", (_, seen) => only(seen)?.first_time_s ?? null],
  ["last_time_s", (_, seen) => only(seen)?.last_time_s ?? null],
  ["first_utc", (_, seen) => utcs(seen, "first_utc").at(0) ?? null],
  ["last_utc", (_, seen) => utcs(seen, "last_utc").at(-1) ?? null],
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

/** Those that are known, ascending; none if one is not: the first one of all would not be known. */
function utcs(seen: readonly SeenIn[], key: "first_utc" | "last_utc"): string[] {
  const known = seen.flatMap((one) => one[key] ?? []);
  return known.length === seen.length ? known.sort() : [];
}

const MOMENT_COLUMNS: [string, (seen: SeenIn, object: FoundObject) => Cell][] = [
  ["object_id", (_, object) => object.id],
  ["model", (_, object) => object.model],
  ["video", (one) => one.video],
  ["first_time_s", (one) => one.first_time_s],
  ["last_time_s", (one) => one.last_time_s],
  ["first_utc", (one) => one.first_utc],
  ["last_utc", (one) => one.last_utc],
  ["frames", (one) => one.frames],
];

/** Those that are of the video, not of the object. */
const OF_VIDEO = MOMENT_COLUMNS.slice(2);

function cell(value: Cell): string {
  if (value === null) return "";
  const text = String(value);
  // A spreadsheet takes a text that begins so for a formula.
  const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/** RFC 4180; what is unknown is an empty cell. */
const table = (names: readonly string[], rows: readonly Cell[][]): string =>
  [names.join(","), ...rows.map((row) => row.map(cell).join(",")), ""].join("\r\n");

/** A row for each object. */
export function toCsv(objects: readonly FoundObject[], videos: Videos): string {
  const rows = objects.map((one) => {
    const seen = seenIn(one, videos);
    return COLUMNS.map(([, read]) => read(one, seen));
  });
  return table(COLUMNS.map(([name]) => name), rows);
}

/** A row for each object and video. */
export function momentsToCsv(objects: readonly FoundObject[], videos: Videos): string {
  const rows = objects.flatMap((object) => seenIn(object, videos).map((one) => MOMENT_COLUMNS.map(([, read]) => read(one, object))));
  return table(MOMENT_COLUMNS.map(([name]) => name), rows);
}

/** RFC 7946; objects without a place are left out. `videos` and `moments` are lists. */
export function toGeoJson(objects: readonly FoundObject[], videos: Videos): FeatureCollection<Point> {
  return {
    type: "FeatureCollection",
    features: objects.flatMap((one) => {
      if (one.place === null) return [];
      const seen = seenIn(one, videos);
      const { longitude_deg, latitude_deg, altitude_m } = one.place;
      return [
        {
          type: "Feature" as const,
          id: one.id,
          geometry: { type: "Point" as const, coordinates: [longitude_deg, latitude_deg, altitude_m] },
          properties: {
            ...Object.fromEntries(COLUMNS.map(([name, read]) => [name, read(one, seen)])),
            videos: seen.map(({ video }) => video),
            moments: seen.map((moment) => Object.fromEntries(OF_VIDEO.map(([name, read]) => [name, read(moment, one)]))),
          },
        },
      ];
    }),
  };
}
