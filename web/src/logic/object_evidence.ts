// What all sightings of an object say together, in sentences: frames, size, lines of sight, heading, views. What of it
// is a doubt, the server decides (`against`).
import type { ObjectEvidence } from "../api/types";

const count = (number: number) => number.toLocaleString("en");
const frames = (number: number) => (number === 1 ? "1 frame" : `${count(number)} frames`);

function recognition({ recognitions, frames: all, by_shape, missed }: ObjectEvidence): string {
  const by = by_shape === 0 ? "" : by_shape === recognitions ? ", by the shape of its edges" : `, in ${count(by_shape)} by the shape of its edges`;
  const lost = missed === 0 ? "" : ` A search missed it in ${frames(missed)} in which it was tracked.`;
  return `Recognised in ${count(recognitions)} of ${frames(all)}${by}.${lost}`;
}

function size({ size_ratio: ratio }: ObjectEvidence): string | null {
  if (ratio === null || ratio <= 0) return null;
  const percent = Math.round(100 * Math.abs(ratio - 1));
  if (percent === 0) return "Its size is that of the model, by where its lines of sight meet.";
  return `By where its lines of sight meet, it is ${percent} % ${ratio > 1 ? "larger" : "smaller"} than the model.`;
}

function linesOfSight({ lines, missing_lines: missing }: ObjectEvidence): string | null {
  return lines === 0 ? null : `${count(lines - missing)} of ${count(lines)} lines of sight meet at its place.`;
}

function headings({ headings: all, contradicting_headings: wrong }: ObjectEvidence): string | null {
  return all < 2 ? null : `Its heading is the same in ${count(all - wrong)} of ${frames(all)}.`;
}

function views({ view_spread_deg: spread }: ObjectEvidence): string | null {
  return spread === null ? null : `The directions from which it is seen spread by ${Math.round(spread)}° (one standard deviation).`;
}

export function describeObject(evidence: ObjectEvidence): string[] {
  const placed = evidence.place_rejected ? ["Its place is doubtful, therefore size and heading are not used."] : [size(evidence), linesOfSight(evidence), headings(evidence)];
  return [recognition(evidence), ...placed, views(evidence)].filter((one) => one !== null);
}
