"""A run of the page in a real browser: page.mjs with the name of a scenario, beside a server over an index."""

import contextlib
import os
import shutil
import sqlite3
import struct
import subprocess
import unittest
from pathlib import Path

import program

SCRIPT = Path(__file__).with_name("page.mjs")
PAGE = Path(os.environ.get("VICTORIOUS_WEB", program.PROGRAM.parent / "web"))
MISSING = [
    what
    for what, is_there in (
        ("node", shutil.which("node")),
        ("/usr/bin/chromium", Path("/usr/bin/chromium").exists()),
        ("web/node_modules (tools/build_web.sh)", (program.REPOSITORY / "web/node_modules/playwright-core").exists()),
        (f"{PAGE} (tools/build_web.sh)", (PAGE / "index.html").exists()),
    )
    if not is_there
]


@unittest.skipIf(MISSING, f"not there: {', '.join(MISSING)}")
class PageTest(program.ProgramTest):
    def drive(self, scenario, db, *flags, inputs=(), cwd=None):
        with program.Server(db, "--web", PAGE, "--videos", program.flight(), *flags, cwd=cwd) as server:
            command = ["node", SCRIPT, scenario, server.url, *inputs]
            done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
        self.assertEqual(done.returncode, 0, f"{done.stdout}{done.stderr}{server.err}")
        return done.stdout

    def index(self, video, *flags):
        db = self.scratch / "index.db"
        self.succeeds("index", video, "--models", program.models(), "--db", db, *flags)
        return db

    def place_objects(self, db, video):
        """The drawn flight has no telemetry: gives each object a place, and the camera a path."""
        covariance = struct.pack("<9d", 4, 0, 0, 0, 9, 0, 0, 0, 4)
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            for i, (number,) in enumerate(index.execute("SELECT id FROM objects ORDER BY id").fetchall()):
                index.execute(
                    "UPDATE objects SET place_time_s = 1, latitude_rad = ?, longitude_rad = 0.234, altitude_m = 40,"
                    " covariance_enu_m2 = ?, ce90_m = 5, le90_m = 4 WHERE id = ?",
                    (0.9163 + 5e-6 * i, covariance, number),
                )
        self.write_telemetry(video, 52.4995)

    def write_telemetry(self, video, latitude):
        rows = [f"{time},{latitude + 1e-4 * time},13.407,140,0,-80,0,60" for time in range(10)]
        header = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"
        Path(f"{video}.telemetry.csv").write_text("\n".join([header, *rows]) + "\n")

    def draw_index(self, objects):
        """An index of drawn rows: of each object the number of its model ("common", "rare") and its score."""
        db = self.scratch / "index.db"
        db.touch()
        with program.Server(db):
            pass  # gives the empty file its tables
        covariance = struct.pack("<9d", 4, 0, 0, 0, 9, 0, 0, 0, 4)
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            index.execute(
                "INSERT INTO videos (id, content_id, name, width_px, height_px, frame_count, duration_s)"
                " VALUES (1, 'c', '/videos/none.mp4', 640, 480, 6000, 600)"
            )
            for number, name in enumerate(("common", "rare"), 1):
                index.execute("INSERT INTO models VALUES (?, ?, ?, 'cad')", (number, name, name))
            for number, (model, score) in enumerate(objects, 1):
                index.execute(
                    "INSERT INTO objects (id, model_id, place_time_s, latitude_rad, longitude_rad, altitude_m,"
                    " covariance_enu_m2, ce90_m, le90_m) VALUES (?, ?, 1, ?, ?, 40, ?, 5, 4)",
                    (number, model, 0.9 + 1e-6 * (number % 50), 0.2 + 2e-6 * (number // 50), covariance),
                )
                index.execute(
                    "INSERT INTO tracklets (id, object_id, video_id, model_id, score, frames, first_time_s, last_time_s)"
                    " VALUES (?, ?, 1, ?, ?, 1, ?, ?)",
                    (number, number, model, score, number / 10, number / 10),
                )
                index.execute(
                    "INSERT INTO sightings (video_id, frame, tracklet_id, time_s, box_x_px, box_y_px, box_width_px,"
                    " box_height_px, outline, score, source, matches, view_index, in_plane_rad)"
                    " VALUES (1, ?, ?, ?, 10, 10, 40, 40, x'', ?, 'recognised', 9, 0, 0)",
                    (number, number, number / 10, score),
                )
        return db
