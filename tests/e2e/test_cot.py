"""`export --format cot`: events that a strict XML parser reads, whatever the names are, and that a socket takes."""

import contextlib
import datetime
import json
import sqlite3
import struct
import xml.etree.ElementTree as ElementTree

import program

HOSTILE = "<car & \"van\" '>]]>\n\x01\tü"


class CotTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.db = self.write("index.db", program.index().read_bytes())
        covariance = struct.pack("<9d", 4, 0, 0, 0, 4, 0, 0, 0, 9)
        with contextlib.closing(sqlite3.connect(self.db)) as index, index:
            index.execute(
                "UPDATE objects SET place_time_s = 1, latitude_rad = 0.9163 + 5e-6 * id, longitude_rad = -0.234,"
                " altitude_m = 40, covariance_enu_m2 = ?, ce90_m = 4.2919, le90_m = 4.93",
                (covariance,),
            )
            index.execute("UPDATE models SET name = ? WHERE name = 'crate'", (HOSTILE,))

    def test_events_equal_the_objects(self):
        lines = self.export(self.db, "cot").splitlines()
        rows = [json.loads(line) for line in self.export(self.db, "objects").splitlines()]
        self.assertEqual(len(lines), len(rows), "one line each")
        self.assertIn(HOSTILE, [row["model"] for row in rows])
        for line, row in zip(lines, rows, strict=True):
            event = ElementTree.fromstring(line)
            self.assertEqual((event.tag, event.get("version")), ("event", "2.0"))
            point = {name: float(value) for name, value in event.find("point").attrib.items()}
            self.assertAlmostEqual(point["lat"], row["latitude_deg"], delta=1e-8)
            self.assertAlmostEqual(point["lon"], row["longitude_deg"], delta=1e-8)
            self.assertEqual((point["hae"], point["ce"], point["le"]), (40, 2, 3))
            name = row["model"].replace("\x01", "")
            self.assertEqual(event.find("detail/contact").get("callsign"), f"{name} {row['object_id']}")
            start, stale = (datetime.datetime.fromisoformat(event.get(key)) for key in ("start", "stale"))
            self.assertLess(start, stale)
        kinds = {row["model"]: ElementTree.fromstring(line).get("type") for line, row in zip(lines, rows)}
        self.assertEqual(kinds[HOSTILE], "a-u-G-E-V-C")
        self.assertEqual(kinds["truck"], "a-u-G-E-V")
        ids = [ElementTree.fromstring(line).get("uid") for line in lines]
        self.assertEqual(len(set(ids)), len(ids))
        self.assertEqual([ElementTree.fromstring(line).get("uid") for line in self.export(self.db, "cot").splitlines()], ids)

    def test_type_is_given(self):
        out = self.scratch / "events.cot"
        self.succeeds("export", "--db", self.db, "--format", "cot", "--model", "truck", "--cot-type", "a-n-G", "--out", out)
        self.assertEqual({ElementTree.fromstring(line).get("type") for line in out.read_text().splitlines()}, {"a-n-G"})
        self.succeeds("export", "--db", self.db, "--format", "cot", "--out", out)  # a file of its own kind
        export = ("export", "--db", self.db, "--format")
        self.refuses(2, ["--cot-type", "cot"], *export, "kml", "--cot-type", "a-n-G")
        self.refuses(2, ["a-h-G-E-V"], *export, "cot", "--cot-type", 'a"><')


if __name__ == "__main__":
    program.main()
