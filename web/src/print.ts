// What is printed: the map and the list as they are now, on paper (views/print.tsx). The page itself is not printed, and
// nothing of it changes for that.
import { signal } from "@preact/signals";

import type { FoundObject } from "./api/types";
import { messageOf } from "./logic/errors";
import { notify } from "./notices";
import * as objects from "./objects";
import { filters, matcher, sort } from "./state";

/** Rows; some thirty pages. */
const MAX_ROWS = 1000;

export interface Sheet {
  when: Date;
  /** In the order of the list; of those that match the filters. */
  objects: FoundObject[];
  /** How many match. */
  total: number;
  /** The map with north and a scale; null: there is none. */
  map: string | null;
}

export const sheet = signal<Sheet | null>(null);

/** Gives a picture of the map; set by it. */
let drawMap: () => string | null = () => null;
export function setMapPicture(draw: () => string | null) {
  drawMap = draw;
}

/** Loads all that is printed, and asks the browser to. */
export async function printList() {
  try {
    const found = await objects.loadAll(sort.peek(), filters.peek(), MAX_ROWS);
    sheet.value = { when: new Date(), objects: found, total: Math.max(found.length, totalMatching()), map: drawMap() };
    // The browser takes the page as it is when it is asked: the sheet must be rendered, and its picture decoded.
    await new Promise((done) => setTimeout(done));
    await Promise.all([...document.querySelectorAll<HTMLImageElement>(".print-sheet img")].map((one) => one.decode()));
    window.print();
  } catch (error) {
    sheet.value = null;
    notify(`The list is not printed: ${messageOf(error)}`, "error");
  }
}

const totalMatching = () => objects.matching.peek() ?? objects.counts.peek()?.objects ?? 0;

/** What the page has loaded of the list: the browser does not wait for more. */
function loaded(): FoundObject[] {
  const list = objects.list.peek();
  const found: FoundObject[] = [];
  for (let at = 0; list && at < list.total && found.length < MAX_ROWS; at++) {
    const id = list.at(at);
    const object = id === undefined ? undefined : objects.objectOf(id);
    if (object && matcher.peek()(object)) found.push(object);
  }
  return found;
}

window.addEventListener("beforeprint", () => {
  if (sheet.peek() !== null) return;
  const found = loaded();
  sheet.value = { when: new Date(), objects: found, total: Math.max(found.length, totalMatching()), map: drawMap() };
});
window.addEventListener("afterprint", () => (sheet.value = null));
