// Short messages at the edge of the page, which go by themselves.
import { signal } from "@preact/signals";

import { messageOf } from "./logic/errors";

export interface Notice {
  id: number;
  text: string;
  kind: "info" | "error";
  /** A later message about the same takes its place. */
  about: string;
  actions: readonly NoticeAction[];
  /** What may be added to what it says. */
  choices: readonly NoticeChoice[];
}

/** What a click on a message does. */
export interface NoticeAction {
  label: string;
  run: () => void;
  /** The message stands on after it. */
  keepsNotice?: boolean;
}
export interface NoticeChoice extends NoticeAction {
  key: string;
  isChosen: boolean;
}
export const notices = signal<Notice[]>([]);
let nextNotice = 0;

/** Returns the number of the message. */
export function notify(
  text: string, kind: Notice["kind"] = "info", about = text, actions: readonly NoticeAction[] = [], choices: readonly NoticeChoice[] = [],
): number {
  const id = nextNotice++;
  notices.value = [...notices.value.filter((one) => one.about !== about), { id, text, kind, about, actions, choices }];
  setTimeout(() => dismiss(id), kind === "error" ? 12_000 : actions.length > 0 ? 7000 : 4000);
  return id;
}

export function dismiss(id: number) {
  notices.value = notices.value.filter((one) => one.id !== id);
}

/** Says what went wrong. */
export function notifyError(error: unknown) {
  notify(messageOf(error), "error");
}
