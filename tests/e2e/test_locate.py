"""`locate`: lines of sight in a file, a place as text and as JSON."""

import json
import math
import unittest

import program

HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg"
KEYS = {
    "latitude_deg", "longitude_deg", "altitude_m", "place_time_s", "velocity_enu_m_s", "speed_m_s", "course_deg",
    "covariance_enu_m2", "velocity_covariance_enu_m2_s2", "ce90_m", "le90_m", "inliers", "status",
}  # fmt: skip
METRES_PER_DEGREE = 111_320  # about: of latitude, and of longitude at the equator


def lines(eastwards_m_s=0.0) -> str:
    """Eight cameras on the equator's circle about (0, 0), 300 m off and 200 m up; the object is at (0, 0) at 7 s."""
    rows = [HEADER]
    for i in range(8):
        angle = math.radians(45 * i)
        north, east = 300 * math.cos(angle), 300 * math.sin(angle)
        away_east = east - (i - 7) * eastwards_m_s
        azimuth = math.degrees(math.atan2(-away_east, -north))
        elevation = math.degrees(math.atan2(-200, math.hypot(away_east, north)))
        rows.append(f"{i},{north / 110_574},{east / METRES_PER_DEGREE},200,{azimuth},{elevation}")
    return "\n".join(rows) + "\n"


class LocateTest(program.ProgramTest):
    def located(self, content, *flags) -> dict:
        return json.loads(self.succeeds("locate", self.write("lines.csv", content), *flags, "--json").out)

    def test_a_place_with_its_error(self):
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
        self.assertIn("8 of 8 agree", said)

    def test_no_place_is_a_result(self):
        place = self.located(HEADER + "\n0,42,-71,100,10,-30\n")
        self.assertEqual(place["status"], "undetermined: one line of sight alone needs a range")
        self.assertEqual(place["inliers"], [False])
        for key in KEYS - {"status", "inliers"}:
            self.assertIsNone(place[key], key)

    def test_ground_and_params(self):
        one = HEADER + "\n0,0,0,100,0,-45\n"
        place = self.located(one, "--ground", "0")
        self.assertAlmostEqual(place["latitude_deg"] * METRES_PER_DEGREE, 100, delta=1)
        params = self.write("params.json", '{"ground_sigma_m": 0.1, "line": {"position_m": 0.1}}')
        self.assertLess(self.located(one, "--ground", "0", "--params", params)["le90_m"], place["le90_m"])

    def test_bad_input_is_one_line(self):
        good = lines()
        for content, words in {
            "": ["no lines of sight"],
            "time_s\n1\n": [":1: no column latitude_deg"],
            good + "8,91,0,200,0,-30\n": [":10: latitude_deg", "from -90 to 90"],
            good + "8,nan,0,200,0,-30\n": [":10: latitude_deg"],
            good + "8,0,0\n": [":10: no altitude_m"],
            b"\x00\xff\x00\n\x01": [":1: no column time_s"],
        }.items():
            path = self.write("bad.csv", content)
            self.refuses(2, [path, *words], "locate", path)
        path = self.write("lines.csv", good)
        self.refuses(2, "--ground", "locate", path, "--method", "ground")
        self.refuses(2, "guess", "locate", path, "--method", "guess")
        self.refuses(2, "none.csv", "locate", self.scratch / "none.csv")


if __name__ == "__main__":
    program.main()
