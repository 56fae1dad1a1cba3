"""`navigate`: camera poses from landmarks, in a small flight over textured roofs."""

import csv
import functools
import json
import math
from pathlib import Path

import program
from test_cad import FEW_VIEWS, png, roof_obj

ROOFS = {"red": (-7, 2), "green": (0, -3), "blue": (8, 3), "grey": (14, -3)}  # metres to the right and ahead
LATITUDE_DEG, LONGITUDE_DEG = 47.0, 8.0
METRES_PER_DEGREE = 111_320  # approximate; of latitude
HFOV_DEG = 24
COLUMNS = {
    "time_s", "latitude_deg", "longitude_deg", "altitude_m", "yaw_deg", "pitch_deg", "roll_deg", "hfov_deg",
    "sigma_position_m", "sigma_attitude_deg", "vertical_datum", "landmarks",
    *(f"covariance_{axes}_m2" for axes in ("east_east", "east_north", "east_up", "north_north", "north_up", "up_up")),
}  # fmt: skip
OFFSETS = {
    *(f"offset_{axis}_m" for axis in ("east", "north", "up")),
    *(f"offset_{axis}_deg" for axis in ("yaw", "pitch", "roll")),
}


@functools.cache
def flight() -> Path:
    """A folder with video.mp4, telemetry.csv, truth.jsonl and models/. Read-only."""
    folder = program.folder_until_exit()
    for seed, name in enumerate(ROOFS):
        (folder / f"{name}.mtl").write_text(f"newmtl roof\nKd 1 1 1\nmap_Kd {name}.png\n")
        (folder / f"{name}.png").write_bytes(png(160, 80, seed))
        (folder / f"{name}.obj").write_text(roof_obj(6, 3).replace("roof.mtl", f"{name}.mtl"))
    scene = {
        "video": {"frames": 16, "fps": 8, "width": 480, "height": 360, "hfov_deg": HFOV_DEG},
        "origin": {"latitude_deg": LATITUDE_DEG, "longitude_deg": LONGITUDE_DEG, "altitude_m": 400},
        "camera": {"aim_m": [[-3, 0], [9, 1]], "from_deg": 180, "off_nadir_deg": 8, "range_m": 60},
        "objects": [
            {"id": name, "model": name, "file": f"{name}.obj", "x_m": x, "y_m": y, "z_m": 1, "heading_deg": 20 * x}
            for name, (x, y) in ROOFS.items()
        ],
        "town": {"squares": [0, 0, 0, 0], "density": 0},
        "assets": str(program.REPOSITORY / "assets"),
    }
    (folder / "scene.json").write_text(json.dumps(scene))
    for arguments in (
        ("simulate", folder / "scene.json", "--out", folder),
        *(("model", "add", name, folder / f"{name}.obj", "--models", folder / "models", *FEW_VIEWS) for name in ROOFS),
    ):
        done = program.run(*arguments)
        assert done.status == 0, done.err
    return folder


def true_landmarks() -> list[dict]:
    rows = map(json.loads, (flight() / "truth.jsonl").read_text().splitlines())
    keys = ("model", "latitude_deg", "longitude_deg", "altitude_m", "heading_deg")
    return list({row["object"]: {key: row[key] for key in keys} for row in rows}.values())


def off_telemetry(folder: Path, east_m: float = 8, later_s: float = 0) -> Path:
    """Telemetry with an error of the given distance east, 5 m up and 2 degrees of yaw."""
    rows = table(flight() / "telemetry.csv")
    east_deg = east_m / METRES_PER_DEGREE / math.cos(math.radians(LATITUDE_DEG))
    lines = [",".join(rows[0])]
    for row in rows:
        off = row | {
            "time_s": float(row["time_s"]) + later_s,
            "longitude_deg": float(row["longitude_deg"]) + east_deg,
            "altitude_m": float(row["altitude_m"]) + 5,
            "yaw_deg": float(row["yaw_deg"]) + 2,
        }
        lines.append(",".join(map(str, off.values())))
    path = folder / f"off-{east_m}-{later_s}.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


@functools.cache
def navigated(is_off: bool) -> tuple[program.Outcome, Path]:
    """The run with all landmarks and the flight's telemetry, or with that telemetry off: its outcome and its output."""
    folder = program.folder_until_exit()
    telemetry = off_telemetry(folder) if is_off else flight() / "telemetry.csv"
    landmarks, out = folder / "landmarks.jsonl", folder / "camera.csv"
    landmarks.write_text("".join(json.dumps(landmark) + "\n" for landmark in true_landmarks()))
    flags = ("--landmarks", landmarks, "--models", flight() / "models", "--telemetry", telemetry, "--out", out)
    done = program.run("navigate", flight() / "video.mp4", *flags)
    assert done.status == 0, done.err
    return done, out


