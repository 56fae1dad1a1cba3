// Sends groups of moments to the server, and shows the objects that it makes of them.
import { computed, signal } from "@preact/signals";

import { regroupObjects } from "./api/client";
import type { RegroupedObjects } from "./api/types";
import * as load from "./load";
import type { Groups } from "./logic/grouping";
import { notifyError } from "./notices";
import * as objects from "./objects";
import { select } from "./selection";
import { selectedId } from "./state";

const MAX_WAIT_MS = 5000;

/** Objects that are being joined or split now; null: none. */
const changing = signal<ReadonlySet<number> | null>(null);
export const isRegrouping = computed(() => changing.value !== null);
export const isChanging = (id: number) => changing.value?.has(id) === true;

/**
 * Makes the moments of each group one object, and selects that of the first group. One call at a time.
 * Returns the objects of the groups, and by which number it is taken back.
 * @param undo  a correction that is taken back instead
 */
export async function regroup(groups: Groups, undo?: number): Promise<RegroupedObjects> {
  const before = objects.holding(new Set(groups.flat()));
  changing.value = new Set(before);
  try {
    await waitForReviews(before);
    const after = await regroupObjects(groups, undo);
    await show(before, after.object_ids).catch(notifyError);
    return after;
  } finally {
    changing.value = null;
  }
}

/** What was decided about the objects reaches the server as long as they are there. */
async function waitForReviews(ids: readonly number[]) {
  const end = Date.now() + MAX_WAIT_MS;
  while (ids.some((id) => objects.pendingReviews.peek().has(id))) {
    if (Date.now() > end) throw new Error("What was decided about these objects is not stored yet. Try again once it is.");
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

async function show(before: readonly number[], after: readonly number[]) {
  await objects.readAgain(after);
  const [first] = after;
  // The video stays where it is unless another object is selected.
  const isStill = selectedId.peek() === first;
  let isShown = false;
  const change = () => {
    if (isShown) return;
    isShown = true;
    objects.forget(before.filter((id) => !after.includes(id)));
    if (first !== undefined) select(first, { seek: !isStill });
  };
  // At once: neither is an object selected that the list has not, nor has the list one that is not there any more.
  await load.showNew(change);
  // Other filters, chosen meanwhile, make another list.
  change();
  await load.refresh();
}
