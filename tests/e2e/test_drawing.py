"""What is drawn for the eye: videos with sightings, the pixel grid, the contact sheet; and what a model promises."""

import json

import program

FLIGHT, MODELS = program.flight(), program.models()
VIDEO = FLIGHT / "flight.mkv"


class DrawingTest(program.ProgramTest):
    def video(self, path) -> dict:
        return json.loads(self.succeeds("doctor", path, "--json").out)

    def differing(self, drawn, frame: int) -> bool:
        """True if the frame of the drawn video differs from the original by more than the encoding, above its last rows."""
        images = []
        for name, video in (("a", VIDEO), ("b", drawn)):
            image = self.scratch / f"{name}.ppm"
            self.succeeds("frame", video, "--number", frame, "--out", image, "--force")
            images.append(image.read_bytes())
        header = images[0].index(b"255\n") + 4
        pixels = [image[header : header + (len(image) - header) * 4 // 5] for image in images]
        return sum(abs(a - b) > 100 for a, b in zip(*pixels)) > 100

    def test_video_of_an_index(self):
        drawn, again = self.scratch / "drawn.mp4", self.scratch / "again.mkv"
        self.succeeds("index", VIDEO, "--models", MODELS, "--db", self.scratch / "index.db", "--draw", drawn)
        times = ("--from", "1", "--to", "1")
        self.succeeds("export", "--db", program.index(), "--format", "video", "--out", again, *times)
        (row, *_) = [json.loads(line) for line in self.export(program.index(), "sightings", *times).splitlines()]
        before = self.video(VIDEO)
        for path in (drawn, again):
            after = self.video(path)
            for key in ("frames_read", "width", "height"):
                self.assertEqual(after[key], before[key], key)
            self.assertTrue(self.differing(path, row["frame"]))
        self.assertFalse(self.differing(again, row["frame"] + 5), "nothing is drawn at other times")

    def test_video_needs_one_video_and_a_name(self):
        export = ("export", "--db", program.index(), "--format", "video")
        self.refuses(2, "--out", *export)
        self.refuses(2, ".mp4", *export, "--out", self.scratch / "drawn.avi")
        self.refuses(2, "not in the index", *export, "--out", self.scratch / "x.mp4", "--video", "other.mkv")
        self.refuses(2, "--draw", "index", VIDEO, FLIGHT / "flight.mp4", "--models", MODELS, "--db",
                     self.scratch / "i.db", "--draw", self.scratch / "x.mp4")  # fmt: skip
        self.assertFalse((self.scratch / "x.mp4").exists())

    def test_video_of_user_boxes(self):
        drawn = self.scratch / "drawn.mp4"
        done = self.succeeds("track", VIDEO, "--box", "10,10,60,60", "--at", "1", "--out", self.scratch / "rows.jsonl",
                             "--draw", drawn, "--json")  # fmt: skip
        self.assertTrue(self.differing(drawn, 10))
        (row,) = done.rows()
        rows = [json.loads(line) for line in (self.scratch / "rows.jsonl").read_text().splitlines()]
        self.assertEqual((row["model"], row["frames"]), ("box-1", {str(VIDEO): len(rows)}))
        self.assertIsNone(row["latitude_deg"])
        self.assertTrue(row["no_place"])

    def test_pixel_grid(self):
        frame = ("frame", VIDEO, "--number", "0", "--out")
        self.succeeds(*frame, self.scratch / "plain.ppm")
        self.succeeds(*frame, self.scratch / "grid.ppm", "--grid")
        plain, grid = ((self.scratch / f"{name}.ppm").read_bytes() for name in ("plain", "grid"))
        self.assertEqual(len(plain), len(grid))
        changed = sum(a != b for a, b in zip(plain, grid)) / len(plain)
        self.assertTrue(0.01 < changed < 0.4, changed)

    def test_moments_of_the_sheet(self):
        sizes = []
        for moments in (2, 8):
            sheet = self.scratch / f"{moments}.ppm"
            self.succeeds("sheet", "--db", program.index(), "--out", sheet, "--moments", moments)
            sizes.append(int(sheet.read_bytes().split(b"\n")[1].split()[1]))
        self.assertGreater(sizes[0], sizes[1], "fewer moments are cut out larger")
        self.refuses(2, "--moments = 0", "sheet", "--db", program.index(), "--out", self.scratch / "x.png", "--moments", "0")

    def test_promise_of_a_model(self):
        models = self.scratch / "models"
        rich = self.succeeds("model", "add", "crate", FLIGHT / "crate.png", "--models", models)
        self.assertRegex(rich.out, r"^crate: 1 view, \d+ features: well recognisable\n$")
        self.assertEqual(rich.err, "")
        small = program.run("model", "add", "corner", FLIGHT / "crate.png", "--models", models, "--box", "2,2,40,40")
        self.assertEqual(small.status, 0, small.err)
        self.assertIn("hardly recognisable", small.out)
        self.assertRegex(small.err, r"\d+ features in its best photo: hardly recognisable: use .* --findable")

    def test_findable_photos(self):
        findable = json.loads(
            self.succeeds("model", "show", "crate", "--models", MODELS, "--findable", "--directions", "4",
                          "--size-px", "100", "--json").out  # fmt: skip
        )["findable"]
        self.assertEqual(findable["directions"], 4)
        self.assertGreater(findable["found"], 0.2)
        self.assertIn("turned_deg", findable["bands"][0])
        self.refuses(2, "photos", "model", "show", "crate", "--models", MODELS, "--findable", "--sun", "40")

    def test_threads(self):
        image = FLIGHT / "crate.png"
        outcomes = []
        for threads in ("1", "3"):
            out = self.scratch / f"{threads}.txt"
            self.succeeds("features", image, "--out", out, "--threads", threads)
            outcomes.append(out.read_bytes())
        self.assertEqual(*outcomes)
        self.refuses(2, "--threads", "features", image, "--out", self.scratch / "x.txt", "--threads", "-1")
        for command in ("model add", "category train", "simulate", "search", "track", "navigate", "match", "index"):
            self.assertIn("--threads", self.succeeds(*command.split(), "--help").out, command)


if __name__ == "__main__":
    program.main()
