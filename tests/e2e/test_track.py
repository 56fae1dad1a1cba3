"""`track`: user boxes tracked forwards, backwards and in other videos; and rejected input."""

import json
import re
import shutil
import unittest

import program

KEYS = {"object_id", "model", "category", "video", "frame", "time_s", "box", "score", "source", "matches", "view"}
PLACE = {"latitude_deg", "longitude_deg", "altitude_m", "ce90_m", "le90_m", "speed_m_s"}
FRAME_S = 0.1  # of the synthetic flight


def overlap(a, b) -> float:
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return width * height / (a[2] * a[3] + b[2] * b[3] - width * height)


class TrackTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.video = program.flight() / "flight.mkv"
        self.truth = {}
        for row in map(json.loads, (program.flight() / "truth.jsonl").read_text().splitlines()):
            self.truth.setdefault(row["model"], {})[row["frame"]] = row

    def tracked(self, *arguments) -> list[dict]:
        out = self.scratch / "out.jsonl"
        self.assertEqual(self.succeeds("track", *arguments, "--out", out).out, "")
        return [json.loads(line) for line in out.read_text().splitlines()]

    def drawn(self, model: str, frame: int) -> tuple[str, ...]:
        return "--box", ",".join(map(str, self.truth[model][frame]["box"])), "--at", str(frame * FRAME_S)

    def whole_frames(self, model: str) -> list[int]:
        return self.frames_with(model, 0.98)

    def frames_with(self, model: str, visible: float) -> list[int]:
        return [frame for frame, row in self.truth[model].items() if row["visible"] > visible]

    def test_forward_and_backward(self):
        start = self.whole_frames("crate")[len(self.whole_frames("crate")) // 2]
        rows = self.tracked(self.video, *self.drawn("crate", start))
        self.assertEqual(set(rows[0]), KEYS | PLACE | {"type"})
        self.assertEqual({rows[0][key] for key in PLACE | {"type"}}, {None}, "nothing tells them")
        self.assertEqual([row["frame"] for row in rows], sorted({row["frame"] for row in rows}), "one a frame, in order")
        boxes = {row["frame"]: row["box"] for row in rows}
        whole = self.whole_frames("crate")
        found = [f for f in whole if f in boxes and overlap(boxes[f], self.truth["crate"][f]["box"]) > 0.5]
        self.assertGreater(len(found), 0.8 * len(whole))
        self.assertTrue(any(f < start for f in found) and any(f > start for f in found), found)
        for row in rows:
            self.assertEqual((row["object_id"], row["model"], row["category"]), (1, "box-1", None))
            self.assertEqual(row["video"], str(self.video))
            self.assertIn(row["source"], ("tracked", "recognised"))
            self.assertEqual(row["source"] == "recognised", row["matches"] is not None)
            self.assertTrue(0 < row["score"] <= 1)
            self.assertAlmostEqual(row["time_s"], row["frame"] * FRAME_S, places=3)
        self.assertEqual(boxes[start], self.truth["crate"][start]["box"])

    def test_several_boxes_and_another_video(self):
        first, second = self.whole_frames("crate")[0], self.whole_frames("truck")[0]
        other = program.flight() / "flight.mp4"
        drawn = (*self.drawn("crate", first), *self.drawn("truck", second))
        rows = self.tracked(self.video, *drawn, "--also", other)
        for name, model in (("box-1", "crate"), ("box-2", "truck")):
            for video in (self.video, other):
                boxes = {row["frame"]: row["box"] for row in rows if (row["model"], row["video"]) == (name, str(video))}
                clear = self.frames_with(model, 0.6)
                found = [f for f in clear if f in boxes and overlap(boxes[f], self.truth[model][f]["box"]) > 0.5]
                self.assertGreater(len(found), 0.5 * len(clear), (name, video))
        self.assertEqual(rows, self.tracked(self.video, *drawn, "--also", other), "the same again")

    def test_telemetry_and_object_type_give_a_place(self):
        start = self.whole_frames("crate")[0]
        x, y, width, height = self.truth["crate"][start]["box"]
        inside = ("--box", f"{x + width / 4},{y + height / 4},{width / 2},{height / 2}", "--at", str(start * FRAME_S))
        rows = ["time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"]
        # Camera states exist only around the time of the box: one line of sight, and the range from a car's length.
        rows += [f"{start * FRAME_S + after_s:.2f},48.0,11.0,100,0,-60,0,20" for after_s in (0, 0.02)]
        table = self.write("camera.csv", "\n".join(rows) + "\n")
        out = self.scratch / "out.jsonl"
        drawn = (self.video, *inside, "--telemetry", table, "--type", "vehicle/car", "--out", out)
        done = self.succeeds("track", *drawn)
        self.assertIn("CE90", done.err)
        placed = [json.loads(line) for line in out.read_text().splitlines()]
        self.assertEqual({row["type"] for row in placed}, {"vehicle/car"})
        placed = [row for row in placed if row["latitude_deg"] is not None]
        self.assertTrue(placed)
        for row in placed:
            self.assertAlmostEqual(row["latitude_deg"], 48, delta=0.02)
            self.assertGreater(row["ce90_m"], 0)
        done = self.succeeds("track", *drawn[:-4], "--type", "the mayor's", "--out", out)
        self.assertIn("a name only", done.err)
        self.assertIn("box-1: no place: its lines of sight do not determine its distance", done.err)
        # The intersection of that line with the ground is a place as well: 100 m below, at 60 degrees.
        self.assertIn("CE90", self.succeeds("track", *drawn[:-4], "--ground", "0", "--out", out).err)
        placed = [row for row in map(json.loads, out.read_text().splitlines()) if row["latitude_deg"] is not None]
        self.assertTrue(placed)
        for row in placed:
            self.assertAlmostEqual(row["altitude_m"], 1.2, delta=0.5)
            north_m = (row["latitude_deg"] - 48) * 111_200
            self.assertTrue(30 < north_m < 90, row)

    def test_missing_place_is_explained(self):
        drawn = (self.video, *self.drawn("crate", self.whole_frames("crate")[0]), "--out", self.scratch / "out.jsonl")
        self.assertIn("no place: no telemetry with camera position", self.succeeds("track", *drawn).err)
        header = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"
        table = self.write("late.csv", f"{header}\n1000,48,11,100,0,-60,0,20\n1001,48,11,100,0,-60,0,20\n")
        reported = self.succeeds("track", *drawn, "--telemetry", table).err
        self.assertIn("telemetry: nothing will get a place: it covers 1000.00 to 1001.00 s", reported)

    def test_a_box_becomes_an_object_of_the_index(self):
        db = self.scratch / "index.db"
        shutil.copy(program.index(), db)
        known = self.succeeds("export", "--db", db, "--format", "objects").rows()
        drawn = (self.video, *self.drawn("truck", self.whole_frames("truck")[0]), "--type", "vehicle/truck")
        done = self.succeeds("track", *drawn, "--db", db, "--out", self.scratch / "out.jsonl")
        rows = [json.loads(line) for line in (self.scratch / "out.jsonl").read_text().splitlines()]
        (number,) = re.findall(r"box-1: is object (\d+), boxed/vehicle/truck", done.err)
        listed = self.succeeds("export", "--db", db, "--format", "objects").rows()
        (boxed,) = (one for one in listed if one["object_id"] == int(number))
        self.assertEqual((boxed["model"], boxed["category"]), (None, "boxed/vehicle/truck"))
        others = [one | {"rank": 0} for one in listed if one is not boxed]
        self.assertEqual(others, [one | {"rank": 0} for one in known], "the others stay as they are")
        sightings = self.succeeds("export", "--db", db, "--category", "boxed", "--format", "sightings").rows()
        for one, row in zip(sightings, rows, strict=True):
            self.assertEqual([one[key] for key in ("frame", "box", "score", "source")], [row[key] for key in ("frame", "box", "score", "source")])
        # Once more, it adds nothing; nor does a search of the video miss anything because of it.
        self.assertIn(f"is object {number},", self.succeeds("track", *drawn, "--db", db).err)
        self.assertEqual(self.succeeds("export", "--db", db, "--format", "objects").rows(), listed)
        self.assertIn("already indexed", self.succeeds("index", self.video, "--models", program.models(), "--db", db).err)
        self.assertEqual(self.succeeds("doctor", db, "--check").status, 0)
        # A video that the index does not have, and no place for the tracks.
        other = ("track", program.flight() / "flight.mp4", *drawn[1:])
        self.refuses(2, "flight.mp4: is not in the index", *other, "--db", db)
        self.refuses(2, "no such index", *other, "--db", self.scratch / "none.db")
        self.refuses(2, "give --out FILE, or --db INDEX", *other)

    def test_what_was_boxed_becomes_a_model(self):
        db, models = self.scratch / "index.db", self.scratch / "models"
        shutil.copy(program.index(), db)
        drawn = (self.video, *self.drawn("truck", self.whole_frames("truck")[0]))
        (number,) = re.findall(r"box-1: is object (\d+)", self.succeeds("track", *drawn, "--db", db).err)
        grow = ("model", "grow", "lorry", "--db", db, "--models", models)
        done = self.succeeds(*grow, "--object", number).out
        self.assertRegex(done, rf"^lorry: \d+ views? learnt from \d+ sightings of object {number}; \d+ views?, \d+ features\n$")
        model = (models / "lorry.vmodel").read_bytes()
        self.assertRegex(self.succeeds(*grow, "--object", number).out, "^lorry: 0 views learnt")
        self.assertEqual((models / "lorry.vmodel").read_bytes(), model, "what is known is not learnt again")
        found = self.scratch / "found.db"
        self.succeeds("index", self.video, "--models", models, "--db", found)
        boxes = {row["frame"]: row["box"] for row in self.succeeds("export", "--db", found, "--format", "sightings").rows()}
        whole = self.whole_frames("truck")
        seen = [f for f in whole if f in boxes and overlap(boxes[f], self.truth["truck"][f]["box"]) > 0.5]
        self.assertGreater(len(seen), 0.8 * len(whole))
        self.refuses(2, "object 9999: not in the index", *grow, "--object", 9999)
        self.refuses(2, "no such file", "model", "grow", "lorry", "--db", self.scratch / "none.db", "--models", models, "--object", 1)
        self.assertEqual((models / "lorry.vmodel").read_bytes(), model)

    def test_unwritable_output_is_reported_first(self):
        drawn = self.drawn("crate", self.whole_frames("crate")[0])
        done = program.run("track", self.video, *drawn, "--out", self.scratch / "gone" / "out.jsonl")
        self.assertNotEqual(done.status, 0)
        self.assertEqual(len(done.err.splitlines()), 1, "no progress: nothing was followed")

    def test_bad_input_is_one_line(self):
        out = ("--out", self.scratch / "out.jsonl")
        good = ("--box", "10,10,40,40", "--at", "0")
        cases = [
            ("outside the frame", (self.video, "--box", "5000,10,40,40", "--at", "0")),
            ("box-2", (self.video, *good, "--box", "-100,10,40,40", "--at", "0")),
            ("above 0", (self.video, "--box", "10,10,0,40", "--at", "0")),
            ("too small", (self.video, "--box", "10,10,1,40", "--at", "0")),
            ("x,y,w,h", (self.video, "--box", "10,10,40", "--at", "0")),
            ("ends at", (self.video, "--box", "10,10,40,40", "--at", "999")),
            ("2 --box and 1 --at", (self.video, *good, "--box", "10,10,40,40")),
            ("1 --box and 2 --at", (self.video, *good, "--at", "1")),
            ("time of at least 0", (self.video, "--box", "10,10,40,40", "--at", "-1")),
            ("time of at least 0", (self.video, "--box", "10,10,40,40", "--at", "nan")),
            ("2 --type and 1 --box", (self.video, *good, "--type", "car", "--type", "bus")),
            ("absent.csv", (self.video, *good, "--telemetry", self.scratch / "absent.csv")),
            ("absent.tif", (self.video, *good, "--terrain", self.scratch / "absent.tif")),
            ("given twice", (self.video, *good, "--ground", "3", "--terrain", self.scratch / "absent.tif")),
            ("absent.mp4", (self.scratch / "absent.mp4", *good)),
            ("absent.mp4", (self.video, *good, "--also", self.scratch / "absent.mp4")),
            ("text.mp4", (self.write("text.mp4", "no video"), *good)),
            ("box.no_such", (self.video, *good, "--params", self.write("p.json", '{"box.no_such": 1}'))),
            ("lost_confidence", (self.video, *good, "--params", self.write("q.json", '{"box.lost_confidence": 2}'))),
        ]
        for words, arguments in cases:
            with self.subTest(words):
                self.refuses(2, words, "track", *arguments, *out)
                self.assertFalse(out[1].exists())


if __name__ == "__main__":
    program.main()
