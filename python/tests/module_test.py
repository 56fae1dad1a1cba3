"""The Python module: the same values as the command line, arrays without copies, one tree of exceptions."""

import ast
import json
import pickle
import os
import signal
import subprocess
import sys
import threading
import unittest
from pathlib import Path

import numpy as np

import program
import victorious

EXAMPLE = program.REPOSITORY / "examples" / "list_finds.py"


class ModuleTest(program.ProgramTest):
    def command_rows(self, form: str, db) -> list[dict]:
        return [json.loads(line) for line in self.export(db, form).splitlines()]

    def library(self) -> victorious.ModelLibrary:
        return victorious.ModelLibrary(str(program.models()))

    def test_index_has_what_the_command_line_writes(self):
        db = self.scratch / "own.db"
        reports = []
        indexer = victorious.Indexer(self.library().load_all())
        report = indexer.index(str(program.flight() / "flight.mkv"), str(db), progress=reports.append)
        self.assertGreater(report.sightings, 0)
        self.assertEqual(reports[-1].unit, "frames")
        for form in ("objects", "sightings"):
            self.assertEqual(self.export(db, form), self.export(program.index(), form))
        index = victorious.Index(db)
        rows = self.command_rows("sightings", db)
        sightings = list(index.sightings())
        self.assertEqual([(one.object, one.frame) for one in sightings], [(r["object_id"], r["frame"]) for r in rows])
        np.testing.assert_allclose([one.box for one in sightings], [row["box"] for row in rows], atol=0.006)
        np.testing.assert_allclose(sightings[0].outline, rows[0]["outline"], atol=0.006)

    def test_example_lists_objects_with_places(self):
        video, models = program.make_placed_flight(self.scratch)
        db, own = self.scratch / "command.db", self.scratch / "own.db"
        self.succeeds("index", video, "--models", models, "--db", db)
        done = subprocess.run([sys.executable, EXAMPLE, video, models, own], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = [
            f"{row['model']} {row['score']:.3f} {row['latitude_deg']:.6f} {row['longitude_deg']:.6f} +-{row['ce90_m']:.1f} m"
            for row in self.command_rows("objects", db)
        ]
        self.assertEqual((done.stdout.splitlines(), done.stderr), (expected, ""))
        for found, row in zip(victorious.Index(own).objects(), self.command_rows("objects", db), strict=True):
            self.assertAlmostEqual(found.place.altitude_m, row["altitude_m"], delta=6e-4)
            np.testing.assert_allclose(found.place.covariance_enu_m2, row["covariance_enu_m2"], atol=6e-4)

    def placed_index(self) -> Path:
        """The index of the drawn flight, which has no telemetry, with a place for each object."""
        import contextlib
        import sqlite3
        import struct

        db = self.write("placed.db", program.index().read_bytes())
        covariance = struct.pack("<9d", 4, 1, 0, 1, 9, 0, 0, 0, 4)
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            index.execute(
                "UPDATE objects SET place_time_s = 1, latitude_rad = 0.9163 + 5e-6 * id, longitude_rad = 0.234,"
                " altitude_m = 40, covariance_enu_m2 = ?, ce90_m = 5, le90_m = 4", (covariance,),
            )  # fmt: skip
        return db

    def test_detections_are_arrays_with_places(self):
        db = self.placed_index()
        index = victorious.Index(db)
        found = index.detections(model="crate")
        rows = [row for row in self.command_rows("sightings", db) if row["model"] == "crate"]
        self.assertEqual(len(found), len(rows))
        self.assertEqual((found.xyxy.dtype, found.xyxy.shape), (np.float32, (len(rows), 4)))
        x, y, width, height = rows[0]["box"]
        np.testing.assert_allclose(found.xyxy[0], [x, y, x + width, y + height], atol=0.02)
        np.testing.assert_allclose(found.confidence, [row["score"] for row in rows], atol=1e-4)
        self.assertEqual(found.tracker_id.tolist(), [row["object_id"] for row in rows])
        self.assertEqual(set(found.data["class_name"]), {"crate"})
        self.assertEqual(index.models()[found.class_id[0]].name, "crate")
        place = next(one.place for one in index.objects() if one.id == found.tracker_id[0])
        self.assertEqual(found.data["latitude_deg"][0], place.latitude_deg)
        self.assertEqual(found.data["covariance_enu_m2"][0].tolist(), [[4, 1, 0], [1, 9, 0], [0, 0, 4]])
        self.assertTrue(np.isnat(found.data["utc"]).all())
        frames = list(index.frames(model="crate"))
        self.assertEqual([number for _, number, _ in frames], sorted({row["frame"] for row in rows}))
        self.assertEqual(sum(len(one) for _, _, one in frames), len(rows))
        unplaced = victorious.Index(program.index()).detections()
        self.assertTrue(np.isnan(unplaced.data["ce90_m"]).all())
        nothing = index.detections(from_s=1e5)
        self.assertEqual((len(nothing), nothing.xyxy.shape), (0, (0, 4)))

    def test_frames_share_their_pixels(self):
        video = victorious.Video(str(program.flight() / "flight.mkv"))
        frames = list(video)
        self.assertEqual([one.index for one in frames], list(range(program.FRAMES)))
        image = frames[0].image
        self.assertEqual((image.dtype, image.shape), (np.uint8, (video.height, video.width, 3)))
        self.assertEqual(frames[0].image.ctypes.data, image.ctypes.data, "not copied")
        self.assertFalse(image.flags.writeable)
        total = int(image.sum())
        del frames, video
        self.assertEqual(int(image.sum()), total, "outlives its frame")
        grey = next(victorious.Video(str(program.flight() / "flight.mkv"), grey=True)).image
        self.assertEqual(grey.shape, image.shape[:2])

    def test_recognizes_views_of_arrays(self):
        recognizer = victorious.Recognizer(self.library().load_all())
        image = next(victorious.Video(str(program.flight() / "flight.mkv"))).image
        found = recognizer.recognize(image)
        rows = [json.loads(line) for line in (program.flight() / "truth.jsonl").read_text().splitlines()]
        truth = next(row["box"] for row in rows if (row["frame"], row["model"]) == (0, "crate"))
        crate = next(one for one in found if one.name == "crate")
        np.testing.assert_allclose(crate.box, truth, atol=8)
        rgb = np.ascontiguousarray(image[:, :, ::-1])
        self.assertEqual([one.box for one in recognizer.recognize(rgb, order="rgb")], [one.box for one in found])
        wide = np.zeros((image.shape[0], image.shape[1] + 40, 3), np.uint8)
        wide[:, : image.shape[1]] = image
        part = recognizer.recognize(wide[:, : image.shape[1]])
        self.assertEqual([one.box for one in part], [one.box for one in found], "rows with a stride")
        arrays = victorious.of_image(found)
        self.assertEqual(len(arrays), len(found))
        self.assertIsNone(arrays.tracker_id)
        unpickled = pickle.loads(pickle.dumps(image))  # its dtype is another object
        self.assertEqual([one.box for one in recognizer.recognize(unpickled)], [one.box for one in found])
        for wrong in (rgb[:, ::-1], image.astype(float), image[0, 0], np.zeros((4, 4, 2), np.uint8)):
            with self.assertRaisesRegex(victorious.InvalidArgument, "image: "):
                recognizer.recognize(wrong)
        with self.assertRaisesRegex(ValueError, "order"):
            recognizer.recognize(image, order="yuv")

    def test_tracker_follows_a_box(self):
        rows = [json.loads(line) for line in (program.flight() / "truth.jsonl").read_text().splitlines()]
        box = next(row["box"] for row in rows if (row["frame"], row["model"]) == (0, "crate"))
        tracker = victorious.Tracker()
        seen = 0
        for frame in victorious.Video(str(program.flight() / "flight.mkv")):
            steps = tracker.step(frame.image)
            if frame.index == 0:
                self.assertTrue(tracker.start(box).seen)
            elif frame.index < 6:
                seen += steps[0].seen
        self.assertGreaterEqual(seen, 4)

    def test_models_are_made_and_kept(self):
        model = victorious.Model.from_photos("crate", [str(program.flight() / "crate.png")])
        self.assertEqual(model.kind, victorious.ModelKind.PHOTOS)
        self.assertEqual(model.id, self.library().load("crate").id, "the model that the command makes")
        library = victorious.ModelLibrary(str(self.scratch / "models"))
        library.add(model)
        self.assertEqual(library.names(), ["crate"])
        with self.assertRaises(victorious.AlreadyExists):
            library.add(model)

    def test_one_tree_of_exceptions(self):
        with self.assertRaises(victorious.NotFound) as raised:
            victorious.Index(self.scratch / "none.db")
        self.assertEqual(raised.exception.code, "not_found")
        self.assertIn("none.db", str(raised.exception))
        with self.assertRaises(victorious.DataLoss):
            victorious.Model.from_cad("bad", str(self.write("bad.obj", "not a mesh")))
        with self.assertRaises(victorious.InvalidArgument):
            victorious.Recognizer([])
        for one in (victorious.Conflict, victorious.Internal, victorious.NoSpace, victorious.Unavailable):
            self.assertTrue(issubclass(one, victorious.Error))

    def index_flight(self, **options):
        indexer = victorious.Indexer(self.library().load_all(), params='{"every": 1}')
        indexer.index(str(program.flight() / "flight.mkv"), str(self.scratch / "own.db"), **options)

    def test_one_thread_at_a_time(self):
        indexer = victorious.Indexer(self.library().load_all(), params='{"every": 1}')
        flight, db = str(program.flight() / "flight.mkv"), str(self.scratch / "two.db")
        with self.assertRaisesRegex(victorious.Conflict, "in use"):
            indexer.index(flight, db, progress=lambda _: indexer.index(flight, db))
        self.assertGreater(indexer.index(flight, db).frames_searched, 0, "it is free again")

    def test_callbacks_end_the_work(self):
        with self.assertRaises(victorious.Cancelled):
            self.index_flight(progress=lambda _: False)
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            self.index_flight(progress=lambda _: 1 / 0)
        self.index_flight()
        self.assertTrue(victorious.Index(self.scratch / "own.db").objects(), "what was stored goes on")

    def test_signals_end_the_work(self):
        def interrupt(_):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            self.index_flight(progress=interrupt)

    def test_other_threads_run_meanwhile(self):
        counted = []
        is_over = threading.Event()

        def count():
            while not is_over.wait(0.001):
                counted.append(None)

        recognizer = victorious.Recognizer(self.library().load_all())
        thread = threading.Thread(target=count)
        thread.start()
        try:
            recognizer.recognize(np.zeros((1500, 2000), np.uint8))
        finally:
            is_over.set()
            thread.join()
        self.assertGreater(len(counted), 5)

    def test_stubs_declare_what_there_is(self):
        tree = ast.parse(Path(victorious.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
        declared = {}
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                names = [n.name for n in node.body if isinstance(n, ast.FunctionDef)]
                names += [n.target.id for n in node.body if isinstance(n, ast.AnnAssign)]
                declared[node.name] = {name for name in names if not name.startswith("_")}
            elif isinstance(node, ast.FunctionDef):
                declared[node.name] = set()
        self.assertEqual(set(declared) | {"__version__"}, set(victorious.__all__))
        for name, members in declared.items():
            there = getattr(victorious, name)
            if isinstance(there, type) and not issubclass(there, (victorious.Error, victorious.Detections)):
                public = {one for one in dir(there) if not one.startswith("_")} - {"name", "value"} - {"conjugate"}
                self.assertEqual(members - {"name", "value"}, public, name)

    def test_tables_where_pandas_is_installed(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        table = victorious.Index(self.placed_index()).to_pandas()
        self.assertIsInstance(table, pandas.DataFrame)
        self.assertEqual(table["ce90_m"].tolist(), [5.0] * len(table))


if __name__ == "__main__":
    program.main()
