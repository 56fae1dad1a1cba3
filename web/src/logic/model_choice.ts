// Which models have a chip: an index may have hundreds.

export interface ChoosableModel {
  name: string;
  objects: number;
}

/** Chips that are always there; a list that can be searched has the others. */
export const MAX_CHIPS = 8;

/** The models with a chip: those of most objects, and those that are chosen; in the order of all. */
export function modelsWithChips(all: readonly ChoosableModel[], chosen: readonly string[]): ChoosableModel[] {
  if (all.length <= MAX_CHIPS + 1) return [...all];
  const most = [...all].sort((a, b) => b.objects - a.objects).slice(0, MAX_CHIPS);
  return all.filter((one) => most.includes(one) || chosen.includes(one.name));
}

/** The models whose name has every word of a text. */
export function findModels(all: readonly ChoosableModel[], text: string): ChoosableModel[] {
  const words = text.toLowerCase().split(/\s+/).filter((word) => word !== "");
  return all.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
}
