import { describe, expect, it } from "vitest";

import type { Review } from "../api/types";
import { MAX_DECISIONS, type Reviews, describeDecisions, isOwnKnown, ownDecision, summarise, withDecision, withStored } from "./decisions";

const say = (reviewer: string, verdict: Review["verdict"], at: number, note = ""): Review => ({ reviewer, verdict, note, updated_utc_us: at });
const NONE: Reviews = { review: null, decisions: [], is_disputed: false };
const all = (...decisions: Review[]) => decisions.reduce(withDecision, NONE);
const two = all(say("ann", "accepted", 1), say("bob", "rejected", 2));

describe("decisions of persons", () => {
  it("are one a person; the latest with a verdict is the team's", () => {
    expect(two.review?.reviewer).toBe("bob");
    expect(two.is_disputed).toBe(true);
    const noted = withDecision(two, say("cid", null, 3, "who knows"));
    expect(noted.review?.reviewer).toBe("bob");
    expect(noted.decisions.map((one) => one.reviewer)).toEqual(["cid", "bob", "ann"]);
    const agreed = withDecision(two, say("ann", "rejected", 4));
    expect(agreed.is_disputed).toBe(false);
    expect(agreed.decisions).toHaveLength(2);
    expect(all(say("cid", null, 3, "who knows")).review?.note).toBe("who knows");
  });

  it("of one time are in the order of the names, as the server's", () => {
    expect(all(say("bob", "rejected", 5), say("ann", "accepted", 5)).review?.reviewer).toBe("ann");
  });

  it("are taken back alone", () => {
    const one = withDecision(two, say("bob", null, 3));
    expect(one.review?.reviewer).toBe("ann");
    expect(one.is_disputed).toBe(false);
    expect(withDecision(one, say("ann", null, 4))).toEqual(NONE);
  });

  it("are one's own by name", () => {
    expect(ownDecision(two, "ann")?.verdict).toBe("accepted");
    expect(ownDecision(two, "cid")).toBeNull();
    expect(describeDecisions(two, "ann")).toBe("rejected by bob, accepted by you");
    expect(describeDecisions(all(say("", "accepted", 1)), "")).toBe("accepted");
    expect(describeDecisions(all(say("", "accepted", 1), say("ann", "accepted", 2)), "ann")).toBe("accepted by you, accepted by somebody");
  });

  it("may come without one's own, which is added", () => {
    const crowd = all(...Array.from({ length: MAX_DECISIONS }, (_, i) => say(`other ${i}`, "rejected", 10 + i)));
    expect(isOwnKnown(two, "cid")).toBe(true);
    expect(isOwnKnown(crowd, "other 3")).toBe(true);
    expect(isOwnKnown(crowd, "ann")).toBe(false);
    const whole = withStored(crowd, "ann", say("ann", "accepted", 1));
    expect(isOwnKnown(whole, "ann")).toBe(true);
    expect(whole.decisions.at(-1)?.reviewer).toBe("ann");
    expect(whole.review).toEqual(crowd.review);
    expect(withStored(whole, "ann", null)).toEqual(crowd);
  });

  it("are told in a word", () => {
    expect(summarise(NONE, "ann")).toBeNull();
    expect(summarise(all(say("ann", null, 1, "look again")), "ann")).toBeNull();
    expect(summarise(two, "ann")).toEqual({ verdict: "rejected", text: "disputed", isOthers: false });
    expect(summarise(all(say("ann", "accepted", 1)), "ann")).toEqual({ verdict: "accepted", text: "accepted", isOthers: false });
    expect(summarise(all(say("ann", "accepted", 1)), "bob")).toEqual({ verdict: "accepted", text: "ann", isOthers: true });
    expect(summarise(all(say("ann", "accepted", 1), say("cid", "accepted", 2)), "bob")?.text).toBe("cid +1");
    expect(summarise(all(say("", "rejected", 1)), "bob")?.text).toBe("rejected");
  });
});
