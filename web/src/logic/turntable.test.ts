import { describe, expect, it } from "vitest";

import type { Sighting } from "../api/types";
import { type View, angleBetween, byNearness, describeDirection, fromDisc, matchedViews, nearest, onDisc, stepsAt, turn, viewsOf } from "./turntable";

const listed = (azimuth_deg: number | null, off_nadir_deg: number | null) => ({ azimuth_deg, off_nadir_deg, has_image: true });
/** The pole and two rings of four. */
const grid = [listed(0, 0), ...[30, 60].flatMap((ring) => [0, 90, 180, 270].map((azimuth) => listed(azimuth, ring)))];
const { views } = viewsOf(grid);
const at = (azimuth_deg: number, off_nadir_deg: number) => ({ azimuth_deg, off_nadir_deg });

describe("a model that turns", () => {
  it("has the views with an image", () => {
    expect(viewsOf(grid).isTurntable).toBe(true);
    expect(viewsOf([{ ...listed(0, 0), has_image: false }, listed(10, 10)]).views).toEqual([{ index: 1, azimuth_deg: 10, off_nadir_deg: 10 }]);
    const photos = viewsOf([listed(null, null), listed(null, null)]);
    expect(photos.isTurntable).toBe(false);
    expect(photos.views.map((one) => one.azimuth_deg)).toEqual([0, 180]);
    expect(viewsOf([]).views).toEqual([]);
  });

  it("shows the nearest view", () => {
    expect(angleBetween(at(10, 90), at(350, 90))).toBeCloseTo(20);
    expect(angleBetween(at(0, 0), at(123, 30))).toBeCloseTo(30);
    expect(nearest(views, at(350, 33))?.index).toBe(1);
    expect(nearest(views, at(200, 4))?.index).toBe(0);
    expect(nearest(views, at(100, 80))?.index).toBe(6);
    expect(nearest([], at(0, 0))).toBeNull();
    const order = byNearness(views, at(90, 60));
    expect(order[0]?.index).toBe(6);
    expect(order).toHaveLength(views.length);
    expect(nearest(views, at(90, 60))).toEqual(order[0]);
  });

  it("turns as it is dragged, to the highest and the lowest view", () => {
    expect(turn(at(0, 30), 40, 0, views).azimuth_deg).toBe(20);
    expect(turn(at(0, 30), -40, 0, views).azimuth_deg).toBe(340);
    expect(turn(at(0, 30), 0, 40, views).off_nadir_deg).toBe(10);
    expect(turn(at(0, 30), 0, 400, views).off_nadir_deg).toBe(0);
    expect(turn(at(0, 30), 0, -400, views).off_nadir_deg).toBe(60);
  });

  it("knows the next view by key", () => {
    expect(stepsAt(views, views[1] as View)).toEqual({ azimuth: 90, offNadir: 30 });
    expect(stepsAt(views, views[0] as View).azimuth).toBe(10);
  });

  it("lies on a disc, its front up", () => {
    expect(onDisc(at(123, 0), 60)).toEqual([-0, -0]);
    const close = (found: readonly [number, number], wanted: [number, number]) => found.forEach((one, i) => expect(one).toBeCloseTo(wanted[i] ?? 0));
    close(onDisc(at(180, 60), 60), [0, -1]);
    close(onDisc(at(90, 30), 60), [-0.5, 0]);
    for (const one of views.slice(1)) {
      const back = fromDisc(onDisc(one, 60), 60);
      expect(angleBetween(back, one)).toBeLessThan(1e-4);
    }
    expect(onDisc(at(0, 0), 0)).toEqual([-0, 0]);
  });

  it("says from where it is seen", () => {
    expect(describeDirection(at(0, 0))).toBe("straight from above");
    expect(describeDirection(at(90, 40))).toBe("from the left (90°), 40° off straight above");
    expect(describeDirection(at(350, 40))).toBe("from behind (350°), 40° off straight above");
  });

  it("lists the views that matched, those of the object first", () => {
    const sighting = (object_id: number, view_index: number, matches: number, source: Sighting["source"] = "recognised") =>
      ({ object_id, view_index, matches, source }) as Sighting;
    const own = [sighting(1, 5, 10), sighting(1, 5, 20), sighting(1, 6, 15), sighting(1, 9, 99, "tracked")];
    const others = [sighting(2, 7, 50), sighting(3, 5, 60), sighting(1, 5, 20)];
    const found = matchedViews(own, others, 1);
    expect(found.map((one) => [one.view, one.sightings.map((each) => [each.object_id, each.matches])])).toEqual([
      [5, [[1, 20], [3, 60]]],
      [6, [[1, 15]]],
      [7, [[2, 50]]],
    ]);
    expect(matchedViews([], others, null)[0]?.view).toBe(5);
  });
});
