import { expect, test } from "vitest";

import { KeepaliveBudget } from "./keepalive";

test("many or long bodies go without it, and what has ended makes room", () => {
  const budget = new KeepaliveBudget();
  const few = Array.from({ length: 300 }, () => budget.take(80)).filter(Boolean).length;
  expect(few).toBeGreaterThan(0);
  expect(few).toBeLessThan(20);
  budget.give(80);
  expect(budget.take(80)).toBe(true);
  const long = new KeepaliveBudget();
  expect([1, 2, 3, 4].map(() => long.take(16_000))).toEqual([true, true, false, false]);
});
