"""`index --detections`: what another program found becomes objects of the index."""

import contextlib
import json
import shutil
import sqlite3
import unittest

import program


class DetectionsTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.video = program.flight() / "flight.mkv"
        self.truth = [json.loads(line) for line in (program.flight() / "truth.jsonl").read_text().splitlines()]
        self.names = sorted({row["model"] for row in self.truth})
        self.db = self.scratch / "index.db"

    def count(self, table: str) -> int:
        with contextlib.closing(sqlite3.connect(self.db)) as index:
            return index.execute(f"SELECT count(*) FROM {table}").fetchone()[0]

    def coco(self, **changes) -> dict:
        frames = sorted({row["frame"] for row in self.truth})
        return {
            "categories": [{"id": i, "name": name} for i, name in enumerate(self.names)],
            "images": [{"id": 100 + frame, "frame_index": frame} for frame in frames],
            "annotations": [
                {"image_id": 100 + row["frame"], "category_id": self.names.index(row["model"]), "bbox": row["box"], "score": 0.8}
                for row in self.truth
            ],
        } | changes  # fmt: skip

    def entered(self, file, *flags) -> list[dict]:
        self.succeeds("index", self.video, "--detections", file, "--db", self.db, *flags)
        return self.succeeds("export", "--db", self.db, "--format", "sightings").rows()

    def expect_truth(self, rows: list[dict], names: dict[str, str]):
        """All boxes of the truth, of these categories."""
        found = sorted((row["category"], row["frame"], *(round(side) for side in row["box"])) for row in rows)
        true = sorted((names[row["model"]], row["frame"], *(round(side) for side in row["box"])) for row in self.truth)
        self.assertEqual(found, true)

    def test_coco(self):
        rows = self.entered(self.write("yolo.json", json.dumps(self.coco())))
        self.expect_truth(rows, {name: f"yolo/{name}" for name in self.names})
        self.assertEqual({row["score"] for row in rows}, {0.8})
        self.assertEqual({row["source"] for row in rows}, {"recognised"})
        objects = self.succeeds("export", "--db", self.db, "--format", "objects").rows()
        self.assertEqual({one["category"] for one in objects}, {f"yolo/{name}" for name in self.names})
        self.assertIn("yolo/", self.succeeds("search", "--db", self.db, "--category", "yolo").out)

    def test_mot_and_yolo_as_exported(self):
        tracks = [
            f"{row['frame'] + 1},{self.names.index(row['model'])},{','.join(map(str, row['box']))},0.8,-1,-1,-1\n" for row in self.truth
        ]
        mot = self.write("tracks.txt", "".join(tracks))
        self.expect_truth(self.entered(mot, "--detector", "peer"), dict.fromkeys(self.names, "peer/object"))
        again = self.scratch / "again.txt"
        again.write_text(self.succeeds("export", "--db", self.db, "--format", "mot").out)
        self.expect_truth(self.entered(again, "--detector", "peer"), dict.fromkeys(self.names, "peer/object"))
        info = json.loads(self.export(self.db, "coco"))["videos"][0]
        labels = self.scratch / "labels"
        labels.mkdir()
        for row in self.truth:
            x, y, width, height = row["box"]
            line = f"{self.names.index(row['model'])} {(x + width / 2) / info['width']} {(y + height / 2) / info['height']}"
            line += f" {width / info['width']} {height / info['height']} 0.8\n"
            with (labels / f"flight_{row['frame'] + 1}.txt").open("a") as out:
                out.write(line)
        classes = self.write("classes.txt", "\n".join(self.names))
        rows = self.entered(labels, "--classes", classes, "--detector", "yolo")
        of_yolo = [row for row in rows if row["category"].startswith("yolo/")]
        self.expect_truth(of_yolo, {name: f"yolo/{name}" for name in self.names})

    def test_entered_twice_is_as_once_and_a_new_list_replaces_the_old(self):
        file = self.write("yolo.json", json.dumps(self.coco()))
        once = self.entered(file)
        self.assertEqual([row | {"object_id": 0} for row in self.entered(file)], [row | {"object_id": 0} for row in once])
        only = [one for one in self.coco()["annotations"] if one["category_id"] == 0]
        rows = self.entered(self.write("yolo.json", json.dumps(self.coco(annotations=only))))
        self.assertEqual({row["category"] for row in rows}, {f"yolo/{self.names[0]}"})
        self.assertEqual(len(rows), len(only))
        self.assertEqual(self.entered(self.write("yolo.json", json.dumps(self.coco(annotations=[])))), [], "nothing found")

    def test_beside_a_search(self):
        shutil.copy(program.index(), self.db)
        before = self.succeeds("export", "--db", self.db, "--format", "sightings").rows()
        kept = self.count("kept_frames")
        self.assertGreater(kept, 0)
        file = self.write("yolo.json", json.dumps(self.coco()))
        for _ in range(2):
            rows = self.entered(file, "--every", "5")
        self.assertEqual(len(rows) - len(before), len(self.truth), "each box, whatever the interval of searches")
        self.assertEqual(self.count("kept_frames"), kept)
        self.assertEqual([row for row in rows if row["model"]], before, "what was searched stays")
        self.assertGreater(len(rows), len(before))
        self.succeeds("doctor", self.db, "--check")

    def test_places(self):
        video, _ = program.make_placed_flight(self.scratch)
        truth = [json.loads(line) for line in (video.parent / "truth.jsonl").read_text().splitlines()]
        tracks = [f"{row['frame'] + 1},1,{','.join(map(str, row['box']))},0.9,-1,-1,-1\n" for row in truth]
        file = self.write("tracks.txt", "".join(tracks))
        self.succeeds("index", video, "--detections", file, "--db", self.db)
        (placed,) = self.succeeds("export", "--db", self.db, "--format", "objects").rows()
        north_m = (placed["latitude_deg"] - truth[0]["latitude_deg"]) * 111_200
        self.assertLess(abs(north_m), placed["ce90_m"] + 1)

    def test_refusals(self):
        file = self.write("yolo.json", json.dumps(self.coco()))
        index = ("index", self.video, "--db", self.db)
        self.refuses(2, "give that, too", *index, "--models", program.models(), "--detector", "yolo")
        self.refuses(2, "are entered, not searched for", *index, "--detections", file, "--models", program.models())
        self.refuses(2, "for the whole video", *index, "--detections", file, "--from", "1")
        self.refuses(2, "no name of a detector", *index, "--detections", file, "--detector", "a/b")
        self.refuses(2, "not JSON", *index, "--detections", self.write("bad.json", "{"))
        self.refuses(2, "line 1", *index, "--detections", self.write("bad.txt", "1,2,3\n"))
        self.refuses(2, "give --first-frame 0", *index, "--detections", self.write("zero.txt", "0,1,1,1,9,9,1\n"))
        self.assertFalse(self.db.exists(), "a wrong file leaves no index")
        late = self.write("late.txt", "9999,1,1,1,9,9,1\n")
        self.assertIn("those after its end are left out", self.succeeds(*index, "--detections", late).err)


if __name__ == "__main__":
    program.main()
