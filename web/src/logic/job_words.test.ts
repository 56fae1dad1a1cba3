import { describe, expect, it } from "vitest";

import { forReaders } from "./errors";
import { describeDone, describeFailed, followedObject, needsNewSearch } from "./job_words";

const placeWithin = (ce90_m: number) => ({
  time_s: 0,
  latitude_deg: 52,
  longitude_deg: 13,
  altitude_m: 0,
  ce90_m,
  le90_m: null,
  ellipse: { semi_major_m: null, semi_minor_m: null, azimuth_deg: null },
});

describe("what a job has come to", () => {
  const index = (message: string) => ({ kind: "index" as const, message });

  it("says what was found, not what was computed", () => {
    expect(describeDone(index("a.mp4: 30 frames searched, 22 sightings"), 1, null)).toBe("1 object found");
    expect(describeDone(index("a.mp4: 30 frames searched, 0 sightings; there is no telemetry, so that nothing gets a place"), 0, null)).toBe(
      "Nothing found; without telemetry, none has a place",
    );
    expect(describeDone(index("a.mp4: 0 frames searched, 0 sightings (already indexed)"), 3, null)).toBe("Already searched, nothing new");
    expect(describeDone(index("a.mp4: 1 frame searched, 1 sighting"), null, null)).toBe("Searched");
    expect(describeDone(index("a.mp4: the clock of the telemetry is unknown"), 3, null)).toBe("a.mp4: the clock of the telemetry is unknown");
  });

  it("says how long and how exactly a box was followed", () => {
    const track = { kind: "track" as const, state: "done" as const, message: "box-1: is object 12, boxed/van" };
    const object = { first_time_s: 3.8, last_time_s: 5.9, place: placeWithin(15.1), speed_m_s: null };
    expect(followedObject(track)).toBe(12);
    expect(followedObject({ ...track, state: "running" })).toBeNull();
    expect(followedObject({ ...track, kind: "index" })).toBeNull();
    expect(describeDone(track, null, object)).toBe("Followed 3.8 – 5.9 s; 90 % within 15.1 m");
    expect(describeDone(track, null, { ...object, speed_m_s: 5.26 })).toBe("Followed 3.8 – 5.9 s; 90 % within 15.1 m, 5.3 m/s");
    expect(describeDone(track, null, { ...object, place: null })).toBe("Followed 3.8 – 5.9 s; it has no place");
    const why = { ...track, message: `${track.message}; no place: no telemetry` };
    expect(describeDone(why, null, { ...object, place: null })).toBe("Followed 3.8 – 5.9 s; no place: no telemetry");
    expect(describeDone(track, null, null)).toBe("Followed");
  });

  it("offers a search from the beginning instead of a command", () => {
    const job = { kind: "index" as const, state: "failed" as const, message: "/v/a.mp4: was indexed with other parameters (to: 0.3): give the same parameters, or --redo to delete its results and search it again" };
    expect(needsNewSearch(job)).toBe(true);
    expect(describeFailed(job)).not.toMatch(/--|\/v\//);
    expect(needsNewSearch({ ...job, message: "a.mp4: not a video" })).toBe(false);
  });
});

describe("messages of the server", () => {
  it("lose folders and commands, not what went wrong", () => {
    expect(forReaders("/data/b.mp4: the video is not there: move it back, or start `victorious serve` in the folder that the index was made in")).toBe("b.mp4: the video is not there.");
    expect(forReaders("none.mp4: lies in none of the folders that this server opens files in: start `victorious serve` with --videos and the folder that it lies in")).toBe(
      "none.mp4: lies in none of the folders that this server opens files in.",
    );
    expect(forReaders("/data/a.db.uploads/481cafc35cdf7828/my flight.mp4: not a video")).toBe("my flight.mp4: not a video");
    for (const text of ["The address must begin with rtsp://, udp:// or srt://", "rtsp://127.0.0.1:1/camera: no answer", "1.5 m/s; 3 of 4 frames", "The note has 4001 bytes; at most 4000 are kept", "either/or: a--b"])
      expect(forReaders(text)).toBe(text);
    // A message that is nothing but a command stays.
    expect(forReaders("start `victorious serve` again")).toBe("start `victorious serve` again");
  });
});
