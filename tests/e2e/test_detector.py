"""`category import`, `show`, `list`, and `index` with an imported detector: a network of one convolution, made here."""

import json
import math
import struct
import unittest
from pathlib import Path

import program

WIDTH, HEIGHT, SIDE, CELL = 160, 128, 64, 16


def varint(value: int) -> bytes:
    out = b""
    while value >= 0x80:
        out += bytes([value & 0x7F | 0x80])
        value >>= 7
    return out + bytes([value])


def number(field: int, value: int) -> bytes:
    return varint(field << 3) + varint(value)


def message(field: int, content: bytes) -> bytes:
    return varint(field << 3 | 2) + varint(len(content)) + content


def tensor(name: str, shape: list[int], values: list[float]) -> bytes:
    sides = b"".join(number(1, side) for side in shape)
    return message(5, sides + number(2, 1) + message(8, name.encode()) + message(9, struct.pack(f"<{len(values)}f", *values)))


def value_info(field: int, name: str, shape: list[int]) -> bytes:
    sides = b"".join(message(1, number(1, side)) for side in shape)
    return message(field, message(1, name.encode()) + message(2, message(1, number(1, 1) + message(2, sides))))


def integers(name: str, values: list[int]) -> bytes:
    return message(5, message(1, name.encode()) + b"".join(number(8, value) for value in values) + number(20, 7))


