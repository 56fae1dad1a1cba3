import { describe, expect, it } from "vitest";

import type { CameraPath, FoundObject, Place, Review } from "../api/types";
import { rectangle } from "./area";
import { withDecision } from "./decisions";
import { momentsToCsv, toCsv, toGeoJson } from "./export";
import { toKml } from "./kml";
import { NO_FILTERS, filterParams, isChosen, isFiltered, makeMatcher, metresBetween, nextReview, parseQuery } from "./filters";
import { baseName, explainScore, formatAngle, formatExpected, formatMetres, formatPosition, formatScore, formatSpan, formatTime } from "./format";
import { FrameTable } from "./frame_table";
import { type Position, cameraAt, contains, ellipseRing, gridLines, gridSpacing, offset, whenSeen } from "./geo";
import { BINDINGS, actionOf } from "./keys";
import { formatMgrs, utmOf } from "./mgrs";
import { boxBetween, boxCentres, fit } from "./overlay";
import { PagedList } from "./paged_list";
import { formatBehind, formatLeft, modelNameOf, planFiles } from "./uploads";
import { PLAIN, formatUrl, parseUrl } from "./url_state";

const place = (latitude: number, longitude: number): Place => ({
  time_s: 0,
  latitude_deg: latitude,
  longitude_deg: longitude,
  altitude_m: 0,
  ce90_m: 1,
  le90_m: 1,
  ellipse: { semi_major_m: 20, semi_minor_m: 5, azimuth_deg: 90 },
});

const found = (id: number, change: Partial<FoundObject> = {}): FoundObject => ({
  id,
  model_id: 1,
  model: "jeep",
  score: 0.9,
  against: [],
  frames: 3,
  first_time_s: 0,
  last_time_s: 1,
  moments: [{ id: 1, video_id: 1, first_time_s: 0, last_time_s: 1, frames: 3, score: 0.9 }],
  place: null,
  heading_deg: null,
  speed_m_s: null,
  review: null,
  decisions: [],
  is_disputed: false,
  ...change,
});

const accepted = { verdict: "accepted" as const, note: "", reviewer: "", updated_utc_us: 0 };

describe("FrameTable", () => {
  const varied = new FrameTable([0, 0.04, 0.08, 0.28, 0.32, 1.5]);

  it("finds the frame that is shown at a time", () => {
    expect([-1, 0, 0.039, 0.04, 0.1, 0.27, 0.28, 1.49, 1.5, 99].map((time) => varied.frameAt(time))).toEqual([
      0, 0, 0, 1, 2, 2, 3, 4, 5, 5,
    ]);
  });

  it("accepts a time that was rounded down", () => {
    varied.times.forEach((time, frame) => expect(varied.frameAt(time - 5e-5)).toBe(frame));
  });

  it("seeks into the interval of the frame", () => {
    varied.times.forEach((_, frame) => expect(varied.frameAt(varied.seekTime(frame))).toBe(frame));
  });

  it("finds the nearest frame", () => {
    expect([0.02, 0.021, 0.17, 0.19].map((time) => varied.nearest(time))).toEqual([0, 1, 2, 3]);
  });

  it("is safe when empty", () => {
    const empty = new FrameTable([]);
    expect([empty.frameAt(3), empty.timeOf(2), empty.end, empty.clamp(7)]).toEqual([0, 0, 0, 0]);
  });
});

