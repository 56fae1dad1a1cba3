"""`serve` in operation: health, numbers, the log of reads, a backup while it runs, and no folder of the server for viewers."""

import contextlib
import http.client
import json
import shutil
import sqlite3
import time
import urllib.parse

import program

API = json.loads((program.REPOSITORY / "api" / "openapi.json").read_text())
PASSWORD = "correct horse battery"


class OperationTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.db = self.scratch / "index.db"
        self.video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", self.video)
        shutil.copy(program.index(), self.db)
        self.library = self.scratch / "models"
        shutil.copytree(program.models(), self.library)
        with contextlib.closing(sqlite3.connect(self.db)) as db, db:
            db.execute("UPDATE videos SET name = ?", (str(self.video),))
        self.tokens = {}
        for role in ("viewer", "analyst", "admin"):
            self.succeeds("user", "add", role, "--role", role, "--db", self.db, input=PASSWORD)
            self.tokens[role] = self.succeeds("user", "token", role, "--label", "t", "--db", self.db).out.strip()

    def ask(self, server, path, account=None, method="GET", body=None):
        headers = {"Authorization": f"Bearer {self.tokens[account]}"} if account else {}
        if body is not None:
            headers["Content-Type"] = "application/json"
        port = urllib.parse.urlsplit(server.url).port
        with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=60)) as connection:
            connection.request(method, path, body=body, headers=headers)
            response = connection.getresponse()
            if path == "/api/v1/events":
                return response.status, response.read1()
            return response.status, response.read()

    def test_health_numbers_and_log(self):
        log = self.scratch / "access.jsonl"
        with program.Server(self.db, "--access-log", log) as server:
            self.assertEqual(self.ask(server, "/healthz"), (200, b"ok\n"))
            self.assertEqual(self.ask(server, "/metrics", "viewer")[0], 403)
            status, _ = self.ask(server, "/api/v1/videos/1/file", "viewer")
            self.assertEqual(status, 200)
            status, numbers = self.ask(server, "/metrics", "admin")
            self.assertEqual(status, 200)
            self.assertIn(b'{route="/api/v1/videos/{id}/file",method="GET",status="200"} 1\n', numbers)
            for line in numbers.decode().splitlines():
                self.assertRegex(line, r"^(# (HELP|TYPE) |[a-z_]+(\{[^}]*(\{id\}[^}]*)*\})? [0-9.e+-]+$)")
            self.refuses(1, "another server writes it", "serve", "--db", self.db, "--listen", "127.0.0.1:0", "--access-log", log)
        entry = json.loads(log.read_text().splitlines()[1])
        self.assertEqual((entry["actor"], entry["target"], entry["status"]), ("viewer", "/api/v1/videos/1/file", 200))
        checked = json.loads(self.succeeds("doctor", "--check", log, "--json").out)
        self.assertEqual((checked["entries"], checked["last_hash"]), (1, entry["hash"]))
        log.write_text(log.read_text().replace('"viewer"', '"nobody"'))
        self.refuses(2, "line 2", "doctor", "--check", log)
        self.refuses(2, "line 2", "serve", "--db", self.db, "--listen", "127.0.0.1:0", "--access-log", log)

    def test_backup_of_an_index_that_is_served(self):
        copy = self.scratch / "copy.db"
        with program.Server(self.db) as server:
            status, body = self.ask(server, "/api/v1/objects", "analyst")
            number = json.loads(body)["objects"][0]["id"]
            review = f"/api/v1/objects/{number}/review"
            self.assertEqual(self.ask(server, review, "analyst", "PUT", '{"verdict": "accepted"}')[0], 200)
            self.succeeds("backup", "--db", self.db, "--to", copy)
            self.assertEqual(self.ask(server, review, "analyst", "PUT", '{"verdict": "rejected"}')[0], 200)
        self.assertEqual(copy.stat().st_mode & 0o777, 0o600)
        self.assertIn("without damage", self.succeeds("doctor", "--check", copy).out)
        with program.Server(copy) as server:
            status, body = self.ask(server, f"/api/v1/objects/{number}", "viewer")
            self.assertEqual(status, 200, "accounts are in the copy")
            self.assertEqual(json.loads(body)["review"]["verdict"], "accepted", "the later review is not")
        self.refuses(2, "exists already", "backup", "--db", self.db, "--to", copy)
        self.refuses(2, "pg_dump", "backup", "--db", "postgresql://me:secret@127.0.0.1:1/videos", "--to", copy)

    def walk(self, server):
        """What a viewer gets of every route that is read, as (target, status, body)."""
        _, body = self.ask(server, "/api/v1/objects", "viewer")
        found = json.loads(body)["objects"][0]
        numbers = {"videos": found["moments"][0]["video_id"], "objects": found["id"], "models": found["model_id"]}
        jobs = [job["id"] for job in json.loads(self.ask(server, "/api/v1/jobs", "viewer")[1])["jobs"]]
        for path, item in API["paths"].items():
            if "get" not in item:
                continue
            kind = (path.split("/") + [""] * 2)[3]
            for number in (jobs or [1]) if kind == "jobs" else [numbers.get(kind, 1)]:
                target = path.replace("{id}", str(number)).replace("{view}", "0").replace("{frame}", "3")
                target = target.replace("{z}/{x}/{y}", "0/0/0")
                for name in ("clip", "copy", "x"):
                    status, body = self.ask(server, target.replace("{name}", name), "viewer")
                    yield target, status, body
                    if "{name}" not in target:
                        break

    def check_walk(self, server):
        seen = 0
        for target, status, body in self.walk(server):
            seen += 1
            for folder in (self.scratch, program.REPOSITORY, "/home/", "/tmp/", "/root/", "/srv/"):
                self.assertNotIn(str(folder).encode(), body, f"{target}: {status}: {body[:300]}")
        self.assertGreater(seen, 20)

    def test_viewers_learn_no_folder(self):
        with program.Server(self.db, "--models", self.library) as server:
            job = json.dumps({"kind": "copy", "video_id": 1})
            self.assertEqual(self.ask(server, "/api/v1/jobs", "analyst", "POST", job)[0], 200)
            self.check_walk(server)
            # What cannot be read, is damaged, or lies elsewhere.
            self.video.write_bytes(b"\x00" * 5000)
            self.ask(server, "/api/v1/jobs", "analyst", "POST", job)
            self.check_walk(server)
            self.video.unlink()
            shutil.rmtree(self.library)
            self.check_walk(server)
            for name in ("/srv/secret/flight.mp4", "/etc/passwd", f"{self.scratch}/../flight.mp4"):
                with contextlib.closing(sqlite3.connect(self.db)) as db, db:
                    db.execute("UPDATE videos SET name = ?, telemetry = ?", (name, "/srv/secret/t.csv"))
                self.check_walk(server)
                for _ in range(100):  # until the server has read the list again
                    _, body = self.ask(server, "/api/v1/videos", "admin")
                    if name.encode() in body:
                        break
                    time.sleep(0.1)
                self.assertIn(name.encode(), body, "an administrator learns which file it is")
                self.check_walk(server)
            self.db.rename(self.scratch / "gone.db")
            for target in ("/api/v1/project", "/api/v1/objects", "/api/v1/videos"):
                self.assertNotIn(str(self.scratch).encode(), self.ask(server, target, "viewer")[1])


if __name__ == "__main__":
    program.main()
