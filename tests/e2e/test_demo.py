"""`tools/demo.sh`, what `make demo` runs: on a short flight with one object, and again."""

import json
import math
import subprocess
import unittest

import program

SCENE = program.REPOSITORY / "scenes" / "demo.json"
MODELS = program.REPOSITORY / "assets" / "models"


class DemoTest(program.ProgramTest):
    def demo(self, *arguments) -> subprocess.CompletedProcess:
        return subprocess.run(
            [program.REPOSITORY / "tools" / "demo.sh", *map(str, arguments)],
            capture_output=True, text=True, timeout=200, check=False,
        )  # fmt: skip

    def short_scene(self) -> str:
        """The demo's scene from where the jet is in view, without the others."""
        scene = json.loads(SCENE.read_text())
        scene["assets"] = str(MODELS.parent)
        scene["video"] |= {"frames": 3}
        scene["camera"]["aim_m"] = [[24, 24], [26, 24]]
        scene["objects"] = [row for row in scene["objects"] if row["model"] == "jet"]
        return json.dumps(scene)

    def metres_off(self, demo) -> float:
        """How far the one find's place is from the truth, along the ground."""
        (find,) = json.loads((demo / "finds.geojson").read_text())["features"]
        told = find["properties"]
        true = json.loads((demo / "flight" / "truth.jsonl").read_text().splitlines()[-1])
        north = math.radians(told["latitude_deg"] - true["latitude_deg"]) * 6.37e6
        east = math.radians(told["longitude_deg"] - true["longitude_deg"]) * 6.37e6
        return math.hypot(north, east * math.cos(math.radians(true["latitude_deg"])))

    def test_finds_the_object_and_repeats_nothing(self):
        arguments = (program.PROGRAM, self.write("scene.json", self.short_scene()), MODELS, self.scratch / "demo")
        first = self.demo(*arguments)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"\n +1 +jet ")
        self.assertRegex(first.stdout, r"sighting_precision +1\.0")
        self.assertLess(self.metres_off(self.scratch / "demo"), 1)
        made = self.files()
        for name in ("finds.jpg", "finds.kml", "finds.geojson", "views/jet.jpg", "flight/video.mp4", "flight/telemetry.csv"):
            self.assertIn(f"demo/{name}", made)
        again = self.demo(*arguments)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("all of it was indexed before", again.stderr)
        self.assertNotIn("a second", again.stderr)  # no progress: nothing was made
        changed = {name for name, content in self.files().items() if made.get(name) != content}
        self.assertLessEqual(changed, {"demo/index.db"})

    def test_errors_are_one_line(self):
        for words, *arguments in (
            ("demo.sh build/victorious", program.PROGRAM),
            ("none.json", program.PROGRAM, self.scratch / "none.json", MODELS, self.scratch / "demo"),
        ):
            done = self.demo(*arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    program.main()
