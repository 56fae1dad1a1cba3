// Why an object was rejected, in a word: stored as the note, so that every export has it.

export interface Reason {
  /** KeyboardEvent.key. Not 0 and 1, which zoom. */
  key: string;
  text: string;
}

export const REASONS: readonly Reason[] = [
  { key: "2", text: "another object" },
  { key: "3", text: "nothing there" },
  { key: "4", text: "wrong place or size" },
  { key: "5", text: "cannot tell" },
];

/** A reason takes the place of no note, or of a reason; what a person has written stays. */
export const takesReason = (note: string) => note === "" || REASONS.some((one) => one.text === note);
