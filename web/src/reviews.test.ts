import { beforeEach, describe, expect, it, vi } from "vitest";

import type { FoundObject, Review } from "./api/types";

const server = vi.hoisted(() => {
  vi.stubGlobal("localStorage", { getItem: () => null, setItem: () => {} });
  const kept = new Map<string, string>();
  vi.stubGlobal("sessionStorage", { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => kept.set(key, value), clear: () => kept.clear() });
  return { putReview: vi.fn(), listDecisions: vi.fn(), listObjects: vi.fn() };
});

vi.mock("./api/client", () => ({
  ...server,
  ApiFailure: class extends Error {
    constructor(message: string, readonly status: number) {
      super(message);
    }
  },
  onUnauthenticated: () => {},
}));
vi.mock("./selection", () => ({ neighbour: () => Promise.resolve(null), select: () => {} }));
const regroup = vi.hoisted(() => vi.fn());
vi.mock("./regroup", async () => {
  const { signal } = await import("@preact/signals");
  return { isChanging: () => false, isRegrouping: signal(false), regroup };
});
vi.mock("./state", async () => {
  const { signal } = await import("@preact/signals");
  return {
    filters: signal({ review: "all" }),
    isConnected: signal(true),
    isQueueDone: signal(false),
    matcher: signal(() => true),
    project: signal({ state: "ready", value: { can_review: true } }),
    selected: signal(null),
    selectedId: signal(null),
  };
});

const { ApiFailure } = await import("./api/client");
const { MAX_DECISIONS, ownDecision } = await import("./logic/decisions");
const { givenName } = await import("./me");
const { notices } = await import("./notices");
const objects = await import("./objects");
const reviews = await import("./reviews");
const state = await import("./state");
const { session } = await import("./session");

const say = (reviewer: string, verdict: Review["verdict"], note = "", at = 1): Review => ({ reviewer, verdict, note, updated_utc_us: at });
const logIn = (name: string | null) => (session.value = { has_accounts: true, account: name === null ? null : { name, role: "analyst" } } as typeof session.value);
const sent = () => server.putReview.mock.calls.map((call) => call as unknown[]);
const settle = () => vi.advanceTimersByTimeAsync(0);
const own = (id: number, name: string) => {
  const object = objects.objectOf(id);
  return object ? ownDecision(object, name) : null;
};

let nextId = 1;
/** An object as the list has it; `stored`: all that was decided about it, latest first. */
async function show(stored: Review[]) {
  const id = nextId++;
  const decisions = stored.slice(0, MAX_DECISIONS);
  const object = { id, model: "jet", moments: [], review: stored[0] ?? null, decisions, is_disputed: false };
  server.listObjects.mockResolvedValue({ objects: [object as unknown as FoundObject] });
  server.listDecisions.mockResolvedValue(stored);
  await objects.needObjects([id]);
  return id;
}
const crowd = Array.from({ length: MAX_DECISIONS }, (_, i) => say(`other ${i}`, "rejected", "", 100 - i));

beforeEach(() => {
  vi.useFakeTimers();
  for (const one of [...Object.values(server), regroup]) one.mockReset();
  server.putReview.mockImplementation((id: number, verdict: Review["verdict"], note: string, reviewer: string) =>
    Promise.resolve({ object_id: id, review: say(reviewer, verdict, note), decisions: [say(reviewer, verdict, note)], is_disputed: false }),
  );
  session.value = { has_accounts: false, account: null };
  givenName.value = "ann";
  notices.value = [];
  state.isQueueDone.value = false;
});

/** As the key does: rejects what is selected. */
async function reject(stored: Review[] = []) {
  const id = await show(stored);
  (state.selected as { value: unknown }).value = objects.objectOf(id);
  state.isQueueDone.value = false;
  reviews.decide("rejected");
  return id;
}
const told = () => notices.value.filter((one) => one.about === "review").map((one) => one.text);

