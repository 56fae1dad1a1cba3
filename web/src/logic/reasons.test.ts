import { describe, expect, it } from "vitest";

import { BINDINGS } from "./keys";
import { REASONS, takesReason } from "./reasons";

describe("reasons of a rejection", () => {
  it("have the keys that the table of keys says", () => {
    expect(REASONS.map((one) => one.key)).toEqual(BINDINGS.reason.keys);
  });

  it("replace each other, but nothing that a person has written", () => {
    expect([takesReason(""), takesReason("nothing there"), takesReason("nothing there, I think")]).toEqual([true, true, false]);
  });
});
