"""`victorious telemetry` and `doctor` on telemetry: tables in and out, exit status, one-line errors for bad input."""

import csv
import gzip
import io
import json
import os
import unittest
from pathlib import Path

import program

HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"
ROWS = ["0,42,-71,100,10,-45,1,40", "0.1,42.0001,-71,101,11,-45,1,40"]
SUBTITLES = """1
00:00:00,000 --> 00:00:00,033
[focal_len: 24.00] [latitude: 49.3] [longitude: 15.0] [rel_alt: 43.2]

2
00:00:00,033 --> 00:00:00,066
[focal_len: 24.00] [latitude: 0.000000] [longitude: 0.000000] [rel_alt: 43.2]
"""
DATA = Path(os.environ.get("VICTORIOUS_DATA", program.REPOSITORY.parent / "shared" / "data"))
REFERENCE = DATA / "real" / "fmv_klv" / "kwiver_synthetic"
LABEL = bytes.fromhex("060e2b34020b01010e01030101000000")


def packet(items: bytes) -> bytes:
    body = LABEL + bytes([len(items) + 4]) + items + b"\x01\x02"
    total = sum(byte << (8 if place % 2 == 0 else 0) for place, byte in enumerate(body))
    return body + (total & 0xFFFF).to_bytes(2, "big")


def plain(value):
    """A value of the reference decoding without its explanation; None for sets and packs, which stay bytes."""
    if isinstance(value, dict):
        return value["value"] if set(value) == {"length", "value"} else value.get("integer")
    if isinstance(value, list):
        return value if all(isinstance(one, int) for one in value) else None
    return value


