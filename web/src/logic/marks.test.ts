import { describe, expect, it } from "vitest";

import { markAt } from "./marks";

describe("the marks of models", () => {
  const marks = Array.from({ length: 36 }, (_, i) => markAt(i));

  it("differ for 35 models, by colour alone for seven", () => {
    const all = marks.map(({ colour, shape }) => `${colour} ${shape}`);
    expect(new Set(all.slice(0, 35)).size).toBe(35);
    expect(all[35]).toBe(all[0]);
    expect(new Set(marks.slice(0, 7).map((one) => one.colour)).size).toBe(7);
    expect(new Set(marks.slice(0, 7).map((one) => one.shape)).size).toBe(1);
    expect(marks[7]?.colour).toBe(marks[0]?.colour);
    expect(marks[7]?.shape).not.toBe(marks[0]?.shape);
  });

  it("are those of the first model where it is not known", () => {
    expect(markAt(-1)).toEqual(markAt(0));
  });
});
