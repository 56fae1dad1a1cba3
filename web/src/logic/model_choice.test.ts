import { describe, expect, it } from "vitest";

import { MAX_CHIPS, findModels, modelsWithChips } from "./model_choice";

const names = (all: readonly { name: string }[]) => all.map((one) => one.name);

describe("models to choose from", () => {
  const all = Array.from({ length: 20 }, (_, i) => ({ name: `model ${String.fromCharCode(97 + i)}`, objects: (i * 7) % 20 }));

  it("have all a chip if they are few", () => {
    expect(modelsWithChips(all.slice(0, MAX_CHIPS + 1), [])).toHaveLength(MAX_CHIPS + 1);
  });

  it("have a chip by the number of their objects, or if they are chosen", () => {
    const shown = modelsWithChips(all, []);
    expect(shown).toHaveLength(MAX_CHIPS);
    const least = Math.min(...shown.map((one) => one.objects));
    expect(all.filter((one) => one.objects > least).every((one) => shown.includes(one))).toBe(true);
    expect(names(shown)).toEqual([...names(shown)].sort());
    const other = names(all).find((name) => !names(shown).includes(name)) ?? "";
    expect(names(modelsWithChips(all, [other]))).toContain(other);
  });

  it("are found by words of their names", () => {
    expect(names(findModels(all, "MODEL t"))).toEqual(["model t"]);
    expect(findModels(all, " ")).toHaveLength(20);
    expect(findModels(all, "nothing")).toEqual([]);
  });
});