describe("filters", () => {
  const matches = (change: Partial<typeof NO_FILTERS>, object: FoundObject) =>
    makeMatcher({ ...NO_FILTERS, ...change }, "ann")(object);

  it("match by score, model, video and review", () => {
    expect(matches({}, found(1))).toBe(true);
    expect(matches({ minScore: 0.95 }, found(1))).toBe(false);
    expect(matches({ models: ["tank"] }, found(1))).toBe(false);
    expect(matches({ models: ["tank", "jeep"] }, found(1))).toBe(true);
    expect(matches({ video: 2 }, found(1))).toBe(false);
    expect(matches({ review: "none" }, found(1))).toBe(true);
    expect(matches({ area: rectangle([13, 52], [14, 53]) }, found(1, { place: place(52.5, 13.5) }))).toBe(true);
    expect(matches({ area: rectangle([13, 52], [14, 53]) }, found(1, { place: place(52.5, 14.5) }))).toBe(false);
    expect(matches({ area: rectangle([13, 52], [14, 53]) }, found(1))).toBe(false);
    expect(matches({ review: "accepted" }, found(1))).toBe(false);
    expect(matches({ review: "accepted" }, found(1, { review: accepted }))).toBe(true);
  });

  it("match by the threshold of the model, where nobody has decided", () => {
    const thresholds = new Map([["jeep", 0.95]]);
    expect(matches({ thresholds }, found(1))).toBe(false);
    expect(matches({ thresholds }, found(1, { score: 0.95 }))).toBe(true);
    expect(matches({ thresholds }, found(1, { review: accepted }))).toBe(true);
    expect(matches({ thresholds }, found(1, { review: { ...accepted, verdict: null } }))).toBe(false);
    expect(matches({ thresholds: new Map([["tank", 0.95]]) }, found(1))).toBe(true);
  });

  it("match by who decided", () => {
    const reviewed = (...decisions: Review[]) => found(1, decisions.reduce(withDecision, found(1)));
    const [ann, bob] = [{ ...accepted, reviewer: "ann" }, { ...accepted, verdict: "rejected" as const, reviewer: "bob" }];
    const states = ["none", "accepted", "rejected", "own", "not_own", "disputed"] as const;
    const matched = (object: FoundObject) => states.filter((review) => matches({ review }, object));
    expect(matched(reviewed())).toEqual(["none", "not_own"]);
    expect(matched(reviewed(ann))).toEqual(["accepted", "own"]);
    expect(matched(reviewed(bob))).toEqual(["rejected", "not_own"]);
    expect(matched(reviewed(ann, { ...bob, updated_utc_us: 1 }))).toEqual(["rejected", "own", "disputed"]);
    expect(matched(reviewed({ ...ann, verdict: null, note: "?" }))).toEqual(["none", "not_own"]);
    expect((["all", ...states] as const).map(nextReview)).toEqual(["none", "none", "none", "none", "own", "not_own", "disputed"]);
  });

  it("match words of the name and the note", () => {
    expect(matches({ text: "JEE" }, found(1))).toBe(true);
    expect(matches({ text: "jeep tank" }, found(1))).toBe(false);
    expect(matches({ text: "barn" }, found(1, { review: { ...accepted, note: "By the Barn" } }))).toBe(true);
  });

  it("match near a place", () => {
    const near = { text: "near 52,13 200 m" };
    expect(matches(near, found(1, { place: place(52.001, 13) }))).toBe(true);
    expect(matches(near, found(1, { place: place(52.01, 13) }))).toBe(false);
    expect(matches(near, found(1))).toBe(false);
  });

  it("parse a query", () => {
    expect(parseQuery("jeep near 52.5, -13.4, 2 km")).toEqual({
      words: ["jeep"],
      near: { latitude: 52.5, longitude: -13.4, metres: 2000 },
      hint: null,
    });
    expect(parseQuery("near the barn")).toEqual({ words: ["near", "the", "barn"], near: null, hint: null });
    const assumed = { latitude: 52.52, longitude: 13.4, metres: 200 };
    for (const text of ["near 52.52,13.40", "near 52.52 13.40", "near 52.52, 13.40"]) {
      expect(parseQuery(text)).toMatchObject({ words: [], near: assumed, hint: expect.stringMatching(/200 m/) as string });
    }
    expect(parseQuery("near 52.52 13.40 50 m").near).toEqual({ ...assumed, metres: 50 });
    expect(parseQuery("near 52.52,")).toMatchObject({ words: [], near: null, hint: expect.stringMatching(/longitude/) as string });
    expect(parseQuery("near 152.52,13.40").near).toBeNull();
    expect(isFiltered(NO_FILTERS)).toBe(false);
    expect(isFiltered({ ...NO_FILTERS, text: "x" })).toBe(true);
    const thresholds = new Map([["jeep", 0.5]]);
    expect(isFiltered({ ...NO_FILTERS, thresholds })).toBe(true);
    expect(isChosen({ ...NO_FILTERS, thresholds })).toBe(false);
    expect(filterParams({ ...NO_FILTERS, thresholds }, "ann").toString()).toBe("thresholds=applied");
  });

  it("measure distances", () => {
    expect(metresBetween({ latitude: 52, longitude: 13 }, { latitude: 52.001, longitude: 13 })).toBeCloseTo(111.2, 0);
    expect(metresBetween({ latitude: 60, longitude: 0 }, { latitude: 60, longitude: 0.001 })).toBeCloseTo(55.6, 0);
  });

  it("are sent to the server", () => {
    expect(filterParams(NO_FILTERS, "ann").toString()).toBe("");
    expect(filterParams({ ...NO_FILTERS, review: "not_own" }, "ann").toString()).toBe("review=not_own&reviewer=ann");
    expect(filterParams({ ...NO_FILTERS, review: "disputed" }, "ann").toString()).toBe("review=disputed");
    const all = { text: "Jeep near 52,13 2 km", models: ["a", "b"], video: 3, review: "none" as const, minScore: 0.5, area: rectangle([13, 52], [14, 53]), thresholds: new Map<string, number>() };
    expect(Object.fromEntries(filterParams(all, "ann"))).toEqual({
      model: "a,b",
      video: "3",
      review: "none",
      min_score: "0.5",
      near: "52,13,2000",
      area: "52,13,53,13,53,14,52,14",
      q: "jeep",
    });
  });
});

