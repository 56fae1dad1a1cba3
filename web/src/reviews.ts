// Decisions about objects: shown at once, then confirmed by the server; one or some together; with undo.
import { computed, signal } from "@preact/signals";

import { ApiFailure, listDecisions, putReview } from "./api/client";
import type { Review, ReviewedObject, Verdict } from "./api/types";
import { type Reviews, isOwnKnown, ownDecision, ownOf, reviewsOf, withDecision } from "./logic/decisions";
import { messageOf } from "./logic/errors";
import { REASONS, takesReason } from "./logic/reasons";
import { type Regrouping, formatUndoSteps, isRegrouping, readUndoSteps } from "./logic/undo_steps";
import { type Filters, isChosen, nextReview } from "./logic/filters";
import { plural } from "./logic/format";
import { me } from "./me";
import { type NoticeChoice, dismiss, notices, notify, notifyError } from "./notices";
import * as objects from "./objects";
import { isChanging, isRegrouping as isBusyRegrouping, regroup } from "./regroup";
import { neighbour, select } from "./selection";
import { account, session } from "./session";
import { filters, isConnected, isQueueDone, matcher, project, selected, selectedId } from "./state";

const RETRY_MS = 3000;
/** In the storage of the tab: a reload does not end what can be taken back. */
const UNDO = "undo";

/** Objects that the next decision is about, together. */
export const marked = signal<ReadonlySet<number>>(new Set());
/** For the case that `can_review` is not set. */
export const whyNoReview = computed(() =>
  account.value?.role === "viewer"
    ? "You may look, but not review: that needs the role analyst."
    : "This index cannot be written: reviews are not kept. Who runs the server can change that.",
);

/** Of one person about one object. */
interface Decision {
  id: number;
  reviewer: string;
  verdict: Verdict;
  note: string;
}
/** What was decided before, or which moments were one object. */
type Step = Decision[] | Regrouping;
/** Of each person; those who share a page do not take back each other's decisions. */
const undoSteps = new Map<string, Promise<Step>[]>(
  readUndoSteps<Decision>(sessionStorage.getItem(UNDO)).map(([reviewer, steps]) => [reviewer, steps.map((one) => Promise.resolve(one))]),
);
/** What the server does not have yet, by person and object: of several decisions the latest. */
const pending = signal<ReadonlyMap<string, Decision>>(new Map());

/** With accounts the server stores a review as that of the account, whoever the page says. */
const canSend = (reviewer: string) => session.value?.has_accounts !== true || account.value?.name === reviewer;

/** How many reviews wait until their person has logged in. */
export const waiting = computed(() => {
  const counts = new Map<string, number>();
  for (const { reviewer } of pending.value.values()) {
    if (!canSend(reviewer)) counts.set(reviewer, (counts.get(reviewer) ?? 0) + 1);
  }
  return counts;
});

const keyOf = (reviewer: string, id: number) => `${id} ${reviewer}`;

/** What is on its way to the server, by person and object. */
const underWay = new Map<string, Promise<unknown>>();
let isLeaving = false;

/** The page may go: what is decided now does not wait for the answer to what was decided before. */
export function hurry() {
  isLeaving = true;
  // For the case that it stays, or comes back.
  setTimeout(() => (isLeaving = false));
}

/** Of two decisions of a person about an object, the later one arrives later. */
async function sendInOrder(key: string, isLatest: () => boolean, send: () => Promise<ReviewedObject>): Promise<ReviewedObject | null> {
  for (let before = underWay.get(key); before !== undefined && !isLeaving; before = underWay.get(key)) {
    await before.catch(() => undefined);
    if (!isLatest()) return null;
  }
  const sent = send();
  underWay.set(key, sent);
  try {
    return await sent;
  } finally {
    if (underWay.get(key) === sent) underWay.delete(key);
  }
}

/** Keeps the steps that can be taken back, for the case of a reload. */
async function keepUndoSteps() {
  const known = await Promise.all([...undoSteps].map(async ([name, steps]) => [name, await settled(steps)] as const));
  sessionStorage.setItem(UNDO, formatUndoSteps(known));
}

