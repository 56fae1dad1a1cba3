"""The output of `match --json`."""

import json
import math
import unittest

import program

STAGES = ["ratio", "first", "second", "third", "mlesac"]


class MatchTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.scratch / "scene.png"
        self.template = program.flight() / "crate.png"
        self.succeeds("frame", program.flight() / "flight.mkv", "--number", "0", "--out", self.scene)

    def match(self, scene, template, *flags):
        return json.loads(self.succeeds("match", scene, template, "--json", *flags).out)

    def test_stages_and_similarity(self):
        reported = self.match(self.scene, self.template)
        self.assertEqual([stage["name"] for stage in reported["stages"]], STAGES)
        before = None
        for stage in reported["stages"]:
            for match in stage["matches"]:
                self.assertLessEqual({"scene", "template", "scale"}, set(match))
                self.assertGreater(match["scale"], 0)
            places = {(*match["scene"], *match["template"]) for match in stage["matches"]}
            self.assertTrue(before is None or places <= before, f"{stage['name']} has what the stage before dropped")
            before = places
        inliers = reported["stages"][-1]["matches"]
        self.assertGreater(len(inliers), 10)

        similarity = reported["similarity"]
        self.assertEqual(set(similarity), {"scale", "rotation_deg", "translation"})
        turn = math.radians(similarity["rotation_deg"])
        for match in inliers:
            x, y = match["template"]
            mapped = [
                similarity["scale"] * (math.cos(turn) * x - math.sin(turn) * y) + similarity["translation"][0],
                similarity["scale"] * (math.sin(turn) * x + math.cos(turn) * y) + similarity["translation"][1],
            ]
            self.assertLess(math.dist(mapped, match["scene"]), 8)
        scales = sorted(match["scale"] for match in inliers)
        self.assertAlmostEqual(scales[len(scales) // 2] / similarity["scale"], 1, delta=0.15)

        truth = json.loads((program.flight() / "truth.jsonl").read_text().splitlines()[0])
        self.assertEqual((truth["frame"], truth["model"]), (0, "crate"))
        self.assertAlmostEqual(similarity["scale"], 0.6, delta=0.15)  # as drawn, within the variation of zoom and thing scale

    def test_stricter_ratio_keeps_fewer_matches(self):
        counts = [len(self.match(self.scene, self.template, "--ratio", r)["stages"][0]["matches"]) for r in (0.5, 0.95)]
        self.assertLess(counts[0], counts[1])

    def test_no_match_is_a_result(self):
        plain = program.plain_image(self.scratch / "plain.ppm")
        reported = self.match(plain, self.template)
        self.assertEqual([stage["name"] for stage in reported["stages"]], STAGES)
        self.assertIsNone(reported["similarity"])
        self.assertEqual([stage["matches"] for stage in reported["stages"]], [[]] * 5)
        self.assertIn("no pose", self.succeeds("match", plain, self.template).out)

    def test_text_and_drawing(self):
        drawing = self.scratch / "drawing.png"
        text = self.succeeds("match", self.scene, self.template, "--draw", drawing).out
        for stage in STAGES:
            self.assertRegex(text, rf"(?m)^{stage} +\d+ matches$")
        self.assertEqual(drawing.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")


if __name__ == "__main__":
    program.main()