def tiny_detector(padding: int = 0) -> bytes:
    """Outputs of a FastestDet with the classes red and blue: each cell of 16 px that has one of these colours."""
    outputs = 7
    weights = [0.0] * (outputs * 3 * CELL * CELL)
    for output, channel, weight in [(0, 0, 1), (0, 1, -2), (0, 2, 1), (5, 2, 1), (6, 0, 1)]:
        first = (output * 3 + channel) * CELL * CELL
        weights[first : first + CELL * CELL] = [weight / CELL**2] * CELL**2
    size = math.log(CELL / SIDE / (1 - CELL / SIDE))
    bias = [0, math.atanh(0.5), math.atanh(0.5), size, size, 0, 0]
    node = message(1, b"images") + message(1, b"weights") + message(1, b"bias") + message(2, b"out") + message(4, b"Conv")
    node += integers("kernel_shape", [CELL] * 2) + integers("strides", [CELL] * 2) + integers("pads", [padding] * 4)
    graph = message(1, node) + message(2, b"tiny") + tensor("weights", [outputs, 3, CELL, CELL], weights)
    graph += tensor("bias", [outputs], bias) + value_info(11, "images", [1, 3, SIDE, SIDE])
    graph += value_info(12, "out", [1, outputs, SIDE // CELL, SIDE // CELL])
    return number(1, 7) + message(8, number(2, 11)) + message(7, graph)


def frame(path: Path, red: tuple[int, int]):
    """A black frame with a red square of a cell at this place, and a white one, which is neither red nor blue."""
    pixels = bytearray(3 * WIDTH * HEIGHT)
    for (left, top), colour in [(red, (255, 0, 0)), ((112, 96), (255, 255, 255))]:
        for y in range(top, top + CELL):
            for x in range(left, left + CELL):
                pixels[3 * (y * WIDTH + x) : 3 * (y * WIDTH + x) + 3] = bytes(colour)
    path.write_bytes(b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + pixels)


class DetectorTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.network = self.scratch / "tiny.onnx"
        self.network.write_bytes(tiny_detector())
        self.classes = self.write("classes.txt", "red\nblue\n")
        self.detector = self.scratch / "tiny.vcat"

    def imported(self, *flags) -> dict:
        done = self.succeeds(
            "category", "import", self.network, "--classes", self.classes, "--out", self.detector, "--json", *flags,
        )  # fmt: skip
        return json.loads(done.out)

    def refused(self, text: str, *flags):
        """One line with the text, and nothing is written."""
        done = program.run(
            "category", "import", self.network, "--classes", self.classes, "--out", self.detector, *flags,
        )  # fmt: skip
        self.assertEqual(done.status, 2, done.err)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        self.assertIn(text, done.err)
        self.assertEqual([path.name for path in self.scratch.iterdir() if path.suffix == ".vcat"], [])

    def test_import_says_what_it_recognised(self):
        made = self.imported("--trained-on", "squares from above")
        self.assertEqual(made["settings"]["layout"], "fastestdet")
        self.assertEqual((made["settings"]["width"], made["settings"]["height"]), (SIDE, SIDE))
        self.assertEqual(made["categories"], ["red", "blue"])
        shown = self.succeeds("category", "show", self.detector).out
        self.assertIn("trained on: squares from above", shown)
        self.assertIn("2 categories: red, blue", shown)
        (listed,) = self.succeeds("category", "list", self.scratch, "--json").rows()
        self.assertEqual(listed["trained_on"], "squares from above")
        self.assertIn("squares from above", self.succeeds("category", "list", self.scratch).out)

    def test_index_finds_its_classes(self):
        self.imported()
        frames = self.scratch / "frames"
        frames.mkdir()
        for i in range(6):
            frame(frames / f"{i:03}.ppm", (16 * (1 + i % 2), 32))
        db = self.scratch / "index.db"
        done = self.succeeds("index", frames, "--categories", self.detector, "--db", db)
        self.assertIn("tiny.onnx searches a frame by", done.err)
        sightings = self.succeeds("export", "--db", db, "--format", "sightings").rows()
        self.assertEqual([one["frame"] for one in sightings], list(range(6)))
        for one in sightings:
            self.assertEqual((one["model"], one["category"], one["source"]), (None, "red", "recognised"))
            left, top, width, height = one["box"]
            self.assertAlmostEqual(left, 16 * (1 + one["frame"] % 2), delta=1)
            self.assertAlmostEqual(top, 32, delta=1)
            self.assertAlmostEqual(width, CELL, delta=1)
            self.assertAlmostEqual(height, CELL, delta=1)
        found = self.succeeds("search", "--db", db, "--category", "red", "--json").out
        self.assertIn('"category":"red"', found.replace(" ", ""))
        again = self.succeeds("index", frames, "--categories", self.detector, "--db", db)
        self.assertEqual(self.succeeds("export", "--db", db, "--format", "sightings").rows(), sightings, again.err)

    def test_default_name_lies_in_the_current_folder(self):
        done = self.succeeds("category", "import", self.network, "--classes", self.classes, cwd=self.scratch)
        self.assertTrue(self.detector.is_file(), done.out)

    def test_wrong_files_are_one_line(self):
        self.network.write_bytes(b"")
        self.refused("an empty file")
        self.network.write_bytes(b"\x08\x07 no network" * 50)
        self.refused("tiny.onnx: ")
        self.network.write_bytes(tiny_detector()[:4000])
        self.refused("tiny.onnx: ")
        self.network.write_bytes(tiny_detector(padding=400_000))  # an output of 70 GB
        self.refused("MiB of memory")
        self.network.unlink()
        self.refused("tiny.onnx")

    def test_wrong_arguments_are_one_line(self):
        self.refused("--input 7: must be WxH", "--input", "7")
        self.refused("three with commas", "--mean", "1,2")
        self.refused("min_score = 3", "--score", "3")
        self.refused("not those of a yolov8", "--layout", "yolov8")
        self.refused("darknet (.cfg)", "--weights", self.classes)
        self.classes.write_text("red\n")
        self.refused("a fastestdet with 2 classes, and the class list has 1")
        self.classes.write_text("red\nred\n")
        self.refused("line 2: the class red comes twice")

    def test_a_detector_is_not_classified_nor_damaged_unnoticed(self):
        self.imported()
        refine = program.run("category", "refine", "--model", self.detector, "--db", "x.db", "--out", self.scratch / "y.vcat")
        self.assertEqual(refine.status, 2)
        self.assertIn("a detector: it is for `index`", refine.err)
        content = bytearray(self.detector.read_bytes())
        content[-10] ^= 1
        self.detector.write_bytes(content)
        for arguments in [("category", "show", self.detector), ("index", "x", "--categories", self.detector, "--db", "x.db")]:
            done = program.run(*arguments)
            self.assertEqual(done.status, 2)
            self.assertIn("its checksum is wrong", done.err)


if __name__ == "__main__":
    unittest.main()
