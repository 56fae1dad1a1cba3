// The evidence of a sighting as a picture: the view on the left, the frame on the right, a line for each match.
import type { Evidence } from "../api/types";

type StageName = Evidence["stages"][number]["name"];
type Box = readonly number[];

export const STAGES: Record<StageName, { label: string; what: string }> = {
  ratio_test: {
    label: "Ratio test",
    what: "features of the frame whose nearest feature of the view is clearly nearer than the second nearest",
  },
  scales: { label: "Scales", what: "matches whose neighbours agree in scale and distance" },
  orientations: { label: "Orientations", what: "of these, matches whose neighbours agree in orientation, too" },
  strict_scales: { label: "Scales, strict", what: "of these, matches whose remaining neighbours agree in scale and distance" },
  ranked_matches: { label: "Matches", what: "the nearest features of the frame for each feature of the view" },
  pose_votes: { label: "Votes", what: "matches that vote for this place, size and rotation" },
  inliers: { label: "Inliers", what: "matches that lie where the pose puts them" },
};

/** A part of a picture and where it is drawn: x on paper = left + scale * (x - box.x). */
export interface Placed {
  box: Box;
  left: number;
  top: number;
  scale: number;
}

export const SHEET = { width: 960, height: 400, gap: 40, viewWidth: 400 } as const;

/** Places a part of a picture in an area of the sheet, whole and centred. */
function place(box: Box, left: number, width: number): Placed {
  const [, , boxWidth = 1, boxHeight = 1] = box;
  const scale = Math.min(width / Math.max(boxWidth, 1), SHEET.height / Math.max(boxHeight, 1));
  return { box, scale, left: left + (width - boxWidth * scale) / 2, top: (SHEET.height - boxHeight * scale) / 2 };
}

export function placeOn(placed: Placed, point: readonly number[]): [number, number] {
  const [x = 0, y = 0] = point;
  const [boxX = 0, boxY = 0] = placed.box;
  return [placed.left + placed.scale * (x - boxX), placed.top + placed.scale * (y - boxY)];
}

export const sizeOf = (placed: Placed) => ({
  width: placed.scale * (placed.box[2] ?? 0),
  height: placed.scale * (placed.box[3] ?? 0),
});

export interface Line {
  from: [number, number];
  to: [number, number];
  /** It passed all stages. */
  isInlier: boolean;
}

export interface EvidenceSheet {
  view: Placed;
  frame: Placed;
  /** Of the matches that passed a stage and end in the picture; inliers last, so that they are drawn above. */
  lines: Line[];
  /** Matches of the stage that end beyond the part of the frame that is shown, or were not sent. */
  hidden: number;
}

/** @param region  the part of the frame that is shown, px */
export function layOut(evidence: Evidence, stage: number, region: Box): EvidenceSheet {
  const view = place(evidence.view.image_box, 0, SHEET.viewWidth);
  const right = SHEET.viewWidth + SHEET.gap;
  const frame = place(region, right, SHEET.width - right);
  const [x = 0, y = 0, width = 0, height = 0] = region;
  const passed = evidence.matches.filter((one) => one.stages > stage);
  const lines = passed
    .filter(({ frame: [atX = 0, atY = 0] }) => atX >= x && atY >= y && atX <= x + width && atY <= y + height)
    .map((one) => ({
      from: placeOn(view, one.template),
      to: placeOn(frame, one.frame),
      isInlier: one.stages === evidence.stages.length,
    }))
    .sort((a, b) => Number(a.isInlier) - Number(b.isInlier));
  return { view, frame, lines, hidden: (evidence.stages[stage]?.matches ?? 0) - lines.length };
}

/** What the matches say, in a sentence. */
export function verdictOf(evidence: Evidence): string {
  const { pose, sighting, stages } = evidence;
  if (sighting.matches === 0) {
    return "Found by the shape of its edges, by size and direction of view known from telemetry, not by matches: those shown here are by the way.";
  }
  if (!pose) {
    return sighting.source === "tracked"
      ? "Followed from frame to frame, not recognised in this one: its matches here give no pose."
      : "The matches of this view give no pose here: other views, or the light of that search, found it.";
  }
  const inliers = stages.at(-1)?.matches ?? 0;
  const light = evidence.is_relit ? ", lit by the sun as in the video" : "";
  const pooled = evidence.is_pooled ? ", with features of the views beside it" : "";
  const chance =
    pose.neg_log10_nfa > 0
      ? `By chance, ${pose.neg_log10_nfa > MAX_DECADES ? "less than " : ""}one frame in ${formatPower(pose.neg_log10_nfa)} shows as good a pose.`
      : "Chance explains it.";
  const counted =
    sighting.source === "recognised" && sighting.matches !== inliers ? ` (the search counted ${sighting.matches})` : "";
  const agreeing = inliers === 1 ? "1 match agrees" : `${inliers} matches agree`;
  return `Matched again here, ${agreeing} on one pose${counted}${light}${pooled}. ${chance}`;
}

/** Beyond it the model of chance says nothing more. */
const MAX_DECADES = 100;

/** 10 to a power, for people: 300, 2 million, 10⁹, at most 10¹⁰⁰. */
export function formatPower(decades: number): string {
  if (decades < 3) return Math.round(10 ** decades).toLocaleString("en");
  if (decades < 6) return `${Math.round(10 ** (decades - 3)).toLocaleString("en")} thousand`;
  if (decades < 9) return `${Math.round(10 ** (decades - 6)).toLocaleString("en")} million`;
  const power = String(Math.floor(Math.min(decades, MAX_DECADES)));
  return `10${power.replaceAll(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹".charAt(Number(digit)))}`;
}