describe("the reason of a rejection", () => {
  it("is its note, one step of undo with it", async () => {
    const id = await reject();
    await settle();
    expect(reviews.giveReason("3")).toBe(true);
    await settle();
    expect(sent().at(-1)).toEqual([id, "rejected", "nothing there", "ann"]);
    expect(told()).toEqual([`jet ${id}: rejected, nothing there.`]);
    reviews.undo();
    await settle();
    await settle();
    expect(sent().at(-1)).toEqual([id, null, "", "ann"]);
    expect(told()).toEqual([]);
  });

  it("is asked for as long as the message stands", async () => {
    const id = await reject();
    await settle();
    expect(reviews.giveReason("9")).toBe(false);
    await vi.advanceTimersByTimeAsync(10_000);
    expect(reviews.giveReason("3")).toBe(false);
    await settle();
    expect(sent()).toEqual([[id, "rejected", "", "ann"]]);
  });

  it("is not put after undo, also if the rejection waited for what was decided before", async () => {
    const id = await reject([...crowd, say("ann", null, "")]);
    expect(reviews.giveReason("2")).toBe(true);
    reviews.undo();
    expect(reviews.giveReason("2")).toBe(false);
    await settle();
    await settle();
    expect(sent().filter(([, , note]) => note !== "")).toEqual([]);
    expect(own(id, "ann")?.verdict ?? null).toBeNull();
    expect(told()).toEqual([]);
  });

  it("is not asked for once another decision has replaced the rejection", async () => {
    const id = await reject();
    await settle();
    reviews.review(id, null);
    await settle();
    expect(reviews.giveReason("2")).toBe(false);
    await reject();
    givenName.value = "bob";
    expect(reviews.giveReason("2")).toBe(false);
  });

  it("replaces an earlier reason, the last one arrives last", async () => {
    const id = await reject();
    const answers: (() => void)[] = [];
    server.putReview.mockImplementation((of: number, verdict: Review["verdict"], note: string, reviewer: string) =>
      new Promise((resolve) => answers.push(() => resolve({ object_id: of, review: say(reviewer, verdict, note), decisions: [say(reviewer, verdict, note)], is_disputed: false }))),
    );
    await settle();
    reviews.giveReason("2");
    await settle();
    reviews.giveReason("4");
    await settle();
    // One at a time: the server may answer the second request first.
    expect(sent().map(([, , note]) => note)).toEqual([""]);
    answers.shift()?.();
    await settle();
    expect(sent().map(([, , note]) => note)).toEqual(["", "wrong place or size"]);
    answers.shift()?.();
    await settle();
    expect(own(id, "ann")?.note).toBe("wrong place or size");
    expect(told()).toEqual([`jet ${id}: rejected, wrong place or size.`]);
  });

  it("leaves a note that was written", async () => {
    const id = await reject([say("ann", null, "by the barn")]);
    await settle();
    expect(reviews.giveReason("2")).toBe(true);
    await settle();
    expect(sent()).toEqual([[id, "rejected", "by the barn", "ann"]]);
    expect(notices.value.map((one) => one.text)).toContain("It has a note, which stays.");
  });

  it("is not asked for if the server has refused the rejection", async () => {
    server.putReview.mockRejectedValueOnce(new ApiFailure("no", 403));
    await reject();
    await settle();
    expect(reviews.giveReason("2")).toBe(false);
    expect(told()).toEqual([]);
  });

  it("is of all that were rejected together", async () => {
    const ids = [await show([]), await show([say("ann", "accepted", "mine")])];
    reviews.marked.value = new Set(ids);
    reviews.decide("rejected");
    await settle();
    reviews.giveReason("5");
    await settle();
    expect(ids.map((id) => own(id, "ann")?.note)).toEqual(["cannot tell", "mine"]);
    expect(told()).toEqual(["2 objects rejected, cannot tell."]);
  });
});

describe("what can be taken back", () => {
  it("outlives a reload of the page", async () => {
    const id = await show([say("ann", "accepted", "by the barn")]);
    reviews.review(id, "rejected");
    await settle();
    const stored = { id, model: "jet", moments: [], review: say("ann", "rejected", "by the barn"), decisions: [say("ann", "rejected", "by the barn")], is_disputed: false };
    vi.resetModules();
    const reloaded = await import("./reviews");
    server.listObjects.mockResolvedValue({ objects: [stored as unknown as FoundObject] });
    (await import("./me")).givenName.value = "ann";
    (await import("./session")).session.value = { has_accounts: false, account: null };
    reloaded.undo();
    await settle();
    await settle();
    expect(sent().at(-1)).toEqual([id, "accepted", "by the barn", "ann"]);
    // It is taken back once.
    const count = sent().length;
    reloaded.undo();
    await settle();
    expect(sent().slice(count).filter(([of]) => of === id)).toEqual([]);
  });

  it("is also which moments were one object", async () => {
    const id = await show([]);
    reviews.review(id, "accepted");
    await settle();
    reviews.addRegrouping({ groups: [[1, 5], [2]], correction: 7 });
    await settle();
    vi.resetModules();
    const reloaded = await import("./reviews");
    (await import("./me")).givenName.value = "ann";
    (await import("./session")).session.value = { has_accounts: false, account: null };
    // A server that is away now may have it later.
    regroup.mockRejectedValueOnce(new ApiFailure("The server does not answer.", 0));
    reloaded.undo();
    await settle();
    regroup.mockResolvedValue({ object_ids: [1, 2], correction: null });
    reloaded.undo();
    await settle();
    expect(regroup.mock.calls).toEqual([[[[1, 5], [2]], 7], [[[1, 5], [2]], 7]]);
    reloaded.undo();
    await settle();
    await settle();
    expect(sent().at(-1)).toEqual([id, null, "", "ann"]);
    expect(regroup).toHaveBeenCalledTimes(2);
  });

  it("is a note as a whole, however often it was stored while it was typed", async () => {
    const id = await show([say("ann", "accepted", "old")]);
    reviews.note(id, "by");
    await settle();
    reviews.note(id, "by the", true);
    await settle();
    reviews.note(id, "by the barn", true);
    await settle();
    expect(sent().map(([, , text]) => text)).toEqual(["by", "by the", "by the barn"]);
    reviews.undo();
    await settle();
    await settle();
    expect(sent().at(-1)).toEqual([id, "accepted", "old", "ann"]);
  });
});