describe("PagedList", () => {
  const list = new PagedList(250, 100);
  list.add(100, Array.from({ length: 100 }, (_, i) => 1000 + i));

  it("knows what is loaded", () => {
    expect([list.at(99), list.at(100), list.at(199), list.at(200)]).toEqual([undefined, 1000, 1099, undefined]);
    expect([list.positionOf(1005), list.positionOf(7)]).toEqual([105, undefined]);
    expect(list.missingPages(90, 210)).toEqual([0, 2]);
    expect(list.missingPages(120, 150)).toEqual([]);
    expect(list.missingPages(-20, 999)).toEqual([0, 2]);
  });

  it("finds neighbours", () => {
    const even = (id: number) => id % 2 === 0;
    expect(list.find(100, 1, even)).toBe(1002);
    expect(list.find(105, -1, even)).toBe(1004);
    expect(list.find(199, 1, even)).toBe("unknown");
    expect(list.find(100, -1, even)).toBe("unknown");
    expect(new PagedList(0, 100).find(-1, 1, even)).toBe("end");
    const short = new PagedList(2, 100);
    short.add(0, [1, 3]);
    expect(short.find(0, 1, even)).toBe("end");
  });
});

describe("format", () => {
  it("names files and databases by their last part", () => {
    expect(["/data/a.mp4", "a.mp4", "postgresql://ann@host/videos", "postgresql://ann@/videos?host=/run/sql"].map(baseName)).toEqual([
      "a.mp4",
      "a.mp4",
      "videos",
      "videos",
    ]);
  });
  it("does not show a probability below 1 as 1", () => {
    expect([1, 0.9999, 0.994, 0.5].map((one) => formatScore(one))).toEqual(["1.00", ">0.99", "0.99", "0.50"]);
    expect(formatScore(0.99996, 3)).toBe(">0.999");
    expect(explainScore(0.9999)).toMatch(/more than 99/);
  });
  it("writes times", () => {
    expect([0, 4.9, 59.999, 61.5, 3661].map(formatTime)).toEqual(["0:00.00", "0:04.90", "1:00.00", "1:01.50", "1:01:01.00"]);
  });

  it("writes intervals", () => {
    expect(formatSpan(3, 5.21)).toBe("3.0 – 5.2 s");
    expect(formatSpan(59.99, 61.9)).toBe("0:59 – 1:01");
  });

  it("writes lengths and angles", () => {
    expect([null, 0.44, 99.94, 250, 1500, 25_000].map(formatMetres)).toEqual(["–", "0.4 m", "99.9 m", "250 m", "1.5 km", "25 km"]);
    expect([null, 0, 359.8, -90].map(formatAngle)).toEqual(["–", "0°", "0°", "270°"]);
  });

  it("writes expected numbers", () => {
    expect([0, 3.14, 13899.2].map(formatExpected)).toEqual(["0.0", "3.1", "13,899"]);
  });

  it("writes positions", () => {
    expect(formatPosition(52.5, -13.25, "decimal")).toBe("52.500000, -13.250000");
    expect(formatPosition(52.5, -13.25, "dms")).toBe("52°30′00.00″N 13°15′00.00″W");
    expect(formatPosition(-0.9999999999, 0, "dms")).toBe("1°00′00.00″S 0°00′00.00″E");
  });
});

