"""`category train` and `category classify`: training, classification, and one-line errors for bad input."""

import functools
import json
import os
import random
import time
import unittest
import urllib.error
import urllib.request
from pathlib import Path

import program

HEADER = "image,category,x0,y0,x1,y1"
WIDTH, HEIGHT = 160, 120


def pair(path: Path, cross_first: bool, seed: int):
    """Draws a cross to the left of a disc, or the reverse, at a random place of an image."""
    draw = random.Random(seed)
    x, y = 30 + draw.randrange(50), 30 + draw.randrange(60)
    cross, disc = (x, x + 40) if cross_first else (x + 40, x)
    pixels = bytearray()
    for row in range(HEIGHT):
        for column in range(WIDTH):
            value = 100 + draw.randrange(8)
            across, down = abs(column - cross), abs(row - y)
            if max(across, down) <= 15 and min(across, down) <= 3:
                value = 230
            if (column - disc) ** 2 + (row - y) ** 2 <= 14**2:
                value = 20
            pixels.append(value)
    path.write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + pixels)
    return f"{path.name},{'cross-disc' if cross_first else 'disc-cross'},{x - 20},{y - 20},{x + 60},{y + 20}"


FOLDER = program.folder_until_exit()
TRAIN = [pair(FOLDER / f"train{i}.pgm", i % 2 == 0, i) for i in range(16)]
TEST = [pair(FOLDER / f"test{i}.pgm", i % 2 == 0, 100 + i) for i in range(10)]
# The two categories are mirror images of each other.
SMALL = {
    "features": {"mirrored": False},
    "vocabulary": {"words": 80, "iterations": 5},
    "phrases": {"word_clusters": 24},
    "fisher": {"components": 8},
}


def listing(rows) -> str:
    return "\n".join([HEADER, *rows]) + "\n"


@functools.cache
def trained() -> Path:
    """The model of TRAIN with the parameters SMALL. Read-only: equal input gives an equal model (test_depends_on_the_seed)."""
    folder = program.folder_until_exit()
    (folder / "params.json").write_text(json.dumps(SMALL))
    (folder / "train.csv").write_text(listing(TRAIN))
    model = folder / "model.vcat"
    done = program.run(
        "category", "train", "--images", FOLDER, "--list", folder / "train.csv", "--params", folder / "params.json",
        "--out", model,
    )  # fmt: skip
    assert done.status == 0, done.err
    return model


