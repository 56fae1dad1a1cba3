"""`locate`: from lines of sight in a file to a place as text and JSON."""

import json
import math
import struct
import unittest

import program

HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg"
KEYS = {
    "latitude_deg", "longitude_deg", "altitude_m", "place_time_s", "velocity_enu_m_s", "speed_m_s", "course_deg",
    "covariance_enu_m2", "velocity_covariance_enu_m2_s2", "ce90_m", "le90_m", "inliers", "status",
}  # fmt: skip
METRES_PER_DEGREE = 111_320  # approximate; of latitude, and of longitude at the equator


def lines(eastwards_m_s=0.0) -> str:
    """Eight cameras on a circle around (0, 0), at 300 m distance and 200 m height; the object is at (0, 0) at 7 s."""
    rows = [HEADER]
    for i in range(8):
        angle = math.radians(45 * i)
        north, east = 300 * math.cos(angle), 300 * math.sin(angle)
        away_east = east - (i - 7) * eastwards_m_s
        azimuth = math.degrees(math.atan2(-away_east, -north))
        elevation = math.degrees(math.atan2(-200, math.hypot(away_east, north)))
        rows.append(f"{i},{north / 110_574},{east / METRES_PER_DEGREE},200,{azimuth},{elevation}")
    return "\n".join(rows) + "\n"


def geotiff(width: int, step_deg: float, north_deg: float, rows: list[list[float]]) -> bytes:
    """Writes heights as a GeoTIFF in WGS 84, with the left edge at longitude 0; rows from north to south."""
    heights = b"".join(struct.pack(f"<{width}f", *row) for row in rows)
    scale = struct.pack("<3d", step_deg, step_deg, 0)
    tie = struct.pack("<6d", 0, 0, 0, 0, north_deg, 0)
    keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326)
    strips = len(rows)
    tags = 13
    after = 8 + 2 + 12 * tags + 4
    at = {}
    data = b""
    for name, block in (("scale", scale), ("tie", tie), ("keys", keys)):
        at[name] = after + len(data)
        data += block
    at["offsets"] = after + len(data)
    at["counts"] = at["offsets"] + 4 * strips
    at["heights"] = at["counts"] + 4 * strips
    data += struct.pack(f"<{strips}I", *(at["heights"] + 4 * width * i for i in range(strips)))
    data += struct.pack(f"<{strips}I", *([4 * width] * strips))
    short, long, double = 3, 4, 12
    entries = [
        (256, short, 1, width), (257, short, 1, len(rows)), (258, short, 1, 32), (259, short, 1, 1),
        (262, short, 1, 1), (273, long, strips, at["offsets"]), (277, short, 1, 1), (278, short, 1, 1),
        (279, long, strips, at["counts"]), (339, short, 1, 3), (33550, double, 3, at["scale"]),
        (33922, double, 6, at["tie"]), (34735, short, 16, at["keys"]),
    ]  # fmt: skip
    directory = struct.pack("<H", tags) + b"".join(struct.pack("<HHII", *entry) for entry in entries) + bytes(4)
    return b"II*\0" + struct.pack("<I", 8) + directory + data + heights


