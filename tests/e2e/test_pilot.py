"""A pilot's way: a rendered clip with the subtitles that a DJI aircraft writes beside it, one photo of an object, no flags."""

import csv
import functools
import json
import math
import shutil
import unittest
from pathlib import Path

import program

GROUND_M = 560  # above the ellipsoid
GEOID_M = 46  # above the ellipsoid there, EGM96, to a metre
SCENE = {
    "seed": 8,
    "assets": str(program.REPOSITORY / "assets"),
    "origin": {"latitude_deg": 48.2, "longitude_deg": 11.3, "altitude_m": GROUND_M, "heading_deg": 40},
    "sun": {"azimuth_deg": 130, "elevation_deg": 55, "strength": 0.5, "sky": 0.58, "ground": 0.3},
    "objects": [{"id": "jeep-1", "model": "jeep", "x_m": -16, "y_m": 25, "heading_deg": 60}],
    "town": {"seed": 18, "density": 0.3},
}
VIDEO = {"fps": 10, "width": 640, "height": 480, "hfov_deg": 16}
FLIGHT = {"aim_m": [[-28, 24], [-4, 24]], "from_deg": [190, 190], "off_nadir_deg": 34, "range_m": 110}
PHOTO = {"aim_m": [[-16, 25], [-15, 25]], "from_deg": [190, 190], "off_nadir_deg": 30, "range_m": 90}


def simulate(folder: Path, name: str, frames: int, camera: dict) -> Path:
    scene = SCENE | {"video": VIDEO | {"frames": frames}, "camera": {"path": "linear"} | camera}
    (folder / f"{name}.json").write_text(json.dumps(scene))
    done = program.run("simulate", folder / f"{name}.json", "--out", folder / name)
    assert done.status == 0, done.err
    return folder / name


def truth(movie: Path) -> dict:
    return json.loads((movie / "truth.jsonl").read_text().splitlines()[0])


def stamp(time_s: float) -> str:
    return f"00:00:{int(time_s):02},{round(time_s % 1 * 1000):03}"


def subtitles(telemetry: Path, with_gimbal: bool = True) -> str:
    """Of a Mavic 3: six decimals of a degree, tenths of a degree of the gimbal, heights above the sea and the take-off."""
    cues = []
    with telemetry.open(newline="") as file:
        for number, row in enumerate(csv.DictReader(file), 1):
            time_s, height_m = float(row["time_s"]), float(row["altitude_m"])
            yaw_deg = (float(row["yaw_deg"]) + 180) % 360 - 180
            gimbal = f" [gb_yaw: {yaw_deg:.1f} gb_pitch: {float(row['pitch_deg']):.1f} gb_roll: 0.0]"
            focal_mm = 18 / math.tan(math.radians(float(row["hfov_deg"])) / 2)
            cues.append(
                f"{number}\n{stamp(time_s)} --> {stamp(time_s + 0.1)}\n"
                f'<font size="28">FrameCnt: {number}, DiffTime: 100ms\n2024-04-23 14:04:{7 + time_s:06.3f}\n'
                f"[iso: 110] [shutter: 1/640.0] [fnum: 2.8] [ev: 0] [focal_len: {focal_mm:.2f}] [dzoom_ratio: 1.00], "
                f"[latitude: {float(row['latitude_deg']):.6f}] [longitude: {float(row['longitude_deg']):.6f}] "
                f"[rel_alt: {height_m - GROUND_M:.3f} abs_alt: {height_m - GEOID_M:.3f}]"
                f"{gimbal if with_gimbal else ''} </font>\n"
            )
    return "\n".join(cues)


@functools.cache
def pilot() -> Path:
    """A folder with flight/ (video, telemetry, truth) and models/ with the jeep of one photo. Read-only."""
    folder = program.folder_until_exit()
    simulate(folder, "flight", 24, FLIGHT)
    photo = simulate(folder, "photo", 2, PHOTO)
    box = ",".join(str(round(side)) for side in truth(photo)["box"])
    for arguments in (
        ("frame", photo / "video.mp4", "--number", 0, "--out", folder / "jeep.png"),
        ("model", "add", "jeep", folder / "jeep.png", "--box", box, "--models", folder / "models"),
    ):
        done = program.run(*arguments)
        assert done.status == 0, done.err
    return folder


def metres_apart(a: dict, b: dict) -> float:
    north_m = math.radians(a["latitude_deg"] - b["latitude_deg"]) * 6.371e6
    east_m = math.radians(a["longitude_deg"] - b["longitude_deg"]) * 6.371e6 * math.cos(math.radians(b["latitude_deg"]))
    return math.hypot(north_m, east_m)


