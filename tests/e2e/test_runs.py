"""Runs of `index`: names, intervals, several processes, quality, kept features, and the check of an index."""

import json
import shutil
import sqlite3
import subprocess

import program

FLIGHT, MODELS = program.flight(), program.models()
VIDEO = FLIGHT / "flight.mkv"


class RunsTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.db = self.scratch / "index.db"

    def index(self, *arguments, **options) -> program.Outcome:
        return self.succeeds("index", *arguments, "--models", MODELS, "--db", self.db, **options)

    def rows(self, db=None) -> list[dict]:
        return [json.loads(line) for line in self.export(db or self.db, "sightings").splitlines()]

    def query(self, sql: str):
        with sqlite3.connect(self.db) as connection:
            return connection.execute(sql).fetchall()

    def test_relative_names_work_from_another_folder(self):
        first, second = self.scratch / "first", self.scratch / "second"
        for folder, name in ((first, "flight.mkv"), (second, "flight.mp4")):
            folder.mkdir()
            shutil.copy(FLIGHT / name, folder / "flight.mkv")
        self.index("flight.mkv", cwd=first)
        self.assertEqual({row["video"] for row in self.rows()}, {"flight.mkv"}, "the name as given")
        sheet = self.scratch / "sheet.png"
        self.succeeds("sheet", "--db", self.db, "--out", sheet, cwd="/")
        self.succeeds("export", "--db", self.db, "--format", "video", "--out", self.scratch / "drawn.mp4", cwd="/")
        # Another video of this name, in another folder, is another video.
        done = self.index("flight.mkv", cwd=second)
        self.assertNotIn("has changed", done.err)
        self.assertEqual(self.query("SELECT name, folder FROM videos ORDER BY id"),
                         [("flight.mkv", str(first)), ("flight.mkv", str(second))])  # fmt: skip

    def test_two_processes_on_one_video(self):
        command = [program.PROGRAM, "index", VIDEO, "--models", MODELS, "--db", self.db]
        both = [subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True) for _ in range(2)]
        said = [process.communicate(timeout=program.TIMEOUT_S)[1] for process in both]
        self.assertEqual([process.returncode for process in both], [0, 0], said)
        key = lambda row: (row["frame"], row["model"], row["box"])
        self.assertEqual(sorted(map(key, self.rows())), sorted(map(key, self.rows(program.index()))))

    def events(self, *arguments, status: int = 0) -> list[dict]:
        """What a command writes with --events, which is all that it writes."""
        with open(self.scratch / "events.jsonl", "w+", encoding="utf-8") as file:
            done = program.run("--events", file.fileno(), *arguments, pass_fds=(file.fileno(),))
            self.assertEqual((done.status, done.out, done.err), (status, "", ""))
            file.seek(0)
            return [json.loads(line) for line in file]

    def test_events_replace_the_log(self):
        index = ("index", VIDEO, "--models", MODELS, "--db", self.db)
        events = self.events(*index)
        last = [event for event in events if event["event"] == "progress"][-1]
        self.assertEqual((last["done"], last["total"], last["unit"]), (program.FRAMES, program.FRAMES, "frames"))
        self.assertGreater(last["elapsed_s"], 0)
        self.assertIn(f"{program.SEARCHED_FRAMES} frames searched", events[-1]["message"])
        self.assertEqual({event["event"] for event in events}, {"progress", "info"})
        [error] = self.events("index", "none.mkv", "--models", MODELS, "--db", self.db, status=2)
        self.assertEqual((error["event"], error["code"]), ("error", "not_found"))
        self.assertIn("none.mkv", error["message"])
        [error] = self.events("index", VIDEO, "--modles", MODELS, status=2)
        self.assertEqual((error["event"], error["code"]), ("error", "invalid_argument"))
        self.refuses(2, ["--events", "999"], "--events", 999, *index)

    def test_events_of_other_programs_and_of_no_command(self):
        for words, arguments in (
            ("nope", ("experiment", "nope", "--out", self.scratch / "out")),
            ("mlesac", ("bench", "speed")),
            ("serach: unknown command: did you mean search?", ("serach", "--db", self.db)),
            ("A subcommand is required", ()),
        ):
            with self.subTest(arguments):
                [error] = self.events(*arguments, status=2)
                self.assertEqual((error["event"], error["code"]), ("error", "invalid_argument"))
                self.assertIn(words, error["message"])
        names = self.succeeds("experiment", "list").out
        self.assertEqual(self.succeeds("--events=2", "experiment", "list").out, names)
        self.assertEqual(self.succeeds("--events", "2", "--version").out, self.succeeds("--version").out)
        for command in (("experiment", "list"), ("bench",), ("serach",)):
            self.refuses(2, "--events: 999: not a descriptor", "--events", 999, *command)
        self.refuses(2, "--events", "--events")

    def test_all_videos_are_opened_first(self):
        missing = self.scratch / "missing.mkv"
        done = program.run("index", VIDEO, missing, "--models", MODELS, "--db", self.db)
        self.assertEqual(done.status, 2)
        said = done.messages()
        left_out = next(i for i, line in enumerate(said) if "left out" in line and "missing.mkv" in line)
        searched = next(i for i, line in enumerate(said) if "frames searched" in line)
        self.assertLess(left_out, searched, said)
        self.assertIn("missing.mkv", said[-1])
        self.assertTrue(self.rows())

    def test_interval_of_time(self):
        done = self.index(VIDEO, "--from", "1", "--to", "0:02")
        self.assertIn("6 frames searched", done.err)
        self.assertIn(": 21 of 21 frames", done.err)  # the progress is that of the interval
        frames = {row["frame"] for row in self.rows()}
        self.assertTrue(frames and min(frames) >= 10 and max(frames) <= 20, frames)
        self.assertIn("0 frames searched", self.index(VIDEO, "--from", "1", "--to", "2").err)
        self.refuses(2, ["--from was 1", "is not given", "--redo to delete its results"], "index", VIDEO, "--models", MODELS, "--db", self.db)
        self.assertIn("1 frame searched", self.index(VIDEO, "--from", "1", "--to", "1", "--redo").err)
        self.refuses(2, ["--from 2", "--to 1"], "index", VIDEO, "--models", MODELS, "--db", self.db, "--from", "2",
                     "--to", "1")  # fmt: skip

    def test_an_interval_after_the_end_is_refused(self):
        index = ("index", VIDEO, "--models", MODELS, "--db", self.db)
        self.refuses(2, ["--from 100", "after its end", "flight.mkv"], *index, "--from", "100")
        self.assertEqual(self.files(), {}, "nothing is written")
        self.succeeds(*index)

    def test_wrong_telemetry_leaves_no_index(self):
        table = self.write("wrong.csv", "time_s,longitude_deg\n0,11\n")
        before = self.files()
        self.refuses(2, "wrong.csv", "index", VIDEO, "--models", MODELS, "--db", self.db, "--telemetry", table)
        self.assertEqual(self.files(), before)

    def test_parameters_that_an_older_version_did_not_have(self):
        self.index(VIDEO)
        with sqlite3.connect(self.db) as connection:
            for number, text in connection.execute("SELECT id, json FROM options").fetchall():
                options = json.loads(text)
                if "telemetry" not in options:
                    continue
                del options["telemetry"]["clock_sigma_apart_s"], options["keep"]
                connection.execute("UPDATE options SET json = ? WHERE id = ?", (json.dumps(options), number))
        found = self.rows()
        self.index(VIDEO)
        self.assertEqual(self.rows(), found)
        refused = ("index", VIDEO, "--models", MODELS, "--db", self.db)
        params = self.write("params.json", json.dumps({"telemetry": {"clock_sigma_apart_s": 3}}))
        self.refuses(2, "other parameters (telemetry.clock_sigma_apart_s was 2.0, is 3.0)", *refused, "--params", params)
        self.refuses(2, "other parameters (--to was not given, is 1.0)", *refused, "--to", "1")

    def test_quality(self):
        fast = self.index(VIDEO, "--quality", "fast")
        self.assertIn("10 frames searched", fast.err)
        self.assertTrue(any(row["frame"] % 6 for row in self.rows()), "objects are tracked in between")
        command = ("index", VIDEO, "--models", MODELS, "--db", self.db)
        self.refuses(2, ["every was 6, is 1", "search.nearest was 4, is 8"], *command, "--quality", "thorough")
        self.refuses(2, ["--quality best", "fast, normal, thorough"], *command, "--quality", "best")
        # A flag overrides the quality; normal is the default.
        self.assertIn("4 frames searched", self.index(VIDEO, "--quality", "fast", "--every", "10", "--redo").err)
        self.index(VIDEO, "--quality", "normal", "--redo")
        self.assertIn("0 frames searched", self.index(VIDEO).err)

    def test_budget(self):
        row = self.index(VIDEO, "--json", "--budget-ms", "1e6", "--keep-features", "none").rows()[0]
        self.assertEqual((row["frames_searched"], row["frames_left_out"]), (program.SEARCHED_FRAMES, 0))
        command = ("index", VIDEO, "--models", MODELS, "--db", self.db, "--keep-features", "none")
        self.refuses(2, "--budget-ms was 1000000.0, is 0.001", *command, "--budget-ms", "0.001")
        self.refuses(2, "--budget-ms", *command, "--budget-ms", "0")
        done = self.index(VIDEO, "--json", "--budget-ms", "0.001", "--redo", "--keep-features", "none")
        (row,) = done.rows()
        self.assertEqual(row["frames_searched"] + row["frames_left_out"], program.SEARCHED_FRAMES)
        self.assertLess(row["frames_searched"], 6, "the first, and those that began with it")
        self.assertIn("only tracked, to keep pace", done.err)
        self.assertIn("more than the budget of 0.001 ms", done.err)
        self.assertTrue(any(sighting["frame"] % 60 for sighting in self.rows()), "objects are tracked in between")

    def test_kept_features(self):
        self.index(VIDEO)
        self.assertEqual(self.query("SELECT count(*) FROM kept_frames"), [(program.FRAMES // 10,)])
        ((keypoints, descriptors),) = self.query("SELECT sum(length(keypoints)), sum(length(descriptors)) FROM kept_frames")
        self.assertEqual(4 * keypoints, descriptors, "16 and 64 bytes each")
        self.index(VIDEO, "--keep-features", "0.5", "--redo")
        self.assertEqual(self.query("SELECT count(*) FROM kept_frames"), [(program.FRAMES // 5,)])
        self.index(VIDEO, "--keep-features", "none", "--redo")
        self.assertEqual(self.query("SELECT count(*) FROM kept_frames"), [(0,)])
        self.refuses(2, "no kept features", "search", "--db", self.db, "--image", FLIGHT / "crate.png")
        self.refuses(2, "--keep-features some", "index", VIDEO, "--models", MODELS, "--db", self.db,
                     "--keep-features", "some")  # fmt: skip

    def test_check(self):
        db = self.write("sound.db", program.index().read_bytes())
        self.assertIn("without damage", self.succeeds("doctor", "--check", db).out)
        self.assertEqual(json.loads(self.succeeds("doctor", "--check", db, "--json").out)["faults"], [])
        self.db = db
        self.query("UPDATE kept_frames SET descriptors = x'0102'")
        self.refuses(2, [db, "damaged", "descriptors"], "doctor", "--check", db)
        damaged = bytearray(program.index().read_bytes())
        damaged[4096 * 3 : 4096 * 5] = bytes(4096 * 2)
        self.refuses(2, "damaged", "doctor", "--check", self.write("damaged.db", bytes(damaged)))
        self.refuses(2, "--check", "doctor", "--check")

    def test_json(self):
        (row,) = self.index(VIDEO, "--json").rows()
        self.assertEqual((row["video"], row["frames_searched"]), (str(VIDEO), program.SEARCHED_FRAMES))
        self.assertEqual(row["sightings"], len(self.rows()))
        (added,) = self.succeeds("model", "add", "crate", FLIGHT / "crate.png", "--models", self.scratch / "m",
                                 "--json").rows()  # fmt: skip
        self.assertEqual((added["name"], added["views"]), ("crate", 1))


if __name__ == "__main__":
    program.main()
