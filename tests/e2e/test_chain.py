"""The complete workflow of a user, from photos and a video to the list of objects, and all exports."""

import json
import random
import shutil
import unittest

import program

OBJECT_KEYS = {
    "object_id", "model", "category", "rank", "score", "videos", "frames", "first_time_s", "last_time_s", "moments",
    "place_time_s", "latitude_deg", "longitude_deg", "altitude_m", "covariance_enu_m2", "ce90_m", "le90_m",
    "heading_deg", "speed_m_s", "sigma_speed_m_s", "course_deg", "sigma_course_deg", "against", "evidence",
}  # fmt: skip
UNKNOWN_WITHOUT_TELEMETRY = OBJECT_KEYS - {
    "object_id", "model", "rank", "score", "videos", "frames", "first_time_s", "last_time_s", "moments", "against", "evidence",
}  # fmt: skip
SIGHTING_KEYS = {
    "object_id", "model", "category", "video", "frame", "time_s", "box", "score", "source", "matches", "view",
}  # fmt: skip
SCORE_KEYS = {
    "findable", "found", "false_objects", "recall", "precision", "average_precision", "sighting_recall",
    "sighting_precision", "density_p25", "density_p50", "density_p75", "ids_per_object", "located", "cep50_m",
    "cep75_m", "cep90_m", "error3d_p50_m", "inside_90_ellipsoid", "inside_ce90", "heading_error_p50_deg",
    "view_error_p50_deg", "view_error_p90_deg", "per_object",
}  # fmt: skip


class ModelsTest(program.ProgramTest):
    def test_add_list_show_remove(self):
        models = self.scratch / "models"
        added = self.succeeds(
            "model", "add", "crate", program.flight() / "crate.png", "--models", models, "--length", "1.5"
        )
        self.assertRegex(added.out, r"^crate: 1 view, \d+ features: well recognisable\n$")
        photos = [program.flight() / name for name in ("truck.png", "sign.png")]
        self.succeeds("model", "add", "pair", *photos, "--models", models)
        self.succeeds(
            "model", "add", "boxed", photos[0], "--models", models, "--box", "10,20,90,120"
        )

        self.assertEqual(sorted(path.name for path in models.iterdir()), ["boxed.vmodel", "crate.vmodel", "pair.vmodel"])
        listed = self.succeeds("model", "list", "--models", models, "--json").rows()
        self.assertEqual([row["name"] for row in listed], ["boxed", "crate", "pair"])
        self.assertEqual([row["views"] for row in listed], [1, 1, 2])
        self.assertEqual([row["length_m"] for row in listed], [None, 1.5, None])
        for name in ("boxed", "crate", "pair"):
            self.assertIn(name, self.succeeds("model", "list", "--models", models).out)
            self.assertIn(name, self.succeeds("model", "show", name, "--models", models).out)

        shown = json.loads(self.succeeds("model", "show", "boxed", "--models", models, "--json").out)
        self.assertEqual(shown["kind"], "photos")
        self.assertEqual(shown["engine"], shown["options"]["features"]["engine"])
        self.assertEqual(shown["view_list"][0]["outline_box"][2] <= 90, True)
        self.assertGreater(shown["features"], 20)
        sheet = self.scratch / "views.png"
        self.succeeds("model", "show", "pair", "--models", models, "--views", sheet)
        self.assertTrue(sheet.read_bytes().startswith(b"\x89PNG"))
        self.refuses(2, "views.gif7", "model", "show", "pair", "--models", models, "--views", self.scratch / "views.gif7")

        self.assertEqual(self.succeeds("model", "remove", "pair", "--models", models).out, "")
        removed = self.succeeds("model", "remove", "boxed", "--models", models, "--json").out
        self.assertEqual(json.loads(removed), {"removed": "boxed"})
        self.assertEqual([path.name for path in models.iterdir()], ["crate.vmodel"])