class PilotTest(program.ProgramTest):
    def index(self, with_gimbal: bool = True, name: str = "a.db", *flags) -> tuple[program.Outcome, list[dict]]:
        shutil.copy(pilot() / "flight" / "video.mp4", self.scratch / "DJI_0001.MP4")
        self.write("DJI_0001.SRT", subtitles(pilot() / "flight" / "telemetry.csv", with_gimbal))
        db = self.scratch / name
        video = self.scratch / "DJI_0001.MP4"
        done = self.succeeds("index", video, "--models", pilot() / "models", "--db", db, *flags)
        return done, [json.loads(line) for line in self.export(db, "objects").splitlines()]

    def test_clip_subtitles_and_one_photo_give_a_place_on_the_map(self):
        done, objects = self.index()
        self.assertEqual(len(objects), 1, done.err)
        self.assertGreater(objects[0]["frames"], 20)
        if objects[0]["latitude_deg"] is None:  # no geoid is installed for heights above the sea
            self.assertIn("--takeoff", done.err)
            self.skipTest("PROJ has no EGM96 grid")
        off_m = metres_apart(objects[0], truth(pilot() / "flight"))
        self.assertLess(off_m, 1.5)
        self.assertLess(off_m, objects[0]["ce90_m"])
        self.assertIn("telemetry.clock_sigma_s", done.err)
        exact = self.write("exact.json", json.dumps({"telemetry": {"clock_sigma_s": 0}}))
        done, known = self.index(True, "exact.db", "--params", exact)
        self.assertNotIn("clock", done.err)
        self.assertEqual(known[0]["latitude_deg"], objects[0]["latitude_deg"])
        self.assertLess(1.1 * known[0]["ce90_m"], objects[0]["ce90_m"], "0.3 s of a flight at 10 m/s")
        (feature,) = json.loads(self.export(self.scratch / "a.db", "geojson"))["features"]
        point, ellipse = feature["geometry"]["geometries"]
        self.assertAlmostEqual(point["coordinates"][0], objects[0]["longitude_deg"], places=6)
        self.assertEqual(ellipse["type"], "Polygon")

    def test_the_log_of_a_whole_flight_may_be_seconds_off(self):
        with (pilot() / "flight" / "telemetry.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        moved = ("time_s", "latitude_deg", "longitude_deg", "altitude_m")
        first, last = ({name: float(row[name]) for name in moved} for row in (rows[0], rows[-1]))
        after = [rows[-1] | {name: first[name] + (last[name] - first[name]) * part for name in moved} for part in (1.5, 2, 2.5)]

        def index(name, params):
            lines = [rows[0], *(row.values() for row in [*rows, *after])]
            log = self.write(f"{name}.csv", "\n".join(",".join(map(str, line)) for line in lines))
            video, db = pilot() / "flight" / "video.mp4", self.scratch / f"{name}.db"
            flags = ("--params", self.write(f"{name}.json", json.dumps(params)))
            done = self.succeeds("index", video, "--telemetry", log, "--models", pilot() / "models", "--db", db, *flags)
            (found,) = map(json.loads, self.export(db, "objects").splitlines())
            return done.err, found

        said, apart = index("apart", {})
        self.assertIn("recorded apart", said)
        self.assertIn("telemetry.clock_sigma_apart_s", said)
        speed_m_s = metres_apart(first, last) / (last["time_s"] - first["time_s"])
        self.assertGreater(apart["ce90_m"], 1.6 * 2 * speed_m_s, "2 s of the flight")
        said, near = index("near", {"telemetry": {"clock_sigma_apart_s": 0.3}})
        self.assertIn("contain 0.3 s", said)
        self.assertLess(near["ce90_m"], apart["ce90_m"] / 2)
        said, exact = index("exact", {"telemetry": {"clock_sigma_s": 0}})
        self.assertNotIn("clock", said)
        self.assertLess(1.1 * exact["ce90_m"], near["ce90_m"])

    def test_without_gimbal_angles_one_line_names_the_flag_and_the_find_stays(self):
        done, objects = self.index(with_gimbal=False)
        self.assertEqual(len(objects), 1, done.err)
        self.assertIsNone(objects[0]["latitude_deg"])
        named = [line for line in done.messages() if "--nadir" in line]
        self.assertEqual(len(named), 1, done.err)


if __name__ == "__main__":
    program.main()
