// A person corrects which moments are one object: joins objects, or splits moments off one.
import { computed } from "@preact/signals";

import type { FoundObject } from "./api/types";
import { messageOf } from "./logic/errors";
import { describeJoin, describeSplit, groupsOf, splitGroups, whyNotJoin, whyNotSplit, withoutDoubles } from "./logic/grouping";
import { dismiss, notify } from "./notices";
import * as objects from "./objects";
import { isRegrouping, regroup } from "./regroup";
import * as reviews from "./reviews";
import { select } from "./selection";
import { selectedId } from "./state";

/** What would be joined, the selected one first: it stays selected when that is taken back. */
const markedObjects = computed(() => {
  const marked = [...reviews.marked.value].flatMap((id) => objects.objectOf(id) ?? []);
  const isSelected = ({ id }: FoundObject) => id === selectedId.value;
  return [...marked.filter(isSelected), ...marked.filter((one) => !isSelected(one))];
});
export const whyNotJoinMarked = computed(() => whyNotJoin(markedObjects.value));

let refusal = -1;
function refuse(why: string) {
  refusal = notify(why, "error", "grouping");
}

/** Whether it may be done now; says why not. */
function canDo(whyNot: string | null): boolean {
  if (isRegrouping.peek() || !reviews.canReview()) return false;
  dismiss(refusal);
  if (whyNot !== null) refuse(whyNot);
  return whyNot === null;
}

/** Objects that are not there any more are not marked. */
function keepMarks() {
  reviews.marked.value = new Set([...reviews.marked.peek()].filter((id) => objects.objectOf(id) !== undefined));
}

/** The marked objects become one, which is selected. */
export async function joinMarked() {
  if (!canDo(whyNotJoinMarked.peek())) return;
  const joined = markedObjects.peek();
  const groups = withoutDoubles(groupsOf(joined));
  if (groups.length < 2) return refuse("They are one object already.");
  try {
    const { correction } = await regroup([groups.flat()]);
    reviews.marked.value = new Set();
    if (correction !== null) reviews.addRegrouping({ groups, correction });
    notify(describeJoin(joined), "info", "review", [reviews.UNDO_ACTION]);
  } catch (error) {
    refuse(messageOf(error));
  }
}

/** The chosen moments of an object become another one; the rest is selected. */
export async function split(object: FoundObject, chosen: ReadonlySet<number>) {
  if (!canDo(whyNotSplit(object, chosen))) return;
  const [rest, apart] = splitGroups(object, chosen);
  try {
    const {
      object_ids: [restId = object.id, other],
      correction,
    } = await regroup([rest, apart]);
    keepMarks();
    if (correction !== null) reviews.addRegrouping({ groups: groupsOf([object]), correction });
    if (other === undefined) return;
    const show = { label: "Show", keepsNotice: true, run: () => select(other, { push: true }) };
    notify(describeSplit(object.id, apart.length, restId, other), "info", "review", [show, reviews.UNDO_ACTION]);
  } catch (error) {
    refuse(messageOf(error));
  }
}
