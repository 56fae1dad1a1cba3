"""Bad input: exit status 2 and a one-line error with the file's name and the remedy; no partial output."""

import sqlite3
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()
CRATE = program.flight() / "crate.png"
SHORT = program.flight(8) / "flight.mkv"  # for tests that index it themselves
MATROSKA_CLUSTER = b"\x1f\x43\xb6\x75"  # start of the frames


class VideosTest(program.ProgramTest):
    def refuses_video(self, video, words=""):
        db = self.scratch / "index.db"
        self.refuses(2, [video, words], "index", video, "--models", MODELS, "--db", db)
        self.assertEqual([path for path in self.scratch.iterdir() if path.name.startswith("index")], [])
        self.refuses(2, video, "doctor", video)

    def test_replaced_video_is_not_drawn(self):
        video = self.write("flight.mkv", SHORT.read_bytes())
        db, sheet = self.scratch / "index.db", self.scratch / "sheet.png"
        self.succeeds("index", video, "--models", MODELS, "--db", db)
        self.succeeds("sheet", "--db", db, "--out", sheet)
        sheet.unlink()
        video.write_bytes(SHORT.with_name("flight.mp4").read_bytes())
        self.refuses(2, (video, "not the video that was indexed"), "sheet", "--db", db, "--out", sheet)
        # A file that cannot be written is named before the videos are looked at.
        for out in (self.scratch / "sheet.exr", self.scratch / ".png", self.scratch / "none/sheet.png"):
            self.refuses(2, out, "sheet", "--db", db, "--out", out)
        self.assertFalse(sheet.exists())

    def test_missing_and_empty(self):
        self.refuses_video(self.scratch / "none.mp4", "no such file")
        self.refuses_video(self.write("empty.mp4", ""), "empty")
        (self.scratch / "folder").mkdir()
        self.refuses_video(self.scratch / "folder", "without images")
        self.write("texts/notes.txt", "no image")
        self.refuses_video(self.scratch / "texts", "without images")

    def test_bad_video_is_reported_and_the_good_one_indexed(self):
        db = self.scratch / "index.db"
        missing = self.scratch / "none.mp4"
        done = program.run("index", missing, SHORT, "--models", MODELS, "--db", db)
        self.assertEqual(done.status, 2)
        self.assertIn(f"error: {missing}: no such file", done.err)
        self.assertNotEqual(self.export(db, "sightings"), "")
        before = self.export(db, "sightings")
        self.refuses(2, missing, "index", missing, "--models", MODELS, "--db", db)
        self.assertEqual(self.export(db, "sightings"), before)

    def test_model_named_like_a_video(self):
        model = self.write("model.mp4", (MODELS / "crate.vmodel").read_bytes())
        self.refuses(2, model, "index", model, "--models", MODELS, "--db", self.scratch / "index.db")
        self.assertIn("a model: crate", self.succeeds("doctor", model).out)

    def test_names_that_are_too_long(self):
        long = "x" * 5000
        for video in (long, long + ".mp4", self.scratch / ("x" * 300)):
            self.refuses_video(video, "File name too long")
        for option in ("--models", "--params", "--db", "--telemetry", "--ground", "--categories", "--cache"):
            given = {"--models": MODELS, "--db": self.scratch / "index.db"} | {option: long}
            self.refuses(2, long, "index", VIDEO, *(word for pair in given.items() for word in pair))
        self.refuses(2, [long, "preset"], "index", VIDEO, "--models", MODELS, "--db", self.scratch / "a.db", "--params", long)
        too_long = "File name too long"
        for command in ("telemetry", "locate", "doctor"):
            self.refuses(2, too_long, command, long)
        out = self.scratch / "out"
        for command in ("features", "simulate", "frame"):
            self.refuses(2, too_long, command, long, "--out", out, *(("--at", 0) if command == "frame" else ()))
        self.refuses(2, too_long, "search", "--db", long)
        self.refuses(2, too_long, "search", "--db", INDEX, "--image", long)
        self.refuses(2, too_long, "evaluate", "--db", INDEX, "--truth", long)
        self.refuses(2, too_long, "export", "--db", INDEX, "--format", "mot", "--out", long)
        self.refuses(2, too_long, "sheet", "--db", INDEX, "--out", long + ".png")
        self.refuses(2, too_long, "track", VIDEO, "--box", "1,1,50,50", "--at", 0, "--out", long)
        self.assertEqual(self.files(), {})

    def test_not_a_video(self):
        self.refuses_video(self.write("text.mp4", "This is a text and no video.\n" * 100))
        self.refuses_video(self.write("random.mkv", bytes((i * i * 7919 >> 8) & 255 for i in range(20000))))
        self.refuses_video(self.write("playlist.m3u8", f"#EXTM3U\n#EXTINF:1,\n{VIDEO}\n"))

    def test_no_frames(self):
        whole = VIDEO.read_bytes()
        self.refuses_video(self.write("header.mkv", whole[: whole.index(MATROSKA_CLUSTER)]))
        mp4 = (program.flight() / "flight.mp4").read_bytes()
        self.refuses_video(self.write("cut.mp4", mp4[: len(mp4) // 2]))  # the frame index is at the end of the file

    def test_unresponsive_url(self):
        self.refuses(
            2, "http://127.0.0.1:1/video", "index", "http://127.0.0.1:1/video", "--models", MODELS,
            "--db", self.scratch / "index.db",
        )  # fmt: skip

    def test_bad_video_does_not_stop_the_others(self):
        db, bad = self.scratch / "index.db", self.write("bad.mkv", "no video")
        done = program.run("index", bad, SHORT, self.scratch / "none.mkv", "--models", MODELS, "--db", db)
        self.assertEqual(done.status, 2, done.err)
        errors = [line for line in done.messages() if line.startswith("error: ")]
        self.assertEqual(len(errors), 1, done.err)
        self.assertIn(str(bad), errors[0])
        self.assertIn("none.mkv", errors[0])
        alone = self.scratch / "alone.db"
        self.succeeds("index", SHORT, "--models", MODELS, "--db", alone)
        self.assertEqual(self.export(db, "sightings"), self.export(alone, "sightings"))


class PhotosTest(program.ProgramTest):
    def refuses_photo(self, photo, words=""):
        out = self.scratch / "out"
        self.refuses(2, [photo, words], "model", "add", "x", photo, "--models", out)
        # The good photo is not used either.
        self.refuses(2, [photo, words], "model", "add", "x", CRATE, photo, "--models", out)
        self.refuses(2, [photo, words], "search", "--db", INDEX, "--image", photo)
        self.assertFalse(out.exists())

    def test_not_an_image(self):
        none, out = self.scratch / "none.png", self.scratch / "out"
        self.refuses_photo(none)
        png = CRATE.read_bytes()
        broken = [
            self.write("empty.png", ""),
            self.write("text.jpg", "This is a text and no image."),
            self.write("cut.png", png[:40]),
            self.scratch,
            VIDEO,
        ]
        for photo in broken:
            with self.subTest(photo):
                self.refuses_photo(photo)
                self.refuses(2, photo, "features", photo, "--out", out)
                self.refuses(2, photo, "match", photo, CRATE)
                self.assertFalse(out.exists())

    def test_nothing_on_it(self):
        self.refuses_photo(program.plain_image(self.scratch / "plain.ppm"), "0 features on the object")
        self.refuses_photo(program.plain_image(self.scratch / "one_pixel.ppm", 1, 1), "0 features on the object")

    def test_other_files(self):
        models = self.scratch / "models"
        cad = self.write("tank.obj", "v 0 0 0\n")
        self.refuses(2, "tank.obj", "model", "add", "x", cad, "--models", models)
        self.refuses(2, "--box", "model", "add", "x", cad, "--box", "1,1,9,9", "--models", models)
        cad.unlink()
        self.refuses(2, ["tank.glb", "No such file"], "model", "add", "x", "tank.glb", "--models", models)
        self.refuses(2, "out.xyz", "sheet", "--db", INDEX, "--out", self.scratch / "out.xyz")
        self.refuses(2, "none/x.png", "sheet", "--db", INDEX, "--out", self.scratch / "none/x.png")
        self.refuses(2, "none/x", "features", CRATE, "--out", self.scratch / "none/x")
        self.refuses(2, "none/x", "export", "--db", INDEX, "--format", "mot", "--out", self.scratch / "none/x")
        (self.scratch / "taken").mkdir()
        self.refuses(2, "taken", "export", "--db", INDEX, "--format", "mot", "--out", self.scratch / "taken")
        self.assertEqual(self.files(), {})


class ModelsTest(program.ProgramTest):
    def test_folders(self):
        none, db = self.scratch / "none", self.scratch / "index.db"
        for command in (("list",), ("show", "crate"), ("remove", "crate")):
            self.refuses(2, none, "model", *command, "--models", none)
        self.refuses(2, none, "index", VIDEO, "--models", none, "--db", db)
        none.mkdir()
        self.refuses(2, [none, "model add"], "index", VIDEO, "--models", none, "--db", db)
        file = self.write("file", "no folder")
        self.refuses(2, file, "index", VIDEO, "--models", file, "--db", db)
        self.refuses(2, file, "model", "add", "x", CRATE, "--models", file)
        self.assertFalse(db.exists())

    def test_corrupt_files(self):
        whole, db = (MODELS / "crate.vmodel").read_bytes(), self.scratch / "index.db"
        flipped = whole[:1000] + bytes([whole[1000] ^ 4]) + whole[1001:]
        for number, content in enumerate((flipped, whole[: len(whole) // 2], b"", b"text\n" * 100)):
            with self.subTest(number):
                bad = self.write("models/crate.vmodel", content)
                self.write("models/truck.vmodel", (MODELS / "truck.vmodel").read_bytes())
                self.refuses(2, bad, "index", VIDEO, "--models", bad.parent, "--db", db)
                self.refuses(2, bad, "model", "list", "--models", bad.parent)
                self.refuses(2, bad, "model", "show", "crate", "--models", bad.parent)
                self.refuses(2, bad, "doctor", bad)
                self.assertFalse(db.exists())
        self.succeeds("model", "show", "truck", "--models", self.scratch / "models")
        self.succeeds("model", "remove", "crate", "--models", self.scratch / "models")
        self.assertNotIn("no models", self.succeeds("model", "list", "--models", self.scratch / "models").err)
        self.succeeds("model", "remove", "truck", "--models", self.scratch / "models")
        self.assertIn("no models", self.succeeds("model", "list", "--models", self.scratch / "models").err)


class IndexesTest(program.ProgramTest):
    def refuses_index(self, db, words):
        before = self.files()
        self.refuses(2, [db, words], "index", VIDEO, "--models", MODELS, "--db", db)
        for command in (
            ("search",),
            ("export", "--format", "objects"),
            ("sheet", "--out", self.scratch / "sheet.png"),
            ("evaluate", "--truth", program.flight() / "truth.jsonl"),
        ):
            with self.subTest(command):
                self.refuses(2, db, *command, "--db", db)
        self.refuses(2, db, "doctor", db)
        self.assertEqual(self.files(), before)

    def test_of_another_program(self):
        path = self.scratch / "other.db"
        with sqlite3.connect(path) as other:
            other.execute("CREATE TABLE songs (title TEXT)")
            other.execute("INSERT INTO songs VALUES ('Yesterday')")
        other.close()
        self.refuses_index(path, "another program")

    def test_of_a_newer_version(self):
        path = self.write("newer.db", INDEX.read_bytes())
        newer = sqlite3.connect(path)
        (version,) = newer.execute("PRAGMA user_version").fetchone()
        newer.execute("PRAGMA journal_mode = DELETE")
        newer.execute(f"PRAGMA user_version = {version + 1}")
        newer.commit()
        newer.close()
        self.refuses_index(path, "newer")

    def test_not_a_database(self):
        self.refuses_index(self.write("text.db", "This is a text.\n" * 1000), "not an index")
        whole = INDEX.read_bytes()
        self.refuses_index(self.write("first_page.db", b"\0" * 100 + whole[100:]), "not an index")
        (self.scratch / "folder.db").mkdir()
        self.refuses_index(self.scratch / "folder.db", "")

    def test_missing(self):
        none = self.scratch / "none.db"
        for command in (("search",), ("export", "--format", "objects"), ("doctor",)):
            self.refuses(2, none, *command, *(["--db"] if command[0] != "doctor" else []), none)
        self.refuses(2, "none", "index", VIDEO, "--models", MODELS, "--db", self.scratch / "none/index.db")
        self.assertEqual(self.files(), {})

    def test_damaged(self):
        whole = INDEX.read_bytes()
        middle = len(whole) // 2
        for number, content in enumerate((whole[: middle // 2], whole[:8192] + b"\x5a" * (middle - 8192) + whole[middle:])):
            path = self.write(f"damaged{number}.db", content)
            for form in ("objects", "sightings"):
                done = program.run("export", "--db", path, "--format", form)
                self.assertIn(done.status, (0, 2), done.err)
                self.assertEqual(len(done.messages()), 0 if done.status == 0 else 1, done.err)
            done = program.run("search", "--db", path, "--image", CRATE)
            self.assertEqual((done.status, len(done.messages())), (2, 1), done.err)


class TruthTest(program.ProgramTest):
    def refuses_truth(self, content, words):
        truth = self.write("truth.jsonl", content)
        self.refuses(2, [truth, words], "evaluate", "--db", INDEX, "--truth", truth)

    def test_missing_or_malformed(self):
        none = self.scratch / "none.jsonl"
        self.refuses(2, none, "evaluate", "--db", INDEX, "--truth", none)
        row = (program.flight() / "truth.jsonl").read_text().splitlines()[0]
        self.refuses_truth("no truth\n", "truth.jsonl:1")
        self.refuses_truth(row + "\n" + row[:-20] + "\n", "truth.jsonl:2")
        self.refuses_truth(row + "\n\n" + row.replace('"box"', '"bax"') + "\n", "truth.jsonl:3")
        self.refuses_truth(row.replace('"frame":0', '"frame":"first"'), "frame")
        self.refuses_truth(b"\xff\xfe\x00", "truth.jsonl:1")


class DataTest(program.ProgramTest):
    def test_missing_data_folder(self):
        none, out = self.scratch / "none", self.scratch / "out"
        self.refuses(2, ["--data", none], "experiment", "table3.2", "--data", none, "--out", out)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    program.main()