def table(path: Path) -> list[dict]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def apart_m(row: dict, other: dict) -> float:
    north = (float(row["latitude_deg"]) - float(other["latitude_deg"])) * METRES_PER_DEGREE
    east = (float(row["longitude_deg"]) - float(other["longitude_deg"])) * METRES_PER_DEGREE
    east *= math.cos(math.radians(LATITUDE_DEG))
    return math.hypot(east, north, float(row["altitude_m"]) - float(other["altitude_m"]))


class NavigateTest(program.ProgramTest):
    def list_of(self, landmarks: list[dict]) -> Path:
        return self.write("landmarks.jsonl", "".join(json.dumps(landmark) + "\n" for landmark in landmarks))

    def navigate(self, landmarks: list[dict], *flags) -> list[dict]:
        out = self.scratch / "camera.csv"
        arguments = ("--landmarks", self.list_of(landmarks), "--models", flight() / "models", "--out", out)
        done = self.succeeds("navigate", flight() / "video.mp4", *arguments, *flags)
        self.assertEqual(done.out, "")
        return table(out)

    def off_telemetry(self, east_m: float = 8, later_s: float = 0) -> Path:
        return off_telemetry(self.scratch, east_m, later_s)

    def errors(self, rows: list[dict]) -> list[float]:
        truth = table(flight() / "telemetry.csv")
        self.assertEqual(len(rows), len(truth))
        return sorted(apart_m(row, true) for row, true in zip(rows, truth))

    def test_telemetry_offset_is_corrected(self):
        done, out = navigated(is_off=True)
        self.assertEqual(done.out, "")
        rows = table(out)
        self.assertEqual(set(rows[0]), COLUMNS | OFFSETS)
        errors = self.errors(rows)
        self.assertLess(errors[len(errors) // 2], 1)
        self.assertLess(errors[-1], 3)
        middle = rows[len(rows) // 2]
        self.assertGreaterEqual(int(middle["landmarks"]), 2)
        self.assertAlmostEqual(float(middle["offset_east_m"]), 8, delta=1)
        self.assertAlmostEqual(float(middle["offset_up_m"]), 5, delta=1)
        self.assertLess(float(middle["sigma_position_m"]), 2)

    def test_without_telemetry(self):
        rows = self.navigate(true_landmarks(), "--hfov", HFOV_DEG)
        self.assertEqual(set(rows[0]), COLUMNS)
        errors = self.errors(rows)
        self.assertLess(errors[len(errors) // 2], 1.5)
        self.assertEqual(float(rows[0]["hfov_deg"]), HFOV_DEG)
        # The output is valid telemetry.
        read = self.succeeds("telemetry", self.scratch / "camera.csv").out
        self.assertEqual(len(read.splitlines()), len(rows) + 1)

    def test_wrong_telemetry_causes_a_second_pass(self):
        params = self.write("once.json", '{"second_pass": false}')
        once = (
            "--landmarks", self.list_of(true_landmarks()), "--models", flight() / "models", "--params", params,
            "--telemetry", self.off_telemetry(), "--out", self.scratch / "camera.csv",
        )  # fmt: skip
        for said, passes in (
            (navigated(is_off=False)[0].err, 1),
            (navigated(is_off=True)[0].err, 2),
            (self.succeeds("navigate", flight() / "video.mp4", *once).err, 1),
        ):
            self.assertEqual(said.count("16 of 16 frames"), passes, said)

    def test_telemetry_without_attitudes_causes_a_second_pass(self):
        rows = table(flight() / "telemetry.csv")
        none = dict.fromkeys(("yaw_deg", "pitch_deg", "roll_deg", "sigma_attitude_deg"), "")
        positions = self.write(
            "positions.csv", "\n".join([",".join(rows[0]), *(",".join((row | none).values()) for row in rows)]) + "\n"
        )
        given = ("--landmarks", self.list_of(true_landmarks()), "--models", flight() / "models", "--telemetry", positions)
        done = self.succeeds("navigate", flight() / "video.mp4", *given, "--out", self.scratch / "camera.csv")
        self.assertEqual(done.err.count("16 of 16 frames"), 2, done.err)
        self.assertLess(self.errors(table(self.scratch / "camera.csv"))[-1], 3)

    def test_telemetry_of_another_video_is_reported(self):
        self.assertNotIn("warning: ", navigated(is_off=False)[0].err)
        landmarks, out = self.list_of(true_landmarks()), self.scratch / "camera.csv"
        for telemetry, words in (
            (self.off_telemetry(3000), " m from the position estimated from landmarks"),
            (self.off_telemetry(0, 1000), "it covers 1000.00 to"),
        ):
            given = ("--landmarks", landmarks, "--models", flight() / "models", "--telemetry", telemetry, "--out", out)
            said = self.succeeds("navigate", flight() / "video.mp4", *given).messages()
            warnings = [line for line in said if line.startswith("warning: ")]
            self.assertEqual(len(warnings), 1, said)
            self.assertIn(words, warnings[0])

    def test_wrong_landmark_is_rejected(self):
        landmarks = true_landmarks()
        wrong = next(landmark for landmark in landmarks if landmark["model"] == "green")
        wrong["latitude_deg"] += 50 / METRES_PER_DEGREE
        for flags in (("--hfov", HFOV_DEG), ("--telemetry", self.off_telemetry())):
            errors = self.errors(self.navigate(landmarks, *flags))
            self.assertLess(errors[len(errors) // 2], 1.5, flags)

    def test_index_gives_landmarks(self):
        db = self.scratch / "index.db"
        video, models = flight() / "video.mp4", flight() / "models"
        self.succeeds("index", video, "--telemetry", flight() / "telemetry.csv", "--models", models, "--db", db)
        out = self.scratch / "camera.csv"
        self.succeeds("navigate", video, "--landmarks", db, "--models", models, "--out", out, "--hfov", HFOV_DEG)
        errors = self.errors(table(out))
        self.assertLess(errors[len(errors) // 2], 3)

    def test_without_sightings_is_unknown(self):
        landmarks = true_landmarks()[:1]
        grey = program.plain_image(self.scratch / "grey.ppm")
        out = self.scratch / "camera.csv"
        flags = ("--landmarks", self.list_of(landmarks), "--models", flight() / "models", "--out", out, "--hfov", "20")
        done = self.succeeds("navigate", grey, *flags, "--json")
        self.assertIn("the camera position is unknown", done.err)
        (report,) = done.rows()
        self.assertEqual((report["out"], report["frames"], report["frames_with_landmark"]), (str(out), 1, 0))
        self.assertIn("no landmark recognised", report["status"])
        self.assertEqual([(one["model"], one["frames"]) for one in report["landmarks"]], [(landmarks[0]["model"], 0)])
        self.assertEqual(set(out.read_text().strip().split(",")), COLUMNS)  # only the header


class BadInputTest(program.ProgramTest):
    def refuses_with(self, words, landmarks, *flags) -> None:
        out = self.scratch / "camera.csv"
        arguments = ("--landmarks", landmarks, "--models", flight() / "models", "--out", out)
        self.refuses(2, words, "navigate", flight() / "video.mp4", *arguments, *flags)
        self.assertFalse(out.exists())

    def list_of(self, *changes: dict) -> Path:
        lines = [json.dumps(true_landmarks()[0] | change) for change in changes]
        return self.write("landmarks.jsonl", "\n".join(lines) + "\n")

    def test_bad_lists(self):
        hfov = ("--hfov", "20")
        self.refuses_with("missing.db", self.scratch / "missing.db", *hfov)
        self.refuses_with("empty.db", self.write("empty.db", ""), *hfov)
        self.refuses_with("line 1", self.write("list.jsonl", "{]\n"), *hfov)
        self.refuses_with("latitude_deg", self.list_of({"latitude_deg": 91}), *hfov)
        self.refuses_with("moves", self.list_of({"speed_m_s": 12}), *hfov)
        self.refuses_with("cut.db", self.write("cut.db", "SQLite format 3\0" + "x" * 84), *hfov)

    def test_unwritable_output_is_reported_before_the_search(self):
        flags = ("--models", flight() / "models", "--hfov", "20", "--out", self.scratch / "absent" / "camera.csv")
        self.refuses(2, "absent", "navigate", "missing.mp4", "--landmarks", self.list_of({}), *flags)

    def test_no_field_of_view(self):
        self.refuses_with("--hfov", self.list_of({}))

    def test_unknown_model(self):
        self.refuses_with(["zeppelin", "model add"], self.list_of({"model": "zeppelin"}), "--hfov", "20")

    def test_bad_telemetry(self):
        self.refuses_with("off.csv", self.list_of({}), "--telemetry", self.write("off.csv", "no table\n"))

    def test_bad_lines_among_good_ones_are_reported(self):
        landmarks = self.list_of({}, {"altitude_m": "high"}, {"model": "zeppelin"})
        out = self.scratch / "camera.csv"
        grey = program.plain_image(self.scratch / "grey.ppm")
        done = self.succeeds(
            "navigate", grey, "--landmarks", landmarks, "--models", flight() / "models", "--out", out, "--hfov", "20"
        )
        self.assertIn("line 2 is skipped", done.err)
        self.assertIn("zeppelin", done.err)


if __name__ == "__main__":
    program.main()
