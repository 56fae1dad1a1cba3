// The objects of the list as KML 2.2, as `victorious export` writes it: a point and its 90 % ellipse each.
import type { FoundObject } from "../api/types";
import { baseName, formatMetres } from "./format";
import { ellipseRing } from "./geo";
import { seenIn } from "./moments";

const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

/** When an object was in sight; a date that is not known of each of its moments is left out: none is invented. */
function timeSpan(seen: ReturnType<typeof seenIn>): string {
  const [begins, ends] = [seen.flatMap((one) => one.first_utc ?? []), seen.flatMap((one) => one.last_utc ?? [])];
  if (seen.length === 0 || begins.length < seen.length || ends.length < seen.length) return "";
  return `<TimeSpan><begin>${begins.sort()[0] ?? ""}</begin><end>${ends.sort().at(-1) ?? ""}</end></TimeSpan>`;
}

function placemark(object: FoundObject, videos: Parameters<typeof seenIn>[1]): string {
  const { place, review } = object;
  if (place === null) return "";
  const seen = seenIn(object, videos);
  const facts = [
    `score ${object.score.toFixed(3)}`,
    `90 % within ${formatMetres(place.ce90_m)}`,
    ...(object.heading_deg === null ? [] : [`heading ${object.heading_deg.toFixed(0)}°`]),
    ...(review?.verdict ? [`${review.verdict}${review.reviewer === "" ? "" : ` by ${review.reviewer}`}`] : []),
    ...(review?.note ? [review.note] : []),
    ...seen.map((one) => baseName(one.video)),
  ];
  const ring = ellipseRing(place);
  const ellipse = ring
    ? `<Polygon><outerBoundaryIs><LinearRing><coordinates>${ring.map(([x, y]) => `${x.toFixed(9)},${y.toFixed(9)}`).join(" ")}</coordinates></LinearRing></outerBoundaryIs></Polygon>`
    : "";
  return (
    `<Placemark id="object-${object.id}"><name>${escaped(object.model)} ${object.id}</name>` +
    `<description>${escaped(facts.join(", "))}</description>${timeSpan(seen)}<styleUrl>#object</styleUrl>` +
    `<MultiGeometry><Point><coordinates>${place.longitude_deg.toFixed(9)},${place.latitude_deg.toFixed(9)}</coordinates></Point>${ellipse}</MultiGeometry></Placemark>\n`
  );
}

/**
 * Objects without a place are left out. Points lie on the ground: KML counts heights from sea level, not from the
 * ellipsoid.
 */
export const toKml = (objects: readonly FoundObject[], videos: Parameters<typeof seenIn>[1]): string =>
  '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document>' +
  '<Style id="object"><PolyStyle><color>4000ffff</color></PolyStyle></Style>\n' +
  `${objects.map((one) => placemark(one, videos)).join("")}</Document></kml>\n`;
