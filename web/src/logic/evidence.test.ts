import { describe, expect, it } from "vitest";

import type { Evidence } from "../api/types";
import { SHEET, formatPower, layOut, placeOn, sizeOf, verdictOf } from "./evidence";

const evidence: Evidence = {
  sighting: {
    video_id: 1, object_id: 2, model_id: 3, frame: 4, time_s: 0.4, box: [120, 110, 40, 30], outline: [], score: 0.9, source: "recognised",
    matches: 1, view_index: 5, distance_m: null, sigma_distance_m: null, heading_deg: null,
  },
  region: [100, 100, 80, 60],
  view: { index: 5, image_box: [0, 0, 200, 200], outline: [], azimuth_deg: 10, off_nadir_deg: 40 },
  is_relit: false,
  is_pooled: false,
  stages: [
    { name: "ranked_matches", matches: 4 },
    { name: "pose_votes", matches: 2 },
    { name: "inliers", matches: 1 },
  ],
  matches: [
    { template: [100, 100], frame: [140, 130], stages: 3 },
    { template: [50, 50], frame: [130, 120], stages: 2 },
    { template: [10, 10], frame: [101, 101], stages: 1 },
    { template: [20, 20], frame: [400, 300], stages: 1 },
  ],
  is_truncated: false,
  pose: { outline: [], score: 0.9, neg_log10_nfa: 7.3 },
};

describe("evidence of a sighting", () => {
  it("draws the matches that passed a stage and lie in the picture, inliers above", () => {
    const first = layOut(evidence, 0, evidence.region);
    expect(first.lines.map((one) => one.isInlier)).toEqual([false, false, true]);
    expect(first.hidden).toBe(1);
    expect(layOut(evidence, 0, [0, 0, 640, 480]).hidden).toBe(0);
    expect(layOut(evidence, 1, evidence.region).lines).toHaveLength(2);
    const last = layOut(evidence, 2, evidence.region);
    expect(last.lines).toEqual([{ from: [200, 200], to: placeOn(last.frame, [140, 130]), isInlier: true }]);
    expect(last.hidden).toBe(0);
  });

  it("places both pictures whole, without overlap", () => {
    const { view, frame } = layOut(evidence, 0, evidence.region);
    expect(view.left + sizeOf(view).width).toBeLessThanOrEqual(SHEET.viewWidth);
    expect(frame.left).toBeGreaterThanOrEqual(SHEET.viewWidth + SHEET.gap);
    expect(frame.left + sizeOf(frame).width).toBeLessThanOrEqual(SHEET.width + 1e-9);
    expect(placeOn(frame, [100, 100])).toEqual([frame.left, frame.top]);
    const wide = layOut(evidence, 0, [0, 0, 1920, 300]);
    expect(sizeOf(wide.frame).width).toBeCloseTo(SHEET.width - SHEET.viewWidth - SHEET.gap);
  });

  it("says what the matches mean", () => {
    expect(verdictOf(evidence)).toBe(
      "Matched again here, 1 match agrees on one pose. By chance, one frame in 20 million shows as good a pose.",
    );
    const counted = { ...evidence, sighting: { ...evidence.sighting, matches: 39 } };
    expect(verdictOf(counted)).toContain("1 match agrees on one pose (the search counted 39).");
    expect(verdictOf({ ...evidence, is_relit: true })).toContain("lit by the sun");
    expect(verdictOf({ ...evidence, pose: null })).toContain("give no pose here");
    expect(verdictOf({ ...evidence, sighting: { ...evidence.sighting, matches: 0 } })).toContain("Found by the shape of its edges");
    const tracked = { ...evidence, pose: null, sighting: { ...evidence.sighting, source: "tracked" as const } };
    expect(verdictOf(tracked)).toContain("Followed from frame to frame");
    expect([1.5, 4, 7.3, 12.8, 340].map(formatPower)).toEqual(["32", "10 thousand", "20 million", "10¹²", "10¹⁰⁰"]);
  });
});
