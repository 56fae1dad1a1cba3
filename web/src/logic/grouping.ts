// Joining and splitting of objects: the groups of moments that are sent to the server, and the messages.
import type { FoundObject, Moment } from "../api/types";
import { plural } from "./format";

/** The API's limits. */
const MAX_GROUPS = 20;
const MAX_MOMENTS = 1000;

/** Of each object the ids of its moments: they stay, the ids of objects change. */
export type Groups = readonly (readonly number[])[];

type Grouped = Pick<FoundObject, "moments">;

export const groupsOf = (objects: readonly Grouped[]): Groups => objects.map(({ moments }) => moments.map(({ id }) => id));

/** Without moments that an earlier group has: an object that another person has joined into it may still be listed. */
export function withoutDoubles(groups: Groups): Groups {
  const before = new Set<number>();
  const once = groups.map((group) => group.filter((id) => !before.has(id) && before.add(id)));
  return once.filter((group) => group.length > 0);
}

const isTooLarge = (objects: readonly Grouped[]) => objects.reduce((count, { moments }) => count + moments.length, 0) > MAX_MOMENTS;

/** Why these objects cannot be joined; null: they can. */
export function whyNotJoin(objects: readonly Pick<FoundObject, "moments" | "model_id" | "model">[]): string | null {
  if (objects.length < 2) return "Mark two or more objects (M) to join them.";
  const models = new Map(objects.map(({ model_id, model }) => [model_id, model]));
  if (models.size > 1) return `They are of different models, and so different objects: ${[...models.values()].join(", ")}.`;
  // Undo makes as many groups of them again.
  if (objects.length > MAX_GROUPS) return `At most ${MAX_GROUPS} objects are joined at once.`;
  return isTooLarge(objects) ? `They have more than ${plural(MAX_MOMENTS, "moment")}, too many to be joined at once.` : null;
}

/** Why the chosen moments cannot be split off an object; null: they can. */
export function whyNotSplit(object: Grouped, chosen: ReadonlySet<number>): string | null {
  const count = object.moments.filter(({ id }) => chosen.has(id)).length;
  if (count === 0) return "Choose the moments that are of another object.";
  if (count === object.moments.length) return "Leave at least one moment to this object.";
  return isTooLarge([object]) ? `It has more than ${plural(MAX_MOMENTS, "moment")}, too many to be split.` : null;
}

/** What stays, and what is another object. */
export function splitGroups(object: Grouped, chosen: ReadonlySet<number>): [number[], number[]] {
  const ids = object.moments.map(({ id }) => id);
  return [ids.filter((id) => !chosen.has(id)), ids.filter((id) => chosen.has(id))];
}

/** What a join did. Of verdicts that differ the latest stands. @param before  the objects that were joined */
export function describeJoin(before: readonly Pick<FoundObject, "review">[]): string {
  const verdicts = new Set(before.flatMap(({ review }) => review?.verdict ?? []));
  const joined = `Joined ${plural(before.length, "object")}`;
  return verdicts.size < 2 ? `${joined}.` : `${joined}, of which some were accepted and some rejected: the latest decision stands.`;
}

/** What a split did. The rest has another id if its first moment was split off. */
export function describeSplit(before: number, moments: number, rest: number, split: number): string {
  const what = `Split object ${before}: ${plural(moments, "moment")} ${moments === 1 ? "is" : "are"} object ${split}`;
  return rest === before ? `${what}.` : `${what}, the rest is object ${rest}.`;
}

/** Another one where the object has other moments, and so, maybe, another best sighting. */
export const lookOf = ({ moments }: Grouped): string => `${moments.length}-${moments.reduce((sum, { id }) => sum + id, 0)}`;

/** In the order of the videos, and of time in each. */
export const inOrder = (moments: readonly Moment[]): Moment[] =>
  [...moments].sort((a, b) => a.video_id - b.video_id || a.first_time_s - b.first_time_s);
