"""Exports of one video, read by decoders written here, from the standards: VMTI, CVAT, WebVTT."""

import contextlib
import json
import math
import re
import sqlite3
import struct
import xml.etree.ElementTree as ElementTree

import program

START_US = 1_700_000_000_000_000
LABEL = bytes.fromhex("060E2B34020B01010E01030101000000")  # of MISB ST 0601
COVARIANCE = (4, 1, 0, 1, 1, 0, 0, 0, 0.25)


class Reader:
    """Bytes of KLV from the front."""

    def __init__(self, data: bytes):
        self.data = data

    def take(self, count: int) -> bytes:
        assert count <= len(self.data), "cut off"
        taken, self.data = self.data[:count], self.data[count:]
        return taken

    def length(self) -> int:
        first = self.take(1)[0]
        return first if first < 0x80 else int.from_bytes(self.take(first & 0x7F), "big")

    def identifier(self) -> int:
        number = 0
        while True:
            byte = self.take(1)[0]
            number = number << 7 | byte & 0x7F
            if byte < 0x80:
                return number

    def items(self) -> dict[int, bytes]:
        found = {}
        while self.data:
            number = self.identifier()
            found[number] = self.take(self.length())
        return found


def real(data: bytes, low: float, high: float) -> float:
    """Mapping B of MISB ST 1201."""
    scale = 2.0 ** (8 * len(data) - 1 - math.ceil(math.log2(high - low)))
    offset = scale * low - math.floor(scale * low) if low < 0 < high else 0
    return (int.from_bytes(data, "big") - offset) / scale + low


def packets(data: bytes):
    """The items of each packet, whose checksum is right."""
    stream = Reader(data)
    while stream.data:
        before = stream.data
        assert stream.take(16) == LABEL
        items = Reader(stream.take(stream.length())).items()
        packet = before[: len(before) - len(stream.data)]
        checksum = sum(byte << 8 if index % 2 == 0 else byte for index, byte in enumerate(packet[:-2])) & 0xFFFF
        assert int.from_bytes(items[1], "big") == checksum
        yield items


def targets(vmti: dict[int, bytes]):
    """The targets of a VMTI set: id and items."""
    series = Reader(vmti[101])
    while series.data:
        pack = Reader(series.take(series.length()))
        yield pack.identifier(), pack.items()


class VideoFormatsTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.db = self.write("index.db", program.index().read_bytes())
        with contextlib.closing(sqlite3.connect(self.db)) as index, index:
            index.execute("UPDATE videos SET start_utc_us = ?", (START_US,))
            index.execute(
                "UPDATE objects SET place_time_s = 1, latitude_rad = 0.9163 + 5e-6 * id, longitude_rad = -0.234,"
                " altitude_m = 40, covariance_enu_m2 = ?, ce90_m = 4, le90_m = 1",
                (struct.pack("<9d", *COVARIANCE),),
            )
        self.sightings = [json.loads(line) for line in self.export(self.db, "sightings").splitlines()]
        self.objects = {row["object_id"]: row for row in map(json.loads, self.export(self.db, "objects").splitlines())}

    def test_vmti_equals_the_sightings(self):
        out = self.scratch / "targets.klv"
        self.succeeds("export", "--db", self.db, "--format", "vmti", "--out", out)
        found = []
        for items in packets(out.read_bytes()):
            vmti = Reader(items[74]).items()
            width, height = (int.from_bytes(vmti[item], "big") for item in (8, 9))
            self.assertEqual(int.from_bytes(vmti[6], "big"), len(list(targets(vmti))))
            for identifier, target in targets(vmti):
                found.append((int.from_bytes(vmti[7], "big"), identifier))
                row = next(row for row in self.sightings if (row["frame"], row["object_id"]) == found[-1])
                self.assertAlmostEqual(int.from_bytes(items[2], "big"), START_US + row["time_s"] * 1e6, delta=1)
                first, last = (divmod(int.from_bytes(target[item], "big") - 1, width) for item in (2, 3))
                x, y, w, h = row["box"]
                self.assertAlmostEqual(first[1], max(x, 0), delta=1)
                self.assertAlmostEqual(first[0], max(y, 0), delta=1)
                self.assertAlmostEqual(last[1], min(x + w, width) - 1, delta=1)
                self.assertAlmostEqual(last[0], min(y + h, height) - 1, delta=1)
                self.assertAlmostEqual(target[5][0], 100 * row["score"], delta=0.6)
                self.assertEqual(Reader(target[102]).items()[2].decode(), row["model"])
                self.check_place(Reader(target[17]), self.objects[identifier])
        self.assertEqual(sorted(found), sorted((row["frame"], row["object_id"]) for row in self.sightings))

    def check_place(self, pack: Reader, row: dict):
        self.assertAlmostEqual(real(pack.take(4), -90, 90), row["latitude_deg"], delta=2e-7)
        self.assertAlmostEqual(real(pack.take(4), -180, 180), row["longitude_deg"], delta=3e-7)
        self.assertAlmostEqual(real(pack.take(2), -900, 19000), row["altitude_m"], delta=1)
        self.assertEqual([round(real(pack.take(2), 0, 650), 1) for _ in range(3)], [2, 1, 0.5])
        self.assertEqual([round(real(pack.take(2), -1, 1), 3) for _ in range(3)], [0.5, 0, 0])

    def test_vmti_needs_utc_and_replaces_no_telemetry(self):
        telemetry = self.write("flight.klv", LABEL + bytes([14]) + bytes(14))
        export = ("export", "--db", self.db, "--format", "vmti")
        self.refuses(2, ["flight.klv", "--force"], *export, "--out", telemetry)
        with contextlib.closing(sqlite3.connect(self.db)) as index, index:
            index.execute("UPDATE videos SET start_utc_us = NULL")
        self.refuses(2, ["UTC", "telemetry"], *export)

    def test_cvat_has_a_track_of_each_object(self):
        root = ElementTree.fromstring(self.export(self.db, "cvat"))
        seen = {(int(track.get("id")), int(box.get("frame"))): [float(box.get(key)) for key in ("xtl", "ytl", "xbr", "ybr")]
                for track in root.iter("track") for box in track if box.get("outside") == "0"}  # fmt: skip
        self.assertEqual(seen.keys(), {(row["object_id"], row["frame"]) for row in self.sightings})
        for row in self.sightings:
            x, y, w, h = row["box"]
            for value, expected in zip(seen[row["object_id"], row["frame"]], (x, y, x + w, y + h), strict=True):
                self.assertAlmostEqual(value, expected, delta=0.02)
        labels = {track.get("label") for track in root.iter("track")}
        self.assertLessEqual(labels, {label.text for label in root.iterfind("meta/task/labels/label/name")})

    def test_webvtt_covers_the_times_of_each_object(self):
        text = self.export(self.db, "vtt")
        self.assertTrue(text.startswith("WEBVTT - victorious\n\n"))
        cues = re.findall(r"(?m)^(\d\d):(\d\d):(\d\d\.\d{3}) --> (\d\d):(\d\d):(\d\d\.\d{3})\n(\S+) (\d+), score", text)
        for identifier, row in self.objects.items():
            mine = [[int(cue[k]) * 3600 + int(cue[k + 1]) * 60 + float(cue[k + 2]) for k in (0, 3)] for cue in cues
                    if int(cue[7]) == identifier]  # fmt: skip
            self.assertAlmostEqual(min(begin for begin, _ in mine), row["first_time_s"], delta=1e-3)
            self.assertGreaterEqual(max(end for _, end in mine), row["last_time_s"] - 1e-3)


if __name__ == "__main__":
    program.main()
