"""`victorious simulate`: three consistent output files, reproducible, and no partial output."""

import csv
import json
import math
import shutil
import signal
import subprocess
import time
import unittest

import program

ASSETS = program.REPOSITORY / "assets"
FRAMES = 6
SCENE = {
    "assets": str(ASSETS),
    "seed": 5,
    "video": {"frames": FRAMES, "fps": 5, "width": 192, "height": 144, "hfov_deg": 20, "noise": 0.02, "blur_px": 0.5},
    "origin": {"latitude_deg": 48.1, "longitude_deg": 11.6, "altitude_m": 560, "heading_deg": 25},
    "camera": {"aim_m": [[20, 24], [28, 24]], "from_deg": [170, 190], "off_nadir_deg": 35, "range_m": 110},
    "objects": [
        {"id": "tank-1", "model": "tank", "x_m": 24, "y_m": 26, "heading_deg": 40},
        {"id": "jeep-1", "model": "jeep", "path_m": [[18, 18], [40, 18]], "speed_m_s": 4},
        {"id": "jeep-2", "model": "jeep", "x_m": 500, "y_m": 0},
    ],
    "pieces": [{"asset": "models/pickup", "x_m": 15, "y_m": 28}],
    "town": {"squares": [1, 1, 1, 1], "tiles": [{"tile": "apron", "column": 1, "row": 1}]},
}


def with_changes(**changes) -> str:
    return json.dumps(SCENE | changes)


class SimulateTest(program.ProgramTest):
    def simulate(self, name: str, scene: str = with_changes()):
        folder = self.scratch / name
        (report,) = self.succeeds("simulate", self.write("scene.json", scene), "--out", folder, "--json").rows()
        self.assertEqual(report["frames"], json.loads(scene)["video"]["frames"])
        for kind, file in (("video", "video.mp4"), ("telemetry", "telemetry.csv"), ("truth", "truth.jsonl")):
            self.assertEqual(report[kind], str(folder / file))
        self.assertEqual(
            sorted(path.name for path in folder.iterdir()), ["telemetry.csv", "truth.jsonl", "video.mp4"]
        )
        with open(folder / "telemetry.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row.pop("vertical_datum") for row in rows}, {"ellipsoid"})
        telemetry = [{key: float(value) for key, value in row.items()} for row in rows]
        truth = [json.loads(line) for line in (folder / "truth.jsonl").read_text().splitlines()]
        return folder, telemetry, truth

    def test_doctor_says_of_telemetry_what_index_says(self):
        straight = with_changes(
            video={"frames": 36, "fps": 5, "width": 160, "height": 120, "hfov_deg": 40},
            camera={"aim_m": [[-10, 24], [40, 24]], "from_deg": [180, 180], "off_nadir_deg": 35, "range_m": 110},
            town={"squares": [-1, 0, 2, 1], "tiles": [{"tile": "apron", "column": 1, "row": 1}]},
        )
        folder, telemetry, _ = self.simulate("straight", straight)
        video = folder / "video.mp4"
        said = self.succeeds("doctor", video).out
        self.assertNotIn("contradicts", said)
        self.assertNotIn("field of view is", said)
        for words, changed in (
            ("contradicts the image", lambda row: {"yaw_deg": row["yaw_deg"] + 6 * row["time_s"]}),
            ("its field of view", lambda row: {"hfov_deg": 1.25 * row["hfov_deg"]}),
        ):
            with self.subTest(words), open(folder / "video.telemetry.csv", "w", encoding="utf-8", newline="") as file:
                table = csv.DictWriter(file, [*telemetry[0], "vertical_datum"])
                table.writeheader()
                table.writerows(row | changed(row) | {"vertical_datum": "ellipsoid"} for row in telemetry)
                file.flush()
                (line,) = [line for line in self.succeeds("doctor", video).out.splitlines() if words in line]
                db = self.scratch / f"{len(words)}.db"
                self.assertIn(line.strip(), self.succeeds("index", video, "--models", program.models(), "--db", db).err)

    def test_files_agree(self):
        folder, telemetry, truth = self.simulate("flight")
        said = self.succeeds("doctor", folder / "video.mp4").out
        self.assertIn("192 x 144", said)
        self.assertEqual([row["time_s"] for row in telemetry], [frame / 5 for frame in range(FRAMES)])
        self.assertEqual({row["object"] for row in truth}, {"tank-1", "jeep-1"})  # the other jeep is far away
        for row in truth:
            camera = telemetry[row["frame"]]
            self.assertEqual(row["time_s"], camera["time_s"])
            x, y, width, height = row["box"]
            self.assertTrue(0 <= x and x + width <= 192 and 0 <= y and y + height <= 144, row)
            self.assertTrue(0 < row["visible"] <= 1 and 0 < row["pixels"] <= width * height, row)
            if row["visible"] > 0.99:
                seen_x, seen_y = project(row, camera)
                self.assertAlmostEqual(seen_x, x + width / 2, delta=0.1 * width + 1, msg=str(row))
                self.assertAlmostEqual(seen_y, y + height / 2, delta=0.1 * height + 1, msg=str(row))
        tank = [row for row in truth if row["object"] == "tank-1"]
        self.assertEqual(len(tank), FRAMES)
        self.assertAlmostEqual(tank[0]["heading_deg"], 65, places=2)  # the sum of the town's heading and its own
        self.assertAlmostEqual(telemetry[0]["yaw_deg"], (170 + 25 + 180) % 360, places=2)
        self.assertAlmostEqual(telemetry[0]["pitch_deg"], -55, places=2)

    def test_driving_objects_move_and_static_ones_do_not(self):
        _, _, truth = self.simulate("flight")
        places = {
            name: {(row["latitude_deg"], row["longitude_deg"]) for row in truth if row["object"] == name}
            for name in ("tank-1", "jeep-1")
        }
        self.assertEqual(len(places["tank-1"]), 1)
        self.assertGreater(len(places["jeep-1"]), 3)

    def test_same_scene_same_flight(self):
        folder, *_ = self.simulate("one")
        again, *_ = self.simulate("two")
        for name in ("telemetry.csv", "truth.jsonl", "video.mp4"):
            self.assertEqual((folder / name).read_bytes(), (again / name).read_bytes(), name)

    def test_bad_scenes(self):
        def refuses(words, scene: str):
            path = self.write("scene.json", scene)
            self.refuses(2, words, "simulate", path, "--out", self.scratch / "out")
            self.assertFalse((self.scratch / "out").exists())

        self.refuses(2, "none.json", "simulate", self.scratch / "none.json", "--out", self.scratch / "out")
        refuses(["scene.json", "JSON"], "no scene")
        refuses(["scene.json", "video.fpz", "video.fps"], with_changes(video={"fpz": 4}))
        refuses(["scene.json", "objects[0]", "model"], with_changes(objects=[{"id": "a"}]))
        refuses("models/submarine.glb", with_changes(objects=[{"id": "a", "model": "submarine"}]))
        refuses("nowhere", with_changes(assets="nowhere"))
        refuses("tiles/lagoon.glb", with_changes(town={"tiles": [{"tile": "lagoon"}]}))
        self.write("broken.glb", "no mesh")
        refuses("broken.glb", with_changes(objects=[{"id": "a", "model": "a", "file": "broken.glb"}]))

    def test_shipped_scenes(self):
        """Each scene starts: all files that it names exist."""
        scenes = sorted((program.REPOSITORY / "scenes").rglob("*.json"))
        self.assertGreaterEqual(len(scenes), 13)
        for path in scenes:
            scene = json.loads(path.read_text())
            if tiles := scene["town"].get("tiles"):
                columns, rows = ([tile[key] for tile in tiles] for key in ("column", "row"))
                scene["town"]["squares"] = [min(columns), min(rows), max(columns), max(rows)]
            scene["video"] |= {"frames": 1, "width": 160, "height": 120, "supersampling": 1}
            _, telemetry, _ = self.simulate(path.stem, json.dumps(scene | {"assets": str(ASSETS)}))
            self.assertEqual(len(telemetry), 1)

    def test_own_model(self):
        shutil.copy(ASSETS / "models" / "jet.glb", self.scratch / "mine.glb")
        scene = with_changes(objects=[{"id": "x", "model": "glider", "file": "mine.glb", "x_m": 24, "y_m": 24}])
        _, _, truth = self.simulate("flight", scene)
        self.assertEqual({row["model"] for row in truth}, {"glider"})

    def test_stopped_by_the_user(self):
        scene = self.write("scene.json", with_changes(video=SCENE["video"] | {"frames": 100000}))
        out = self.scratch / "out"
        with subprocess.Popen(
            [program.PROGRAM, "simulate", scene, "--out", out], stderr=subprocess.PIPE, text=True
        ) as process:
            until = time.monotonic() + program.TIMEOUT_S
            while time.monotonic() < until and not (out.exists() and any(out.iterdir())):
                time.sleep(0.05)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=program.TIMEOUT_S)
        outcome = program.Outcome(process.returncode, "", err)
        self.assertEqual(outcome.status, 130, err)
        self.assertEqual(len(outcome.messages()), 1, err)
        self.assertIn("stopped at frame", outcome.messages()[0])
        self.assertEqual(list(out.iterdir()), [])


