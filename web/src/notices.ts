// Short messages at the edge of the page, which go by themselves.
import { signal } from "@preact/signals";

import { messageOf } from "./logic/errors";

export interface Notice {
  id: number;
  text: string;
  kind: "info" | "error";
  /** A later message about the same takes its place. */
  about: string;
  action: NoticeAction | null;
}

/** What a click on a message does. */
export interface NoticeAction {
  label: string;
  run: () => void;
}
export const notices = signal<Notice[]>([]);
let nextNotice = 0;

export function notify(text: string, kind: Notice["kind"] = "info", about = text, action: NoticeAction | null = null) {
  const id = nextNotice++;
  notices.value = [...notices.value.filter((one) => one.about !== about), { id, text, kind, about, action }];
  setTimeout(() => dismiss(id), kind === "error" ? 12_000 : action !== null ? 7000 : 4000);
}

export function dismiss(id: number) {
  notices.value = notices.value.filter((one) => one.id !== id);
}

/** Says what went wrong. */
export const notifyError = (error: unknown) => notify(messageOf(error), "error");
