"""Which files `serve` opens: whoever writes the index names them, and must not get at others of the machine."""

import contextlib
import json
import os
import shutil
import sqlite3
import subprocess
import unittest
from pathlib import Path

import program
import test_serve

JOBS = "/api/v1/jobs"


class ServedFilesTest(test_serve.ServerCase):
    def setUp(self):
        super().setUp()
        self.shown, self.other = self.scratch / "shown", self.scratch / "other"
        for folder in (self.shown, self.other):
            folder.mkdir()
            shutil.copy(program.flight() / "flight.mp4", folder)
        self.db = self.shown / "index.db"
        shutil.copy(test_serve.index_of_mp4(), self.db)
        self.name(self.shown / "flight.mp4")
        self.key = self.write("other/server.key", "-----BEGIN PRIVATE KEY-----\nMIGHAgEAMBMG\n")

    def write_index(self, statement, *values):
        with contextlib.closing(sqlite3.connect(self.db)) as db, db:
            db.execute(statement, values)

    def name(self, path, column="name"):
        self.write_index(f"UPDATE videos SET {column} = ?", str(path))

    def routes(self, server):
        found = self.get(server, "/api/v1/objects")["objects"][0]
        return [f"videos/1/{part}" for part in ("file", "times", "frames/0")] + [
            f"objects/{found['id']}/{part}" for part in ("thumbnail", "evidence")
        ]

    def test_no_route_reads_another_file(self):
        (self.shown / "link.mp4").symlink_to(self.other / "flight.mp4")
        (self.shown / ".hidden.mp4").write_bytes((self.shown / "flight.mp4").read_bytes())
        names = (self.key, self.other / "flight.mp4", self.other / "none.mp4", self.shown / ".." / "other" / "flight.mp4",
                 "/etc/passwd", self.db, self.shown / "link.mp4", self.shown / ".hidden.mp4")  # fmt: skip
        for name in names:
            self.name(name)
            with program.Server(self.db, "--models", program.models()) as server:
                for route in self.routes(server):
                    status, _, body = self.ask(server, f"/api/v1/{route}")
                    error = self.described(body, "Error")
                    self.assertEqual((status, error["code"]), (403, "permission_denied"), f"{name} {route}")
                    self.assertIn("--videos", error["message"])
                    self.assertNotIn(str(self.scratch), error["message"])
                self.assertIn("--videos", self.get(server, "/api/v1/videos/1")["missing"])
                self.assertIsNone(self.get(server, "/api/v1/videos/1/camera")["source"])
                found = self.get(server, "/api/v1/objects")["objects"][0]
                for job in ({"kind": "index"}, {"kind": "copy"}, {"kind": "clip", "object_id": found["id"]},
                            {"kind": "track", "frame": 1, "box": [1, 2, 30, 40]},
                            {"kind": "model", "name": "x", "frame": 1, "box": [1, 2, 30, 40]}):  # fmt: skip
                    status, _, body = self.ask(server, JOBS, "POST", json.dumps(job | {"video_id": 1}))
                    self.assertEqual(status, 403, f"{name} {job} {body}")
            self.assertIn(f"for the first give --videos {os.path.normpath(Path(name).parent)}", server.err)

    def test_a_flag_allows_a_folder(self):
        self.name(self.other / "flight.mp4")
        self.refuses(2, ["--videos", "none"], "serve", "--db", self.db, "--videos", self.scratch / "none")
        with program.Server(self.db, "--models", program.models(), "--videos", self.scratch / "shown", "--videos", self.other) as server:
            for route in self.routes(server):
                self.assertEqual(self.ask(server, f"/api/v1/{route}")[0], 200, route)
            job = self.wait_for_job(server, self.post_job(server, kind="copy", video_id=1), "done")
            self.assertEqual(job["title"], "flight.mp4")
        self.assertNotIn("--videos", server.err)
        self.name(self.key)
        with program.Server(self.db, "--videos", self.other) as server:
            self.assertEqual(self.ask(server, "/api/v1/videos/1/file")[0], 415, "neither a video nor an image")

    @unittest.skipIf(shutil.which("openssl") is None, "openssl is not installed")
    def test_the_key_of_the_server_is_never_opened(self):
        program.self_signed(self.shown, "server", alternative=None)
        for name in ("server.key", "server.pem"):
            self.name(self.shown / name)
            certificate = ("--tls-cert", self.shown / "server.pem", "--tls-key", self.shown / "server.key")
            command = [program.PROGRAM, "serve", "--db", self.db, "--listen", "127.0.0.1:0", *certificate]
            with subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as served:
                served.stdout.readline()
                served.terminate()
                self.assertIn("1 of 1 videos are not shown", served.communicate(timeout=program.TIMEOUT_S)[1])

    def test_telemetry_of_another_folder_is_not_read(self):
        rows = [f"{time},52.5,13.407,140,0,-80,0,60" for time in range(10)]
        table = self.write("other/table.csv", "\n".join([test_serve.HEADER, *rows]) + "\n")
        self.name(table, "telemetry")
        with program.Server(self.db, "--models", program.models()) as server:
            camera = self.get(server, "/api/v1/videos/1/camera")
            self.assertIsNone(camera["source"])
            self.assertIn("--videos", camera["reason"])
            self.wait_for_job(server, self.post_job(server, kind="index", video_id=1), "done")
        with program.Server(self.db, "--videos", self.other) as server:
            self.assertEqual(self.get(server, "/api/v1/videos/1/camera")["source"], "telemetry")
        model = ("--models", program.models(), "--db", self.db)
        said = self.succeeds("index", self.shown / "flight.mp4", *model, "--files-below", self.shown).err
        self.assertIn("is not read: table.csv: lies in none of the folders", said)
        said = self.succeeds("index", self.shown / "flight.mp4", *model).err
        self.assertIn(f"telemetry: {table}, as it was given", said)

    def test_jobs_of_an_index_from_elsewhere(self):
        """They read and write only what those of this server may."""
        victim = self.write("other/victim.mp4", "mine")
        video, copies = str(self.shown / "flight.mp4"), f"{self.db}.copies"
        jobs = [
            ("copy", {"video": video, "copy": str(victim)}),
            ("copy", {"video": str(self.other / "flight.mp4"), "copy": f"{copies}/c.mp4"}),
            ("clip", {"video": video, "object": 1, "clip": str(victim)}),
            ("track", {"video": str(self.other / "flight.mp4"), "at_s": 0, "box": [1, 2, 30, 40]}),
            ("refine", {"categories": video, "refine": str(victim)}),
            ("index", {"video": str(self.other / "flight.mp4")}),
            ("index", {"video": video, "telemetry": str(self.key)}),
            ("index", {"video": "http://127.0.0.1:9/a.mp4"}),
            ("live", {"video": f"file://{self.other}/flight.mp4"}),
            ("model", {"name": "x", "files": [str(self.other / "flight.mp4")]}),
        ]
        for kind, value in jobs:
            self.write_index("INSERT INTO jobs (kind, input, state, created_utc_us) VALUES (?, ?, 'queued', 1)",
                             kind, json.dumps(value))  # fmt: skip
        self.write_index("INSERT INTO jobs (kind, input, state, created_utc_us, ended_utc_us) VALUES ('refine', ?, 'done', 1, 2)",
                         json.dumps({"categories": "", "refine": str(self.key)}))  # fmt: skip
        before = {path.name: path.read_bytes() for path in self.other.iterdir()}
        with program.Server(self.db, "--models", program.models()) as server:
            for number in range(1, len(jobs) + 1):
                job = self.wait_for_job(server, number, "failed")
                self.assertRegex(job["message"], "--videos|folder of copies|live source|category model of this server", job)
            self.assertEqual(self.ask(server, f"{JOBS}/{len(jobs) + 1}/files/categories")[0], 404)
            self.assertEqual(self.get(server, "/api/v1/project")["videos"], 1)
        self.assertEqual({path.name: path.read_bytes() for path in self.other.iterdir()}, before)

    def test_processes_of_jobs_check_what_the_index_names_by_then(self):
        self.name(self.other / "flight.mp4")
        number = program.run("search", "--db", self.db, "--json").rows()[0]["object_id"]
        clip = ("export", "--db", self.db, "--format", "video", "--object", number, "--clip", 1, "--out", self.scratch / "c.mp4")
        self.refuses(1, ["flight.mp4", "--videos"], *clip, "--files-below", self.shown)
        self.assertFalse((self.scratch / "c.mp4").exists())
        self.succeeds(*clip, "--files-below", self.shown, "--files-below", self.other)


if __name__ == "__main__":
    program.main()
