// Who decided what about an object: each person alone; the team's review is the latest with a verdict.
import type { FoundObject, Review, Verdict } from "../api/types";

/** What reviews say of an object. */
export type Reviews = Pick<FoundObject, "review" | "decisions" | "is_disputed">;

/** The server sends the latest decisions of so many persons with an object. */
export const MAX_DECISIONS = 10;

export const reviewsOf = ({ review, decisions, is_disputed }: Reviews): Reviews => ({ review, decisions, is_disputed });

export const ownOf = (decisions: readonly Review[], me: string): Review | null =>
  decisions.find((one) => one.reviewer === me) ?? null;
export const ownDecision = (object: Reviews, me: string) => ownOf(object.decisions, me);

/** False: others have decided later, so that the object may have come without the reader's decision. */
export const isOwnKnown = (object: Reviews | undefined, me: string) =>
  object === undefined || object.decisions.length < MAX_DECISIONS || ownDecision(object, me) !== null;

/** The reviews with a person's decision as it is stored, null: there is none. The team's review remains. */
export function withStored(before: Reviews, reviewer: string, own: Review | null): Reviews {
  const others = before.decisions.filter((one) => one.reviewer !== reviewer);
  return { ...before, decisions: own === null ? others : [...others, own].sort(latestFirst) };
}

const latestFirst = (a: Review, b: Review) => b.updated_utc_us - a.updated_utc_us || (a.reviewer < b.reviewer ? -1 : 1);

/** The reviews once a person has decided; a decision that says nothing is taken back. The same as the server's. */
export function withDecision(before: Reviews, decision: Review): Reviews {
  const others = before.decisions.filter((one) => one.reviewer !== decision.reviewer);
  const isEmpty = decision.verdict === null && decision.note === "";
  const decisions = isEmpty ? others : [decision, ...others].sort(latestFirst);
  const verdicts = new Set(decisions.flatMap((one) => one.verdict ?? []));
  return {
    decisions,
    review: decisions.find((one) => one.verdict !== null) ?? decisions[0] ?? null,
    is_disputed: verdicts.size > 1,
  };
}

export const nameOf = (reviewer: string, me: string) => (reviewer === me ? "you" : reviewer === "" ? "somebody" : reviewer);

/** "rejected by you, accepted by Ann", latest first; "accepted" if only somebody without a name has decided. */
export function describeDecisions(object: Reviews, me: string): string {
  const decided = object.decisions.filter((one) => one.verdict !== null);
  if (decided.length === 1 && decided[0]?.reviewer === "") return decided[0].verdict ?? "";
  return decided.map((one) => `${one.verdict} by ${nameOf(one.reviewer, me)}`).join(", ");
}

/**
 * What a row says of its review.
 * `text`: who decided, if others did and the reader did not; else the verdict.
 */
export function summarise(object: Reviews, me: string): { verdict: Exclude<Verdict, null>; text: string; isOthers: boolean } | null {
  const verdict = object.review?.verdict ?? null;
  if (verdict === null) return null;
  if (object.is_disputed) return { verdict, text: "disputed", isOthers: false };
  const decided = object.decisions.filter((one) => one.verdict !== null);
  const names = decided.flatMap((one) => (one.reviewer === "" ? [] : [one.reviewer]));
  const isOthers = !decided.some((one) => one.reviewer === me);
  if (!isOthers || names[0] === undefined) return { verdict, text: verdict, isOthers };
  return { verdict, text: decided.length > 1 ? `${names[0]} +${decided.length - 1}` : names[0], isOthers };
}
