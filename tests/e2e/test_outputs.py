"""No output overwrites an input, and no existing file of another kind is replaced without --force."""

import contextlib
import itertools
import json
import os
import re
import shutil
import sqlite3
import struct
import subprocess

import program

FLIGHT, MODELS, INDEX = program.flight(), program.models(), program.index()
FORMATS = ("objects", "sightings", "mot", "coco", "cvat", "vtt", "vmti", "geojson", "kml", "gpkg", "cot", "czml")
NOTES = "my notes: do not lose them\n"
TELEMETRY = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n0,52,13,100,0,-90,0,30\n"


def png_size(path):
    return struct.unpack(">II", path.read_bytes()[16:24])


class OutputsTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.video = self.write("w.mp4", (FLIGHT / "flight.mp4").read_bytes())
        self.other = self.write("other.mkv", (FLIGHT / "flight.mkv").read_bytes())
        self.photo = self.write("crate.png", (FLIGHT / "crate.png").read_bytes())
        self.db = self.write("index.db", INDEX.read_bytes())
        with contextlib.closing(sqlite3.connect(self.db)) as index, index:
            index.execute("UPDATE videos SET start_utc_us = 1700000000000000")  # for vmti
        self.telemetry = self.write("w.telemetry.csv", TELEMETRY)
        self.list = self.write("images/list.csv", "image,category\ncrate.png,crate\n")
        self.listed = self.write("images/crate.png", self.photo.read_bytes())
        self.category = self.write("model.vcat", "\x8aVCAT\r\n\x1a".encode("latin-1"))
        self.scene = self.write("flight/scene.json", json.dumps({"assets": str(program.REPOSITORY / "assets")}))
        self.write("flight/video.mp4", self.video.read_bytes())

    def test_no_binary_output_on_a_terminal(self):
        words = (program.PROGRAM, "export", "--db", self.db, "--format", "gpkg")
        terminal, end = os.openpty()
        self.addCleanup(os.close, terminal)
        refused = subprocess.run(words, stdout=end, stderr=subprocess.PIPE, text=True, timeout=program.TIMEOUT_S)
        os.close(end)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--format gpkg: is binary, and not for a terminal: give --out FILE", refused.stderr)
        piped = subprocess.run(words, capture_output=True, timeout=program.TIMEOUT_S)
        self.assertTrue(piped.stdout.startswith(b"SQLite format 3"))

    def keeps_files(self, words, *arguments):
        before = self.files()
        self.refuses(2, words, *arguments)
        self.assertEqual(self.files(), before, arguments)

    def commands(self):
        """Every command with an output: its arguments without it, the flag of the output, and its inputs."""
        export = ("export", "--db", self.db, "--format")
        track = ("track", self.video, "--box", "1,1,20,20", "--at", "0", "--also", self.other)
        navigate = ("navigate", self.video, "--landmarks", self.db, "--models", MODELS)
        images = ("--images", self.list.parent, "--list", self.list)
        yield ("features", self.photo), "--out", [self.photo]
        yield ("frame", self.video, "--at", "0"), "--out", [self.video]
        yield ("copy", self.video), "--out", [self.video]
        yield ("match", self.photo, self.listed), "--draw", [self.photo, self.listed]
        yield ("model", "add", "crate", self.photo, "--models", self.scratch / "m"), "--draw", [self.photo]
        yield ("model", "show", "crate", "--models", MODELS), "--views", []
        for form in FORMATS:
            yield (*export, form), "--out", [self.db]
        yield (*export, "coverage", "--models", MODELS), "--out", [self.db]
        yield ("sheet", "--db", self.db), "--out", [self.db]
        yield track, "--out", [self.video, self.other, self.telemetry]
        yield (*track, "--out", self.scratch / "boxes.jsonl"), "--draw", [self.video, self.other, self.telemetry]
        yield ("index", self.video, "--models", MODELS, "--db", self.db), "--draw", [self.video]
        yield (*export, "video"), "--out", [self.db]
        yield navigate, "--out", [self.video, self.db, self.telemetry]
        yield ("telemetry", self.telemetry), "--out", [self.telemetry]
        yield ("telemetry", "--video", self.video), "--out", [self.video, self.telemetry]
        yield ("category", "train", *images), "--out", [self.list, self.listed]
        yield ("category", "refine", "--model", self.category, *images), "--out", [self.list, self.category]

    def test_no_output_is_an_input(self):
        """Each input of each command, by its path or by a link, in turn with and without --force: one check serves all."""
        ways = itertools.cycle(itertools.product(range(3), ((), ("--force",))))
        for arguments, flag, inputs in self.commands():
            for path in inputs:
                way, force = next(ways)
                name = self.names(path)[way]
                with self.subTest(f"{' '.join(map(str, arguments))} {flag} {name}"):
                    # A category model that cannot be read is refused for that.
                    words = [] if arguments[:2] == ("category", "refine") else [flag, name, "input"]
                    self.keeps_files(words, *arguments, flag, name, *force)

    def names(self, path):
        """The path, a symbolic link and a hard link to it."""
        links = [self.scratch / f"{kind}-{path.parent.name}-{path.name}" for kind in ("symbolic", "hard")]
        if not links[0].exists():
            links[0].symlink_to(path)
            os.link(path, links[1])
        return path, *links

    def test_index_is_not_written_over_a_video(self):
        for name in self.names(self.video):
            self.keeps_files(["--db", "input"], "index", self.video, "--models", MODELS, "--db", name)

    def test_two_outputs_of_one_name_are_refused(self):
        new = self.scratch / "new.mp4"
        link = self.scratch / "link.mp4"
        link.symlink_to(new.name)
        track = ("track", self.video, "--box", "1,1,20,20", "--at", "0", "--out", new, "--draw")
        index = ("index", self.video, "--models", MODELS, "--db", new, "--draw")
        for arguments in (track, index):
            for name in (new, self.scratch / "images" / ".." / new.name, link):
                self.keeps_files(["--draw", name, "same file"], *arguments, name)
                self.keeps_files(["--draw", name, "same file"], *arguments, name, "--force")

    def test_files_of_another_kind_are_kept(self):
        notes = self.write("notes.png", NOTES)
        for arguments, flag, _ in self.commands():
            if arguments[:2] == ("category", "refine"):
                continue
            with self.subTest(" ".join(map(str, arguments))):
                self.keeps_files([flag, notes, "--force"], *arguments, flag, notes)

    def test_photos_are_kept(self):
        jpeg = self.scratch / "own.jpg"
        for _ in range(2):  # its own pictures are replaced
            self.succeeds("frame", self.video, "--at", "0", "--out", jpeg)
        tags = b"\xff\xe1\x00\x1aExif\0\0II*\0\x08\0\0\0\0\0\0\0\0\0\0\0"
        photo = self.write("photo.jpg", jpeg.read_bytes()[:2] + tags + jpeg.read_bytes()[2:])
        for arguments in (("frame", self.video, "--at", "0"), ("sheet", "--db", self.db)):
            self.keeps_files(["--out", photo, "EXIF", "--force"], *arguments, "--out", photo)
        self.succeeds("frame", self.video, "--at", "0", "--out", photo, "--force")
        self.assertNotIn(b"Exif", photo.read_bytes())

    def test_json_says_what_was_written(self):
        image, copy = self.scratch / "x.png", self.scratch / "copy.mp4"
        (frame,) = self.succeeds("frame", self.video, "--at", "0.45", "--out", image, "--json").rows()
        self.assertEqual((frame["image"], frame["frame"], frame["time_s"]), (str(image), 5, 0.5))
        (copied,) = self.succeeds("copy", self.video, "--out", copy, "--json").rows()
        self.assertEqual((copied["copy"], copied["frames"]), (str(copy), program.FRAMES))
        (sheet,) = self.succeeds("sheet", "--db", self.db, "--out", image, "--json").rows()
        self.assertEqual((sheet["image"], (sheet["width"], sheet["height"])), (str(image), png_size(image)))
        features = self.scratch / "x.txt"
        (found,) = self.succeeds("features", image, "--out", features, "--json").rows()
        self.assertEqual((found["file"], found["features"]), (str(features), len(features.read_text().splitlines()) - 1))
        self.assertGreater(found["seconds"], 0)

    def test_json_of_export(self):
        counts = {form: len(self.succeeds("export", "--db", self.db, "--format", form).out.splitlines())
                  for form in ("objects", "sightings")}  # fmt: skip
        for form in (*FORMATS, "video"):
            out = self.scratch / ("said.mp4" if form == "video" else f"said.{form}")
            (said,) = self.succeeds("export", "--db", self.db, "--format", form, "--out", out, "--json").rows()
            self.assertTrue(out.exists())
            self.assertEqual(said, {"file": str(out), "format": form, **counts, "placed_objects": said["placed_objects"]})
            self.assertLessEqual(said["placed_objects"], counts["objects"])
        self.refuses(2, "--out", "export", "--db", self.db, "--format", "objects", "--json")

    def test_coverage_says_what_it_lacks(self):
        coverage = ("export", "--db", self.db, "--format", "coverage")
        self.refuses(2, "--models DIR", *coverage)
        self.refuses(2, ["crate", "no size"], *coverage, "--models", MODELS)
        sized = self.scratch / "sized"
        for name in ("crate", "truck"):
            self.succeeds("model", "add", name, self.photo, "--models", sized, "--length", "1.5")
        out = self.scratch / "coverage.tif"
        self.refuses(2, ["coverage needs telemetry"], *coverage, "--models", sized, "--out", out)
        self.assertFalse(out.exists())
        self.refuses(2, "--format coverage", "export", "--db", self.db, "--format", "geojson", "--models", MODELS)
        self.refuses(2, "--clip", "export", "--db", self.db, "--format", "geojson", "--telemetry", self.telemetry)

    def test_export_does_not_hold_the_archive_in_memory(self):
        """The peak memory does not grow with the sightings; the file does, by far more than that."""
        if re.search(rb"__[at]san_init", program.PROGRAM.read_bytes()):
            self.skipTest("sanitizers keep memory that was freed")
        db, out = self.scratch / "large.db", self.scratch / "out"

        def export():
            """The peak memory and the file's size, in MB."""
            command = [program.PROGRAM, "export", "--db", db, "--format", "sightings", "--out", out]
            child = subprocess.Popen(list(map(str, command)))
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(child.returncode, 0)
            return usage.ru_maxrss / 1e3, out.stat().st_size / 1e6

        shutil.copy(program.index(), db)
        small_memory, small_size = export()
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            columns = [row[1] for row in index.execute("PRAGMA table_info(sightings)")]
            values = ["frame + 1000 * n" if name == "frame" else name for name in columns]
            index.execute(f"""WITH RECURSIVE numbers (n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM numbers WHERE n < 2000)
                              INSERT INTO sightings ({", ".join(columns)})
                              SELECT {", ".join(values)} FROM sightings, numbers""")
        memory, size = export()
        self.assertGreater(size - small_size, 30)
        self.assertLess(memory - small_memory, 15)

    def test_footage_is_kept_by_simulate(self):
        footage = self.scratch / "flight"
        self.keeps_files(["video.mp4", "--force"], "simulate", self.scene, "--out", footage)

    def test_force_and_the_same_kind_replace(self):
        notes = self.write("notes.png", NOTES)
        frame = ("frame", self.video, "--at", "0", "--out", notes)
        self.succeeds(*frame, "--force")
        self.assertNotIn(NOTES.encode(), notes.read_bytes())
        self.succeeds(*frame)
        for form in FORMATS:
            for _ in range(2):
                self.succeeds("export", "--db", self.db, "--format", form, "--out", self.scratch / f"x.{form}")
        for flags in ((), ("--json",)):
            for _ in range(2):
                self.succeeds("telemetry", self.telemetry, *flags, "--out", self.scratch / f"telemetry{len(flags)}")

    def test_every_command_with_an_output_is_covered(self):
        covered = {" ".join(arguments[:2]) if arguments[0] in ("model", "category") else arguments[0]
                   for arguments, _, _ in self.commands()}  # fmt: skip
        covered |= {"simulate", "category classify"}  # they call the same function
        said = self.succeeds("--help").out
        for command in set(re.findall(r"^  (\w+) {2,}", said, re.MULTILINE)) - {"bench", "experiment"}:  # own programs
            parts = {"model": ("add", "list", "show", "remove"), "category": ("train", "classify", "refine")}
            for name in [f"{command} {part}" for part in parts.get(command, ())] or [command]:
                described = self.succeeds(*name.split(), "--help").out
                if re.search(r"--(out|draw|views|explain)\b", described):
                    self.assertIn(name, covered)
                    self.assertIn("--force", described, name)


if __name__ == "__main__":
    program.main()