describe("mgrs", () => {
  // By GeographicLib: latitude, longitude, MGRS, easting, northing.
  const places = [
    [52.5, 13.4, "33UUU9139017855", 391390.7313, 5817855.2408],
    [-33.8568, 151.2153, "56HLH3490052288", 334900.5697, 6252288.7529],
    [60.5, 5.3, "32VKN9681712810", 296817.4247, 6712810.0719],
    [75, 20, "33XXD4429329692", 644293.4334, 8329692.6507],
    [0.0001, 0.0001, "31NAA6603200011", 166032.5860, 11.0683],
    [-0.0001, -0.0001, "30MZE3396799988", 833967.4140, 9999988.9317],
    [83.9, -179.9, "01XDP6560917795", 465609.1687, 9317795.7533],
    [-79.5, 179.9, "60CWS5897472753", 558974.6426, 1172753.1372],
    [64.1, -21.9, "27WVM5613708467", 456137.5541, 7108467.4170],
    [-68.31526458211692, 122.38165528861185, "51DVE7450221857", 474502.6919, 2421857.9817],
    [43.30053692417647, -138.1620274113538, "07TGH3019398101", 730193.5948, 4798101.3167],
    [-30.350779824097664, -141.86817898706482, "07JDG1656042024", 416560.6237, 6642024.9205],
    [-75.80085870146624, -156.28684175662374, "04CEA7426585330", 574265.1741, 1585330.2888],
    [19.582903700267167, 164.16833626460658, "58QDG1277465538", 412774.3920, 2165538.6981],
    [29.22090416710992, -148.03883520830203, "06RUT9903032907", 399030.4872, 3232907.1899],
    [40.45068893460916, 137.63933811950346, "53TQE2381781127", 723817.6388, 4481127.1130],
    [-72.41209063952272, -172.22302291207274, "02CME5875464681", 458754.2125, 1964681.6164],
    [49.773685817556924, -98.89076346395237, "14UNA0786513474", 507865.3504, 5513474.2754],
    [-37.147567101365745, -135.3313742097181, "08HMD7057288705", 470572.6577, 5888705.9390],
  ] as const;

  it("agrees with GeographicLib", () => {
    for (const [latitude, longitude, text, easting, northing] of places) {
      const utm = utmOf(latitude, longitude);
      expect(utm?.easting).toBeCloseTo(easting, 3);
      expect(utm?.northing).toBeCloseTo(northing, 3);
      expect(formatMgrs(latitude, longitude)?.replaceAll(" ", "").padStart(15, "0")).toBe(text);
    }
  });

  it("ends where UPS begins", () => {
    expect([formatMgrs(84, 10), formatMgrs(-80.1, 10), formatMgrs(NaN, 0)]).toEqual([null, null, null]);
    expect(formatPosition(89, 10, "mgrs")).toBe("89.000000, 10.000000 (no MGRS there)");
    expect(formatPosition(52.5, 13.4, "mgrs")).toBe("33U UU 91390 17855");
    expect(formatPosition(52.5, 13.4, "utm")).toBe("33U 391390.7 5817855.2");
  });
});

