// What a threshold of the score costs, from counts of objects by score and verdict.
import type { Counts, Verdict } from "../api/types";

type Bins = Pick<Counts, "scores" | "accepted_scores" | "rejected_scores">;

/**
 * Above a threshold, what was rejected and the further false alarms; below it, real objects. What nobody has decided counts by its score s, the probability
 * that the object is real: s of a real object, 1 - s of a false alarm. An accepted object is real, a rejected one false.
 * The score of all objects of a bin is taken as that of its middle.
 */
export function thresholdCost({ scores, accepted_scores, rejected_scores }: Bins, minScore: number) {
  let falseAlarms = 0;
  let rejectedAbove = 0;
  let misses = 0;
  scores.forEach((count, i) => {
    const score = (i + 0.5) / scores.length;
    const [accepted, rejected] = [accepted_scores[i] ?? 0, rejected_scores[i] ?? 0];
    const undecided = count - accepted - rejected;
    if (score < minScore) misses += accepted + undecided * score;
    else {
      rejectedAbove += rejected;
      falseAlarms += undecided * (1 - score);
    }
  });
  return { rejected: rejectedAbove, falseAlarms, misses };
}

/** Counts after the team's verdict of an object has changed. */
export function withVerdict(counts: Counts, score: number, before: Verdict, after: Verdict): Counts {
  const next = { ...counts, accepted_scores: [...counts.accepted_scores], rejected_scores: [...counts.rejected_scores] };
  const bin = Math.min(Math.floor(score * counts.scores.length), counts.scores.length - 1);
  const change = (verdict: Verdict, by: number) => {
    if (verdict === null) {
      next.unreviewed += by;
      return;
    }
    next[verdict] += by;
    const bins = verdict === "accepted" ? next.accepted_scores : next.rejected_scores;
    bins[bin] = (bins[bin] ?? 0) + by;
  };
  change(before, -1);
  change(after, 1);
  return next;
}
