// Positions as UTM and MGRS coordinates (WGS 84): the transverse Mercator projection by Krueger's series to the fourth
// order in the third flattening, which is exact to less than a millimetre within a zone, and the letters of NGA.SIG.0012.
// Beyond 84 degrees north and 80 degrees south, where UPS begins, there are none.

const A = 6_378_137;
const F = 1 / 298.257223563;
const N = F / (2 - F);
const K0 = 0.9996;
const RECTIFYING = (A / (1 + N)) * (1 + N ** 2 / 4 + N ** 4 / 64);
const ALPHA = [
  N / 2 - (2 * N ** 2) / 3 + (5 * N ** 3) / 16 + (41 * N ** 4) / 180,
  (13 * N ** 2) / 48 - (3 * N ** 3) / 5 + (557 * N ** 4) / 1440,
  (61 * N ** 3) / 240 - (103 * N ** 4) / 140,
  (49561 * N ** 4) / 161280,
];
/** Of the way back. */
const BETA = [
  N / 2 - (2 * N ** 2) / 3 + (37 * N ** 3) / 96 - N ** 4 / 360,
  N ** 2 / 48 + N ** 3 / 15 - (437 * N ** 4) / 1440,
  (17 * N ** 3) / 480 - (37 * N ** 4) / 840,
  (4397 * N ** 4) / 161280,
];
const E = Math.sqrt(F * (2 - F));
const BANDS = "CDEFGHJKLMNPQRSTUVWXX";
const COLUMNS = ["ABCDEFGH", "JKLMNPQR", "STUVWXYZ"];
const ROWS = "ABCDEFGHJKLMNPQRSTUV";

export interface Utm {
  zone: number;
  band: string;
  /** m */
  easting: number;
  northing: number;
}

/** With the exceptions of Norway and Svalbard. */
function zoneOf(latitude: number, longitude: number): number {
  const zone = Math.min(Math.max(Math.floor((longitude + 180) / 6) + 1, 1), 60);
  if (latitude >= 56 && latitude < 64 && longitude >= 3 && longitude < 12) return 32;
  if (latitude < 72 || longitude < 0 || longitude >= 42) return zone;
  return longitude < 9 ? 31 : longitude < 21 ? 33 : longitude < 33 ? 35 : 37;
}

/** Null where UTM is not defined. */
export function utmOf(latitude: number, longitude: number): Utm | null {
  if (!(latitude >= -80 && latitude < 84)) return null;
  const east = ((((longitude + 180) % 360) + 360) % 360) - 180;
  const zone = zoneOf(latitude, east);
  const phi = (latitude * Math.PI) / 180;
  const lambda = ((east - (6 * zone - 183)) * Math.PI) / 180;
  // The conformal latitude, then the Gauss-Schreiber coordinates, then the series.
  const tangent = Math.tan(phi);
  const conformal = conformalTangent(tangent);
  const xi = Math.atan2(conformal, Math.cos(lambda));
  const eta = Math.asinh(Math.sin(lambda) / Math.hypot(conformal, Math.cos(lambda)));
  let [x, y] = [eta, xi];
  ALPHA.forEach((alpha, i) => {
    const order = 2 * (i + 1);
    x += alpha * Math.cos(order * xi) * Math.sinh(order * eta);
    y += alpha * Math.sin(order * xi) * Math.cosh(order * eta);
  });
  return {
    zone,
    band: BANDS[Math.floor((latitude + 80) / 8)] ?? "X",
    easting: K0 * RECTIFYING * x + 500_000,
    northing: K0 * RECTIFYING * y + (latitude < 0 ? 10_000_000 : 0),
  };
}

/** To a metre: "33U UU 90842 20188"; null where MGRS has no UTM. Digits are cut off, not rounded, as the standard says. */
export function formatMgrs(latitude: number, longitude: number): string | null {
  const utm = utmOf(latitude, longitude);
  if (utm === null) return null;
  const { zone, band, easting, northing } = utm;
  const column = COLUMNS[(zone - 1) % 3]?.[Math.floor(easting / 100_000) - 1] ?? "?";
  const row = ROWS[(Math.floor(northing / 100_000) + (zone % 2 === 0 ? 5 : 0)) % 20] ?? "?";
  const digits = (metres: number) => String(Math.floor(metres % 100_000)).padStart(5, "0");
  return `${zone}${band} ${column}${row} ${digits(easting)} ${digits(northing)}`;
}

