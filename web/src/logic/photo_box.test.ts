import { describe, expect, it } from "vitest";

import { boxAfterKey, boxesToSend, middleBox } from "./photo_box";
import { cleanModelName, modelNameOf } from "./uploads";

const size = { width: 400, height: 200 };

describe("the box in a photo", () => {
  it("is made, moved and sized by keys, and stays in the photo", () => {
    const first = boxAfterKey(null, "ArrowLeft", false, size);
    expect(first).toEqual(middleBox(size));
    expect(boxAfterKey(first, "ArrowRight", false, size)).toEqual([108, 50, 200, 100]);
    expect(boxAfterKey(first, "ArrowDown", true, size)).toEqual([100, 50, 200, 108]);
    expect(boxAfterKey(first, "Enter", false, size)).toBeNull();
    let box = first;
    for (let i = 0; i < 100; i++) box = boxAfterKey(box, "ArrowRight", false, size);
    expect(box).toEqual([200, 50, 200, 100]);
    for (let i = 0; i < 100; i++) box = boxAfterKey(box, "ArrowLeft", true, size);
    expect(box?.[2]).toBe(12);
    for (let i = 0; i < 100; i++) box = boxAfterKey(box, "ArrowDown", true, size);
    expect(box?.[3]).toBe(150);
  });

  it("is sent for all photos or for none", () => {
    expect(boxesToSend([null, null], [size, size])).toBeNull();
    expect(boxesToSend([[1, 2, 30, 40], null], [size, size])).toEqual([[1, 2, 30, 40], [0, 0, 400, 200]]);
  });
});

describe("the name of a model", () => {
  it("is made of what is typed", () => {
    expect(["My Jeep (2)", "Bär/groß", " -x", "tank.v2", "a b "].map(cleanModelName)).toEqual(["My-Jeep-2-", "Bar-gross", "x", "tank.v2", "a-b-"]);
    expect(modelNameOf("Über Auto.PNG")).toBe("uber-auto");
  });
});
