// The objects that the page has loaded: pages of the list, those of the video that is shown, those that were selected.
import { batch, signal } from "@preact/signals";

import { countObjects, listObjects } from "./api/client";
import type { Counts, FoundObject, Review } from "./api/types";
import { type Reviews, isOwnKnown, ownDecision, reviewsOf, withStored } from "./logic/decisions";
import { type Filters, filterParams, isFiltered } from "./logic/filters";
import { PagedList } from "./logic/paged_list";
import type { Order } from "./logic/url_state";
import { withVerdict } from "./logic/threshold_cost";
import { me } from "./me";

export type Sort = Order;

const PAGE = 100;
const MAX_LANES = 200;
const MAX_PAGES_AT_ONCE = 3;

const known = new Map<number, FoundObject>();
/** Changes with the objects that are known. */
export const version = signal(0);

/** The list in its order, which stays while the page is open; null before it is loaded. */
export const list = signal<PagedList | null>(null);
/** Changes with the pages that are loaded. */
export const listVersion = signal(0);
/** Of all objects. */
export const counts = signal<Counts | null>(null);
/** Objects of the index when the list was made; null before. */
export const listedAll = signal<number | null>(null);
/** The list has objects that were joined, split or removed. */
export const isListOld = signal(false);
/** How many objects match the filters; null: not known yet. */
export const matching = signal<number | null>(null);
/** Of the objects that match all filters but that of the score; null: those of all, or not known yet. */
export const countsOfAnyScore = signal<Counts | null>(null);
/** The best objects of the video that is shown, best first. */
export const videoObjects = signal<{ video: number; ids: readonly number[]; total: number } | null>(null);
/** How many of them the reader has decided about; null: not known yet. */
export const ownCount = signal<number | null>(null);
/** Objects whose review the server does not have yet. */
export const pendingReviews = signal<ReadonlySet<number>>(new Set());
/** The last review that was written, for the map. */
export const lastReview = signal<{ id: number; review: Review | null } | null>(null);

let queueTime = 0;
let listParams = new URLSearchParams();
let listKey: string | null = null;
const pagesUnderWay = new Set<string>();

export function setQueueTime(utc_us: number) {
  queueTime = utc_us;
}

export function objectOf(id: number): FoundObject | undefined {
  void version.value;
  return known.get(id);
}

function remember(objects: readonly FoundObject[]) {
  for (const one of objects) {
    const before = known.get(one.id);
    const isNewer = before !== undefined && pendingReviews.peek().has(one.id);
    if (isNewer) known.set(one.id, { ...one, ...reviewsOf(before) });
    else known.set(one.id, before === undefined || isOwnKnown(one, me.peek()) ? one : { ...one, ...withOwnOf(before, one) });
  }
  version.value = version.peek() + 1;
}

/** The reader's decision stays where the server's answer leaves it out, because others have decided later. */
function withOwnOf(before: FoundObject, answer: FoundObject): Reviews {
  return withStored(reviewsOf(answer), me.peek(), ownDecision(before, me.peek()));
}

function paramsOf(sort: Sort, filters: Filters | null): URLSearchParams {
  const params = filters === null ? new URLSearchParams() : filterParams(filters, me.peek());
  params.set("sort", sort);
  if (sort === "queue") params.set("since", String(queueTime));
  return params;
}

const withParams = (params: URLSearchParams, more: Record<string, number>) => {
  const all = new URLSearchParams(params);
  for (const [name, value] of Object.entries(more)) all.set(name, String(value));
  return all;
};

/** Begins the list anew, with its first page. @param also  is done in the moment in which it is shown */
export async function loadList(sort: Sort, filters: Filters, isOnlyMatching: boolean, also?: () => void) {
  const params = paramsOf(sort, isOnlyMatching ? filters : null);
  const key = params.toString();
  listKey = key;
  const [page, all] = await Promise.all([
    listObjects(withParams(params, { offset: 0, limit: PAGE })),
    countObjects(new URLSearchParams()),
  ]);
  if (listKey !== key) return;
  listParams = params;
  const fresh = new PagedList(page.total ?? 0, PAGE);
  fresh.add(0, page.objects.map((one) => one.id));
  batch(() => {
    remember(page.objects);
    list.value = fresh;
    counts.value = all;
    listedAll.value = all.objects;
    listVersion.value++;
    isListOld.value = false;
    also?.();
  });
}