def project(place: dict, camera: dict) -> tuple[float, float]:
    """Projects a place to the image, px, by an independent flat-Earth computation, accurate to centimetres over 100 m."""
    metres_a_degree = math.pi / 180 * 6.378e6
    latitude = math.radians(camera["latitude_deg"])
    flattening_north, flattening_east = 1 - 0.0067 * (1 - 1.5 * math.sin(latitude) ** 2), 1 + 0.0034 * math.sin(latitude) ** 2
    east = (place["longitude_deg"] - camera["longitude_deg"]) * metres_a_degree * math.cos(latitude) * flattening_east
    north = (place["latitude_deg"] - camera["latitude_deg"]) * metres_a_degree * flattening_north
    up = place["altitude_m"] - camera["altitude_m"]
    yaw, pitch, roll = (math.radians(camera[f"{name}_deg"]) for name in ("yaw", "pitch", "roll"))
    right = east * math.cos(yaw) - north * math.sin(yaw)
    ahead = east * math.sin(yaw) + north * math.cos(yaw)
    forward = ahead * math.cos(pitch) + up * math.sin(pitch)
    down = ahead * math.sin(pitch) - up * math.cos(pitch)
    right, down = right * math.cos(roll) + down * math.sin(roll), down * math.cos(roll) - right * math.sin(roll)
    focal = 96 / math.tan(math.radians(camera["hfov_deg"]) / 2)
    return 96 + focal * right / forward, 72 + focal * down / forward


if __name__ == "__main__":
    program.main()