async function settled<T>(promises: readonly Promise<T>[]): Promise<T[]> {
  const all = await Promise.allSettled(promises);
  return all.flatMap((one) => (one.status === "fulfilled" ? [one.value] : []));
}

function setPending(key: string, decision: Decision | null) {
  const next = new Map(pending.peek());
  if (decision) next.set(key, decision);
  else next.delete(key);
  pending.value = next;
  objects.pendingReviews.value = new Set([...next.values()].map((one) => one.id));
}

const asReview = ({ reviewer, verdict, note }: Decision): Review => ({ verdict, note, reviewer, updated_utc_us: Date.now() * 1000 });

/** The reviews of an object with what other persons of this page have decided and the server does not have yet. */
function withPending(id: number, reviews: Reviews): Reviews {
  const others = [...pending.peek().values()].filter((one) => one.id === id);
  return others.reduce((before, one) => withDecision(before, asReview(one)), reviews);
}

async function writeReview(wanted: Decision) {
  const decision = { ...wanted };
  const { id, reviewer, verdict, note } = decision;
  const object = objects.objectOf(id);
  if (!object) return;
  const key = keyOf(reviewer, id);
  const stored = ownDecision(object, reviewer);
  let isTold = false;
  const isLatest = () => pending.peek().get(key) === decision;
  setPending(key, decision);
  objects.setReviews(id, withDecision(reviewsOf(object), asReview(decision)));
  while (isLatest()) {
    if (canSend(reviewer)) {
      try {
        const reviewed = await sendInOrder(key, isLatest, () => putReview(id, verdict, note, reviewer));
        if (reviewed === null) return;
        isConnected.value = true;
        if (!isLatest()) return;
        setPending(key, null);
        objects.setReviews(id, withPending(id, reviewed));
        return;
      } catch (error) {
        if (!isLatest()) return;
        // A server without its database answers, too: that is no refusal.
        const isAway = error instanceof ApiFailure && (error.status === 0 || error.status >= 500);
        if (!isAway && !(error instanceof ApiFailure && error.status === 401)) {
          setPending(key, null);
          if (told?.reviewer === reviewer && told.ids.includes(id)) endMessage(told);
          notify(`The review is not stored: ${messageOf(error)}`, "error");
          const shown = objects.objectOf(id) ?? object;
          objects.setReviews(id, withDecision(reviewsOf(shown), stored ?? asReview({ id, reviewer, verdict: null, note: "" })));
          return;
        }
        if (isAway) isConnected.value = false;
      }
    }
    // Nothing typed is lost: the review is kept and sent again once the server answers, or its person has logged in.
    if (!canSend(reviewer) && !isTold) {
      notify(`What ${reviewer || "a reviewer without a name"} decided is kept, and stored after a log-in with that name.`, "error");
      isTold = true;
    }
    await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
  }
}

/** Says why not. */
export function canReview() {
  const isAllowed = project.value.state !== "ready" || project.value.value.can_review;
  if (!isAllowed) notify(whyNoReview.value, "error");
  return isAllowed;
}

export function review(id: number, verdict: Verdict) {
  if (!objects.objectOf(id) || isChanging(id) || !canReview()) return;
  if (told?.ids.includes(id) === true) endMessage(told);
  void change([id], (before) => ({ ...before, verdict }));
}

/** Decisions of which a message tells; as long as it stands, a rejection takes a reason. */
interface Told {
  ids: readonly number[];
  /** "jeep 3: rejected" */
  text: string;
  reviewer: string;
  /** What undo takes back, and whether it came about. */
  step: Promise<Step> | undefined;
  isDone: Promise<boolean>;
  notice: number;
  /** The reason that was given last. */
  reason: string | null;
  isOver: boolean;
}
let told: Told | null = null;

/** The message does not hold any more. */
function endMessage(one: Told) {
  one.isOver = true;
  dismiss(one.notice);
  if (told === one) told = null;
}

