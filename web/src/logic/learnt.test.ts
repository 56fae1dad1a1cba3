import { describe, expect, it } from "vitest";

import type { ThresholdOfModel } from "../api/types";
import { describeBelow, describeDecided, describeLearnt, isSuggested, worthShowing } from "./learnt";

const model = (change: Partial<ThresholdOfModel>): ThresholdOfModel => ({
  model_id: 1, model: "jeep", is_category: false, accepted: 12, rejected: 5, learnt: null, in_force: null, ...change,
});
const learnt = { min_score: 0.83, accepted_below: 0, rejected_below: 4, undecided_below: 3 };
const inForce = { min_score: 0.83, set_by: "ann", set_utc_us: 1, undecided_below: 3 };
const shown = (models: ThresholdOfModel[], chosen: string[] = []) => worthShowing({ min_decisions: 10, models }, chosen).map((one) => one.model);

describe("what is said of thresholds", () => {
  it("shows models with a threshold, what waits first", () => {
    const models = [model({ in_force: inForce }), model({ model: "tank" }), model({ model: "crane", learnt })];
    expect(shown(models)).toEqual(["crane", "jeep"]);
  });
  it("says of chosen models why they have none", () => {
    const models = [model({ in_force: inForce }), model({ model: "tank" })];
    expect(shown(models, ["tank"])).toEqual(["tank"]);
  });
  it("suggests what is not in force", () => {
    expect(isSuggested(model({ learnt }))).toBe(true);
    expect(isSuggested(model({ learnt, in_force: inForce }))).toBe(false);
    expect(isSuggested(model({ learnt, in_force: { ...inForce, min_score: 0.5 } }))).toBe(true);
    expect(isSuggested(model({ in_force: inForce }))).toBe(false);
  });
  it("tells what was decided", () => {
    expect(describeDecided(model({}))).toBe("12 accepted, 5 rejected");
    expect(describeLearnt(model({ learnt }), 10)).toBe("below 0.83, all 4 were rejected");
    expect(describeLearnt(model({ learnt: { ...learnt, accepted_below: 1 } }), 10)).toBe("below 0.83, 4 of 5 were rejected");
    expect(describeLearnt(model({ accepted: 3, rejected: 2 }), 10)).toBe("a threshold is learnt from 10 decisions on");
    expect(describeLearnt(model({}), 10)).toBe("no score separates them");
    expect(describeBelow(0)).toBe("nothing undecided scores less");
    expect(describeBelow(2)).toBe("leaves out 2 objects");
  });
});
