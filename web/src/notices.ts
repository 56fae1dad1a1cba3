// Short messages at the edge of the page, which go by themselves.
import { signal } from "@preact/signals";

import { messageOf } from "./logic/errors";

export interface Notice {
  id: number;
  text: string;
  kind: "info" | "error";
}
export const notices = signal<Notice[]>([]);
let nextNotice = 0;

export function notify(text: string, kind: Notice["kind"] = "info") {
  const id = nextNotice++;
  notices.value = [...notices.value.filter((one) => one.text !== text), { id, text, kind }];
  setTimeout(() => dismiss(id), kind === "error" ? 12_000 : 4000);
}

export function dismiss(id: number) {
  notices.value = notices.value.filter((one) => one.id !== id);
}

/** Says what went wrong. */
export const notifyError = (error: unknown) => notify(messageOf(error), "error");
