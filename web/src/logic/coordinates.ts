// Reads positions as people and this page write them: decimal degrees, degrees with minutes and seconds, MGRS, UTM.
import { positionOfMgrs, positionOfUtm } from "./mgrs";

export interface ReadPosition {
  /** May lie beyond 90 or 180 degrees, as typed. */
  latitude: number;
  longitude: number;
  /** What follows it in the text. */
  rest: string;
}

const NUMBER = "\\d+(?:\\.\\d+)?";
const BETWEEN = "(?:\\s*[,;]\\s*|\\s+)";
const DECIMAL = new RegExp(`^(-?${NUMBER})°?${BETWEEN}(-?${NUMBER})°?(?![\\w.°′'’])`);
const angle = (letters: string) => `(${NUMBER})\\s*°?\\s*(?:(${NUMBER})\\s*[′'’]\\s*)?(?:(${NUMBER})\\s*(?:[″"”]|''|′′)\\s*)?([${letters}])`;
const DMS = new RegExp(`^${angle("NS")}\\s*[,;]?\\s*${angle("EW")}(?!\\w)`, "i");
const ZONE = "^(\\d{1,2})\\s*([C-HJ-NP-X])";
const MGRS = new RegExp(`${ZONE}\\s*([A-HJ-NP-Z])([A-HJ-NP-V])\\s*(?:(\\d{1,5})\\s+(\\d{1,5})(?!\\d)|((?:\\d\\d){1,5})(?!\\d))`, "i");
const UTM = new RegExp(`${ZONE}\\s+(${NUMBER})(?:\\s*m?E)?${BETWEEN}(${NUMBER})(?:\\s*m?N)?(?!\\w)`, "i");

const degrees = (whole = "", minutes = "0", seconds = "0", letter = "") =>
  (/[SW]/i.test(letter) ? -1 : 1) * (Number(whole) + Number(minutes) / 60 + Number(seconds) / 3600);

/** The position that a text begins with; null: it begins with none. */
export function readPosition(text: string): ReadPosition | null {
  const decimal = DECIMAL.exec(text);
  if (decimal) return { latitude: Number(decimal[1]), longitude: Number(decimal[2]), rest: text.slice(decimal[0].length) };
  const dms = DMS.exec(text);
  if (dms) {
    const latitude = degrees(dms[1], dms[2], dms[3], dms[4]);
    return { latitude, longitude: degrees(dms[5], dms[6], dms[7], dms[8]), rest: text.slice(dms[0].length) };
  }
  const mgrs = MGRS.exec(text);
  const digits = mgrs?.[7] === undefined ? [mgrs?.[5] ?? "", mgrs?.[6] ?? ""] : [mgrs[7].slice(0, mgrs[7].length / 2), mgrs[7].slice(mgrs[7].length / 2)];
  if (mgrs && digits[0]?.length === digits[1]?.length) {
    const found = positionOfMgrs(Number(mgrs[1]), mgrs[2] ?? "", `${mgrs[3]}${mgrs[4]}`, digits[0] ?? "", digits[1] ?? "");
    return found && { ...found, rest: text.slice(mgrs[0].length) };
  }
  const utm = UTM.exec(text);
  if (!utm) return null;
  const found = positionOfUtm({ zone: Number(utm[1]), band: utm[2] ?? "", easting: Number(utm[3]), northing: Number(utm[4]) });
  return found && { ...found, rest: text.slice(utm[0].length) };
}

/** Whether a text is a position without a word that says so: two whole numbers may be anything. */
export function isPosition(text: string): boolean {
  const decimal = DECIMAL.exec(text.trim());
  if (decimal) return [decimal[1], decimal[2]].every((one) => one?.includes("."));
  return readPosition(text.trim()) !== null;
}