/** Reads the counts again. */
export async function refreshCounts() {
  const [all] = await Promise.all([countObjects(new URLSearchParams()), countOwn(), countAnyScore()]);
  counts.value = all;
}

export async function countOwn() {
  const reviewer = me.peek();
  const own = await countObjects(new URLSearchParams({ review: "own", reviewer }));
  if (me.peek() === reviewer) ownCount.value = own.objects;
}

/** Of the filters without that of the score; empty: there are none. */
let anyScoreParams = "";

async function countAnyScore() {
  const params = anyScoreParams;
  const found = params === "" ? null : await countObjects(new URLSearchParams(params));
  if (params === anyScoreParams) countsOfAnyScore.value = found;
}

let followTimer: ReturnType<typeof setTimeout> | undefined;
let followAbort: AbortController | null = null;

/** Follows the user's choice: counts what matches, and loads another list if the choice is one. */
export function follow(sort: Sort, filters: Filters, isOnlyMatching: boolean, fail: (error: unknown) => void) {
  followAbort?.abort();
  clearTimeout(followTimer);
  const isOther = paramsOf(sort, isOnlyMatching ? filters : null).toString() !== listKey;
  const params = filterParams({ ...filters, minScore: 0 }, me.peek()).toString();
  const isOtherCount = params !== anyScoreParams;
  if (!isFiltered(filters)) matching.value = null;
  if (!isFiltered(filters) && !isOther && !isOtherCount) return;
  const abort = new AbortController();
  followAbort = abort;
  // Not for each letter that is typed.
  followTimer = setTimeout(() => {
    if (isFiltered(filters)) {
      countObjects(filterParams(filters, me.peek()), abort.signal)
        .then((found) => (matching.value = found.objects))
        .catch((error: unknown) => !abort.signal.aborted && fail(error));
    }
    if (isOtherCount) {
      anyScoreParams = params;
      countAnyScore().catch(fail);
    }
    if (isOther) loadList(sort, filters, isOnlyMatching).catch(fail);
  }, 150);
}

/** Loads the pages of the list that hold these positions. */
export function need(first: number, last: number, fail: (error: unknown) => void) {
  shownRows = [first, last];
  const shown = list.peek();
  if (!shown) return;
  const params = listParams;
  for (const page of shown.missingPages(first, last).slice(0, MAX_PAGES_AT_ONCE)) {
    const wanted = withParams(params, { offset: page * PAGE, limit: PAGE });
    const key = wanted.toString();
    if (pagesUnderWay.has(key)) continue;
    pagesUnderWay.add(key);
    listObjects(wanted)
      .then((found) => addPage(shown, found))
      .catch(fail)
      .finally(() => pagesUnderWay.delete(key));
  }
}

function addPage(shown: PagedList, page: { objects: FoundObject[]; offset: number | null }) {
  batch(() => {
    remember(page.objects);
    if (page.offset === null) return;
    shown.add(page.offset, page.objects.map((one) => one.id));
    if (shown === list.peek()) listVersion.value++;
  });
}

/** Loads the page of the list that holds an object. */
export async function locate(id: number) {
  const shown = list.peek();
  if (shown) addPage(shown, await listObjects(withParams(listParams, { around: id, limit: PAGE })));
  // It may be one that the list leaves out.
  if (!known.has(id)) await needObjects([id]);
}

/** The object that a key names now; null: none. */
export async function idOfKey(key: string): Promise<number | null> {
  const found = await listObjects(new URLSearchParams({ key }));
  remember(found.objects);
  return found.objects[0]?.id ?? null;
}

/** Loads objects by id, unless they are known. */
export async function needObjects(ids: readonly number[]) {
  await readAgain(ids.filter((id) => !known.has(id)));
}

/** Loads objects by id, as they are now. */
export async function readAgain(ids: readonly number[]) {
  const wanted = [...new Set(ids)];
  for (let i = 0; i < wanted.length; i += 500) {
    remember((await listObjects(new URLSearchParams({ ids: wanted.slice(i, i + 500).join(",") }))).objects);
  }
}

/** Objects that are not in the index any more. */
export function forget(ids: readonly number[]) {
  for (const id of ids) known.delete(id);
  version.value++;
}

/** The objects, of those that are known, that these moments are of. */
export const holding = (moments: ReadonlySet<number>): number[] =>
  [...known.values()].filter((one) => one.moments.some(({ id }) => moments.has(id))).map(({ id }) => id);

