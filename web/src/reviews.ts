// Decisions about objects: shown at once, then confirmed by the server; one or some together; with undo.
import { computed, signal } from "@preact/signals";

import { ApiFailure, putReview } from "./api/client";
import type { FoundObject, Verdict } from "./api/types";
import { ownDecision, reviewsOf, withDecision } from "./logic/decisions";
import { messageOf } from "./logic/errors";
import { nextReview } from "./logic/filters";
import { plural } from "./logic/format";
import { me } from "./me";
import { notify, notifyError } from "./notices";
import * as objects from "./objects";
import { neighbour, select } from "./selection";
import { account } from "./session";
import { filters, isConnected, matcher, project, selected, selectedId } from "./state";

const RETRY_MS = 3000;

/** Objects that the next decision is about, together. */
export const marked = signal<ReadonlySet<number>>(new Set());
/** For the case that `can_review` is not set. */
export const whyNoReview = computed(() =>
  account.value?.role === "viewer"
    ? "You may look, but not review: that needs the role analyst."
    : "This index cannot be written: reviews are not kept.",
);

/** Of one person about one object. */
interface Decision {
  id: number;
  reviewer: string;
  verdict: Verdict;
  note: string;
}
/** What was decided before. */
const undoStack: Decision[][] = [];
const pendingReviews = objects.pendingReviews;
const latestWrite = new Map<number, number>();
let writes = 0;

async function writeReview({ id, reviewer, verdict, note }: Decision) {
  const object = objects.objectOf(id);
  if (!object) return;
  const write = ++writes;
  const stored = reviewsOf(object);
  const isLatest = () => latestWrite.get(id) === write;
  latestWrite.set(id, write);
  pendingReviews.value = new Set([...pendingReviews.value, id]);
  objects.setReviews(id, withDecision(stored, { verdict, note, reviewer, updated_utc_us: Date.now() * 1000 }));
  while (isLatest()) {
    try {
      const reviewed = await putReview(id, verdict, note, reviewer);
      isConnected.value = true;
      if (isLatest()) objects.setReviews(id, reviewed);
      break;
    } catch (error) {
      if (!isLatest()) return;
      if (!(error instanceof ApiFailure && (error.status === 0 || error.status === 401))) {
        notify(`The review is not stored: ${messageOf(error)}`, "error");
        objects.setReviews(id, stored);
        break;
      }
      // Nothing typed is lost: the review is kept and sent again once the server answers, or the user has logged in.
      if (error.status === 0) isConnected.value = false;
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
  }
  if (!isLatest()) return;
  const left = new Set(pendingReviews.value);
  left.delete(id);
  pendingReviews.value = left;
}

function canReview() {
  const isAllowed = project.value.state !== "ready" || project.value.value.can_review;
  if (!isAllowed) notify(whyNoReview.value, "error");
  return isAllowed;
}

export function review(id: number, verdict: Verdict, note?: string) {
  const object = objects.objectOf(id);
  if (!object) return;
  if (!canReview()) return;
  const before = presentDecision(object);
  undoStack.push([before]);
  void writeReview({ ...before, verdict, note: note ?? before.note });
}

function presentDecision(object: FoundObject): Decision {
  const own = ownDecision(object, me.peek());
  return { id: object.id, reviewer: me.peek(), verdict: own?.verdict ?? null, note: own?.note ?? "" };
}

/** Marks the selected object, or takes its mark back. */
export function toggleMark(id: number | null) {
  if (id === null) return;
  const next = new Set(marked.value);
  if (!next.delete(id)) next.add(id);
  marked.value = next;
}

/** Marks what lies between two objects of the list, as far as it is loaded and matches the filters. */
export function markRange(from: number, to: number) {
  const list = objects.list.value;
  const [a, b] = [list?.positionOf(from), list?.positionOf(to)];
  if (!list || a === undefined || b === undefined) return toggleMark(to);
  const next = new Set(marked.value);
  for (let at = Math.min(a, b); at <= Math.max(a, b); at++) {
    const id = list.at(at);
    const object = id === undefined ? undefined : objects.objectOf(id);
    if (object && matcher.value(object)) next.add(object.id);
  }
  marked.value = next;
}

/** One decision about all marked objects; one step of undo. */
function decideMarked(verdict: Exclude<Verdict, null>) {
  const all = [...marked.value].flatMap((id) => objects.objectOf(id) ?? []).map(presentDecision);
  undoStack.push(all);
  for (const before of all) void writeReview({ ...before, verdict });
  marked.value = new Set();
  notify(`${plural(all.length, "object")} ${verdict}. U takes it back.`);
}

/** Decides about the selected object and goes on to the next one to review. */
export function decide(verdict: Exclude<Verdict, null>) {
  if (!canReview()) return;
  if (marked.value.size > 0) return decideMarked(verdict);
  const object = selected.value;
  if (!object) return;
  const next = neighbour(1, { ...filters.value, review: nextReview(filters.value.review) });
  review(object.id, verdict);
  notify(`${object.model} ${object.id}: ${verdict}. U takes it back.`);
  next
    .then((id) => {
      if (id !== null && selectedId.value === object.id) select(id, { push: true });
    })
    .catch(notifyError);
}

export function undo() {
  const last = undoStack.pop();
  if (!last) {
    notify("There is nothing to take back.");
    return;
  }
  for (const before of last) void writeReview(before);
  if (last[0]) select(last[0].id);
}
