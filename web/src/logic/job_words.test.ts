import { describe, expect, it } from "vitest";

import { forReaders } from "./errors";
import { describeDone, describeFailed, needsNewSearch } from "./job_words";

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
    const track = (message: string) => ({ kind: "track" as const, message });
    const span = { first: 3.8, last: 5.9 };
    expect(describeDone(track("box-1: place at 5.90 s: 52.500000, 13.400000, 76.3 m; CE90 15.1 m, LE90 5.0 m"), null, span)).toBe(
      "Followed 3.8 – 5.9 s; 90 % within 15.1 m",
    );
    expect(describeDone(track("box-1: no place: no telemetry"), null, null)).toBe("Followed; no place: no telemetry");
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