describe("geo", () => {
  const metres = (a: Position, b: Position) =>
    metresBetween({ longitude: a[0], latitude: a[1] }, { longitude: b[0], latitude: b[1] });

  it("draws the ellipse along its azimuth", () => {
    const ring = ellipseRing(place(52, 13)) as Position[];
    const [first, quarter] = [ring[0] as Position, ring[12] as Position];
    expect(ring[0]).toEqual(ring.at(-1));
    expect(first[0]).toBeGreaterThan(13); // the longer axis points east
    expect(metres(first, [13, 52])).toBeCloseTo(20, 0);
    expect(metres(quarter, [13, 52])).toBeCloseTo(5, 0);
    expect(ellipseRing({ ...place(52, 13), ellipse: { semi_major_m: null, semi_minor_m: 1, azimuth_deg: 0 } })).toBeNull();
  });

  const corners = (east: number) =>
    [offset([13, 52], east - 50, 40), offset([13, 52], east + 50, 40), offset([13, 52], east + 50, -40), offset([13, 52], east - 50, -40)];
  const path: CameraPath = {
    source: "telemetry",
    reason: null,
    ground_m: 0,
    points: [0, 1, 2, 9].map((time) => ({
      time_s: time,
      position: offset([13, 52], 20 * time, 0),
      altitude_m: 100,
      yaw_deg: time === 0 ? 350 : 10,
      footprint: time === 9 ? null : corners(20 * time),
    })),
  };

  it("interpolates the camera", () => {
    const half = cameraAt(path, 0.5);
    expect(metres(half?.position ?? [0, 0], offset([13, 52], 10, 0))).toBeLessThan(0.1);
    expect(half?.yaw).toBeCloseTo(360); // over north, not around the back
    expect(metres(half?.footprint?.[0] ?? [0, 0], offset([13, 52], -40, 40))).toBeLessThan(0.1);
    expect(cameraAt(path, 5)).toBeNull(); // a gap
    expect(cameraAt(path, 9.5)?.footprint).toBeNull();
    expect(cameraAt({ ...path, points: [] }, 0)).toBeNull();
  });

  it("finds when a place was seen", () => {
    expect(contains(corners(0), offset([13, 52], 10, 10))).toBe(true);
    expect(contains(corners(0), offset([13, 52], 60, 10))).toBe(false);
    expect(whenSeen(path, offset([13, 52], 22, 0))).toBe(1);
    expect(whenSeen(path, offset([13, 52], 500, 0))).toBeNull();
  });

  it("spaces the grid", () => {
    expect([90, 430, 1100].map((width) => gridSpacing(width, 8))).toEqual([20, 100, 200]);
    const lines = gridLines(13, 52, 13.01, 52.01, 100);
    expect(lines.length).toBeGreaterThan(12);
    expect(gridLines(0, 0, 90, 45, 1)).toEqual([]);
  });
});

describe("uploads", () => {
  const files = (...names: string[]) => names.map((name) => ({ name }));

  it("are sorted by what they are", () => {
    const plan = planFiles(files("a.MP4", "a.telemetry.csv"));
    expect(plan.videos).toEqual([{ file: { name: "a.MP4" }, telemetry: { name: "a.telemetry.csv" } }]);
    expect(plan.problems).toEqual([]);
    expect(planFiles(files("x.jpg", "y.png")).model).toHaveLength(2);
    expect(planFiles(files("tank.glb")).model).toHaveLength(1);
    const both = planFiles(files("a.ts", "b.mkv", "jeep.jpg"));
    expect([both.videos.length, both.model.length, both.problems.length]).toEqual([2, 1, 0]);
  });

  it("are refused with a reason", () => {
    expect(planFiles(files("notes.txt")).problems[0]).toMatch(/^notes.txt/);
    expect(planFiles(files("a.mp4", "b.mp4", "t.csv")).problems).toHaveLength(1);
    const mixed = planFiles(files("a.glb", "b.jpg"));
    expect([mixed.model.length, mixed.problems.length]).toEqual([0, 1]);
    expect(planFiles(files("a.glb", "b.obj")).model).toEqual([]);
  });

  it("give models a name", () => {
    expect(["My Jeep (2).JPG", "tank.v2.glb", "___.png", "über.png"].map(modelNameOf)).toEqual(["my-jeep-2", "tank.v2", "model", "uber"]);
  });

  it("say how long yet", () => {
    expect([0.2, 42, 90, 7300].map(formatLeft)).toEqual(["1 s left", "42 s left", "2 min left", "2.0 h left"]);
  });

  it("say how far a live source is behind, if it is", () => {
    const of = (behind_s: number | null, change = {}) => formatBehind({ kind: "live", state: "running", behind_s, ...change });
    expect([null, 0.4, 1, 1.2, 12.4, 150].map((one) => of(one))).toEqual([null, null, null, "up to 2 s behind", "up to 13 s behind", "up to 3 min behind"]);
    expect(of(12, { state: "done" })).toBeNull();
  });
});