/** Says what was just decided by change(), and what may be done about it. */
function tell(ids: readonly number[], text: string, verdict: Exclude<Verdict, null>, isDone: Promise<boolean>) {
  const reviewer = me.peek();
  const notice = notify(`${text}.`, "info", "review", [UNDO_ACTION], verdict === "rejected" ? choicesOf(null) : []);
  const one: Told = { ids, text, reviewer, step: undoSteps.get(reviewer)?.at(-1), isDone, notice, reason: null, isOver: false };
  told = one;
  void isDone.then((isThere) => {
    if (!isThere) endMessage(one);
  });
}

const choicesOf = (chosen: string | null): NoticeChoice[] =>
  REASONS.map(({ key, text }) => ({ key, label: text, isChosen: text === chosen, run: () => giveReason(key) }));

/** Puts the reason of a key to what was just rejected. Returns whether one is asked for: false as soon as its message has gone. */
export function giveReason(key: string): boolean {
  const one = told;
  const reason = REASONS.find((other) => other.key === key);
  if (!one || !reason || one.reviewer !== me.peek()) return false;
  if (!notices.peek().some(({ id, choices }) => id === one.notice && choices.length > 0)) return false;
  one.reason = reason.text;
  void putReason(one, reason.text);
  return true;
}

async function putReason(one: Told, reason: string) {
  if (!(await one.isDone) || one.isOver || one.reason !== reason) return;
  const owns = one.ids.flatMap((id) => {
    const object = objects.objectOf(id);
    const own = object ? ownDecision(object, one.reviewer) : null;
    return own?.verdict === "rejected" ? [{ id, note: own.note }] : [];
  });
  const free = owns.filter(({ note }) => takesReason(note));
  // The same step of undo as the rejection.
  for (const { id } of free) void writeReview({ id, reviewer: one.reviewer, verdict: "rejected", note: reason });
  if (free.length < owns.length) notify(owns.length === 1 ? "It has a note, which stays." : "Notes that are there stay.");
  if (free.length > 0 && told === one) one.notice = notify(`${one.text}, ${reason}.`, "info", "review", [UNDO_ACTION], choicesOf(reason));
}

/**
 * Stores a note beside what the reader decided, if it is another one than before.
 * @param isSameStep  it goes on with the note that was stored last: one step of undo takes back both
 * Returns whether it is another one.
 */
export function note(id: number, text: string, isSameStep = false): boolean {
  const object = objects.objectOf(id);
  if (!object || text === (ownDecision(object, me.peek())?.note ?? "") || !canReview()) return false;
  if (!isSameStep) {
    void change([id], (before) => ({ ...before, note: text }));
    return true;
  }
  presentDecision(id, me.peek())
    .then((before) => void writeReview({ ...before, note: text }))
    .catch((error: unknown) => notify(`The note is not stored: ${messageOf(error)}`, "error"));
  return true;
}

/** Replaces what the reader decided about objects; one step of undo. Returns whether what to replace was known. */
async function change(ids: readonly number[], next: (before: Decision) => Decision): Promise<boolean> {
  const reviewer = me.peek();
  const step = Promise.all(ids.map((id) => presentDecision(id, reviewer)));
  const steps = () => undoSteps.get(reviewer) ?? [];
  undoSteps.set(reviewer, [...steps(), step]);
  try {
    for (const before of await step) void writeReview(next(before));
    void keepUndoSteps();
    return true;
  } catch (error) {
    undoSteps.set(reviewer, steps().filter((one) => one !== step));
    notify(`The review is not stored: ${messageOf(error)}`, "error");
    return false;
  }
}

async function presentDecision(id: number, reviewer: string): Promise<Decision> {
  const isKnown = () => pending.peek().has(keyOf(reviewer, id)) || isOwnKnown(objects.objectOf(id), reviewer);
  if (!isKnown()) {
    const decisions = await listDecisions(id);
    // Not if the reader has decided meanwhile.
    if (!isKnown()) setStored(id, reviewer, decisions);
  }
  const own = ownOf(objects.objectOf(id)?.decisions ?? [], reviewer);
  return { id, reviewer, verdict: own?.verdict ?? null, note: own?.note ?? "" };
}

