"""`serve` in operation: health, numbers, the log of reads, a backup while it runs."""

import contextlib
import http.client
import json
import shutil
import sqlite3
import urllib.parse

import program

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


if __name__ == "__main__":
    program.main()