describe("address", () => {
  it("survives a round trip", () => {
    const state = { ...PLAIN, object: 3, video: 1, time: 4.9 };
    expect(formatUrl(state)).toBe("?object=3&video=1&t=4.9");
    expect(parseUrl(formatUrl(state))).toEqual(state);
    const there = { ...state, filters: { ...PLAIN.filters, area: rectangle([13.4, 52.5], [13.5, 52.6]) } };
    expect(formatUrl(there)).toBe("?object=3&video=1&t=4.9&area=52.5,13.4,52.6,13.4,52.6,13.5,52.5,13.5");
    expect(parseUrl(formatUrl(there))).toEqual(there);
    expect(parseUrl(formatUrl({ ...PLAIN, filters: there.filters })).filters.area).toEqual(there.filters.area);
    expect(parseUrl("?area=1,2,x").filters.area).toBeNull();
    expect(formatUrl(PLAIN)).toBe("");
  });

  it("holds what the reader has set of the list", () => {
    const filters = { text: 'shed & "near 52.5,13.4"', models: ["a, b", "c&d"], video: 2, review: "not_own" as const, minScore: 0.35, area: null };
    const state = { ...PLAIN, filters, order: "newest" as const, isAllListed: true };
    expect(parseUrl(formatUrl(state))).toEqual(state);
    expect(parseUrl("?review=wrong&min=7&order=x&in=1.5&list=")).toEqual(PLAIN);
  });

  it("names an object by its key, and takes the id of older links", () => {
    const key = "2f00c4.4900000.1.25.0.10.20.vehicle/car & van.v2";
    const state = { ...PLAIN, object: key, video: 1, time: 4.9 };
    expect(parseUrl(formatUrl(state))).toEqual(state);
    expect(parseUrl("?object=12").object).toBe(12);
  });

  it("ignores what is no number", () => {
    expect(parseUrl("?object=x&t=-3&video=1.5")).toEqual(PLAIN);
  });
});

describe("keys", () => {
  const press = (key: string, change = {}) => actionOf({ key, ctrlKey: false, metaKey: false, altKey: false, ...change });

  it("have one action each", () => {
    const keys = Object.values(BINDINGS).flatMap((one) => [...one.keys]);
    expect(new Set(keys).size).toBe(keys.length);
  });

  it("leave the browser's combinations alone", () => {
    expect(press("a")).toBe("accept");
    expect(press("A")).toBe("accept");
    expect([press("l"), press("L"), press("m"), press("M")]).toEqual(["nextMoment", "nextSighting", "mark", "unmark"]);
    expect(press(">")).toBe("frameOn");
    expect(press("a", { ctrlKey: true })).toBeNull();
    expect(press("q")).toBeNull();
  });
});

