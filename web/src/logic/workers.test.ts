import { describe, expect, it } from "vitest";

import type { Cluster } from "../api/types";
import { describeBehind, describePart, describeRate, formatSilence, formatUtcGap, isLate } from "./workers";

const NONE = { queued: 0, waiting: 0, running: 0, done: 0, failed: 0 };
const cluster = (more: Partial<Cluster>): Cluster => ({
  is_shared: true, workers: 0, videos: NONE, segments: NONE, video_s: null, segment_s: null, left_s: null, tasks: [], gaps: [], quarantined: [], sources: [], ...more,
});

describe("workers", () => {
  it("are late once they say nothing for half of their lease", () => {
    const task = { id: 1, video: "/a.mp4", segment: null, state: "running" as const, attempt: 1, worker: "a:1", searched_frames: null, reason: "" };
    expect(isLate({ ...task, silent_s: 14 })).toBe(false);
    expect(isLate({ ...task, silent_s: 45 })).toBe(true);
    expect(isLate({ ...task, silent_s: null })).toBe(false);
    expect([0.2, 14.6, 45, 300].map(formatSilence)).toEqual(["alive 1 s ago", "alive 15 s ago", "alive 45 s ago", "alive 5 min ago"]);
  });

  it("have a part of a video, or all of it", () => {
    expect(describePart({ segment: [1200, 1800], searched_frames: null })).toBe("frames 1,200 to 1,799");
    expect(describePart({ segment: null, searched_frames: 1 })).toBe("1 frame searched");
    expect(describePart({ segment: null, searched_frames: null })).toBe("begins");
  });

  it("follow live sources", () => {
    expect([null, 1.6, 300, 8000].map((behind_s) => describeBehind({ behind_s }))).toEqual(["nothing searched yet", "2 s behind", "5 min behind", "2 h behind"]);
    expect(formatUtcGap({ from_utc_us: 1_779_887_662_911_042, to_utc_us: 1_779_887_675_411_042 })).toBe("2026-05-27 13:14:22 UTC (13 s)");
  });

  it("have a rate once one task was done", () => {
    expect(describeRate(cluster({ videos: { ...NONE, running: 4 } }))).toBeNull();
    expect(describeRate(cluster({ videos: { ...NONE, running: 4 }, video_s: 600 }))).toBe("about 24 videos an hour");
    expect(describeRate(cluster({ segments: { ...NONE, running: 2 }, segment_s: 3600, video_s: 1 }))).toBe("about 2.0 segments an hour");
    expect(describeRate(cluster({ video_s: 600 }))).toBeNull();
  });
});
