"""The programs of examples/, and the code that their README.md quotes."""

import json
import re
import subprocess
import unittest
from pathlib import Path

import program

EXAMPLES = program.REPOSITORY / "examples"
QUOTED = re.compile(r"^```cpp\n(.*?)^```", re.MULTILINE | re.DOTALL)
TABLE = """time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg
0,42,-71,100,10,-45,0,40
1,42.0002,-71,102,20,-45,0,40
"""


class ExamplesTest(program.ProgramTest):
    def run_example(self, name: str, *arguments) -> subprocess.CompletedProcess:
        command = [program.PROGRAM.with_name(f"example_{name}"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=program.TIMEOUT_S, check=False)

    def lines(self, name: str, *arguments) -> list[str]:
        done = self.run_example(name, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def assert_refuses(self, words: str, name: str, *arguments):
        done = self.run_example(name, *arguments)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertIn(words, done.stderr)

    def test_find_object_finds_the_crate(self):
        image = self.scratch / "frame.png"
        self.succeeds("frame", program.flight() / "flight.mkv", "--number", "0", "--out", image)
        rows = [json.loads(line) for line in (program.flight() / "truth.jsonl").read_text().splitlines()]
        truth = next(row["box"] for row in rows if (row["frame"], row["model"]) == (0, "crate"))
        found = [line.split() for line in self.lines("find_object", image, program.models())]
        boxes = [[float(side) for side in box.split(",")] for model, _, box in found if model == "crate"]
        self.assertTrue(boxes, found)
        for side, true in zip(boxes[0], truth, strict=True):
            self.assertAlmostEqual(side, true, delta=8)
        self.assert_refuses("holds no model", "find_object", image, self.scratch)

    def test_camera_position_interpolates(self):
        table = self.write("flight.csv", TABLE)
        self.assertEqual(
            self.lines("camera_position", table, "0.5"),
            ["latitude 42.0001000, longitude -71.0000000, altitude 101.00 m", "yaw 15.00, pitch -45.00 degrees"],
        )
        self.assert_refuses("no camera state at 9 s", "camera_position", table, "9")
        self.assert_refuses("usage", "camera_position", table, "soon")

    def test_list_objects_lists_what_search_lists(self):
        listed = self.succeeds("search", "--db", program.index(), "--json").rows()
        self.assertTrue(listed)
        self.assertEqual(
            [line.split()[:2] for line in self.lines("list_objects", program.index())],
            [[str(row["rank"]), row["model"]] for row in listed],
        )
        self.assert_refuses("none.db", "list_objects", self.scratch / "none.db")

    def test_readme_quotes_the_programs(self):
        sources = "".join(path.read_text(encoding="utf-8") for path in sorted(EXAMPLES.glob("*.cc")))
        quoted = QUOTED.findall((EXAMPLES / "README.md").read_text(encoding="utf-8"))
        self.assertGreater(len(quoted), 3)
        for block in quoted:
            self.assertIn(block, sources)


if __name__ == "__main__":
    program.main()