export function formatUtm(latitude: number, longitude: number): string | null {
  const utm = utmOf(latitude, longitude);
  return utm && `${utm.zone}${utm.band} ${utm.easting.toFixed(1)} ${utm.northing.toFixed(1)}`;
}

export interface LatLon {
  /** degrees */
  latitude: number;
  longitude: number;
}

/** The tangent of the conformal latitude. */
function conformalTangent(tangent: number): number {
  const sigma = Math.sinh(E * Math.atanh((E * tangent) / Math.hypot(1, tangent)));
  return tangent * Math.hypot(1, sigma) - sigma * Math.hypot(1, tangent);
}

/** Null if there is no such zone or band, or the point lies far beyond its zone. */
export function positionOfUtm({ zone, band, easting, northing }: Utm): LatLon | null {
  const isZone = zone >= 1 && zone <= 60 && BANDS.includes(band.toUpperCase()) && band.length === 1;
  if (!isZone || easting < 0 || easting > 1_000_000 || northing < 0 || northing > 10_000_000) return null;
  const isSouth = band.toUpperCase() < "N";
  const [x, y] = [(easting - 500_000) / (K0 * RECTIFYING), (northing - (isSouth ? 10_000_000 : 0)) / (K0 * RECTIFYING)];
  let [eta, xi] = [x, y];
  BETA.forEach((beta, i) => {
    const order = 2 * (i + 1);
    eta -= beta * Math.cos(order * y) * Math.sinh(order * x);
    xi -= beta * Math.sin(order * y) * Math.cosh(order * x);
  });
  const wanted = Math.sin(xi) / Math.hypot(Math.sinh(eta), Math.cos(xi));
  // Newton's steps from the conformal latitude (Karney 2011, equations 19 to 21).
  let tangent = wanted;
  for (let step = 0; step < 5; step++) {
    const present = conformalTangent(tangent);
    tangent += ((wanted - present) / Math.hypot(1, present)) * ((1 + (1 - E * E) * tangent ** 2) / ((1 - E * E) * Math.hypot(1, tangent)));
  }
  const longitude = 6 * zone - 183 + (Math.atan2(Math.sinh(eta), Math.cos(xi)) * 180) / Math.PI;
  return { latitude: (Math.atan(tangent) * 180) / Math.PI, longitude: longitude - 360 * Math.round(longitude / 360) };
}

/**
 * The middle of the square that MGRS names.
 * @param square  two letters
 * @param east  digits of the easting, as many as of the northing
 */
export function positionOfMgrs(zone: number, band: string, square: string, east: string, north: string): LatLon | null {
  const [column, row] = [square.charAt(0).toUpperCase(), square.charAt(1).toUpperCase()];
  const at = COLUMNS[(zone + 2) % 3]?.indexOf(column) ?? -1;
  const line = ROWS.indexOf(row);
  const place = BANDS.indexOf(band.toUpperCase());
  if (at < 0 || line < 0 || place < 0 || band.length !== 1) return null;
  const size = 10 ** (5 - east.length);
  const metres = (digits: string) => (Number(digits) + 0.5) * size;
  const easting = (at + 1) * 100_000 + metres(east);
  const first = ((line + (zone % 2 === 0 ? 15 : 0)) % 20) * 100_000 + metres(north);
  // The letters of rows come again each 2000 km: the band, 8 degrees high, says which ones are meant.
  const middle = place >= 19 ? 78 : 8 * place - 76;
  const all = [0, 1, 2, 3, 4].flatMap((turns) => positionOfUtm({ zone, band, easting, northing: first + turns * 2_000_000 }) ?? []);
  return all.sort((a, b) => Math.abs(a.latitude - middle) - Math.abs(b.latitude - middle))[0] ?? null;
}
