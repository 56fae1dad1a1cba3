"""The output of `features`."""

import json
import math
import random
import unittest

import program


ENGINES = ("opencv", "sift")


class FeaturesTest(program.ProgramTest):
    def test_one_line_per_feature_with_128_numbers(self):
        for engine in ENGINES:
            with self.subTest(engine=engine):
                self.check_lines(engine)

    def check_lines(self, engine):
        out = self.scratch / "features.txt"
        image = program.flight() / "crate.png"
        self.assertEqual(self.succeeds("features", image, "--out", out, "--engine", engine).out, "")
        lines = out.read_text().splitlines()
        count, size = lines[0].split(" ")
        self.assertEqual(size, "128")
        self.assertEqual(int(count), len(lines) - 1)
        self.assertGreater(len(lines), 100)
        for line in lines[1:]:
            numbers = line.split(" ")
            self.assertEqual(len(numbers), 4 + 128)
            x, y, scale, orientation = map(float, numbers[:4])
            self.assertTrue(0 <= x <= 180 and 0 <= y <= 180, line[:40])
            self.assertTrue(0.5 < scale < 100, line[:40])
            self.assertLessEqual(abs(orientation), math.pi + 1e-4)
            descriptor = [int(number) for number in numbers[4:]]
            self.assertTrue(0 <= min(descriptor) and max(descriptor) <= 255)
            length = math.sqrt(sum(value * value for value in descriptor))
            self.assertTrue(400 < length < 600, length)  # a unit vector times 512, rounded and clipped

    def test_keypoints_move_with_the_image(self):
        """White discs on black: the centre of the first pixel is at 0.5, 0.5."""

        def keypoints(name, cx, cy, engine):
            rows = bytes(
                255 if math.hypot(x + 0.5 - cx, y + 0.5 - cy) < 6 else 0 for y in range(100) for x in range(120)
            )
            image = self.write(name + ".pgm", b"P5\n120 100\n255\n" + rows)
            out = self.scratch / (name + ".txt")
            self.succeeds("features", image, "--out", out, "--engine", engine)
            return [tuple(map(float, line.split(" ")[:4])) for line in out.read_text().splitlines()[1:]]

        places = ((40.0, 30.0), (80.0, 70.0), (40.5, 30.5))
        for cx, cy, engine in ((*place, engine) for place in places for engine in ENGINES):
            found = keypoints("disc", cx, cy, engine)
            self.assertGreater(len(found), 0)
            blob = max(found, key=lambda keypoint: keypoint[2])
            self.assertAlmostEqual(blob[0], cx, delta=0.3)
            self.assertAlmostEqual(blob[1], cy, delta=0.3)
            self.assertAlmostEqual(blob[2], 6 / math.sqrt(2), delta=1.2)  # a disc's scale is its radius over root 2

    def test_image_without_features(self):
        out = self.scratch / "features.txt"
        self.succeeds("features", program.plain_image(self.scratch / "plain.ppm"), "--out", out)
        self.assertEqual(out.read_text(), "0 128\n")

    def test_engine_and_parameters(self):
        engine = json.loads(self.succeeds("params", "features", "--json").out)["engine"]
        few = self.write("few.json", '{"contrast_threshold": 0.3}')
        out = self.scratch / "features.txt"
        self.succeeds("features", program.flight() / "crate.png", "--out", out)
        by_default = int(out.read_text().split(" ")[0])
        self.succeeds(
            "features", program.flight() / "crate.png", "--out", out, "--engine", engine, "--params", few
        )
        self.assertLess(int(out.read_text().split(" ")[0]), by_default / 2)

    def count(self, image, **parameters) -> int:
        """The number of features of an image under these parameters."""
        params = self.write("params.json", json.dumps(parameters))
        out = self.scratch / "features.txt"
        self.succeeds("features", image, "--out", out, "--params", params)
        return int(out.read_text().split(" ")[0])

    def test_a_lower_edge_threshold_drops_keypoints_on_edges(self):
        crate = program.flight() / "crate.png"
        all_of_them, off_edges = (self.count(crate, edge_threshold=threshold) for threshold in (1000, 2))
        self.assertLess(off_edges, 0.7 * all_of_them)

    def test_the_impulse_fraction_decides_whether_noise_is_removed(self):
        draw = random.Random(1)
        rows = bytearray(b"\x80" * (160 * 120))
        for place in draw.sample(range(len(rows)), len(rows) // 20):
            rows[place] = draw.choice((0, 255))
        noisy = self.write("noisy.pgm", b"P5\n160 120\n255\n" + rows)
        never, removed = (self.count(noisy, contrast_threshold=0.005, impulse_fraction=share) for share in (1, 0.015))
        self.assertGreater(never, 50)
        self.assertLess(removed, never / 5)


if __name__ == "__main__":
    program.main()