describe("a decision that came without the reader's own", () => {
  it("keeps the stored note, and undo restores all of it", async () => {
    const id = await show([...crowd, say("ann", "accepted", "by the barn")]);
    reviews.review(id, "rejected");
    await settle();
    expect(sent()).toEqual([[id, "rejected", "by the barn", "ann"]]);
    reviews.undo();
    await settle();
    expect(sent()[1]).toEqual([id, "accepted", "by the barn", "ann"]);
  });

  it("is not sent while the own one cannot be read", async () => {
    const id = await show([...crowd, say("ann", "accepted", "by the barn")]);
    server.listDecisions.mockRejectedValue(new ApiFailure("away", 0));
    reviews.review(id, "rejected");
    await settle();
    expect(sent()).toEqual([]);
    expect(objects.pendingReviews.value.size).toBe(0);
  });

  it("is not asked for where all have come", async () => {
    const id = await show([say("bob", "accepted"), say("ann", null, "look again")]);
    reviews.review(id, "accepted");
    await settle();
    expect(server.listDecisions).not.toHaveBeenCalled();
    expect(sent()).toEqual([[id, "accepted", "look again", "ann"]]);
  });

  it("remains when the object is read again", async () => {
    const id = await show([...crowd, say("ann", "accepted", "by the barn")]);
    reviews.setStored(id, "ann", [say("ann", "accepted", "by the barn")]);
    await objects.reread(id);
    expect(own(id, "ann")?.note).toBe("by the barn");
    expect(objects.objectOf(id)?.review?.reviewer).toBe("other 0");
  });
});

describe("a review that is not stored yet", () => {
  it("waits for its own person after the session has ended", async () => {
    logIn("ann");
    const id = await show([]);
    server.putReview.mockImplementationOnce(() => {
      logIn(null);
      return Promise.reject(new ApiFailure("log in", 401));
    });
    reviews.review(id, "accepted");
    await settle();
    expect(sent()).toHaveLength(1);
    expect([...reviews.waiting.value]).toEqual([["ann", 1]]);
    logIn("bob");
    await vi.advanceTimersByTimeAsync(60_000);
    expect(sent()).toHaveLength(1);
    expect(objects.pendingReviews.value.has(id)).toBe(true);
    logIn("ann");
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent()[1]).toEqual([id, "accepted", "", "ann"]);
    expect(objects.pendingReviews.value.size).toBe(0);
    expect(reviews.waiting.value.size).toBe(0);
  });

  it("is not dropped by that of another person", async () => {
    logIn("ann");
    const id = await show([]);
    server.putReview.mockRejectedValueOnce(new ApiFailure("away", 0));
    reviews.note(id, "ann's");
    await settle();
    logIn("bob");
    reviews.note(id, "bob's");
    await settle();
    expect(sent()[1]).toEqual([id, null, "bob's", "bob"]);
    expect(own(id, "ann")?.note).toBe("ann's");
    expect(objects.pendingReviews.value.has(id)).toBe(true);
    logIn("ann");
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent()[2]).toEqual([id, null, "ann's", "ann"]);
  });

  it("without accounts is sent in the name that made it", async () => {
    const id = await show([]);
    server.putReview.mockRejectedValueOnce(new ApiFailure("away", 0));
    reviews.review(id, "accepted");
    await settle();
    givenName.value = "bob";
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent()[1]).toEqual([id, "accepted", "", "ann"]);
  });

  it("that is refused leaves what others decided", async () => {
    const id = await show([say("bob", "accepted")]);
    server.putReview.mockRejectedValueOnce(new ApiFailure("no", 403));
    reviews.review(id, "rejected");
    await settle();
    expect(objects.objectOf(id)?.decisions).toEqual([say("bob", "accepted")]);
    expect(objects.pendingReviews.value.size).toBe(0);
  });
});

describe("undo", () => {
  it("takes back one's own steps only", async () => {
    const [first, second] = [await show([]), await show([])];
    givenName.value = "cid";
    reviews.review(first, "accepted");
    await settle();
    givenName.value = "dan";
    reviews.undo();
    await settle();
    expect(sent()).toHaveLength(1);
    reviews.review(second, "rejected");
    await settle();
    givenName.value = "cid";
    reviews.undo();
    await settle();
    expect(sent()[2]).toEqual([first, null, "", "cid"]);
  });
});
