// What a job has come to, in the words of the page; the server's own message is that of the command that it ran.
import type { Job } from "../api/types";
import { formatMetres, formatSpan, plural } from "./format";

const SEARCHED = /\d[\d,]* frames? searched, \d[\d,]* sightings?/;

/** @param objects  that the video has now; null: not known. @param span  when what was followed was in sight, s; null: not known */
export function describeDone(job: Pick<Job, "kind" | "message">, objects: number | null, span: { first: number; last: number } | null): string {
  const { kind, message } = job;
  if ((kind === "index" || kind === "live") && SEARCHED.test(message)) {
    if (message.includes("(already indexed)")) return "Already searched, nothing new";
    const found = objects === null ? "Searched" : objects === 0 ? "Nothing found" : `${plural(objects, "object")} found`;
    return message.includes("there is no telemetry") ? `${found}; without telemetry, none has a place` : found;
  }
  if (kind === "track") {
    const followed = span === null ? "Followed" : `Followed ${formatSpan(span.first, span.last)}`;
    const within = /CE90 ([\d.]+) m/.exec(message)?.[1];
    const speed = /moving at ([\d.]+) m\/s/.exec(message)?.[1];
    const why = /: no place: (.*)$/.exec(message)?.[1];
    const place = within !== undefined ? `; 90 % within ${formatMetres(Number(within))}` : why !== undefined ? `; no place: ${why}` : "";
    return followed + place + (speed === undefined ? "" : `, ${speed} m/s`);
  }
  return message;
}

/** A video was searched with other options than those of the server: in part, say. */
export const needsNewSearch = (job: Pick<Job, "kind" | "state" | "message">) =>
  job.kind === "index" && job.state === "failed" && job.message.includes("was indexed with other parameters");

export function describeFailed(job: Pick<Job, "kind" | "state" | "message">): string {
  return needsNewSearch(job) ? "It was searched with other options: only a part of it, say. What is new can be searched for after a search from the beginning." : job.message;
}
