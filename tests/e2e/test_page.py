"""The page in a real browser (page.mjs): triage by mouse and keys; box and frame belong together."""

import contextlib
import json
import os
import shutil
import sqlite3
import struct
import subprocess
import unittest
from pathlib import Path

import program
import streams
import tiles
from test_postgres import Postgres

SCRIPT = Path(__file__).with_name("page.mjs")
DRAW_NUMBERS = program.path_from_environment("VICTORIOUS_DRAW_NUMBERS")
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
    def drive(self, scenario, db, *flags, inputs=()):
        with program.Server(db, "--web", PAGE, *flags) as server:
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

    def test_triage(self):
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        db = self.index(video)
        self.place_objects(db, video)
        self.drive("triage", db, "--models", program.models())

    def test_links(self):
        """A link finds its object after a new search from nothing, which gives it another id."""
        db = self.index(program.flight() / "flight.mp4")
        before = self.drive("link", db)
        self.index(program.flight() / "flight.mp4", "--redo")
        self.drive("link", db, inputs=(json.loads(before)["link"], before))

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

    def test_accessible(self):
        """axe finds nothing in the main states."""
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        db = self.index(video)
        self.place_objects(db, video)
        models = self.scratch / "models"
        shutil.copytree(program.models(), models)
        self.drive("accessible", db, "--models", models)

    def test_tablet(self):
        """Narrow windows, and a laptop's at 200 %."""
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        db = self.index(video)
        self.place_objects(db, video)
        self.drive("narrow", db, "--models", program.models())

    def test_videos(self):
        """Three videos of one flight: the second one looks at ground in the north of the first, the third has no telemetry."""
        videos = [self.scratch / name for name in ("one.mp4", "two.mp4", "three.mp4")]
        for number, video in enumerate(videos):
            video.write_bytes((program.flight() / "flight.mp4").read_bytes() + bytes(number))
        for video in videos:
            db = self.index(video)
        self.write_telemetry(videos[1], 52.501)
        self.index(videos[1])  # what its camera shows is known from then on
        self.place_objects(db, videos[0])
        self.drive("videos", db, "--models", program.models())

    def test_live_sources(self):
        """A transport stream by UDP, RTSP and SRT, sent as it would be filmed."""
        flight = program.flight(300)
        for kind in (streams.Udp, streams.Rtsp, streams.Srt):
            with self.subTest(kind.__name__), kind(flight / "flight.ts", seconds=120) as source:
                db = self.scratch / f"{kind.__name__}.db"
                db.touch()
                self.drive("live", db, "--models", program.models(), inputs=(source,))

    def test_many_objects(self):
        """3000 drawn rows: ten are of the model "rare"."""
        self.drive("many", self.draw_index([(2 if n % 300 == 7 else 1, 1 - n / 3100) for n in range(1, 3001)]))

    def test_thresholds(self):
        """Twenty objects of "common" with scores from 0.99 down to 0.04, four of "rare"."""
        self.drive("thresholds", self.draw_index([*((1, 0.99 - 0.05 * n) for n in range(20)), *((2, 0.1 * n) for n in range(1, 5))]))

    def test_base_map(self):
        """Tiles of a server on another port, of a PMTiles file with images, and of one with vectors."""
        db = self.draw_index([(1, 0.9)])
        colour = (220, 40, 90)
        address = "{z}/{x}/{y}.png"
        with tiles.Server(tiles.png(*colour)) as origin:
            self.drive(
                "tiles", db, "--tiles", f"{origin}/{address}", "--tiles-attribution", "© the test",
                inputs=(json.dumps({"colour": colour, "attribution": "© the test", "origin": origin}),),
            )
        images = self.write("images.pmtiles", tiles.pmtiles(tiles.png(*colour), tiles.PNG, {"attribution": "<b>&copy; images</b>"}))
        self.drive("tiles", db, "--tiles", images, inputs=(json.dumps({"colour": colour, "attribution": "© images"}),))
        layers = [{"id": "water", "fields": {}}, {"id": "places", "fields": {}}]
        vectors = self.write("vectors.pmtiles", tiles.pmtiles(tiles.square("water"), tiles.VECTOR, {"vector_layers": layers}))
        self.drive("tiles", db, "--tiles", vectors, inputs=(json.dumps({"colour": (0xC9, 0xDC, 0xEA), "attribution": ""}),))

    def test_turning_model(self):
        """A CAD model of 25 views beside photos; two drawn objects of it, the first matched two of its views."""
        models = self.scratch / "models"
        shutil.copytree(program.models(), models)
        cad = program.REPOSITORY / "assets" / "models" / "jeep.glb"
        self.succeeds("model", "add", "jeep", cad, "--models", models, "--step", "30", "--max-off-nadir", "60")
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        db = self.scratch / "index.db"
        self.succeeds("index", video, "--models", models, "--db", db)
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            ((model, width),) = index.execute(
                "SELECT m.id, v.width_px FROM models m, videos v WHERE m.name = 'jeep'"
            ).fetchall()
            for number, score, seen in ((9001, 0.999, ((3, 7, 40), (5, 8, 30))), (9002, 0.998, ((9, 20, 25),))):
                index.execute("INSERT INTO objects (id, model_id) VALUES (?, ?)", (number, model))
                index.execute(
                    "INSERT INTO tracklets (id, object_id, video_id, model_id, score, frames, first_time_s, last_time_s)"
                    " VALUES (?, ?, 1, ?, ?, ?, ?, ?)",
                    (number, number, model, score, len(seen), seen[0][0] / 10, seen[-1][0] / 10),
                )
                for frame, view, matches in seen:
                    index.execute(
                        "INSERT INTO sightings (video_id, frame, tracklet_id, time_s, box_x_px, box_y_px, box_width_px,"
                        " box_height_px, outline, score, source, matches, view_index, in_plane_rad)"
                        " VALUES (1, ?, ?, ?, 10, 10, ?, 40, x'', ?, 'recognised', ?, ?, 0)",
                        (frame, number, frame / 10, width / 4, score, matches, view),
                    )
        self.drive("turning", db, "--models", models)

    def test_jobs(self):
        db, models = self.scratch / "index.db", self.scratch / "models"
        db.touch()
        models.mkdir()
        photos = ",".join(str(program.flight() / f"{name}.png") for name in ("crate", "truck"))
        self.drive("jobs", db, "--models", models, inputs=(photos, program.flight() / "flight.mp4"))

    def test_workers(self):
        """Two videos that wait, one that is gone; then a worker takes them."""
        videos = [self.scratch / "flight.mp4", self.scratch / "gone.mp4"]
        for video in videos:
            shutil.copy(program.flight() / "flight.mp4", video)
        gone = videos[1].open("ab")
        gone.write(b"another content")
        gone.close()
        with Postgres() as server:
            self.succeeds("submit", *videos, "--models", program.models(), "--db", server.url)
            videos[1].unlink()
            self.drive("workers", server.url, "--models", program.models(), inputs=(program.PROGRAM, server.url))

    def test_tabs(self):
        self.drive("tabs", self.index(program.flight() / "flight.mp4"))

    def test_accounts(self):
        db = self.index(program.flight() / "flight.mp4")
        password = "correct horse battery"
        for name, role in (("ann", "analyst"), ("bob", "viewer")):
            self.succeeds("user", "add", name, "--role", role, "--db", db, input=password)
        self.drive("accounts", db, "--models", program.models(), inputs=(password,))

    def test_overlay_belongs_to_its_frame(self):
        """At a varying rate with B-frames; with an edit list that leaves out the first frames."""
        for name in ("numbers.mp4", "numbers.edit.mp4"):
            with self.subTest(name):
                video = self.scratch / name
                subprocess.run([DRAW_NUMBERS, video], check=True)
                db = self.scratch / f"{name}.db"
                self.succeeds("index", video, "--models", program.models(), "--db", db)
                self.drive("frames", db)

    def test_copies_show_the_same_frames(self):
        """Remuxed (H.264 in MPEG-TS) and encoded again (MPEG-1)."""
        for name in ("numbers.ts", "numbers.mpg"):
            with self.subTest(name):
                video = self.scratch / name
                subprocess.run([DRAW_NUMBERS, video], check=True)
                db = self.scratch / f"{name}.db"
                self.succeeds("index", video, "--models", program.models(), "--db", db)
                self.drive("copies", db, "--models", program.models())

    def test_shows_a_format_that_the_browser_cannot_play(self):
        video = self.scratch / "frames"
        video.mkdir()
        for name in ("1.png", "2.png", "3.png"):
            shutil.copy(program.flight() / "crate.png", video / name)
        self.drive("images", self.index(video))


if __name__ == "__main__":
    program.main()
