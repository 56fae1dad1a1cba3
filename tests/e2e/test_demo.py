"""`tools/demo.sh` (`make demo`) on a short flight with one searched object among others, and a repeated call."""

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
            capture_output=True, text=True, timeout=2 * program.TIMEOUT_S, check=False,
        )  # fmt: skip

    def short_scene(self) -> str:
        """The demo's scene in six frames. The jet is searched for; it is out of view first, then in view. The other
        objects are distractors."""
        scene = json.loads(SCENE.read_text())
        scene["assets"] = str(MODELS.parent)
        scene["video"] |= {"frames": 6, "fps": 1}
        scene["camera"]["aim_m"] = [[-32, 24], [36, 24]]
        rest = [row for row in scene["objects"] if row["model"] != "jet"]
        scene["objects"] = [row for row in scene["objects"] if row["model"] == "jet"]
        scene["pieces"] = [
            {"asset": f"models/{row['model']}"} | {key: row[key] for key in row if key not in ("id", "model")}
            for row in rest
        ]
        return json.dumps(scene)

    def metres_off(self, demo) -> float:
        """The horizontal error of the place of the only object found."""
        (find,) = json.loads((demo / "finds.geojson").read_text())["features"]
        reported = find["properties"]
        true = json.loads((demo / "flight" / "truth.jsonl").read_text().splitlines()[-1])
        north = math.radians(reported["latitude_deg"] - true["latitude_deg"]) * 6.37e6
        east = math.radians(reported["longitude_deg"] - true["longitude_deg"]) * 6.37e6
        return math.hypot(north, east * math.cos(math.radians(true["latitude_deg"])))

    def test_finds_the_object_once(self):
        folder = self.scratch / "demo"
        arguments = (program.PROGRAM, self.write("scene.json", self.short_scene()), MODELS, folder)
        first = self.demo(*arguments)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"\n +1 +jet ")
        self.assertRegex(first.stdout, r"sightings that are right +100\.0 %")
        self.finds_the_jet_where_it_is(folder)
        self.assertLess(self.metres_off(self.scratch / "demo"), 1)
        made = self.files()
        for name in ("finds.jpg", "finds.kml", "finds.geojson", "views/jet.jpg", "flight/video.mp4", "flight/video.telemetry.csv"):
            self.assertIn(f"demo/{name}", made)
        again = self.demo(*arguments)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("already indexed", again.stderr)
        self.assertNotIn("a second", again.stderr)  # no progress: no step was repeated
        changed = {name for name, content in self.files().items() if made.get(name) != content}
        self.assertLessEqual(changed, {"demo/index.db"})

        self.templates_are_kept_for_the_next_search(folder)

    def templates_are_kept_for_the_next_search(self, folder):
        """They do not change what is found, and are not made again."""
        cache = self.scratch / "cache"
        found = []
        for place in ("none", cache, cache):
            db = self.scratch / f"again{len(found)}.db"
            flags = ("--models", folder / "models", "--db", db, "--cache", place)
            self.succeeds("index", folder / "flight" / "video.mp4", *flags)
            found.append(self.export(db, "sightings"))
            files = {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.is_file()}
            self.assertEqual(len(files) > 3, place == cache)
            if len(found) == 2:
                kept = files
        self.assertEqual([found[0]] * 3, found)
        self.assertEqual(files, kept)

    def finds_the_jet_where_it_is(self, folder):
        truth = [json.loads(line) for line in (folder / "flight" / "truth.jsonl").read_text().splitlines()]
        sightings = [json.loads(line) for line in self.export(folder / "index.db", "sightings").splitlines()]
        in_view = {row["frame"] for row in truth}
        clear = {row["frame"] for row in truth if row["visible"] > 0.9}
        found = {row["frame"] for row in sightings}
        self.assertGreaterEqual(len(clear), 2, truth)
        self.assertLessEqual(in_view, {2, 3, 4, 5})  # frames without it are searched as well
        self.assertLessEqual(clear, found)
        self.assertLessEqual(found, in_view)

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
