import { describe, expect, it } from "vitest";

import { describeJoin, describeSplit, groupsOf, inOrder, lookOf, splitGroups, whyNotJoin, whyNotSplit, withoutDoubles } from "./grouping";

const moment = (id: number, video_id = 1, first_time_s = id) => ({ id, video_id, first_time_s, last_time_s: first_time_s + 1, frames: 3, score: 0.9 });
const object = (ids: readonly number[], model_id = 1) => ({ model_id, model: model_id === 1 ? "jeep" : "jet", moments: ids.map((id) => moment(id)) });
const range = (count: number, from = 1) => Array.from({ length: count }, (_, i) => from + i);

it("makes a group of each object's moments", () => {
  expect(groupsOf([object([3, 9]), object([4])])).toEqual([[3, 9], [4]]);
});

describe("whyNotJoin", () => {
  it("joins objects of one model", () => {
    expect(whyNotJoin([object([1]), object([2, 5]), object([3])])).toBeNull();
  });
  it("wants two of them", () => {
    expect(whyNotJoin([])).toMatch(/two or more/);
    expect(whyNotJoin([object([1, 2])])).toMatch(/two or more/);
  });
  it("names the models where they differ", () => {
    expect(whyNotJoin([object([1]), object([2], 2), object([3])])).toMatch(/: jeep, jet\.$/);
  });
  it("joins no more than undo can make apart again", () => {
    expect(whyNotJoin(range(20).map((id) => object([id])))).toBeNull();
    expect(whyNotJoin(range(21).map((id) => object([id])))).toMatch(/At most 20/);
    expect(whyNotJoin([object(range(500)), object(range(500, 501))])).toBeNull();
    expect(whyNotJoin([object(range(500)), object(range(501, 501))])).toMatch(/more than 1,000 moments/);
  });
});

describe("a split", () => {
  it("needs chosen moments and a rest", () => {
    expect(whyNotSplit(object([3, 9]), new Set())).toMatch(/Choose/);
    expect(whyNotSplit(object([3, 9]), new Set([3, 9]))).toMatch(/at least one/);
    expect(whyNotSplit(object([3, 9]), new Set([9]))).toBeNull();
    expect(whyNotSplit(object(range(1001)), new Set([9]))).toMatch(/more than 1,000/);
  });
  it("does not count what was chosen of another object", () => {
    expect(whyNotSplit(object([3, 9]), new Set([40]))).toMatch(/Choose/);
    expect(splitGroups(object([3, 9]), new Set([9, 40]))).toEqual([[3], [9]]);
  });
  it("says which object is which", () => {
    expect(describeSplit(12, 1, 12, 40)).toBe("Split object 12: 1 moment is object 40.");
    expect(describeSplit(12, 2, 15, 12)).toBe("Split object 12: 2 moments are object 12, the rest is object 15.");
  });
});

it("has another thumbnail with other moments", () => {
  const looks = [[3], [3, 9], [3, 10], [9]].map((ids) => lookOf(object(ids)));
  expect(new Set(looks).size).toBe(looks.length);
  expect(lookOf(object([9, 3]))).toBe(lookOf(object([3, 9])));
});

it("orders moments by video and time", () => {
  expect(inOrder([moment(3, 2, 0), moment(1, 1, 7), moment(2, 1, 4)]).map(({ id }) => id)).toEqual([2, 1, 3]);
});

it("names no moment twice", () => {
  expect(withoutDoubles([[3, 8], [8], [9, 3]])).toEqual([[3, 8], [9]]);
});

it("says that verdicts of joined objects differ", () => {
  const decided = (verdict: "accepted" | "rejected" | null) => ({ review: { verdict, note: "", reviewer: "ann", updated_utc_us: 1 } });
  expect(describeJoin([decided("accepted"), { review: null }, decided("accepted")])).toBe("Joined 3 objects.");
  expect(describeJoin([decided("accepted"), decided("rejected")])).toContain("the latest decision stands");
});