class CategoryTest(program.ProgramTest):
    def train(self, rows=None, params=None, *flags):
        if rows is None and params is None and not flags:
            return trained()
        model = self.scratch / "model.vcat"
        flags += ("--params", self.write("params.json", json.dumps({**SMALL, **(params or {})})))
        self.succeeds(
            "category", "train", "--images", FOLDER, "--list", self.write("train.csv", listing(rows or TRAIN)),
            "--out", model, *flags,
        )  # fmt: skip
        return model

    def classify(self, model, *flags) -> list[dict]:
        rows = self.write("test.csv", listing(TEST))
        return self.succeeds(
            "category", "classify", "--model", model, "--images", FOLDER, "--list", rows, *flags, "--json"
        ).rows()

    def refuses_list(self, words, content, name="bad.csv"):
        out = self.scratch / "model.vcat"
        bad = self.write(name, content)
        self.refuses(2, words, "category", "train", "--images", FOLDER, "--list", bad, "--out", out)
        self.assertFalse(out.exists())

    def test_labels_and_scores(self):
        model = self.train()
        results = self.classify(model)
        self.assertEqual([row["image"] for row in results], [row.split(",")[0] for row in TEST])
        right = sum(row["label"] == listed.split(",")[1] for row, listed in zip(results, TEST))
        self.assertGreaterEqual(right, 9)
        for row in results:
            self.assertEqual(set(row), {"image", "label", "scores"})
            self.assertEqual(set(row["scores"]), {"cross-disc", "disc-cross"})
            self.assertEqual(row["label"], max(row["scores"], key=row["scores"].get))
            self.assertTrue(all(0 <= score <= 1 for score in row["scores"].values()))
        words = self.classify(model, "--method", "words")
        self.assertNotEqual([row["scores"] for row in words], [row["scores"] for row in results])

    def test_training_and_refining_report_as_json(self):
        model = self.scratch / "model.vcat"
        (report,) = self.succeeds(
            "category", "train", "--images", FOLDER, "--list", self.write("train.csv", listing(TRAIN)), "--out", model,
            "--params", self.write("params.json", json.dumps(SMALL)), "--json",
        ).rows()  # fmt: skip
        self.assertEqual((report["model"], report["images"], report["cad_files"]), (str(model), len(TRAIN), 0))
        self.assertEqual(set(report["categories"]), {row.split(",")[1] for row in TRAIN})
        self.assertGreater(report["words"], 0)

    def test_an_output_without_a_folder_is_named_before_the_images_are_looked_at(self):
        broken = self.write("images/broken.pgm", "no image")
        rows = self.write("train.csv", listing([f"broken.pgm,{name}" for name in ("cross-disc", "disc-cross")]))
        out = self.scratch / "none/model.vcat"
        self.refuses(2, out, "category", "train", "--images", broken.parent, "--list", rows, "--out", out)
        refine = ("category", "refine", "--model", trained(), "--images", broken.parent, "--list", rows)
        self.refuses(2, out, *refine, "--out", out)

    def test_missing_background_is_reported(self):
        def train(rows):
            listed, params = self.write("list.csv", listing(rows)), self.write("params.json", json.dumps(SMALL))
            return self.succeeds(
                "category", "train", "--images", FOLDER, "--list", listed, "--params", params,
                "--out", self.scratch / "m.vcat",
            ).messages()  # fmt: skip

        reported = train(TRAIN)
        self.assertEqual(len(reported), 1, reported)
        self.assertIn("every image is labelled as one of the categories", reported[0])
        self.assertEqual(train([row.replace(",disc-cross,", ",background,") for row in TRAIN]), [])

    def test_thesis_method(self):
        model = self.train(None, {"scoring": "likelihood", "words_per_keypoint": 1})
        for method in ("phrases", "words"):
            self.assertEqual(len(self.classify(model, "--method", method)), len(TEST))

    def test_depends_on_the_seed(self):
        first = self.train(None, None, "--seed", "7").read_bytes()
        self.assertEqual(self.train(None, None, "--seed", "7").read_bytes(), first)
        self.assertNotEqual(self.train(None, None, "--seed", "8").read_bytes(), first)

    def test_text(self):
        model = self.train()
        rows = self.write("test.csv", "image\n" + TEST[0].split(",")[0] + "\n")
        text = self.succeeds("category", "classify", "--model", model, "--images", FOLDER, "--list", rows).out
        self.assertRegex(text, r"^test0\.pgm: (cross-disc|disc-cross) [01]\.\d{3}\n$")

    def test_explanations(self):
        model = self.train()
        rows = self.write("two.csv", listing(TEST[:2]))
        command = ("category", "classify", "--model", model, "--images", FOLDER, "--list", rows)
        self.succeeds(*command, "--explain", self.scratch / "why.png")
        for name in ("why.png", "why-2.png"):
            self.assertTrue((self.scratch / name).read_bytes().startswith(b"\x89PNG"))
        self.refuses(2, "--method phrases", *command, "--method", "words", "--explain", self.scratch / "no.png")
        self.refuses(2, "no.txt", *command, "--explain", self.scratch / "no.txt")

    def test_feedback(self):
        model = self.train()
        image, name = TEST[0].split(",")[:2]
        before = next(row for row in self.classify(model) if row["image"] == image)["scores"][name]
        marks = self.write("marks.csv", f"image,category,mark\n{image},{name},wrong\n")
        better = self.scratch / "better.vcat"
        command = ("category", "refine", "--model", model, "--images", FOLDER, "--out", better, "--list")
        (report,) = self.succeeds(*command, marks, "--json").rows()
        agreed = {"agreed_before": report["agreed_before"], "agreed_after": 1}
        self.assertEqual(report, {"model": str(better), "marks": 1, "right": 0, "wrong": 1, **agreed})
        after = next(row for row in self.classify(better) if row["image"] == image)["scores"][name]
        self.assertLess(after, before)
        better.unlink()
        self.refuses(2, ["line 2", "no mark"], *command, self.write("no.csv", listing(TEST)))
        self.refuses(2, "boat", *command, self.write("boat.csv", f"image,category,mark\n{image},boat,right\n"))
        self.assertFalse(better.exists())

    def test_cad_file_represents_its_category(self):
        model = self.scratch / "model.vcat"
        jet = program.REPOSITORY / "assets" / "models" / "jet.glb"
        nothing = [f"{row.split(',')[0]},background,,,," for row in TRAIN]
        params = self.write("params.json", json.dumps({**SMALL, "cad": {"views": 6}}))
        rows = self.write("train.csv", listing([*nothing, f"{jet},jet,,,,"]))
        result = self.succeeds(
            "category", "train", "--images", FOLDER, "--list", rows, "--params", params, "--out", model
        )
        self.assertIn("from 16 images and 1 CAD file", result.out)
        self.assertEqual({row["label"] for row in self.classify(model)}, {"background"})

    def test_bad_cad_files(self):
        jet = program.REPOSITORY / "assets" / "models" / "jet.glb"
        self.refuses_list(["line 18", "requires background images", "for example background"], listing([*TRAIN, f"{jet},jet,,,,"]))
        self.refuses_list(["line 18", "a box"], listing([*TRAIN, f"{jet},jet,0,0,9,9"]))
        (FOLDER / "broken.glb").write_bytes(b"glTF and no more")
        nothing = [f"{row.split(',')[0]},background,,,," for row in TRAIN]
        self.refuses_list(["line 18", "broken.glb"], listing([*nothing, "broken.glb,jet,,,,"]))

    def test_bad_lists(self):
        self.refuses_list("no images", "")
        self.refuses_list("no column image", "\n".join(TRAIN))
        self.refuses_list(["line 2", "no category"], "image\ntrain0.pgm\n")
        self.refuses_list(["line 2", "is empty"], listing(["train0.pgm,a,10,10,10,50"]))
        self.refuses_list(["line 2", "four numbers"], listing(["train0.pgm,a,10,10"]))
        self.refuses_list(["line 18", "outside the image", "160 x 120"], listing([*TRAIN, "train1.pgm,a,500,10,600,20"]))
        self.refuses_list(["line 18", "nowhere.png"], listing([*TRAIN, "nowhere.png,a,,,,"]))
        (FOLDER / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nand no more")
        self.refuses_list(["line 18", "broken.png"], listing([*TRAIN, "broken.png,a,,,,"]))
        self.refuses_list("one category", listing(TRAIN[::2]))
        self.refuses_list("disc-cross: one image", listing([*TRAIN[::2], TRAIN[1]]))

    def test_bad_models(self):
        rows = self.write("test.csv", listing(TEST))
        command = ("category", "classify", "--images", FOLDER, "--list", rows, "--model")
        self.refuses(2, "none.vcat", *command, self.scratch / "none.vcat")
        self.refuses(2, "not a category model", *command, rows)
        whole = self.train().read_bytes()
        self.refuses(2, "cut off", *command, self.write("cut.vcat", whole[:-1]))
        self.refuses(2, "newer version", *command, self.write("new.vcat", whole[:8] + b"\x07" + whole[9:]))
        self.refuses(2, ["older version", "train again"], *command, self.write("old.vcat", whole[:8] + b"\x03" + whole[9:]))

    def test_videos_are_indexed_by_category(self):
        model = self.train()
        video = self.scratch / "video"
        video.mkdir()
        for i in range(12):
            pair(video / f"{i:03d}.pgm", i < 6, 500 if i < 6 else 501)
        db = self.scratch / "index.db"
        command = ("index", video, "--categories", model, "--db", db)
        self.succeeds(*command)
        for name, frames in (("cross-disc", range(6)), ("disc-cross", range(6, 12))):
            rows = [json.loads(line) for line in self.export(db, "sightings", "--category", name).splitlines()]
            self.assertEqual([row["frame"] for row in rows], list(frames))
            for row in rows:
                self.assertEqual((row["model"], row["category"]), (None, name))
                x, y, w, h = row["box"]
                self.assertTrue(0 <= x and 0 <= y and 0 < w and 0 < h and x + w <= WIDTH and y + h <= HEIGHT)
            (found,) = self.succeeds("search", "--db", db, "--category", name, "--json").rows()
            self.assertEqual((found["rank"], found["category"], found["frames"]), (1, name, 6))
        self.assertIn("0 frames searched", self.succeeds(*command).err)
        self.succeeds("sheet", "--db", db, "--category", "cross-disc", "--out", self.scratch / "sheet.png")

        everything = self.export(db, "objects")
        self.refuses(2, ["boat", "cross-disc, disc-cross"], "search", "--db", db, "--category", "boat")
        self.refuses(2, "--model and --category", "search", "--db", db, "--category", "boat", "--model", "boat")
        other = self.write("other.json", '{"categories": {"min_probability": 0.9}}')
        self.refuses(2, ["min_probability", "--redo"], *command, "--params", other)
        self.assertEqual(self.export(db, "objects"), everything)
        new = self.scratch / "new.db"
        self.refuses(2, ["--models", "--categories"], "index", video, "--db", new)
        broken = self.write("cut.vcat", model.read_bytes()[:-1])
        self.refuses(2, "cut off", "index", video, "--categories", broken, "--db", new)
        self.refuses(2, "none.vcat", "index", video, "--categories", self.scratch / "none.vcat", "--db", new)
        none = self.write("none.json", '{"categories": {"background": "cross-disc, disc-cross"}}')
        self.refuses(2, "all are background", "index", video, "--categories", model, "--db", new, "--params", none)
        self.assertFalse(new.exists())

    def test_reviews_refine_categories(self):
        """Accepted and rejected objects are marks: by the command, and as a job of the server."""
        model = self.train()
        video = self.scratch / "video"
        video.mkdir()
        for i in range(12):
            pair(video / f"{i:03d}.pgm", i < 6, 500 if i < 6 else 501)
        db, models, better = self.scratch / "index.db", self.scratch / "models", self.scratch / "better.vcat"
        models.mkdir()
        self.succeeds("index", video, "--categories", model, "--db", db)
        command = ("category", "refine", "--model", model, "--db", db, "--out", better)
        self.refuses(2, "no object of a category", *command)
        self.refuses(2, "--list, or --db", *command, "--images", FOLDER)
        self.refuses(2, "--list, or --db", "category", "refine", "--model", model, "--out", better)
        with program.Server(db, "--models", models) as server:
            self.refused_job(server, "--categories")
        with program.Server(db, "--models", models, "--categories", model) as server:
            self.assertEqual(self.ask(server, "GET", "project")["categories"], model.name)
            for found in self.ask(server, "GET", "objects")["objects"]:
                verdict = "accepted" if found["model"] == "cross-disc" else "rejected"
                self.ask(server, "PUT", f"objects/{found['id']}/review", {"verdict": verdict})
            job = self.ask(server, "POST", "jobs", {"kind": "refine"})
            self.assertEqual(job["title"], model.name)
            while job["state"] in ("queued", "running"):
                time.sleep(0.05)
                (job,) = (one for one in self.ask(server, "GET", "jobs")["jobs"] if one["id"] == job["id"])
            self.assertEqual((job["state"], job["files"]), ("done", ["categories"]), job)
            self.assertRegex(job["message"], "2 marks, 1 right and 1 wrong: . agreed with the model, . agree with the refined one")
            with urllib.request.urlopen(f"{server.url}/api/v1/jobs/{job['id']}/files/categories") as response:
                self.assertIn(f'"{model.stem}-refined.vcat"', response.headers["Content-Disposition"])
                made = response.read()
            again = self.ask(server, "POST", "jobs", {"kind": "refine"})
            self.assertEqual((again["id"], again["message"]), (job["id"], job["message"]), "nothing was decided since")
            (file,) = Path(f"{db}.copies").iterdir()
            forgotten = file.with_stem(file.stem[:-16] + 16 * "0")  # by a job that is not listed any more
            forgotten.touch()
            os.utime(forgotten, (0, 0))
            for number in range(2):  # another decision is another job, once
                self.ask(server, "PUT", f"objects/{found['id']}/review", {"verdict": "rejected" if verdict == "accepted" else "accepted"})
                other = self.ask(server, "POST", "jobs", {"kind": "refine"})
                self.assertEqual(other["id"], job["id"] + 1)
            while forgotten.exists():
                time.sleep(0.05)
            self.assertTrue(file.exists())
            self.ask(server, "PUT", f"objects/{found['id']}/review", {"verdict": verdict})
            self.assertEqual(self.ask(server, "POST", "jobs", {"kind": "refine"})["id"], job["id"], "decided as at first")
        (report,) = self.succeeds(*command, "--json").rows()
        self.assertEqual((report["marks"], report["right"], report["wrong"]), (2, 1, 1))
        self.assertGreaterEqual(report["agreed_after"], report["agreed_before"])
        self.assertEqual(better.read_bytes(), made)
        self.assertNotEqual(made, model.read_bytes())

    def ask(self, server, method, path, body=None):
        request = urllib.request.Request(
            f"{server.url}/api/v1/{path}", json.dumps(body).encode() if body else None,
            {"Content-Type": "application/json"}, method=method,
        )
        with urllib.request.urlopen(request) as response:
            return json.load(response)

    def refused_job(self, server, word):
        with self.assertRaises(urllib.error.HTTPError) as caught:
            self.ask(server, "POST", "jobs", {"kind": "refine"})
        with caught.exception as answer:
            self.assertIn(word, json.load(answer)["message"])

    def test_missing_images(self):
        model = self.train()
        rows = self.write("test.csv", listing([*TEST, "nowhere.png,a"]))
        self.refuses(
            2, ["line 12", "nowhere.png"], "category", "classify", "--model", model, "--images", FOLDER, "--list", rows
        )


if __name__ == "__main__":
    program.main()
