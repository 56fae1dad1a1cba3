import { describe, expect, it } from "vitest";

import { describeSeen, formatUtcSpan, seenIn, summarizeSeen } from "./moments";

const videos = [
  { id: 1, name: "/v/a.mp4", start_utc_us: 1_700_000_000_000_000 },
  { id: 2, name: "/v/b.mp4", start_utc_us: null },
];
const moment = (video_id: number, first_time_s: number, last_time_s: number, frames = 3) => ({ id: video_id, video_id, first_time_s, last_time_s, frames, score: 0.9 });
const object = { moments: [moment(2, 2, 2.5), moment(1, 4, 5.1), moment(1, 3, 3.5)] };

describe("seenIn", () => {
  it("has the times of each video by itself, with UTC where the video has it", () => {
    expect(seenIn(object, videos)).toEqual([
      { video_id: 1, video: "/v/a.mp4", first_time_s: 3, last_time_s: 5.1, frames: 6, first_utc: "2023-11-14T22:13:23.000Z", last_utc: "2023-11-14T22:13:25.100Z" },
      { video_id: 2, video: "/v/b.mp4", first_time_s: 2, last_time_s: 2.5, frames: 3, first_utc: null, last_utc: null },
    ]);
  });
});

it("writes the day of UTC once", () => {
  expect(formatUtcSpan("2023-11-14T22:13:23.000Z", "2023-11-14T22:13:25.100Z")).toBe("2023-11-14 22:13:23 – 22:13:25 UTC");
  expect(formatUtcSpan("2023-11-14T23:59:59.000Z", "2023-11-15T00:00:01.000Z")).toBe("2023-11-14 23:59:59 – 2023-11-15 00:00:01 UTC");
});

describe("summarizeSeen", () => {
  const seen = seenIn(object, videos);
  it("never joins times of different videos", () => {
    expect(summarizeSeen(seen, 1)).toBe("3.0 – 5.1 s here");
    expect(summarizeSeen(seen, null)).toBe("in 2 videos");
    expect(summarizeSeen(seen.slice(1), 1)).toBe("2.0 – 2.5 s");
    expect(seen.map(describeSeen)).toEqual(["a.mp4 3.0 – 5.1 s", "b.mp4 2.0 – 2.5 s"]);
  });
});