class TelemetryTest(program.ProgramTest):
    def rows(self, text: str) -> list[dict]:
        return list(csv.DictReader(io.StringIO(text)))

    def test_table_round_trips(self):
        table = self.write("a.csv", "\n".join([HEADER, *ROWS]) + "\n")
        done = self.succeeds("telemetry", table)
        self.assertEqual(done.messages(), [])
        for given, row in zip(csv.DictReader([HEADER, *ROWS]), self.rows(done.out), strict=True):
            for name, value in given.items():
                self.assertAlmostEqual(float(row[name]), float(value), places=6)
        self.succeeds("telemetry", table, "--out", self.scratch / "b.csv")
        self.assertEqual((self.scratch / "b.csv").read_text(), done.out)

    def test_damaged_in_part_is_used_with_a_warning(self):
        table = self.write("a.csv", "\n".join([HEADER, ROWS[0], "0.05,99,0,0,0,0,0,40", ROWS[1]]) + "\n")
        done = self.succeeds("telemetry", table)
        self.assertEqual(len(self.rows(done.out)), 2)
        self.assertIn("line 3 is skipped: latitude_deg", done.err)

    def test_subtitles_without_a_fix_give_no_row(self):
        done = self.succeeds("telemetry", self.write("a.SRT", SUBTITLES))
        rows = self.rows(done.out)
        self.assertEqual(len(rows), 1)
        self.assertEqual((rows[0]["vertical_datum"], rows[0]["yaw_deg"]), ("takeoff", ""))
        self.assertIn("1 of 2 subtitles", done.err)

    def test_take_off_height_by_parameter(self):
        params = self.write("p.json", '{"takeoff_altitude_m": 300, "hfov_deg": 60, "time_offset_s": 2}')
        rows = self.rows(self.succeeds("telemetry", self.write("a.SRT", SUBTITLES), "--params", params).out)
        self.assertEqual(rows[0]["vertical_datum"], "ellipsoid")
        self.assertAlmostEqual(float(rows[0]["altitude_m"]), 343.2)
        self.assertAlmostEqual(float(rows[0]["hfov_deg"]), 60)
        self.assertAlmostEqual(float(rows[0]["time_s"]), 2)

    def test_what_the_pilot_knows_completes_subtitles(self):
        cues = (
            f"{i + 1}\n00:00:0{i},000 --> 00:00:0{i + 1},000\nHOME(11.41,48.1) 2017.08.05 14:11:51\n"
            f"GPS(11.41,{48.1 + 1e-4 * i},16) BAROMETER:51.9\nISO:100 Shutter:60 EV: Fnum:2.2\n"
            for i in range(4)
        )
        subtitles = self.write("a.SRT", "\n".join(cues))
        (said,) = self.succeeds("telemetry", subtitles).messages()
        for flag in ("--nadir", "--camera", "--takeoff"):
            self.assertIn(flag, said)
        flags = ("--nadir", "--camera", "Mavic Pro", "--takeoff", "500")
        done = self.succeeds("telemetry", subtitles, *flags)
        self.assertEqual(done.messages(), [])
        row = self.rows(done.out)[0]
        self.assertEqual((row["vertical_datum"], float(row["pitch_deg"])), ("ellipsoid", -90))
        self.assertAlmostEqual(float(row["altitude_m"]), 551.9)
        self.assertAlmostEqual(float(row["hfov_deg"]), 66.6, delta=0.1)
        self.refuses(2, ["--camera", "phantom-9", "mavic-pro"], "telemetry", subtitles, "--camera", "phantom-9")
        self.refuses(2, ["--yaw", "give --pitch or --nadir"], "telemetry", subtitles, "--yaw", "90")

    def test_klv_items_by_number_and_name(self):
        good = packet(b"\x02\x08" + (1_000_000).to_bytes(8, "big") + b"\x05\x02\x71\xc2")
        bad = good[:-1] + bytes([good[-1] ^ 1])
        file = self.write("a.klv", good + b"noise" + bad + good[:20])
        done = self.succeeds("telemetry", file, "--json")
        report = json.loads(done.out)
        self.assertEqual([one["checksum"]["valid"] for one in report["packets"]], [True, False])
        item = report["packets"][0]["items"][1]
        self.assertEqual((item["number"], item["name"], item["unit"]), (5, "Platform Heading Angle", "deg"))
        self.assertAlmostEqual(item["value"], 159.974365, places=6)
        self.assertEqual(report["packets"][0]["precision_time_us"], 1_000_000)
        self.assertIn("1 of 2 KLV packets fail their checksum", done.err)
        self.assertEqual(report["states"], [])

    @unittest.skipUnless(REFERENCE.is_dir(), f"SKIPPED: no outside data at {REFERENCE}")
    def test_every_number_and_text_of_the_reference_decoding(self):
        report = json.loads(self.succeeds("telemetry", REFERENCE / "h264_klv.ts", "--json").out)
        with gzip.open(REFERENCE / "video_stream_klv.expected.json.gz") as file:
            reference = json.load(file)
        compared = 0
        for packet, known in zip(report["packets"], reference, strict=True):
            self.assertTrue(packet["checksum"]["valid"])
            items = {item["number"]: item["value"] for item in packet["items"] if item["number"] != 1}
            self.assertEqual(sorted(items), sorted(item["key"]["integer"] for item in known["value"]))
            for item in known["value"]:
                number, value = item["key"]["integer"], plain(item["value"])
                if value is None:
                    continue
                compared += 1
                if isinstance(value, float):
                    self.assertAlmostEqual(items[number], value, delta=1e-12 * max(1, abs(value)))
                else:
                    self.assertEqual(items[number], value, number)
        self.assertGreater(compared, 30 * 100)

    def test_nested_sets_are_reported_and_skipped(self):
        nested = b"\x30\x03\x01\x01\x02" + b"\x4a\x04\x05\x7f\x00\x00"  # one complete item, one with a wrong length
        file = self.write("a.klv", packet(b"\x02\x08" + (1_000_000).to_bytes(8, "big") + nested + b"\x05\x02\x71\xc2"))
        report = json.loads(self.succeeds("telemetry", file, "--json").out)
        self.assertEqual(report["nested_sets"], [{"number": 48, "name": "Security Local Set", "packets": 1},
                                                 {"number": 74, "name": "VMTI Local Set", "packets": 1}])
        items = {item["number"]: item for item in report["packets"][0]["items"]}
        self.assertEqual(items[48]["value"], {"hex": "010102"})
        self.assertIn("truncated at byte 0 of 4", items[74]["note"])
        self.assertAlmostEqual(items[5]["value"], 159.974365, places=6)
        self.assertIn("Security Local Set (48) in 1 packets, VMTI Local Set (74)", self.succeeds("doctor", file).out)

    def test_offset_of_the_clock(self):
        table = self.write("a.csv", "\n".join([HEADER, *(f"{i},42,-71,100,10,-45,1,40" for i in range(6))]) + "\n")
        video = program.flight() / "flight.mp4"
        done = self.succeeds("telemetry", table, "--video", video, "--estimate-offset")
        self.assertIn("unknown: ", done.out, "a camera that stands says nothing")
        report = json.loads(self.succeeds("telemetry", table, "--video", video, "--estimate-offset", "--json").out)
        self.assertIsNone(report["time_offset_s"])
        self.refuses(2, ["nothing to write"], "telemetry", table, "--video", video, "--estimate-offset", "--out",
                     self.scratch / "b.csv")
        self.assertFalse((self.scratch / "b.csv").exists())
        self.refuses(2, ["--video"], "telemetry", table, "--estimate-offset")
        self.refuses(2, ["--video", "--estimate-offset"], "telemetry", table, "--video", video)
        self.refuses(2, ["neither FILE"], "telemetry")
        self.refuses(2, ["no telemetry in the video or beside it"], "telemetry", "--video", video)

    def test_not_telemetry(self):
        self.refuses(2, ["gone.klv"], "telemetry", self.scratch / "gone.klv")
        self.refuses(2, ["empty.SRT", "empty"], "telemetry", self.write("empty.SRT", ""))
        self.refuses(2, ["a.csv", "time_s"], "telemetry", self.write("a.csv", "one,two\n1,2\n"))
        self.refuses(2, ["no telemetry"], "telemetry", program.flight() / "flight.mp4")
        self.refuses(2, ["takeoff_altitude"], "telemetry", self.write("b.csv", HEADER + "\n" + ROWS[0]), "--params",
                     self.write("p.json", '{"takeoff_altitude_m": 1e9}'))

    def test_doctor_names_missing_parts(self):
        text = self.succeeds("doctor", self.write("a.SRT", SUBTITLES)).out
        self.assertIn("DJI subtitles: 2 records, 1 camera states", text)
        self.assertIn("missing: the camera's attitude", text)
        self.assertIn("missing: heights above the ellipsoid", text)
        text = self.succeeds("doctor", program.flight() / "flight.mp4").out
        self.assertIn("impossible: no telemetry", text)

    def test_doctor_finds_files_beside_a_video(self):
        video = self.write("v.mp4", (program.flight() / "flight.mp4").read_bytes())
        self.write("v.mp4.telemetry.csv", "\n".join([HEADER, *ROWS]) + "\n")
        text = self.succeeds("doctor", video).out
        self.assertIn("telemetry beside the file", text)
        self.assertIn("complete for geolocation: all", text)


if __name__ == "__main__":
    program.main()
