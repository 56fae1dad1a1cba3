"""`serve` and `user` on an index in PostgreSQL: what the page shows of it, jobs, and a database that goes away."""

import concurrent.futures
import contextlib
import http.client
import json
import os
import shutil
import signal
import subprocess
import time
import urllib.parse
from pathlib import Path

import program
import test_serve
from test_postgres import Postgres

PASSWORD = "correct horse battery"
SECRET = "se:cr/et"


class ServePostgresTest(test_serve.ServerCase):
    @classmethod
    def setUpClass(cls):
        cls.postgres = cls.enterClassContext(Postgres("--restart"))

    def setUp(self):
        super().setUp()
        name = f"t{time.monotonic_ns()}"
        self.sql(f"CREATE DATABASE {name}", self.postgres.url)
        base, _, parameters = self.postgres.url.partition("?")
        self.url = f"{base.rpartition('/')[0]}/{name}?{parameters}"
        self.video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", self.video)
        self.succeeds("index", self.video, "--models", program.models(), "--db", self.url)

    def sql(self, statement, url=None) -> list[str]:
        command = ["psql", url or self.url, "--quiet", "--no-align", "--tuples-only", "--command", statement]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()

    def serve(self, *flags, url=None):
        folders = ("--uploads", self.scratch / "uploads", "--copies", self.scratch / "copies", "--videos", self.scratch)
        return program.Server(url or self.url, *folders, *flags)

    def wait_until(self, is_so):
        for _ in range(int(program.TIMEOUT_S / 0.05)):
            if is_so():
                return
            time.sleep(0.05)
        self.fail("did not come")

    def test_shows_what_a_page_of_a_file_shows(self):
        file = self.scratch / "index.db"
        self.succeeds("index", self.video, "--models", program.models(), "--db", file)
        routes = ("videos", "objects?sort=rank", "objects?sort=queue&q=crate", "objects/counts?min_score=0.5", "thresholds",
                  "videos/1/times", "videos/1/sightings?from=0.5&to=1", "videos/1/camera", "models/1/views")  # fmt: skip
        with self.serve("--models", program.models()) as server, program.Server(file, "--models", program.models()) as other:
            for route in routes:
                answers = [self.get(one, f"/api/v1/{route}") for one in (server, other)]
                self.assertEqual(*answers, route)
            found = self.get(server, "/api/v1/objects")["objects"]
            self.assertGreater(len(found), 1)
            for path in (f"objects/{found[0]['id']}", f"objects/{found[0]['id']}/sightings"):
                self.assertEqual(*(self.get(one, f"/api/v1/{path}") for one in (server, other)))
            thumbnail = f"/api/v1/objects/{found[0]['id']}/thumbnail"
            self.assertEqual(*(self.ask(one, thumbnail)[2] for one in (server, other)))
            self.assertEqual(self.ask(server, "/api/v1/videos/1/file")[2], self.video.read_bytes())
            with concurrent.futures.ThreadPoolExecutor(32) as pool:
                answers = pool.map(lambda i: self.ask(server, f"/api/v1/objects?min_score={i / 1000}")[0], range(200))
                self.assertEqual(set(answers), {200})
            connections = self.sql("SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND"
                                   " pid <> pg_backend_pid()")  # fmt: skip
            self.assertLessEqual(int(connections[0]), 22, "as docs/cluster.md says")

    def test_analysts_log_in_and_review(self):
        """Accounts, reviews, thresholds and the log are in the database, for every server of it."""
        # The drawn flight has no telemetry; the map needs a place.
        self.sql(
            "UPDATE victorious.objects SET place_time_s = 1, latitude_rad = 0.9, longitude_rad = 0.2, altitude_m = 40,"
            " covariance_enu_m2 = decode(repeat('00', 72), 'hex'), ce90_m = 5, le90_m = 4"
        )
        for name in ("analyst", "viewer"):
            self.succeeds("user", "add", name, "--role", name, "--db", self.url, input=PASSWORD)
        self.refuses(2, "already", "user", "add", "ANALYST", "--role", "admin", "--db", self.url, input=PASSWORD)
        token = self.succeeds("user", "token", "viewer", "--label", "test", "--db", self.url).out.strip()
        viewer = {"Authorization": f"Bearer {token}"}
        with self.serve() as server, self.serve() as second:
            self.assertEqual(self.ask(server, "/api/v1/project")[0], 401)
            log_in = json.dumps({"name": "analyst", "password": PASSWORD})
            status, headers, body = self.ask(server, "/api/v1/session", "POST", log_in)
            self.assertEqual(status, 200, body)
            analyst = {"Cookie": headers["Set-Cookie"].split(";")[0]}
            project = self.described(self.ask(server, "/api/v1/project", **viewer)[2], "Project")
            self.assertRegex(project["name"], r"^postgresql://victorious@")
            found = self.described(self.ask(server, "/api/v1/objects", **viewer)[2], "ObjectList")["objects"]
            route = f"/api/v1/objects/{found[0]['id']}/review"
            review = json.dumps({"verdict": "rejected", "note": "a shadow"})
            self.assertEqual(self.ask(server, route, "PUT", review, **viewer)[0], 403)
            self.assertEqual(self.ask(server, route, "PUT", review, **analyst)[0], 200)
            status, _, body = self.ask(server, f"/api/v1/models/{found[1]['model_id']}/threshold", "PUT",
                                       '{"min_score": 1}', **analyst)  # fmt: skip
            self.assertEqual(status, 200, body)
            status, headers, tile = self.ask(second, "/api/v1/tiles/0/0/0", **viewer)
            self.assertEqual((status, headers["Content-Type"]), (200, "application/vnd.mapbox-vector-tile"))
            self.assertGreater(len(tile), 100)
            rejected = json.loads(self.ask(second, "/api/v1/objects?review=rejected", **viewer)[2])["objects"]
            self.assertEqual([(one["id"], one["review"]["reviewer"]) for one in rejected], [(found[0]["id"], "analyst")])
            self.wait_until(lambda: json.loads(self.ask(second, "/api/v1/project", **viewer)[2])["rejected"] == 1)
            self.succeeds("user", "remove", "analyst", "--db", self.url)
            self.assertEqual(self.ask(server, "/api/v1/project", **analyst)[0], 401, "at once")
        log = [row["action"] for row in self.succeeds("user", "log", "--db", self.url, "--json").rows()]
        self.assertEqual(log, ["remove_account", "threshold", "review", "log_in", "add_token", "add_account", "add_account"])
        # A new search keeps the review.
        self.succeeds("index", self.video, "--models", program.models(), "--db", self.url, "--redo")
        with self.serve() as server:
            again = json.loads(self.ask(server, "/api/v1/objects?review=rejected", **viewer)[2])["objects"]
            self.assertEqual([(one["model"], one["review"]["note"]) for one in again], [(found[0]["model"], "a shadow")])

    def test_jobs_and_events(self):
        """An uploaded video is searched; no process of a job has the password of the database in its arguments."""
        self.sql("DO $$ BEGIN CREATE ROLE with_password LOGIN SUPERUSER; EXCEPTION WHEN duplicate_object THEN END $$;"
                 f" ALTER ROLE with_password PASSWORD '{SECRET}'")  # fmt: skip
        url = self.url.replace("victorious@", f"with_password:{urllib.parse.quote(SECRET, safe='')}@")
        other = self.scratch / "other.mkv"
        shutil.copy(program.flight(20) / "flight.mkv", other)
        with self.serve("--models", program.models(), url=url) as server:
            port = urllib.parse.urlsplit(server.url).port
            with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=program.TIMEOUT_S)) as stream:
                stream.request("GET", "/api/v1/events")
                events = stream.getresponse()
                before = self.get(server, "/api/v1/project")
                number = self.post_job(server, kind="index", upload=self.upload(server, other))
                commands = []

                def is_done():
                    commands.extend(self.commands_of(server.process.pid))
                    jobs = self.get(server, "/api/v1/jobs")["jobs"]
                    state = next(one["state"] for one in jobs if one["id"] == number)
                    self.assertIn(state, ("queued", "running", "done"), jobs)
                    return state == "done"

                self.wait_until(is_done)
                names, newest = set(), 0
                while newest <= 10**9:  # an object of the second video
                    line = events.readline().decode().strip()
                    names |= {line.removeprefix("event: ")} if line.startswith("event: ") else set()
                    if line.startswith("data: ") and "newest_object" in line:
                        newest = json.loads(line.removeprefix("data: "))["newest_object"]
                self.assertEqual(names, {"index", "jobs"})
            self.assertTrue(any("index" in words for words in commands), commands)
            for words in commands:
                self.assertNotIn(SECRET, " ".join(words))
                self.assertNotIn(urllib.parse.quote(SECRET, safe=""), " ".join(words))
            self.wait_until(lambda: self.get(server, "/api/v1/project")["videos"] == 2)
            self.assertGreater(self.get(server, "/api/v1/project")["objects"], before["objects"])
            found = self.get(server, "/api/v1/objects?sort=newest")["objects"][0]
            moment = found["moments"][0]
            clip = self.post_job(server, kind="clip", object_id=found["id"], video_id=moment["video_id"])
            self.wait_for_job(server, clip, "done")
            self.assertEqual(self.ask(server, f"/api/v1/jobs/{clip}/files/clip")[2][4:8], b"ftyp")
        self.assertNotIn(SECRET, server.err)
        self.assertTrue(list((self.scratch / "uploads").glob("*/other.mkv")))

    @staticmethod
    def commands_of(parent) -> list[list[str]]:
        """The arguments of the child processes of a process."""
        commands = []
        for process in Path("/proc").iterdir():
            with contextlib.suppress(OSError, ValueError, IndexError):
                if int((process / "stat").read_text().rpartition(")")[2].split()[1]) == parent:
                    commands.append((process / "cmdline").read_bytes().decode().split("\0"))
        return commands

    def test_says_what_workers_do(self):
        other = self.scratch / "other.mkv"
        shutil.copy(program.flight(20) / "flight.mkv", other)
        gone = self.write("gone.mkv", other.read_bytes() + b"0")
        with self.serve() as server:

            def status():
                time.sleep(1.1)  # an answer is a second old at most
                return self.described(self.ask(server, "/api/v1/cluster")[2], "Cluster")

            nothing = status()
            self.assertEqual((nothing["is_shared"], nothing["videos"]["queued"], nothing["tasks"]), (True, 0, []))
            self.succeeds("submit", other, gone, "--models", program.models(), "--db", self.url)
            self.succeeds("submit", "udp://ann:secret@127.0.0.1:9", "--models", program.models(), "--db", self.url)
            queued = status()
            self.assertEqual(queued["videos"]["queued"], 2)
            (live,) = queued["sources"]
            self.assertEqual((live["source"], live["state"], live["covered"]), ("udp://127.0.0.1:9", "queued", None))
            gone.unlink()
            worked = program.run("work", "--db", self.url, "--until-empty", "--retry-delay", "0", "--threads", 1)
            self.assertEqual(worked.status, 1, worked.err)
            ended = status()
            self.assertEqual((ended["videos"]["done"], ended["videos"]["failed"], ended["workers"]), (1, 1, 0))
            self.assertGreater(ended["video_s"], 0)
            self.assertEqual([(task["video"], task["state"]) for task in ended["tasks"]], [(str(gone), "failed")])
            self.assertIn("gone.mkv", ended["tasks"][0]["reason"])
            printed = json.loads(self.succeeds("cluster", "status", "--db", self.url, "--json").out)
            self.assertEqual(printed["seconds_per_video"], ended["video_s"])

    def test_database_goes_away_and_comes_back(self):
        folder = Path(urllib.parse.parse_qs(self.url.partition("?")[2])["host"][0])
        script = self.postgres.process
        with self.serve("--models", program.models()) as server:
            before = self.get(server, "/api/v1/objects")
            number = before["objects"][0]["id"]
            script.send_signal(signal.SIGSTOP)  # else it starts the server again at once
            try:
                os.kill(int((folder / "data" / "postmaster.pid").read_text().split()[0]), signal.SIGQUIT)
                self.wait_until(lambda: self.ask(server, "/api/v1/objects")[0] != 200)
                for route in ("project", "objects", "objects?thresholds=applied", "objects/counts", f"objects/{number}",
                              f"objects/{number}/sightings", f"objects/{number}/thumbnail", f"objects/{number}/decisions",
                              f"objects/{number}/evidence", "tiles/0/0/0", "thresholds", "videos", "videos/1",
                              "videos/1/sightings", "videos/1/camera", "videos/1/times", "cluster", "jobs", "audit", "session"):  # fmt: skip
                    self.refused_as_away(server, f"/api/v1/{route}")
                for method, route, body in (("PUT", f"objects/{number}/review", {"verdict": "accepted"}),
                                            ("PUT", "models/1/threshold", {"min_score": 0.5}),
                                            ("POST", "jobs", {"kind": "index", "video_id": 1}),
                                            ("POST", "jobs/1/cancel", {})):  # fmt: skip
                    self.refused_as_away(server, f"/api/v1/{route}", method, json.dumps(body))
                # More at once than have ever been open: they open connections of their own.
                with concurrent.futures.ThreadPoolExecutor(16) as pool:
                    answers = pool.map(lambda _: self.ask(server, f"/api/v1/objects/{number}")[0], range(64))
                    self.assertEqual(set(answers), {503})
                time.sleep(3)  # in which jobs are looked for and the index is watched
            finally:
                script.send_signal(signal.SIGCONT)
            self.wait_until(lambda: self.ask(server, "/api/v1/objects")[0] == 200)
            self.assertEqual(self.get(server, "/api/v1/objects"), before)
            self.review(server, number, verdict="accepted")
            self.wait_until(lambda: self.get(server, "/api/v1/project")["accepted"] == 1)
            job = self.post_job(server, kind="index", video_id=1)
            self.assertEqual(self.wait_for_job(server, job, "done")["state"], "done")
        warnings = [line for line in server.err.splitlines() if "connection" in line]
        self.assertGreater(len(warnings), 0)
        self.assertLess(len(warnings), 30, "not one for each look")

    def refused_as_away(self, server, *request):
        status, _, body = self.ask(server, *request)
        self.assertEqual(status, 503, f"{request}: {body}")
        error = self.described(body, "Error")
        self.assertEqual(error["code"], "unavailable", request)
        self.assertIn("start the server", error["message"])

    def test_bad_arguments(self):
        empty = self.url.replace("/t", "/none", 1)
        self.refuses(2, "does not exist", "serve", "--db", empty)
        name = f"e{time.monotonic_ns()}"
        self.sql(f"CREATE DATABASE {name}", self.postgres.url)
        base, _, parameters = self.url.partition("?")
        empty = f"{base.rpartition('/')[0]}/{name}?{parameters}"
        self.refuses(2, "no index in this database", "serve", "--db", empty)
        self.refuses(2, "no such index", "user", "list", "--db", empty)
        self.assertEqual(self.sql("SELECT to_regnamespace('victorious') IS NULL", empty), ["t"], "nothing was made")
        self.refuses(2, ["loopback", "user add"], "serve", "--db", self.url, "--listen", "0.0.0.0:0")


if __name__ == "__main__":
    program.main()
