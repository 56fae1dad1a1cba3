// Who uses the page. A server without accounts needs no log-in; else the form of views/log_in.tsx is shown as long as
// nobody is logged in, also when a session ends while the page is open.
import { computed, signal } from "@preact/signals";

import { getSession, onUnauthenticated, postLogIn, postLogOut } from "./api/client";
import type { Session } from "./api/types";

/** Null: not known yet. */
export const session = signal<Session | null>(null);
export const account = computed(() => session.value?.account ?? null);
export const needsLogIn = computed(() => session.value?.has_accounts === true && session.value.account === null);

/** Who was logged in before the session ended: what is on the page, and not yet stored, is theirs. */
let former: string | null = null;
let waiting: (() => void)[] = [];

onUnauthenticated(() => {
  former = account.peek()?.name ?? former;
  session.value = { has_accounts: true, account: null };
});

/** Asks who is logged in. Returns once somebody is, or nobody needs to be, or the server does not answer. */
export async function startSession() {
  // Without an answer the page begins to load, which says so and tries again.
  session.value = await getSession().catch(() => ({ has_accounts: false, account: null }));
  if (needsLogIn.value) await new Promise<void>((resolve) => waiting.push(resolve));
}

/** Throws ApiFailure with a message for the user. */
export async function logIn(name: string, password: string) {
  const next = await postLogIn(name, password);
  if (former !== null && former !== next.account?.name) return location.reload();
  session.value = next;
  for (const resume of waiting) resume();
  waiting = [];
}

/** Nothing of the former user stays on the page. */
export async function logOut() {
  await postLogOut();
  sessionStorage.clear();
  location.reload();
}
