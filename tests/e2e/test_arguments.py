"""Bad usage: exit status 2 and a one-line error with the correct usage; no file is written."""

import os
import pty
import re
import shutil
import subprocess
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()
CRATE = program.flight() / "crate.png"


class ArgumentsTest(program.ProgramTest):
    def refuses_unchanged(self, words, *arguments):
        before = self.files()
        self.refuses(2, words, *arguments)
        self.assertEqual(self.files(), before, arguments)

    def test_commands(self):
        self.refuses_unchanged("subcommand")
        self.refuses_unchanged("frobnicate", "frobnicate")
        self.refuses_unchanged("did you mean search?", "serach", "--db", INDEX)
        self.refuses_unchanged("--modles: did you mean --models?", "index", VIDEO, "--modles", MODELS, "--db", "x")
        self.refuses_unchanged("shwo: did you mean show?", "model", "shwo", "--models", MODELS)
        self.refuses_unchanged("subcommand is required", "--frobnicate")
        self.refuses_unchanged("subcommand", "model")
        self.refuses_unchanged("subcommand", "model", "rename", "--models", MODELS)

    def test_required_flags(self):
        out = self.scratch / "out"
        for words, arguments in (
            ("VIDEO", ("index", "--models", MODELS, "--db", out)),
            ("--models", ("index", VIDEO, "--db", out)),
            ("--db", ("index", VIDEO, "--models", MODELS)),
            ("--db", ("search",)),
            ("--format", ("export", "--db", INDEX)),
            ("--truth", ("evaluate", "--db", INDEX)),
            ("--out", ("sheet", "--db", INDEX)),
            ("--out", ("features", CRATE)),
            ("TEMPLATE", ("match", CRATE)),
            ("INPUT", ("model", "add", "crate", "--models", out)),
            ("--models", ("model", "list")),
            ("NAME", ("model", "show", "--models", MODELS)),
            ("--at or --number", ("frame", VIDEO, "--out", out)),
        ):
            with self.subTest(arguments):
                self.refuses_unchanged(words, *arguments)

    def test_unknown_and_meaningless_flags(self):
        out = self.scratch / "out.png"
        for words, arguments in (
            ("--colour", ("search", "--db", INDEX, "--colour", "red")),
            ("extra", ("export", "--db", INDEX, "--format", "mot", "extra")),
            ("--at or --number", ("frame", VIDEO, "--at", "0", "--number", "0", "--out", out)),
            ("--image and --model", ("search", "--db", INDEX, "--image", CRATE, "--model", "crate")),
            ("need --image", ("search", "--db", INDEX, "--box", "1,2,3,4")),
            ("boxes for 1 photos", ("model", "add", "x", CRATE, "--box", "1,1,9,9", "--box", "1,1,9,9", "--models", out)),
        ):
            with self.subTest(arguments):
                self.refuses_unchanged(words, *arguments)

    def test_values(self):
        db, out = self.scratch / "new.db", self.scratch / "out"
        index = ("index", VIDEO, "--models", MODELS, "--db", db)
        for words, arguments in (
            (("--every", "-1", "must be a whole number from 0"), (*index, "--every", "-1")),
            (("--every", "-3", "must be a whole number from 0"), (*index, "--every", "-3")),
            (("--every", "two", "whole number from 0"), (*index, "--every", "two")),
            (("--every", "2.5", "whole number from 0"), (*index, "--every", "2.5")),
            ("--step wide: give a number", ("model", "add", "x", "x.glb", "--models", out, "--step", "wide")),
            ("--every", (*index, "--every", "99999999999")),
            ("--threads", (*index, "--threads", "-1")),
            ("--threads", (*index, "--threads", "1e3")),
            ("--most = 0: must be", ("sheet", "--db", INDEX, "--out", out, "--most", "0")),
            ("--columns = 0: must be", ("sheet", "--db", INDEX, "--out", out, "--columns", "0")),
            ("--ratio = 1.5: must be", ("match", CRATE, CRATE, "--ratio", "1.5")),
            ("--ratio = 0", ("match", CRATE, CRATE, "--ratio", "0")),
            ("--ratio = nan", ("match", CRATE, CRATE, "--ratio", "nan")),
            ("--engine = ", ("features", CRATE, "--out", out, "--engine", "nobody")),
            ("--length", ("model", "add", "x", CRATE, "--models", out, "--length", "0")),
            ("--length", ("model", "add", "x", CRATE, "--models", out, "--length", "-2")),
            ("--length", ("model", "add", "x", CRATE, "--models", out, "--length", "nan")),
            ("--length", ("model", "add", "x", CRATE, "--models", out, "--length", "big")),
            ("--step = 0", ("model", "add", "x", "x.glb", "--models", out, "--step", "0")),
            ("--max-off-nadir = 200", ("model", "add", "x", "x.glb", "--models", out, "--max-off-nadir", "200")),
            (("--device", "auto, cpu, cuda"), ("index", VIDEO, "--models", MODELS, "--db", out, "--device", "gpu")),
            (("grid", "even"), ("model", "add", "x", "x.glb", "--models", out, "--layout", "odd")),
            ("--layout", ("model", "add", "x", CRATE, "--models", out, "--layout", "even")),
            ("--directions = 1", ("model", "show", "crate", "--models", MODELS, "--findable", "--directions", "1")),
            (("one of objects, sightings", "czml, video"), ("export", "--db", INDEX, "--format", "excel")),
            ("one of objects, sightings", ("export", "--db", INDEX, "--format", "")),
            ("params", ("params", "everything")),
        ):
            with self.subTest(arguments):
                self.refuses_unchanged(words, *arguments)

    def test_device_that_is_not_there(self):
        hidden = {**os.environ, "CUDA_VISIBLE_DEVICES": ""}  # where there is one
        self.refuses(2, ("--device cuda", "cpu"), "index", VIDEO, "--models", MODELS, "--db", self.scratch / "x.db",
                     "--device", "cuda", env=hidden)
        self.assertEqual(self.files(), {})

    def test_times(self):
        for command in (("export", "--format", "sightings"), ("search",), ("search", "--image", CRATE)):
            for words, times in (
                (("--from 3", "--to 2"), ("--from", "3", "--to", "2")),
                ("--from", ("--from", "soon")),
                ("--from", ("--from", "nan")),
                ("--to", ("--to", "nan")),
            ):
                with self.subTest(f"{command} {times}"):
                    self.refuses_unchanged(words, *command, "--db", INDEX, *times)
        self.refuses_unchanged(
            ("--from 3", "--to 2"), "sheet", "--db", INDEX, "--out", self.scratch / "x.png", "--from", "3", "--to", "2"
        )
        for words, at in (("--at", "-1"), ("--at", "nan"), ("--at", "1:75"), ("before the requested frame", "1:39")):
            self.refuses_unchanged(words, "frame", VIDEO, "--at", at, "--out", self.scratch / "x.png")
        self.refuses_unchanged("--number", "frame", VIDEO, "--number", "-1", "--out", self.scratch / "x.png")

    def test_times_with_minutes_and_hours(self):
        for at in ("1", "0:01", "0:00:01.0"):
            self.succeeds("frame", VIDEO, "--at", at, "--out", self.scratch / "frame.png")
            self.assertEqual(len(set(self.files().values())), 1, at)
            self.write("first.png", self.files()["frame.png"])
        listed = self.succeeds("search", "--db", INDEX, "--from", "1", "--to", "90").out
        self.assertEqual(self.succeeds("search", "--db", INDEX, "--from", "0:01", "--to", "1:30").out, listed)

    def test_names_that_are_not_in_the_index(self):
        for command in (
            ("export", "--format", "objects"),
            ("search",),
            ("sheet", "--out", self.scratch / "sheet.png"),
        ):
            with self.subTest(command):
                self.refuses_unchanged(("nope.mp4", "flight.mkv"), *command, "--db", INDEX, "--video", "nope.mp4")
                self.refuses_unchanged(("tank", "crate, truck"), *command, "--db", INDEX, "--model", "tank")
        # The end of a name matches whole path components only.
        self.refuses_unchanged("light.mkv", "search", "--db", INDEX, "--video", "light.mkv")
        self.refuses_unchanged(("tank", "crate, truck"), "model", "show", "tank", "--models", MODELS)
        self.refuses_unchanged(("tank", "crate, truck"), "model", "remove", "tank", "--models", MODELS)
        truth = program.flight() / "truth.jsonl"
        self.refuses_unchanged("nope", "evaluate", "--db", INDEX, "--truth", truth, "--video", "nope")

    def test_empty_near_search_is_explained(self):
        done = self.succeeds("search", "--db", INDEX, "--near", "48,11,50")
        self.assertEqual(done.out, "nothing found\n")
        self.assertEqual(len(done.messages()), 1, done.err)
        self.assertIn("has a place: index the videos with telemetry", done.err)

    def test_an_image_that_is_nowhere_is_reported_with_what_was_searched(self):
        params = self.write("params.json", '{"detect.min_side_px": 10000}')
        done = self.succeeds("search", "--db", INDEX, "--image", CRATE, "--params", params)
        self.assertEqual(done.out.splitlines()[-1], "nothing found")
        self.assertRegex(done.err, r"in none of the \d+ kept frames? of 1 video that were searched")

    def test_an_index_without_kept_features_names_the_flag(self):
        db = self.scratch / "none.db"
        self.succeeds("index", VIDEO, "--models", MODELS, "--db", db, "--keep-features", "none", "--to", "0")
        self.refuses(2, ["--keep-features none", "--redo"], "search", "--db", db, "--image", CRATE)

    def test_doctor_says_how_far_a_part_was_searched(self):
        db = self.scratch / "part.db"
        self.succeeds("index", VIDEO, "--models", MODELS, "--db", db, "--to", "0")
        self.assertIn("searched, 1 frame; 0.00 s to the end: outside of --from and --to\n", self.succeeds("doctor", db).out)
        self.assertRegex(self.succeeds("search", "--db", db).err, r"not all of it was searched: 0.00 s to the end: outside of --from and --to\n")

    def test_an_object_that_is_not_in_the_index_is_refused(self):
        for command in (
            ("search",),
            ("export", "--format", "kml", "--out", self.scratch / "objects.kml"),
            ("sheet", "--out", self.scratch / "sheet.png"),
        ):
            with self.subTest(command):
                self.refuses_unchanged("object 77: not in the index", *command, "--db", INDEX, "--object", "77")

    def test_filters_that_leave_nothing_are_named(self):
        for command in (("search",), ("export", "--format", "objects")):
            done = self.succeeds(*command, "--db", INDEX, "--model", "truck", "--from", "3600")
            self.assertIn("no object matches --model truck, --from 3600; the index has", done.err)

    def test_rejected_objects_that_are_not_listed_are_counted(self):
        listed = self.succeeds("search", "--db", INDEX)
        rejected = len(self.succeeds("search", "--db", INDEX, "--rejected", "--json").rows()) - (
            len(listed.out.splitlines()) - 1
        )
        self.assertEqual("rejected: --rejected lists" in listed.err, rejected > 0)
        self.assertNotIn("--rejected lists", self.succeeds("search", "--db", INDEX, "--json").err)

    def test_a_missing_index_is_named_with_what_makes_one(self):
        missing = self.scratch / "none.db"
        self.refuses_unchanged((str(missing), "no such file", "`victorious index` makes"), "search", "--db", missing)

    def test_a_file_is_no_folder(self):
        file = self.write("file", "x")
        for command in (("index", VIDEO, "--models", file, "--db", self.scratch / "db"), ("model", "list", "--models", file)):
            self.refuses(2, f"{file}: a file, not a folder", *command)
        self.refuses(2, f"{file}: a file, not a folder", "index", VIDEO, "--models", MODELS, "--db", file / "db")
        gone = self.scratch / "gone"
        self.refuses(2, f"{gone}: no such folder", "model", "list", "--models", gone)
        self.refuses(2, f"--videos {file}: a file, not a folder", "serve", "--db", INDEX, "--videos", file)

    def test_an_empty_index_is_said_to_be_empty(self):
        db = self.scratch / "empty.db"
        with program.Server(db, "--create"):
            pass
        for filters in ((), ("--near", "52.5,13.4,200"), ("--from", "3")):
            self.assertIn("the index is empty", self.succeeds("search", "--db", db, *filters).err)

    def test_extra_arguments_are_named_in_their_order(self):
        self.refuses_unchanged("13.4 200", "search", "--db", INDEX, "--near", "52.5", "13.4", "200")

    def test_boxes(self):
        models = self.scratch / "models"
        for box in ("1,2,3", "1,2,3,4,5", "a,b,c,d", "1, 2,3,4", "1;2;3;4", "1,2,3,4px", "nan,0,9,9", "0,0,inf,9",
                    "1e999,0,5,5", "crate.png"):  # fmt: skip
            with self.subTest(box):
                self.refuses_unchanged((box, "x,y,w,h"), "model", "add", "x", CRATE, f"--box={box}", "--models", models)
        for box in ("5,5,0,10", "5,5,10,-1"):
            self.refuses_unchanged((box, "above 0"), "model", "add", "x", CRATE, f"--box={box}", "--models", models)
        self.refuses_unchanged("--box", "model", "add", "x", CRATE, "--models", models, "--box")
        for box in ("-1,0,20,20", "170,0,20,20", "0,0,181,100", "500,500,10,10"):
            with self.subTest(box):
                words = ("crate.png", "inside the photo", "0,0,180,180")
                self.refuses_unchanged(words, "model", "add", "x", CRATE, f"--box={box}", "--models", models)
                self.refuses_unchanged(words, "search", "--db", INDEX, "--image", CRATE, f"--box={box}")

    def test_flags_may_stand_in_any_order(self):
        models = self.scratch / "models"
        box = ("--box", "10,10,150,150")
        self.succeeds("model", "add", *box, "first", CRATE, "--models", models)
        self.succeeds("model", "add", "--models", models, "second", *box, CRATE)
        self.succeeds("model", "add", "third", CRATE, CRATE, "--models", models, *box, *box)
        self.succeeds("evaluate", "--models", "crate,truck", "--db", INDEX, "--truth", program.flight() / "truth.jsonl")

    def test_whole_photo_is_reported(self):
        whole = self.scratch / "whole.png"
        self.succeeds("frame", VIDEO, "--number", "0", "--out", whole)
        models = ("--models", self.scratch / "models")
        (reported,) = self.succeeds("model", "add", "whole", whole, *models).messages()
        self.assertIn("whole.png: the whole photo is used as the object; cut it out by --box", reported)
        cut_out = self.succeeds("model", "add", "a", whole, "--box", "10,10,150,150", *models)
        self.assertNotIn("whole photo", cut_out.err)
        self.assertNotIn("whole photo", self.succeeds("model", "add", "b", CRATE, *models).err, "its alpha channel cuts")

    def test_model_names(self):
        models = self.scratch / "models"
        for name in ("", "a/b", "../a", ".hidden", "two words", "naïve", "a\nb", "a\x1b[31mb", "x" * 101):
            with self.subTest(name):
                self.refuses_unchanged("letters, digits", "model", "add", name, CRATE, "--models", models)
                self.refuses_unchanged("letters, digits", "model", "show", name, "--models", MODELS)
                self.refuses_unchanged("letters, digits", "model", "remove", name, "--models", MODELS)
        self.succeeds("model", "add", "crate", CRATE, "--models", models)
        self.refuses_unchanged(("crate", "another name"), "model", "add", "crate", CRATE, "--models", models)

    def test_control_characters_do_not_break_the_line(self):
        line = self.refuses(2, "no such file", "index", "a\nb\r\x1bc.mp4", "--models", MODELS, "--db", self.scratch / "db")
        self.assertNotRegex(line, r"[\x00-\x1f]")
        line = self.refuses(2, "", "index", VIDEO, "--models", "a\nb", "--db", self.scratch / "db", "--no\nflag")
        self.assertNotRegex(line, r"[\x00-\x1f]")

    def test_unknown_experiments_are_refused_by_name(self):
        lines = self.succeeds("experiment", "list").out.splitlines()
        self.assertGreater(len(lines), 30)
        for line in lines:
            self.assertRegex(line, r"^[a-z0-9.-]+: [A-Z].+")
        names = [line.split(":")[0] for line in lines]
        self.refuses_unchanged(names + ["experiment list"], "experiment", "nope", "--out", self.scratch / "out")
        self.refuses_unchanged("--out", "experiment", names[0])
        self.assertIn(lines[0], self.succeeds("experiment", "--help").out)

    def test_other_programs_get_their_arguments_unchanged(self):
        self.assertIn("mlesac", self.succeeds("bench", "--help").out)
        self.assertIn("speed", self.refuses(2, "mlesac", "bench", "speed", "--json"))
        self.assertIn("--movies", self.succeeds("experiment", "--help").out)

    def test_manual_page_has_every_option(self):
        page = self.succeeds("manual").out.replace("\\-", "-")
        for command in ("index", "track", "search", "export", "model add", "category train"):
            self.assertIn(f".SS {command}\n", page)
            described = self.succeeds(*command.split(), "--help").out
            for option in re.findall(r"^  (?:-\w,)?(--[a-z-]+)", described, re.MULTILINE):
                if option != "--help":
                    self.assertIn(f"\\fB{option}\\fR", page)

    def test_bash_completion(self):
        script = self.write("completion", self.succeeds("manual", "bash").out)

        def completed(*words):
            line = " ".join(f"'{word}'" for word in words)
            ask = f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _victorious; echo ${{COMPREPLY[@]}}"
            return subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True, cwd=self.scratch).stdout.split()

        self.assertEqual(completed("victorious", "ind"), ["index"])
        self.assertIn("add", completed("victorious", "model", ""))
        self.assertEqual(completed("victorious", "model", "add", "--max"), ["--max-off-nadir"])
        self.assertIn("--telemetry", completed("victorious", "index", "w.mp4", "--te"))
        self.assertEqual(completed("victorious", "index", "comp"), ["completion"])

    def test_zsh_completion(self):
        script = self.succeeds("manual", "zsh").out
        self.assertTrue(script.startswith("#compdef victorious\n"))
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")

        def completed(*words):
            self.write("completion", script)
            line = " ".join(f"'{word}'" for word in words)
            ask = (
                "_describe() { [[ $1 == -o ]] && shift; print -l -- ${(P)2}; }; _files() { print files; }; "
                f"words=({line}); CURRENT={len(words)}; . ./completion"
            )
            return subprocess.run(["zsh", "-f", "-c", ask], capture_output=True, text=True, check=True, cwd=self.scratch).stdout

        self.assertRegex(completed("victorious", "ind"), "(?m)^index:[A-Z]")
        self.assertRegex(completed("victorious", "model", ""), "(?m)^add:[A-Z]")
        self.assertRegex(completed("victorious", "model", "add", "--max"), "(?m)^--max-off-nadir:[A-Z]")
        self.assertRegex(completed("victorious", "index", "w.mp4", "--te"), "(?m)^--telemetry:[A-Z]")
        self.assertEqual(completed("victorious", "index", "comp"), "files\n")

    def test_fish_completion(self):
        script = self.succeeds("manual", "fish").out
        self.assertIn("""complete -c victorious -n '__victorious_is_at "model"' -f -a add -d""", script)
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")
        self.write("completion", script)

        def completed(line):
            ask = ["fish", "-N", "-c", f"source completion; complete -C '{line}'"]
            home = os.environ | {"HOME": str(self.scratch)}
            done = subprocess.run(ask, capture_output=True, text=True, check=True, cwd=self.scratch, env=home)
            return [one.split("\t")[0] for one in done.stdout.splitlines()]

        self.assertEqual(completed("victorious ind"), ["index"])
        self.assertIn("add", completed("victorious model "))
        self.assertEqual(completed("victorious model add --max"), ["--max-off-nadir"])
        self.assertIn("--telemetry", completed("victorious index w.mp4 --te"))
        self.assertEqual(completed("victorious index comp"), ["completion"])

    def test_colours_are_off_with_no_color(self):
        for value, coloured in (("", True), ("1", False)):
            terminal, other = pty.openpty()
            with open(terminal, "rb", closefd=True) as seen:
                subprocess.run([program.PROGRAM, "search", "--db", "none"], stderr=other, check=False,
                               env=os.environ | {"NO_COLOR": value, "TERM": "xterm-256color"})  # fmt: skip
                os.close(other)
                self.assertEqual(b"\x1b[" in os.read(seen.fileno(), 10000), coloured)

    def test_help_and_version(self):
        for flag in ("--version", "-V"):
            self.assertRegex(self.succeeds(flag).out, r"^\d+\.\d+\.\d+\n$")
        reported = self.succeeds("--help").out
        for command in ("model", "index", "export", "search", "features", "match", "evaluate", "doctor"):
            self.assertIn(command, reported)
        self.assertIn("--models", self.succeeds("index", "--help").out)
        self.assertEqual(self.succeeds("help").out, reported)
        self.assertEqual(self.succeeds("help", "index").out, self.succeeds("index", "--help").out)
        self.assertEqual(self.succeeds("help", "model", "add").out, self.succeeds("model", "add", "--help").out)
        self.refuses(2, "frobnicate: unknown command", "help", "frobnicate")


if __name__ == "__main__":
    program.main()
