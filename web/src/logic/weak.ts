// Weak finds: objects of models that are more likely false than right. The same bound as that of the command line.
import type { FoundObject } from "../api/types";

/** Scores of objects of models are probabilities; those of categories are of single frames. */
export const WEAK_SCORE = 0.5;

/** Whether the list, best first, passes the bound between two of its rows. */
export const isBelow = (before: Pick<FoundObject, "score"> | undefined, object: Pick<FoundObject, "score">): boolean =>
  before !== undefined && before.score >= WEAK_SCORE && object.score < WEAK_SCORE;

/** @param categories  names of the categories, which have no weak finds */
export const isWeak = (object: Pick<FoundObject, "model" | "score" | "review">, categories: ReadonlySet<string>): boolean =>
  object.score < WEAK_SCORE && (object.review?.verdict ?? null) === null && !categories.has(object.model);