/** All objects that match, in an order: page after page, so that no answer of the server is large. */
export async function loadAll(sort: Sort, filters: Filters, enough = Infinity): Promise<FoundObject[]> {
  const all: FoundObject[] = [];
  let cursor: string | null = null;
  do {
    const params = withParams(paramsOf(sort, filters), { limit: 1000 });
    if (cursor !== null) params.set("cursor", cursor);
    const page = await listObjects(params);
    all.push(...page.objects);
    cursor = page.next_cursor;
  } while (cursor !== null && all.length < enough);
  return all.slice(0, enough);
}

/** Positions of the list that are on the screen. */
let shownRows: [number, number] = [0, -1];

/** Reads again what is on the screen: others may have reviewed it. Returns whether the selected object is still there. */
export async function reread(selected: number | null): Promise<boolean> {
  const shown = list.peek();
  const ids = new Set(selected === null ? [] : [selected]);
  for (let at = shownRows[0]; at <= shownRows[1]; at++) {
    const id = shown?.at(at);
    if (id !== undefined) ids.add(id);
  }
  if (ids.size === 0) return true;
  const found = (await listObjects(new URLSearchParams({ ids: [...ids].join(",") }))).objects;
  remember(found);
  for (const { id } of found) ids.delete(id);
  if (shown === list.peek() && [...ids].some((id) => shown?.positionOf(id) !== undefined)) isListOld.value = true;
  return selected === null || !ids.has(selected);
}

export async function loadVideoObjects(video: number, signal: AbortSignal) {
  const params = withParams(new URLSearchParams(), { video, limit: MAX_LANES, offset: 0 });
  const page = await listObjects(params, signal);
  batch(() => {
    remember(page.objects);
    videoObjects.value = { video, ids: page.objects.map((one) => one.id), total: page.total ?? 0 };
  });
}

/** The nearest loaded object of the list before or after another one that passes a test. */
export function findNeighbour(id: number | null, by: 1 | -1, test: (object: FoundObject) => boolean) {
  const shown = list.peek();
  if (!shown) return "end";
  const from = id === null ? (by > 0 ? -1 : shown.total) : shown.positionOf(id);
  if (from === undefined) return "unknown";
  return shown.find(from, by, (one) => {
    const object = known.get(one);
    return object !== undefined && test(object);
  });
}

/** The same, of all objects: the server looks. */
export async function askNeighbour(id: number | null, by: 1 | -1, sort: Sort, filters: Filters): Promise<number | null> {
  const from = id === null ? undefined : { [by > 0 ? "after" : "before"]: id };
  const found = await listObjects(withParams(paramsOf(sort, filters), { ...from, limit: 1 }));
  remember(found.objects);
  return found.objects[0]?.id ?? null;
}

/** The last of all objects that match; null: none does. */
export async function askLast(sort: Sort, filters: Filters): Promise<number | null> {
  const ask = (offset: number) => listObjects(withParams(paramsOf(sort, filters), { offset, limit: 1 }));
  const { total } = await ask(0);
  const found = await ask(Math.max(0, (total ?? 0) - 1));
  remember(found.objects);
  return found.objects[0]?.id ?? null;
}

export function setReviews(id: number, reviews: Reviews) {
  const before = known.get(id);
  if (!before) return;
  const { review } = reviews;
  known.set(id, { ...before, ...reviewsOf(reviews) });
  batch(() => {
    version.value++;
    lastReview.value = { id, review };
    const isOwn = (of: Reviews) => Number((ownDecision(of, me.peek())?.verdict ?? null) !== null);
    if (ownCount.peek() !== null) ownCount.value = (ownCount.peek() ?? 0) + isOwn(reviews) - isOwn(before);
    const all = counts.peek();
    if (!all) return;
    counts.value = withVerdict(all, before.score, before.review?.verdict ?? null, review?.verdict ?? null);
  });
}

/** Adds a person's decision as the server has it; null: there is none. */
export function setStored(id: number, reviewer: string, own: Review | null) {
  const before = known.get(id);
  if (!before || ownDecision(before, reviewer)?.updated_utc_us === own?.updated_utc_us) return;
  known.set(id, { ...before, ...withStored(reviewsOf(before), reviewer, own) });
  version.value++;
}