class LocateTest(program.ProgramTest):
    def located(self, content, *flags) -> dict:
        return json.loads(self.succeeds("locate", self.write("lines.csv", content), *flags, "--json").out)

    def test_place_with_its_error(self):
        for method in ("ml", "ransac", "prior", "least-squares"):
            place = self.located(lines(), "--method", method)
            self.assertEqual(set(place), KEYS)
            self.assertEqual(place["status"], "ok")
            self.assertLess(abs(place["latitude_deg"]) * METRES_PER_DEGREE, 0.5)
            self.assertLess(abs(place["longitude_deg"]) * METRES_PER_DEGREE, 0.5)
            self.assertLess(abs(place["altitude_m"]), 0.5)
            self.assertEqual(place["inliers"], [True] * 8)
            self.assertIsNone(place["velocity_enu_m_s"])
            self.assertEqual([len(row) for row in place["covariance_enu_m2"]], [3, 3, 3])
            self.assertAlmostEqual(place["le90_m"], 1.645 * math.sqrt(place["covariance_enu_m2"][2][2]), places=2)

    def test_motion(self):
        place = self.located(lines(eastwards_m_s=5), "--motion", "velocity")
        self.assertAlmostEqual(place["velocity_enu_m_s"][0], 5, delta=0.1)
        self.assertAlmostEqual(place["speed_m_s"], 5, delta=0.1)
        self.assertAlmostEqual(place["course_deg"], 90, delta=2)
        self.assertEqual(place["place_time_s"], 7)
        self.assertLess(abs(place["longitude_deg"]) * METRES_PER_DEGREE, 0.5)

    def test_text(self):
        path = self.write("lines.csv", lines())
        said = self.succeeds("locate", path).out
        self.assertRegex(said, r"CE90 [\d.]+ m, LE90 [\d.]+ m")
        self.assertIn("8 of 8 are inliers", said)

    def test_missing_place_is_a_result(self):
        place = self.located(HEADER + "\n0,42,-71,100,10,-30\n")
        self.assertEqual(place["status"], "undetermined: a single line of sight needs a range")
        self.assertEqual(place["inliers"], [False])
        for key in KEYS - {"status", "inliers"}:
            self.assertIsNone(place[key], key)

    def test_ground_and_params(self):
        one = HEADER + "\n0,0,0,100,0,-45\n"
        place = self.located(one, "--ground", "0")
        self.assertAlmostEqual(place["latitude_deg"] * METRES_PER_DEGREE, 100, delta=1)
        params = self.write("params.json", '{"ground_sigma_m": 0.1, "line": {"position_m": 0.1}}')
        self.assertLess(self.located(one, "--ground", "0", "--params", params)["le90_m"], place["le90_m"])

    def test_terrain(self):
        # A plain 20 m above the ellipsoid that ends at the equator with a ridge of 60 m.
        path = self.write("hill.tif", geotiff(100, 0.00001, 0.0005, [[60.0] * 100] * 40 + [[20.0] * 100] * 60))
        one = HEADER + "\n0,-0.0004,0.0005,100,0,{}\n"
        flags = ("--terrain", path, "--terrain-datum", "ellipsoid")
        down = self.located(one.format(-90), *flags)
        self.assertAlmostEqual(down["altitude_m"], 20, delta=0.01)
        north = self.located(one.format(-45), *flags)  # the ridge is 55 m away: 45 m above the ellipsoid there
        self.assertAlmostEqual(north["altitude_m"], 100 - (north["latitude_deg"] + 0.0004) * 110_574, delta=0.01)
        self.assertGreater(north["altitude_m"], 25)
        away = self.located(one.format(-20), *flags)
        self.assertEqual(away["status"].split(":")[0], "undetermined")

    def test_bad_terrain_is_one_line(self):
        lines_path = self.write("lines.csv", lines())
        hill = geotiff(100, 0.00001, 0.0005, [[20.0] * 100] * 100)
        path = self.write("hill.tif", hill)
        self.refuses(2, [path, "no vertical datum"], "locate", lines_path, "--terrain", path)
        self.refuses(2, "given twice", "locate", lines_path, "--terrain", path, "--ground", "0")
        self.refuses(2, "none.tif", "locate", lines_path, "--terrain", self.scratch / "none.tif")
        self.refuses(2, "mars", "locate", lines_path, "--terrain", path, "--terrain-datum", "mars")
        for content in (b"", b"II*\0", hill[:200], b"\x89PNG\r\n\x1a\n" + bytes(100)):
            path = self.write("bad.tif", content)
            self.refuses(2, path, "locate", lines_path, "--terrain", path, "--terrain-datum", "ellipsoid")
        # Half of the file exists: it is used, with a warning.
        path = self.write("half.tif", hill[: len(hill) // 2])
        outcome = self.succeeds("locate", lines_path, "--terrain", path, "--terrain-datum", "ellipsoid")
        self.assertIn("truncated", outcome.err)

    def test_bad_input_is_one_line(self):
        good = lines()
        for content, words in {
            "": ["no lines of sight"],
            "time_s\n1\n": [":1: no column latitude_deg"],
            good.splitlines()[0] + "\n8,91,0,200,0,-30\n": [":2: latitude_deg", "from -90 to 90"],
            b"\x00\xff\x00\n\x01": [":1: no column time_s"],
        }.items():
            path = self.write("bad.csv", content)
            self.refuses(2, [path, *words], "locate", path)
        for row, word in {"8,nan,0,200,0,-30": ":10: latitude_deg", "8,0,0": ":10: no altitude_m"}.items():
            path = self.write("partly.csv", good + row + "\n")
            done = self.succeeds("locate", path, "--json")
            self.assertIn(word, done.err)
            self.assertEqual(json.loads(done.out)["inliers"][8], False)
        path = self.write("lines.csv", good)
        self.refuses(2, "--ground", "locate", path, "--method", "ground")
        self.refuses(2, "guess", "locate", path, "--method", "guess")
        self.refuses(2, "none.csv", "locate", self.scratch / "none.csv")


if __name__ == "__main__":
    program.main()
