import { describe, expect, it } from "vitest";

import type { FoundObject, Place, Sighting } from "../api/types";
import { agree, overlapOf, reachOf, rivalsOf } from "./rivals";

const place = (north: number, east: number, change: Partial<Place> = {}): Place => ({
  time_s: 0, latitude_deg: north / 111_320, longitude_deg: east / 111_320, altitude_m: 0, ce90_m: 4, le90_m: 1,
  ellipse: { semi_major_m: 8, semi_minor_m: 3, azimuth_deg: 90 }, ...change,
});
const sighting = (object: number, model: number, box: number[], change: Partial<Sighting> = {}): Sighting => ({
  video_id: 1, object_id: object, model_id: model, frame: 4, time_s: 0.4, box, outline: [], score: 0.4, source: "recognised",
  matches: 9, view_index: 0, distance_m: null, sigma_distance_m: null, heading_deg: null, ...change,
});
const found = (id: number, model: number, change: Partial<FoundObject> = {}): FoundObject => ({
  id, model_id: model, model: `model ${model}`, score: 0.9, against: [], frames: 3, first_time_s: 0, last_time_s: 1, moments: [], place: null,
  heading_deg: null, speed_m_s: null, review: null, decisions: [], is_disputed: false, ...change,
});

describe("boxes and places", () => {
  it("overlap by what they share of what both cover", () => {
    expect(overlapOf([0, 0, 10, 10], [0, 0, 10, 10])).toBe(1);
    expect(overlapOf([0, 0, 10, 10], [5, 0, 10, 10])).toBeCloseTo(1 / 3);
    expect([overlapOf([0, 0, 10, 10], [10, 0, 10, 10]), overlapOf([0, 0, 0, 0], [0, 0, 0, 0])]).toEqual([0, 0]);
  });

  it("agree within the ellipse of their difference", () => {
    // The longer axes lie along east: 8 m twice make 11.3 m there, 3 m twice 4.2 m across.
    const at = place(0, 0);
    expect([agree(at, place(0, 11)), agree(at, place(0, 11.6)), agree(at, place(4.1, 0)), agree(at, place(4.5, 0))]).toEqual([true, false, true, false]);
    const none = { semi_major_m: null, semi_minor_m: null, azimuth_deg: null };
    const round = place(0, 0, { ellipse: none });
    expect([agree(round, place(5.5, 0, { ellipse: none })), agree(round, place(5.8, 0, { ellipse: none }))]).toEqual([true, false]);
    expect(agree(place(0, 0, { ce90_m: null, ellipse: none }), at)).toBe(false);
    expect(reachOf(at)).toBe(36);
  });

  it("agree across the antimeridian", () => {
    expect(agree({ ...place(0, 0), longitude_deg: 179.99999 }, { ...place(0, 0), longitude_deg: -179.99999 })).toBe(true);
  });
});

describe("rivals of a sighting", () => {
  const own = sighting(1, 1, [100, 100, 40, 40]);

  it("are other models at the same part of the same frame, best first", () => {
    const sightings = [
      own, sighting(2, 2, [102, 98, 40, 40]), sighting(3, 3, [110, 100, 40, 40], { score: 0.7 }), sighting(4, 2, [300, 300, 40, 40]),
      sighting(5, 2, [100, 100, 40, 40], { frame: 5 }), sighting(6, 1, [100, 100, 40, 40]), sighting(7, 4, [100, 100, 40, 40]),
    ];
    const objects = [1, 2, 3, 4, 5, 6].map((id) => found(id, sightings[id - 1]?.model_id ?? 0));
    const rejected = found(7, 4, { review: { verdict: "rejected", note: "", reviewer: "", updated_utc_us: 0 } });
    expect(rivalsOf(own, objects[0] ?? null, sightings, [...objects, rejected])).toEqual([
      { object: 3, model: "model 3", score: 0.7, isInFrame: true },
      { object: 2, model: "model 2", score: 0.4, isInFrame: true },
    ]);
  });

  it("are objects at the same place, if both stand", () => {
    const self = found(1, 1, { place: place(0, 0), speed_m_s: 0 });
    const near = found(2, 2, { place: place(0, 5), score: 0.6 });
    const objects = [self, near, found(3, 2, { place: place(0, 5), speed_m_s: 4 }), found(4, 2, { place: place(30, 5) }), found(5, 1, { place: place(0, 5) })];
    expect(rivalsOf(own, self, [own], objects)).toEqual([{ object: 2, model: "model 2", score: 0.6, isInFrame: false }]);
    expect(rivalsOf(own, null, [own], objects)).toEqual([]);
  });
});