describe("saved lists", () => {
  const review = { ...accepted, note: 'a "shed", red', reviewer: "=1+1" };
  const decisions = [review, { ...accepted, verdict: "rejected" as const, reviewer: "ann" }];
  const videos = [
    { id: 1, name: "/v/a.mp4", start_utc_us: 1_700_000_000_000_000 },
    { id: 2, name: "/v/b.mp4", start_utc_us: null },
  ];
  const moments = [
    { id: 1, video_id: 1, first_time_s: 3, last_time_s: 5.1, frames: 2, score: 0.9 },
    { id: 2, video_id: 2, first_time_s: 2, last_time_s: 2.5, frames: 1, score: 0.8 },
  ];
  const placed = found(7, { place: place(52.5, 13.25), heading_deg: 90, review, decisions, is_disputed: true });

  it("are tables that spreadsheets read, without formulas", () => {
    const rows = toCsv([placed, found(8)], videos).split("\r\n");
    expect(rows[0]?.split(",").slice(0, 3)).toEqual(["object_id", "model", "score"]);
    expect(rows[1]).toBe(`7,jeep,0.9,3,/v/a.mp4,0,1,2023-11-14T22:13:20.000Z,2023-11-14T22:13:21.000Z,52.5,13.25,0,1,1,90,,accepted,'=1+1,"a ""shed"", red",1,accepted by =1+1; rejected by ann`);
    expect(rows[2]).toBe("8,jeep,0.9,3,/v/a.mp4,0,1,2023-11-14T22:13:20.000Z,2023-11-14T22:13:21.000Z,,,,,,,,,,,0,");
    expect(rows).toHaveLength(4);
  });

  it("do not join the times of two videos", () => {
    const rows = toCsv([found(9, { moments })], videos).split("\r\n");
    expect(rows[1]).toMatch(/^9,jeep,0.9,3,\/v\/a.mp4; \/v\/b.mp4,,,,,/);
    expect(momentsToCsv([found(9, { moments })], videos).split("\r\n")).toEqual([
      "object_id,model,video,first_time_s,last_time_s,first_utc,last_utc,frames",
      "9,jeep,/v/a.mp4,3,5.1,2023-11-14T22:13:23.000Z,2023-11-14T22:13:25.100Z,2",
      "9,jeep,/v/b.mp4,2,2.5,,,1",
      "",
    ]);
    const { properties } = toGeoJson([found(9, { moments, place: place(52.5, 13.25) })], videos).features[0] ?? {};
    expect(properties).toMatchObject({ videos: ["/v/a.mp4", "/v/b.mp4"], first_time_s: null, moments: [{ video: "/v/a.mp4", first_time_s: 3 }, { video: "/v/b.mp4", first_utc: null }] });
  });

  it("keep a negative number a number", () => {
    expect(toCsv([found(1, { place: place(-33.9, 18.4) })], videos)).toContain(",-33.9,18.4,");
  });

  it("are placemarks, with a date only where it is known of all moments", () => {
    const [dated] = moments;
    const kml = toKml([placed, found(8), found(9, { moments, place: place(52.5, 13.25) })], videos);
    expect(kml.match(/<Placemark id="object-\d+">/g)).toEqual(['<Placemark id="object-7">', '<Placemark id="object-9">']);
    expect(kml).toContain("<Point><coordinates>13.250000000,52.500000000</coordinates></Point>");
    expect(toKml([found(9, { moments, place: place(52.5, 13.25) })], videos)).not.toContain("<TimeSpan>");
    expect(toKml([found(9, { moments: dated ? [dated] : [], place: place(52.5, 13.25) })], videos)).toContain(
      "<TimeSpan><begin>2023-11-14T22:13:23.000Z</begin><end>2023-11-14T22:13:25.100Z</end></TimeSpan>",
    );
    expect(toKml([found(1, { model: 'a<b&"c"', place: place(1, 2) })], videos)).toContain("<name>a&lt;b&amp;&quot;c&quot; 1</name>");
  });

  it("are points, longitude first, without objects of unknown place", () => {
    const { features } = toGeoJson([placed, found(8)], videos);
    expect(features).toHaveLength(1);
    expect(features[0]).toMatchObject({ id: 7, geometry: { coordinates: [13.25, 52.5, 0] }, properties: { model: "jeep", verdict: "accepted", speed_m_s: null } });
  });
});

describe("boxBetween", () => {
  const frame = { width: 640, height: 480 };
  const at = fit(640, 480, 1280, 1000);

  it("is in the pixels of the video, from any corner, and ends at its edges", () => {
    expect(at).toEqual({ scale: 2, x: 0, y: 20 });
    expect(boxBetween([100, 120], [300, 220], frame, at)).toEqual([50, 50, 100, 50]);
    expect(boxBetween([300, 220], [100, 120], frame, at)).toEqual([50, 50, 100, 50]);
    expect(boxBetween([1200, 900], [1400, 1200], frame, at)).toEqual([600, 440, 40, 40]);
  });

  it("is none if it is too small for an object", () => {
    expect(boxBetween([100, 100], [100, 100], frame, at)).toBeNull();
    expect(boxBetween([100, 100], [400, 110], frame, at)).toBeNull();
  });
});

describe("boxCentres", () => {
  it("leaves out frames without a box", () => {
    const boxes = new Map([
      [1, [0, 0, 10, 20]],
      [3, [4, 4, 2, 2]],
      [9, [0, 0, 2, 2]],
    ]);
    const boxAt = (frame: number) => boxes.get(frame);
    expect(boxCentres(3, 60, boxAt)).toEqual([[5, 10], [5, 5]]);
    expect(boxCentres(4, 2, boxAt)).toEqual([[5, 5]]);
  });
});
