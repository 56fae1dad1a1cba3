// What all sightings of an object say together, in sentences: frames, size, lines of sight, heading, views.
import type { ObjectEvidence } from "../api/types";

export interface Statement {
  text: string;
  /** It speaks against the object. */
  isDoubt: boolean;
}

/** Lines of sight give the size of right objects to a few per cent. */
const DOUBTED_SIZE = 0.1;
/** Of headings, lines of sight and searches. */
const DOUBTED_PART = 0.2;

const frames = (count: number) => (count === 1 ? "1 frame" : `${count.toLocaleString("en")} frames`);

function recognition({ recognitions, frames: all, by_shape, missed }: ObjectEvidence): Statement {
  const by = by_shape === 0 ? "" : by_shape === recognitions ? ", by the shape of its edges" : `, in ${by_shape.toLocaleString("en")} by the shape of its edges`;
  const lost = missed === 0 ? "" : `; searched for in vain in ${frames(missed)} where it was followed to`;
  return { text: `Recognised in ${recognitions.toLocaleString("en")} of ${frames(all)}${by}${lost}.`, isDoubt: missed > DOUBTED_PART * (recognitions + missed) };
}

function size({ size_ratio: ratio }: ObjectEvidence): Statement | null {
  if (ratio === null || ratio <= 0) return null;
  const percent = Math.round(100 * Math.abs(ratio - 1));
  const text =
    percent === 0
      ? "Its size is that of the model, by where its lines of sight meet."
      : `By where its lines of sight meet, it is ${percent} % ${ratio > 1 ? "larger" : "smaller"} than the model.`;
  return { text, isDoubt: Math.abs(Math.log(ratio)) > DOUBTED_SIZE };
}

function linesOfSight({ lines, missing_lines: missing }: ObjectEvidence): Statement | null {
  if (lines === 0) return null;
  return { text: `${(lines - missing).toLocaleString("en")} of ${lines.toLocaleString("en")} lines of sight meet at its place.`, isDoubt: missing > DOUBTED_PART * lines };
}

function headings({ headings: all, contradicting_headings: wrong }: ObjectEvidence): Statement | null {
  if (all < 2) return null;
  return { text: `It faces one way in ${(all - wrong).toLocaleString("en")} of ${frames(all)}.`, isDoubt: wrong > DOUBTED_PART * all };
}

function views({ view_jumps: jumps, view_spread_deg: spread }: ObjectEvidence): Statement | null {
  if (jumps > 0) return { text: `Its view jumps by more than 50° ${jumps === 1 ? "once" : `${jumps} times`} within two seconds.`, isDoubt: true };
  return spread === null ? null : { text: `It is seen from directions ${Math.round(spread)}° apart.`, isDoubt: false };
}

/** Doubts first. */
export function describeObject(evidence: ObjectEvidence): Statement[] {
  const placed = evidence.place_rejected ? [{ text: "Its place is in doubt, so that size and heading say nothing.", isDoubt: true }] : [size(evidence), linesOfSight(evidence), headings(evidence)];
  const all = [recognition(evidence), ...placed, views(evidence)].filter((one) => one !== null);
  return [...all.filter((one) => one.isDoubt), ...all.filter((one) => !one.isDoubt)];
}
