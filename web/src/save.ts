// Saves the list as a file.
import { toCsv, toGeoJson } from "./logic/export";
import { messageOf } from "./logic/errors";
import { plural } from "./logic/format";
import { notify } from "./notices";
import * as objects from "./objects";
import { filters, sort } from "./state";

/** Saves the objects that match the filters as a file, in the order of the list. */
export async function saveList(kind: "csv" | "geojson") {
  try {
    const found = await objects.loadAll(sort.peek(), filters.peek());
    const text = kind === "csv" ? toCsv(found) : JSON.stringify(toGeoJson(found));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: kind === "csv" ? "text/csv" : "application/geo+json" }));
    link.download = `objects.${kind}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    notify(`Saved ${plural(found.length, "object")}.`);
  } catch (error) {
    notify(`The list is not saved: ${messageOf(error)}`, "error");
  }
}