/** Shows a person's decision as the server has it, unless a later one is on its way there. */
export function setStored(id: number, reviewer: string, decisions: readonly Review[]) {
  if (!pending.peek().has(keyOf(reviewer, id))) objects.setStored(id, reviewer, ownOf(decisions, reviewer));
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
  const ids = [...marked.value].filter((id) => objects.objectOf(id) !== undefined);
  if (ids.some(isChanging)) return;
  marked.value = new Set();
  const isDone = change(ids, (before) => ({ ...before, verdict }));
  tell(ids, `${plural(ids.length, "object")} ${verdict}`, verdict, isDone);
  void isDone.then((isThere) => {
    if (!isThere) marked.value = new Set([...marked.value, ...ids]);
  });
}

/** What is said once nothing is left to decide. */
export const queueEnd = computed(() =>
  isChosen({ ...filters.value, review: "all" })
    ? "All that matches the filters is reviewed. U takes the last decision back."
    : "All reviewed. U takes the last decision back.",
);

/** Decides about the selected object and goes on to the next one to review. */
export function decide(verdict: Exclude<Verdict, null>) {
  if (!canReview()) return;
  if (marked.value.size > 0) return decideMarked(verdict);
  const object = selected.value;
  if (!object || isChanging(object.id)) return;
  // The key that ended the queue, pressed again, decides nothing.
  if (isQueueDone.value) {
    notify(queueEnd.value);
    return;
  }
  const wanted = { ...filters.value, review: nextReview(filters.value.review) };
  const next = neighbour(1, wanted);
  tell([object.id], `${object.model} ${object.id}: ${verdict}`, verdict, change([object.id], (before) => ({ ...before, verdict })));
  void goOn(object.id, next, wanted).catch(notifyError);
}

/** Selects the next object to review, which may stand before the one that was decided; else says that there is none. */
async function goOn(from: number, next: Promise<number | null>, wanted: Filters) {
  const after = await next;
  const id = after ?? (await neighbour(1, wanted, null));
  if (selectedId.value !== from) return;
  if (id !== null && id !== from) {
    select(id, { push: true });
    if (after === null) notify("The rest of the list is reviewed: on from its beginning.");
    return;
  }
  isQueueDone.value = true;
  notify(queueEnd.value);
}

/** Takes back the reader's last step. */
export function undo() {
  // What was decided before may be about objects that come back with it.
  if (isBusyRegrouping.peek()) return;
  const last = undoSteps.get(me.peek())?.pop();
  isQueueDone.value = false;
  if (!last) {
    notify("There is nothing to take back.");
    return;
  }
  if (last === told?.step) endMessage(told);
  takeBack(last).catch(notifyError);
}

async function takeBack(step: Promise<Step>) {
  // change() has said why it is not known.
  const all = await step.catch(() => []);
  void keepUndoSteps();
  if (isRegrouping(all)) return takeRegroupingBack(all);
  // After a reload, they may not be loaded.
  await objects.needObjects(all.map((one) => one.id));
  const there = all.filter((one) => objects.objectOf(one.id) !== undefined);
  if (there.length < all.length) notify("What was decided about is not in this index any more: a new search has replaced it.", "error");
  for (const before of there) void writeReview(before);
  if (there[0]) select(there[0].id);
}

/** Objects were joined or split: a step of undo. @param before  which moments were one object */
export function addRegrouping(before: Regrouping) {
  const reviewer = me.peek();
  if (told) endMessage(told);
  undoSteps.set(reviewer, [...(undoSteps.get(reviewer) ?? []), Promise.resolve(before)]);
  void keepUndoSteps();
}

async function takeRegroupingBack(step: Regrouping) {
  try {
    await regroup(step.groups, step.correction);
    // In place of the message whose undo it was.
    const isJoin = step.groups.length > 1;
    notify(isJoin ? `Took back the join: ${plural(step.groups.length, "object")} again.` : "Took back the split: one object again.", "info", "review");
  } catch (error) {
    // A moment that is not there any more never comes back.
    if (!(error instanceof ApiFailure && error.status === 404)) addRegrouping(step);
    throw error;
  }
}

export const UNDO_ACTION = { label: "Undo (U)", run: undo };
