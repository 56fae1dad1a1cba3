// What a job has come to, in the words of the page; the server's own message is that of the command that it ran.
import type { FoundObject, Job } from "../api/types";
import { formatMetres, formatSpan, plural } from "./format";

const SEARCHED = /\d[\d,]* frames? searched, \d[\d,]* sightings?/;

/** An object that was boxed and followed. */
export type FollowedObject = Pick<FoundObject, "first_time_s" | "last_time_s" | "place" | "speed_m_s">;

/** The object that a job has made of what was boxed; null: none. */
export function followedObject(job: Pick<Job, "kind" | "state" | "message">): number | null {
  const object = /: is object (\d+), /.exec(job.message)?.[1];
  return job.kind === "track" && job.state === "done" && object !== undefined ? Number(object) : null;
}

function describePlace(place: FollowedObject["place"], message: string): string {
  if (place !== null) return place.ce90_m === null ? "" : `; 90 % within ${formatMetres(place.ce90_m)}`;
  const why = /; no place: (.*)$/.exec(message)?.[1];
  return why === undefined ? "; it has no place" : `; no place: ${why}`;
}

/** @param objects  that the video has now; null: not known. @param followed  what was boxed and followed; null: not known */
export function describeDone(job: Pick<Job, "kind" | "message">, objects: number | null, followed: FollowedObject | null): string {
  const { kind, message } = job;
  if ((kind === "index" || kind === "live") && SEARCHED.test(message)) {
    if (message.includes("(already indexed)")) return "Already searched, nothing new";
    const found = objects === null ? "Searched" : objects === 0 ? "Nothing found" : `${plural(objects, "object")} found`;
    return message.includes("there is no telemetry") ? `${found}; without telemetry, none has a place` : found;
  }
  if (kind === "track") {
    if (followed === null) return "Followed";
    const { first_time_s, last_time_s, place, speed_m_s } = followed;
    const speed = speed_m_s === null || speed_m_s === 0 ? "" : `, ${speed_m_s.toFixed(1)} m/s`;
    return `Followed ${formatSpan(first_time_s, last_time_s)}${describePlace(place, message)}${speed}`;
  }
  return message;
}

/** A video was searched with other options than those of the server: in part, say. */
export const needsNewSearch = (job: Pick<Job, "kind" | "state" | "message">) =>
  job.kind === "index" && job.state === "failed" && job.message.includes("was indexed with other parameters");

export function describeFailed(job: Pick<Job, "kind" | "state" | "message">): string {
  return needsNewSearch(job) ? "It was searched with other options: only a part of it, say. What is new can be searched for after a search from the beginning." : job.message;
}
