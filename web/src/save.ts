// Saves the list as a file.
import { getObjectPackage } from "./api/client";
import { momentsToCsv, toCsv, toGeoJson } from "./logic/export";
import { filterParams } from "./logic/filters";
import { toKml } from "./logic/kml";
import { messageOf } from "./logic/errors";
import { plural } from "./logic/format";
import { me } from "./me";
import { notify } from "./notices";
import * as objects from "./objects";
import { filters, sort, videos } from "./state";

const FILES = {
  csv: { name: "objects.csv", type: "text/csv", make: toCsv },
  moments: { name: "moments.csv", type: "text/csv", make: momentsToCsv },
  geojson: {
    name: "objects.geojson",
    type: "application/geo+json",
    make: (...args: Parameters<typeof toGeoJson>) => JSON.stringify(toGeoJson(...args)),
  },
  kml: { name: "objects.kml", type: "application/vnd.google-earth.kml+xml", make: toKml },
};

/** Saves the objects that match the filters as a file, in the order of the list. */
export async function saveList(kind: keyof typeof FILES) {
  try {
    const found = await objects.loadAll(sort.peek(), filters.peek());
    const { name, type, make } = FILES[kind];
    download(new Blob([make(found, videos.peek())], { type }), name);
    notify(`Saved ${plural(found.length, "object")}.`);
  } catch (error) {
    notify(`The list is not saved: ${messageOf(error)}`, "error");
  }
}

/** Saves the objects of known place that match the filters as a GeoPackage, which the server makes. */
export async function savePackage() {
  notify("The server makes the file.", "info", PACKAGE);
  try {
    download(await getObjectPackage(filterParams(filters.peek(), me.peek())), "objects.gpkg");
    notify("Saved objects.gpkg.", "info", PACKAGE);
  } catch (error) {
    notify(`The list is not saved: ${messageOf(error)}`, "error", PACKAGE);
  }
}

const PACKAGE = "package";

function download(file: Blob, name: string) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(file);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
