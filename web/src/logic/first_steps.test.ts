import { describe, expect, it } from "vitest";

import type { Job } from "../api/types";
import { stepsOf } from "./first_steps";

const job = (id: number, kind: Job["kind"], state: Job["state"], change: Partial<Job> = {}): Job => ({
  id, kind, state, title: "a", done: 0, total: null, unit: "", message: "", left_s: null, behind_s: null, cancel_asked: false, files: [], video_id: null,
  created_utc_us: 0, ended_utc_us: null, ...change,
});

describe("stepsOf", () => {
  const nothing = { has_targets: false, videos: 0 };
  it("begins with an object", () => {
    expect(stepsOf(nothing, [], 0)).toEqual({ object: "open", video: "waits", finds: "waits", progress: "", failure: "" });
  });
  it("lets a video be added while the model is made", () => {
    const model = job(1, "model", "running", { done: 40, total: 253, unit: "views", left_s: 20 });
    expect(stepsOf(nothing, [model], 0)).toMatchObject({ object: "runs", video: "open", progress: "40 of 253 views, 20 s left" });
    expect(stepsOf(nothing, [model, job(2, "sample", "queued"), job(3, "index", "queued")], 0)).toMatchObject({ video: "runs", finds: "waits" });
  });
  it("ends with the search", () => {
    const search = job(3, "index", "running", { done: 12, total: 60, unit: "frames" });
    expect(stepsOf({ has_targets: true, videos: 1 }, [search], 0)).toMatchObject({ object: "done", video: "done", finds: "runs", progress: "12 of 60 frames" });
  });
  it("says why the last one failed, once nothing else runs", () => {
    const failed = job(4, "model", "failed", { message: "no view has features" });
    expect(stepsOf(nothing, [failed], 0).failure).toBe("no view has features");
    expect(stepsOf(nothing, [failed, job(5, "model", "running")], 0).failure).toBe("");
    expect(stepsOf(nothing, [failed, job(5, "model", "done")], 0).failure).toBe("");
  });
});
