// What the page asks before it deletes something that cannot be taken back.
import { signal } from "@preact/signals";

export interface Question {
  title: string;
  /** What is lost, and what stays. */
  text: string;
  /** What the button says that does it. */
  label: string;
  run: () => void;
}

export const question = signal<Question | null>(null);

export function ask(next: Question) {
  question.value = next;
}
