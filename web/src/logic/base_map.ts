// How vector tiles of a base map are drawn, whoever made them: by the names of their layers. No letters: fonts would have to
// be fetched.

export type BaseKind = "land" | "green" | "water" | "building" | "boundary" | "road";

// The names of Protomaps, OpenMapTiles and Shortbread, and what others call the same. The first that fits.
const NAMES: [RegExp, BaseKind][] = [
  [/bound|border|admin/i, "boundary"],
  [/building|housenum/i, "building"],
  [/water|ocean|sea|lake|river/i, "water"],
  [/road|street|transport|highway|rail|path|bridge|ferr/i, "road"],
  [/land_?use|land_?cover|park|natural|wood|forest|site/i, "green"],
  [/^(earth|land)$/i, "land"],
];

/** In this order, the first below all others. */
const ORDER: readonly BaseKind[] = ["land", "green", "water", "building", "boundary", "road"];

/** The layers that are drawn, from below; those of other kinds, labels above all, are not. */
export function drawnLayers(names: readonly string[]): { name: string; kind: BaseKind }[] {
  const known = names.flatMap((name) => {
    const isLabel = /label|name|poi|place|shield/i.test(name);
    const kind = isLabel ? undefined : NAMES.find(([pattern]) => pattern.test(name))?.[1];
    return kind ? [{ name, kind }] : [];
  });
  return known.sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
}

/** The layers that the metadata of a tile archive names. */
export function layerNames(metadata: unknown): string[] {
  const layers = (metadata as { vector_layers?: unknown } | null)?.vector_layers;
  if (!Array.isArray(layers)) return [];
  return layers.flatMap((one: unknown) => {
    const id = (one as { id?: unknown } | null)?.id;
    return typeof id === "string" ? [id] : [];
  });
}

/** Whose map it is, as plain text: archives have it as HTML. */
export function attributionOf(metadata: unknown): string {
  const text = (metadata as { attribution?: unknown } | null)?.attribution;
  if (typeof text !== "string") return "";
  const plain = text.replace(/<[^>]*>/g, " ").replaceAll("&copy;", "©").replaceAll("&amp;", "&");
  return plain.replace(/\s+/g, " ").trim().slice(0, 200);
}
