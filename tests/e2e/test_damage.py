"""Partly damaged input is used as far as possible: a warning with the position of the damage, exit status 0."""

import json
import shutil
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()


class DamageTest(program.ProgramTest):
    def index(self, video):
        """Returns the video's sightings and the warnings."""
        db = self.scratch / "index.db"
        done = self.succeeds("index", video, "--models", MODELS, "--db", db)
        warnings = [line for line in done.messages() if line.startswith("warning: ")]
        self.assertEqual(len(done.messages()), len(warnings) + 1, done.err)  # and the summary line
        for line in warnings:
            self.assertIn(str(video), line)
        sightings = [json.loads(line) for line in self.export(db, "sightings").splitlines()]
        again = self.succeeds("index", video, "--models", MODELS, "--db", db)
        self.assertIn("0 frames searched", again.err)
        return sightings, warnings

    def setUp(self):
        super().setUp()
        self.whole = [json.loads(line) for line in self.export(INDEX, "sightings").splitlines()]

    def test_truncated_file(self):
        content = VIDEO.read_bytes()
        sightings, warnings = self.index(self.write("cut.mkv", content[: len(content) * 6 // 10]))
        self.assertGreater(len(warnings), 0)
        self.assertRegex(warnings[0], r"\d\.\d+ s")
        self.assertGreater(len(sightings), 5)
        expected = [(row["frame"], row["model"], row["box"]) for row in self.whole][: len(sightings)]
        self.assertEqual([(row["frame"], row["model"], row["box"]) for row in sightings], expected)
        searched = self.succeeds("doctor", self.scratch / "index.db").out
        self.assertRegex(searched, r"searched, \d+ frames; \d\.\d+ s to \d\.\d+ s: no frames, the video is damaged\n")

    def test_time_beyond_a_truncated_video(self):
        content = VIDEO.read_bytes()
        cut = self.write("cut.mkv", content[: len(content) * 6 // 10])
        out = self.scratch / "out"
        beyond = f"{(program.FRAMES - 1) * 0.1:.1f}"
        box = ("--box", "10,10,40,40", "--at")
        self.refuses(2, ["cut.mkv", "decoding stopped at"], "track", cut, *box, beyond, "--out", out)
        self.refuses(2, ["cut.mkv", "decoding stopped at"], "frame", cut, "--at", beyond, "--out", f"{out}.png")
        self.assertIn("decoding stopped at", self.succeeds("track", cut, *box, "0", "--out", out).err)
        self.assertIn("stopped at", self.succeeds("doctor", cut).out)

    def test_hole_in_the_middle(self):
        content = bytearray(VIDEO.read_bytes())
        middle = len(content) // 2
        content[middle : middle + len(content) // 10] = b"\x5a" * (len(content) // 10)
        sightings, warnings = self.index(self.write("hole.mkv", bytes(content)))
        self.assertGreater(len(warnings), 0)
        self.assertGreater(len(sightings), 5)

    def test_folder_with_a_bad_image(self):
        folder = self.scratch / "frames"
        folder.mkdir()
        for number in range(4):
            self.succeeds("frame", VIDEO, "--number", number, "--out", folder / f"{number}.png")
        shutil.copy(folder / "0.png", folder / "4.png")
        (folder / "2.png").write_bytes((folder / "2.png").read_bytes()[:200])
        sightings, warnings = self.index(folder)
        self.assertEqual(len(warnings), 1)
        self.assertIn("2.png", warnings[0])
        self.assertGreater(len(sightings), 2)


if __name__ == "__main__":
    program.main()