class FindsTest(program.ProgramTest):
    def test_search_lists_objects_best_first(self):
        rows = self.succeeds("search", "--db", program.index(), "--json").rows()
        self.assertEqual({row["model"] for row in rows}, {"crate", "truck"})
        self.assertEqual([row["rank"] for row in rows], list(range(1, len(rows) + 1)))
        scores = [row["score"] for row in rows]
        self.assertEqual(scores, sorted(scores, reverse=True))
        only = self.succeeds("search", "--db", program.index(), "--model", "truck", "--json").rows()
        self.assertEqual({row["model"] for row in only}, {"truck"})
        text = self.succeeds("search", "--db", program.index()).out
        self.assertEqual(len(text.splitlines()), len(rows) + 1)

    def test_search_by_image_needs_no_model(self):
        rows = self.succeeds(
            "search", "--db", program.index(), "--image", program.flight() / "sign.png", "--json"
        ).rows()
        self.assertGreater(len(rows), 0)
        truth = self.truth("sign")
        self.assertGreater(overlap(rows[0]["box"], truth[rows[0]["frame"]]), 0.5)

        frame = self.scratch / "frame.png"
        number = max(truth, key=lambda f: truth[f][2] * truth[f][3])
        self.succeeds("frame", program.flight() / "flight.mkv", "--number", number, "--out", frame)
        box = ",".join(map(str, truth[number]))
        rows = self.succeeds("search", "--db", program.index(), "--image", frame, "--box", box, "--json").rows()
        self.assertGreater(overlap(rows[0]["box"], truth[rows[0]["frame"]]), 0.5)

    def test_export_objects(self):
        rows = [json.loads(line) for line in self.export(program.index(), "objects").splitlines()]
        self.assertGreaterEqual(len(rows), 2)
        for rank, row in enumerate(rows, start=1):
            self.assertEqual(set(row), OBJECT_KEYS)
            self.assertEqual(row["rank"], rank)
            self.assertEqual(row["videos"], [str(program.flight() / "flight.mkv")])
            self.assertLessEqual(row["first_time_s"], row["last_time_s"])
            for key in UNKNOWN_WITHOUT_TELEMETRY:
                self.assertIsNone(row[key], key)

    def test_export_sightings(self):
        rows = [json.loads(line) for line in self.export(program.index(), "sightings").splitlines()]
        objects = [json.loads(line) for line in self.export(program.index(), "objects").splitlines()]
        self.assertEqual(len(rows), sum(row["frames"] for row in objects))
        self.assertEqual([row["frame"] for row in rows], sorted(row["frame"] for row in rows))
        right = 0
        for row in rows:
            self.assertLessEqual(SIGHTING_KEYS, set(row))
            self.assertIn(row["source"], ("recognised", "tracked"))
            self.assertAlmostEqual(row["time_s"], row["frame"] / 10, places=3)
            self.assertEqual(set(row["view"]), {"azimuth_deg", "off_nadir_deg", "in_plane_deg"})
            self.assertIsNone(row["view"]["azimuth_deg"])
            x, y, width, height = row["box"]
            self.assertTrue(x >= 0 and y >= 0 and x + width <= 256.01 and y + height <= 192.01, row["box"])
            right += overlap(row["box"], self.truth(row["model"]).get(row["frame"], [0, 0, 0, 0])) >= 0.4
        self.assertGreaterEqual(right, 0.95 * len(rows))

    def test_export_mot_and_coco_hold_the_same_sightings(self):
        rows = [json.loads(line) for line in self.export(program.index(), "sightings").splitlines()]
        mot = [line.split(",") for line in self.export(program.index(), "mot").splitlines()]
        self.assertEqual([(int(line[0]), int(line[1])) for line in mot], [(r["frame"] + 1, r["object_id"]) for r in rows])
        for line, row in zip(mot, rows):
            self.assertEqual(len(line), 10)
            self.assertEqual([float(number) for number in line[2:6]], row["box"])

        coco = json.loads(self.export(program.index(), "coco"))
        self.assertEqual({category["name"] for category in coco["categories"]}, {"crate", "truck"})
        images = {image["id"]: image for image in coco["images"]}
        (video,) = coco["videos"]
        self.assertEqual((video["width"], video["height"]), (images[1]["width"], images[1]["height"]))
        self.assertAlmostEqual(video["annotation_fps"], 10, delta=0.01)
        tracks = {track["id"]: track["name"] for track in coco["tracks"]}
        categories = {category["id"]: category["name"] for category in coco["categories"]}
        for one in coco["annotations"]:
            self.assertEqual(tracks[one["track_id"]], f"{categories[one['category_id']]} {one['track_id']}")
        for one in coco["images"]:
            self.assertEqual((one["video_id"], one["frame_index"], one["timestamp"]), (video["id"], one["frame"], one["time_s"]))
        found = [(images[a["image_id"]]["frame"], a["track_id"], a["bbox"]) for a in coco["annotations"]]
        self.assertEqual(found, [(row["frame"], row["object_id"], row["box"]) for row in rows])
        for image in images.values():
            self.assertEqual((image["width"], image["height"]), (256, 192))

    def test_export_filters_and_writes_files(self):
        out = self.scratch / "sightings.jsonl"
        flags = ["--model", "truck", "--from", "0.5", "--to", "2", "--video", "flight.mkv"]
        self.assertEqual(self.export(program.index(), "sightings", *flags, "--out", out), "")
        rows = [json.loads(line) for line in out.read_text().splitlines()]
        self.assertGreater(len(rows), 0)
        for row in rows:
            self.assertEqual(row["model"], "truck")
            self.assertTrue(0.5 <= row["time_s"] <= 2, row["time_s"])
        self.assertEqual(list(self.files()), ["sightings.jsonl"])

    def test_rejected_objects_are_listed_on_request(self):
        db = self.scratch / "index.db"
        # An object that is not in the flight: all of its detections are false, and weak.
        image = self.write("noise.ppm", b"P6\n96 72\n255\n" + random.Random(1).randbytes(3 * 96 * 72))
        self.succeeds("model", "add", "noise", image, "--models", self.scratch / "models")
        params = self.write(
            "params.json",
            '{"objects.false_alarm_rate": 1, "detect.min_score": 0, "pose.min_inliers": 2, "cascade.filter": "none"}',
        )
        video = program.flight() / "flight.mkv"
        self.succeeds("index", video, "--models", self.scratch / "models", "--db", db, "--params", params)
        self.assertEqual(self.succeeds("search", "--db", db, "--json").out, "")
        for command in (("search",), ("export", "--format", "objects"), ("export", "--format", "geojson")):
            said = self.succeeds(*command, "--db", db).err
            self.assertRegex(said, r"\d+ objects? rejected \(--rejected lists them\); the best, noise with score [\d.]+ in "
                                   r"\d+ frames?: not significant")  # fmt: skip
        self.assertIn("(rejected: not significant: as strong a false detection", self.succeeds("search", "--db", db, "--rejected").out)
        rows = self.succeeds("search", "--db", db, "--rejected", "--json").rows()
        self.assertGreater(len(rows), 0)
        for row in rows:
            self.assertEqual(set(row), OBJECT_KEYS | {"rejected"})
        self.assertEqual(self.export(db, "sightings"), "")
        self.assertGreater(len(self.export(db, "sightings", "--rejected").splitlines()), len(rows))
        exported = [json.loads(line) for line in self.export(db, "objects", "--rejected").splitlines()]
        self.assertEqual(exported, rows)
        sheet = self.scratch / "sheet.png"
        self.refuses(2, "rejected (--rejected lists them)", "sheet", "--db", db, "--out", sheet)
        self.succeeds("sheet", "--db", db, "--out", sheet, "--rejected")
        self.assertTrue(sheet.exists())

    def test_telemetry_of_another_flight_costs_the_place_only(self):
        header = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"
        rows = [f"{i / 10},{48 + i * i % 7 / 1000},11,{100 + 40 * (i % 3)},{i * 97 % 360},{-20 - i * 31 % 60},0,30"
                for i in range(2 * program.FRAMES)]  # fmt: skip
        other = self.write("other.csv", "\n".join([header, *rows]) + "\n")
        db = self.scratch / "index.db"
        video = program.flight() / "flight.mkv"
        said = self.succeeds("index", video, "--models", program.models(), "--db", db, "--telemetry", other).err
        self.assertIn("it may belong to another flight", said)
        listed = self.succeeds("search", "--db", db, "--json").rows()
        self.assertLessEqual({"crate", "truck"}, {row["model"] for row in listed})
        for row in listed:
            self.assertIsNone(row["latitude_deg"], row)
            self.assertIn("lines of sight do not intersect", row["place_rejected"])
        self.assertIn("(no place: its lines of sight do not intersect", self.succeeds("search", "--db", db).out)
        self.assertNotEqual(self.export(db, "sightings"), "")
        for form in ("geojson", "kml", "gpkg"):
            done = self.succeeds("export", "--db", db, "--format", form, "--out", self.scratch / form)
            self.assertIn("no place", done.err)
            self.assertIn("do not intersect", done.err)

    def test_evaluate(self):
        truth = program.flight() / "truth.jsonl"
        flags = ["--db", program.index(), "--truth", truth, "--models", "crate,truck"]
        score = json.loads(self.succeeds("evaluate", *flags, "--json").out)
        self.assertEqual(set(score), SCORE_KEYS)
        self.assertEqual(score["findable"], 2)
        self.assertEqual(score["found"], 2)
        self.assertGreater(score["sighting_recall"], 0.8)
        self.assertGreater(score["sighting_precision"], 0.95)
        self.assertIn("findable", self.succeeds("evaluate", *flags).out)
        judged = json.loads(self.succeeds("evaluate", *flags, "--scores", "--json").out)["reliability"]
        self.assertEqual(judged["wrong"], 0)
        self.assertEqual(judged["right"], len(judged["objects"]))
        self.assertGreater(judged["mean_score_right"], 0.9)
        self.assertEqual({row["model"] for row in judged["objects"]}, {"crate", "truck"})
        self.assertIn("calibration_error", self.succeeds("evaluate", *flags, "--scores").out)
        # The third object has no model.
        everything = json.loads(self.succeeds("evaluate", *flags[:4], "--json").out)
        self.assertEqual((everything["findable"], everything["found"]), (3, 2))

    def test_sheet(self):
        out = self.scratch / "finds.png"
        self.assertEqual(self.succeeds("sheet", "--db", program.index(), "--out", out).out, "")
        self.assertEqual(out.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(list(self.files()), ["finds.png"])

    def test_doctor_and_params(self):
        of_machine = self.succeeds("doctor").out
        self.assertIn("victorious", of_machine)
        self.assertIn("\n  sandbox          ", of_machine, "what confines the decoders of hostile files")
        self.assertIn("matroska", self.succeeds("doctor", program.flight() / "flight.mkv").out)
        of_index = self.succeeds("doctor", program.index()).out
        for words in ("2 models", "searched to the end"):
            self.assertIn(words, of_index)
        self.assertIn("crate", self.succeeds("doctor", program.models() / "crate.vmodel").out)

    def test_doctor_as_json(self):
        def reported(*arguments) -> dict:
            return json.loads(self.succeeds("doctor", *arguments, "--json").out)

        self.assertIn("opencv", reported()["feature_engines"])
        video = reported(program.flight() / "flight.mkv")
        self.assertEqual((video["kind"], video["frames_read"], video["read_to_end"]), ("video", program.FRAMES, True))
        self.assertEqual(video["streams"][0]["type"], "video")
        self.assertIsNone(video["telemetry"])
        index = reported(program.index())
        self.assertEqual((index["kind"], index["models"]), ("index", 2))
        self.assertEqual([row["finished"] for row in index["videos"][0]["searches"]], [True, True])
        model = reported(program.models() / "crate.vmodel")
        self.assertEqual((model["kind"], model["name"], model["made_from"]), ("model", "crate", "photos"))

        self.assertEqual(json.loads(self.succeeds("params", "--json").out)["match"]["ratio"], 0.8)
        self.assertIn("`match.ratio`", self.succeeds("params").out)

    def truth(self, model):
        rows = (json.loads(line) for line in (program.flight() / "truth.jsonl").read_text().splitlines())
        return {row["frame"]: row["box"] for row in rows if row["model"] == model}


class IndexTest(program.ProgramTest):
    def test_second_run_searches_new_models_only(self):
        models, db = self.scratch / "models", self.scratch / "index.db"
        models.mkdir()
        shutil.copy(program.models() / "truck.vmodel", models)
        video = program.flight() / "flight.mkv"
        first = self.succeeds("index", video, "--models", models, "--db", db)
        self.assertEqual(first.out, "")
        self.assertEqual(len(first.messages()), 1, first.err)
        self.assertIn("there is no telemetry, so that nothing gets a place", first.err)
        self.assertIn(f"{program.SEARCHED_FRAMES} frames searched", first.err)
        trucks = self.export(db, "sightings")

        again = self.succeeds("index", video, "--models", models, "--db", db)
        self.assertIn("0 frames searched", again.err)
        self.assertEqual(self.export(db, "sightings"), trucks)

        shutil.copy(program.models() / "crate.vmodel", models)
        self.succeeds("index", video, "--models", models, "--db", db)
        self.assertEqual(self.export(db, "sightings", "--model", "truck"), trucks)
        self.assertEqual(*(without_ids(self.export(d, "sightings")) for d in (db, program.index())))
        self.assertEqual(sorted(path.name for path in self.scratch.iterdir()), ["index.db", "models"])

        copy = self.scratch / "copy.mkv"
        shutil.copy(video, copy)
        before = len(self.export(db, "sightings").splitlines())
        self.succeeds("index", copy, "--models", models, "--db", db)
        self.assertEqual(len(self.export(db, "sightings", "--video", "copy.mkv").splitlines()), before)

    def test_every_and_parameters(self):
        db = self.scratch / "index.db"
        params = self.write("params.json", '{"match": {"ratio": 0.75}, "keep.interval_s": 2}')
        flags = ["index", program.flight() / "flight.mkv", "--models", program.models(), "--db", db]
        done = self.succeeds(*flags, "--every", "7", "--params", params, "--threads", "3")
        self.assertEqual(len(done.messages()), 1, done.err)
        self.assertIn("6 frames searched", done.err)
        rows = [json.loads(line) for line in self.export(db, "sightings").splitlines()]
        self.assertTrue(any(row["frame"] % 7 for row in rows), "between them, objects are followed")
        sources = {row["source"] for row in rows if row["frame"] % 7 == 0}
        self.assertIn("recognised", sources)

        before = self.export(db, "sightings")
        for flag, words in ((["--params", params], "every was 7, is 3"), (["--every", "7"], "match.ratio was 0.75")):
            self.refuses(2, [words, "--redo", "flight.mkv"], *flags, *flag)
            self.assertEqual(self.export(db, "sightings"), before)
        self.succeeds(*flags, "--redo")
        self.assertEqual(*(without_ids(self.export(d, "sightings")) for d in (db, program.index())))

    def test_folder_of_images_is_a_video(self):
        folder, db = self.scratch / "frames", self.scratch / "index.db"
        folder.mkdir()
        for number in range(3):
            self.succeeds(
                "frame", program.flight() / "flight.mkv", "--number", number, "--out", folder / f"{number:03}.png"
            )
        self.succeeds("index", folder, "--models", program.models(), "--db", db)
        rows = [json.loads(line) for line in self.export(db, "sightings").splitlines()]
        expected = [json.loads(line) for line in self.export(program.index(), "sightings", "--to", "0.25").splitlines()]
        self.assertEqual([(row["frame"], row["model"]) for row in rows], [(r["frame"], r["model"]) for r in expected])


def overlap(a, b):
    """Intersection over union of two boxes x, y, w, h."""
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    common = width * height if width > 0 and height > 0 else 0
    return common / (a[2] * a[3] + b[2] * b[3] - common)


def without_ids(sightings):
    """Sightings by frame and model; object ids depend on the order of the index runs."""
    rows = []
    for line in sightings.splitlines():
        row = json.loads(line)
        row.pop("object_id")
        rows.append(json.dumps(row))
    return sorted(rows)


if __name__ == "__main__":
    program.main()
