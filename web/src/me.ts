// Who decides: the account, or the name that is given where there are none.
import { computed, effect, signal } from "@preact/signals";

import { account } from "./session";

/** The name that a reviewer gives without an account. */
export const givenName = signal(localStorage.getItem("reviewer") ?? "");
/** Empty: nobody in particular. */
export const me = computed(() => account.value?.name ?? givenName.value);

effect(() => localStorage.setItem("reviewer", givenName.value));
