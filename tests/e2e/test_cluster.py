"""Videos shared out to workers: what N workers write is what one process writes, whoever dies meanwhile."""

import contextlib
import http.server
import json
import os
import shutil
import signal
import ssl
import socket
import subprocess
import threading
import time
import unittest
from pathlib import Path

import program
import streams
from test_postgres import Postgres

FRAMES = (40, 20, 30)  # of the videos, so that their contents differ


class ClusterTest(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.server = cls.enterClassContext(Postgres())

    def setUp(self):
        super().setUp()
        self.url = self.make_database()
        self.videos = [program.flight(frames) / "flight.mkv" for frames in FRAMES]

    def make_database(self) -> str:
        name = f"t{time.monotonic_ns()}"
        subprocess.run(["psql", self.server.url, "--quiet", "--command", f"CREATE DATABASE {name}"], check=True)
        base, _, parameters = self.server.url.partition("?")
        return f"{base.rpartition('/')[0]}/{name}?{parameters}"

    def submit(self, *videos, **options):
        return self.succeeds("submit", *videos, "--models", program.models(), "--db", self.url, **options)

    def start_worker(self, *flags):
        command = [program.PROGRAM, "work", "--db", self.url, "--threads", 1, *flags]
        return subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)

    def finish(self, *workers, status=0) -> str:
        """What the last one said."""
        err = ""
        for worker in workers:
            err = worker.communicate(timeout=program.TIMEOUT_S)[1]
            self.assertEqual(worker.returncode, status, err)
        return err

    def status(self) -> dict:
        return json.loads(self.succeeds("cluster", "status", "--db", self.url, "--json").out)

    def assert_same_as_one_process(self, *flags):
        """Objects and sightings are those of one process; the objects have other ids."""
        db = self.scratch / "one.db"
        self.succeeds("index", *self.videos, "--models", program.models(), "--db", db, *flags)
        for form in ("objects", "sightings"):
            of_workers, of_one = (self.numbered(self.exported(index, form)) for index in (self.url, db))
            self.assertEqual(of_workers, of_one, form)
            self.assertGreater(len(of_one), 3)

    def rows(self) -> list[str]:
        """The sightings, but for the ids of objects and the order that follows from these."""
        rows = map(json.loads, self.exported(self.url, "sightings").splitlines())
        return sorted(json.dumps(row | {"object_id": 0}) for row in rows)

    def exported(self, db, form) -> str:
        return self.succeeds("export", "--db", db, "--format", form).out

    @staticmethod
    def numbered(lines: str) -> list[dict]:
        """The rows, with the ids of objects replaced by the order in which they come first."""
        rows = [json.loads(line) for line in lines.splitlines()]
        numbers = {}
        return [row | {"object_id": numbers.setdefault(row["object_id"], len(numbers))} for row in rows]

    def test_workers_write_what_one_process_writes(self):
        said = self.submit(*self.videos)
        self.assertIn("3 videos submitted; 3 queued", said.err)
        self.assertIn("0 videos submitted, 3 submitted before;", self.submit(*self.videos).err)
        self.finish(*(self.start_worker("--until-empty") for _ in range(2)))
        status = self.status()
        self.assertEqual((status["queued"], status["running"], status["done"]), (0, 0, 3), status)
        self.assertGreater(status["seconds_per_video"], 0)
        self.assertIn("3 done, 0 failed", self.succeeds("cluster", "status", "--db", self.url).out)
        self.assert_same_as_one_process()
        of_two, self.url = self.url, self.make_database()
        self.submit(*self.videos)
        self.finish(self.start_worker("--until-empty"))
        for form in ("objects", "sightings", "geojson", "kml"):
            self.assertEqual(self.exported(self.url, form), self.exported(of_two, form), form)

    def test_killed_and_interrupted_workers_lose_nothing(self):
        self.submit(*self.videos)
        for sent in (signal.SIGKILL, signal.SIGINT):
            worker = self.start_worker()
            self.wait_until(lambda: self.events_of(worker) or worker.poll() is not None)
            worker.send_signal(sent)
            worker.communicate(timeout=program.TIMEOUT_S)
            if sent == signal.SIGINT:
                events = self.events_of(worker)
                self.assertEqual(events.count("claimed"), events.count("done") + events.count("released"), events)
        # As after a minute: the killed worker does not answer any more.
        self.sql("UPDATE victorious.tasks SET leased_until = now() - interval '1 s' WHERE state = 'running'")
        self.finish(self.start_worker("--until-empty"))
        self.assertEqual(self.status()["done"], 3)
        self.assert_same_as_one_process()

    def test_workers_share_one_video(self):
        params = self.write("params.json", '{"follow": {"restart_interval_frames": 5}}')
        self.videos = self.videos[:2]
        self.submit(*self.videos, "--params", params, "--segment", 1)
        workers = [self.start_worker() for _ in range(3)]
        self.wait_until(lambda: self.events_of(workers[0]).count("claimed") > 1)
        workers[0].kill()
        workers[0].communicate(timeout=program.TIMEOUT_S)
        self.sql("UPDATE victorious.tasks SET leased_until = now() - interval '1 s' WHERE state = 'running'")
        self.wait_until(lambda: self.status()["done"] == 2)
        for worker in workers[1:]:
            worker.send_signal(signal.SIGINT)
        self.finish(*workers[1:])
        status = self.status()
        self.assertEqual((status["queued"], status["waiting"], status["failed"]), (0, 0, 0), status)
        self.assertEqual(status["segments"], {"queued": 0, "running": 0, "done": 6, "failed": 0})
        self.assertGreater(status["seconds_per_segment"], 0)
        self.assertEqual(status["gaps"], [])
        self.assertEqual(self.sql("SELECT count(*) FROM victorious.video_cuts"), ["0"])
        self.assert_same_as_one_process("--params", params)

    def test_frames_that_kill_are_left_out(self):
        self.videos = [program.flight(130) / "flight.mkv"]
        self.submit(*self.videos, "--segment", 6)
        worker = self.start_worker("--until-empty", "--retry-delay", "0")
        while worker.poll() is None:
            self.kill_who_searches(70)
            time.sleep(0.01)
        self.assertIn("1 gap left", self.finish(worker, status=1))
        status = self.status()
        self.assertEqual((status["done"], status["segments"]["failed"]), (1, 1), status)
        (gap,) = status["gaps"]
        self.assertEqual((gap["video"], gap["segment"]), (str(self.videos[0]), [60, 120]))
        self.assertIn("crashed (signal 11)", gap["reason"])
        self.assertIn("frames 60 to 119, 6.0 to 11.9 s", self.succeeds("cluster", "status", "--db", self.url).out)
        db = self.scratch / "one.db"
        self.succeeds("index", *self.videos, "--models", program.models(), "--db", db)
        found, all_found = (self.seen_in(index) for index in (self.url, db))
        self.assertEqual(found, [row for row in all_found if not 60 <= row[0] < 120])
        self.assertGreater(len(all_found), len(found))
        self.assertIn("--redo searches again", self.submit(*self.videos, "--segment", 6).err)
        self.assertIn("1 video submitted", self.submit(*self.videos, "--segment", 6, "--redo").err)
        self.finish(self.start_worker("--until-empty"))
        self.assertEqual(self.status()["gaps"], [])
        self.assertEqual(self.seen_in(self.url), all_found)

    def kill_who_searches(self, frame):
        for process in Path("/proc").iterdir():
            try:
                words = (process / "cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            if "--frames" not in words or self.url not in words:
                continue
            begin, _, end = words[words.index("--frames") + 1].partition(":")
            if int(begin) <= frame < int(end):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(process.name), signal.SIGSEGV)

    def seen_in(self, db) -> list[tuple]:
        rows = [json.loads(line) for line in self.exported(db, "sightings").splitlines()]
        return sorted((row["frame"], row["model"], row["score"]) for row in rows)

    def sql(self, statement) -> list[str]:
        command = ["psql", self.url, "--quiet", "--no-align", "--tuples-only", "--command", statement]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()

    def events_of(self, worker) -> list[str]:
        return self.sql(f"SELECT event FROM victorious.task_log WHERE worker LIKE '%:{worker.pid}'")

    def wait_until(self, is_so):
        for _ in range(int(program.TIMEOUT_S / 0.05)):
            if so := is_so():
                return so
            time.sleep(0.05)
        self.fail("did not come")

    def test_worker_waits_for_a_database_that_is_started_after_it(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            port = taken.getsockname()[1]
        command = [program.PROGRAM, "work", "--db", f"postgresql://127.0.0.1:{port}/videos", "--until-empty"]
        worker = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.assertIn("start the server", worker.stderr.readline())
        self.assertIsNone(worker.poll())
        worker.send_signal(signal.SIGINT)
        self.finish(worker, status=1)

    def test_what_fails_is_listed_with_its_reason(self):
        gone = Path(self.write("gone.mkv", self.videos[1].read_bytes()))
        self.submit(gone, self.videos[0])
        gone.unlink()
        said = self.finish(self.start_worker("--until-empty", "--retry-delay", "0"), status=1)
        self.assertIn("1 video failed", said.splitlines()[-1])
        status = self.status()
        self.assertEqual((status["done"], status["failed"]), (1, 1), status)
        self.assertEqual(status["tasks"][0]["video"], str(gone))
        self.assertIn("gone.mkv", status["tasks"][0]["reason"])
        gone.write_bytes(self.videos[1].read_bytes())
        self.assertIn("1 video submitted", self.submit(gone).err)
        self.finish(self.start_worker("--until-empty"))
        self.assertEqual(self.status()["done"], 2)

    def test_other_options_are_refused_or_searched_again(self):
        self.submit(self.videos[0])
        self.finish(self.start_worker("--until-empty"))
        found = self.rows()
        submit = ("submit", *self.videos, "--models", program.models(), "--db", self.url, "--every", 7)
        done = program.run(*submit)
        self.assertEqual(done.status, 2, done.err)
        self.assertIn(", is 7)", done.messages()[-1])
        self.assertIn("--redo", done.messages()[-1])
        self.assertEqual(self.rows(), found)
        done = program.run(*submit[:-2])
        self.assertEqual(done.status, 2, done.err)
        self.assertEqual(len([line for line in done.messages() if "is queued with other options (--every 7)" in line]), 2)
        self.finish(self.start_worker("--until-empty"))  # the other videos
        self.assertIn("1 video submitted, 2 done already;", self.succeeds(*submit, "--redo").err)
        self.finish(self.start_worker("--until-empty"))
        self.assert_same_as_one_process("--every", 7)
        self.assertIn("3 done already;", self.succeeds(*submit, "--redo").err)

    def test_models_of_a_name_that_change(self):
        video, other, _ = self.videos
        library = self.scratch / "models"
        shutil.copytree(program.models(), library)
        truck = library / "truck.vmodel"
        before = truck.read_bytes()

        def submit(video):
            return self.succeeds("submit", video, "--models", library, "--db", self.url).err

        def replace():
            self.succeeds("model", "remove", "truck", "--models", library)
            self.succeeds("model", "add", "truck", program.flight() / "crate.png", "--models", library)

        self.assertIn("1 video submitted;", submit(video))
        self.finish(self.start_worker("--until-empty"))
        found = self.rows()
        self.assertIn("0 videos submitted, 1 done already;", submit(video))
        replace()
        self.assertIn("1 video submitted;", submit(video))
        self.finish(self.start_worker("--until-empty"))
        self.assertNotEqual(self.rows(), found)
        truck.write_bytes(before)
        self.assertIn("1 video submitted;", submit(video), "its results were deleted for the other truck")
        self.finish(self.start_worker("--until-empty"))
        self.assertEqual(self.rows(), found)
        # Replaced between submission and search: nothing is deleted.
        submit(other)
        replace()
        self.finish(self.start_worker("--until-empty", "--retry-delay", "0"), status=1)
        status = self.status()
        self.assertEqual((status["done"], status["failed"]), (2, 1), status)
        self.assertIn("truck was replaced after the video was submitted", status["tasks"][0]["reason"])
        self.assertEqual(self.rows(), found)

    def move_away(self, *folders) -> None:
        """As on a machine that does not have them."""
        for folder in folders:
            folder.rename(folder.with_name(f"{folder.name}-of-another-machine"))

    def submit_published(self, *flags) -> Path:
        """Submits copies of the videos and models, and takes them away. Returns where they are published."""
        content, videos, models = (self.scratch / name for name in ("content", "videos", "models"))
        videos.mkdir()
        shutil.copytree(program.models(), models)
        for number, video in enumerate(self.videos):
            shutil.copy(video, videos / f"{number}.mkv")
        params = Path(self.write("videos/params.json", '{"follow": {"restart_interval_frames": 5}}'))
        names = [videos / f"{number}.mkv" for number in range(len(self.videos))]
        submit = ("submit", *names, "--models", models, "--params", params, "--db", self.url, "--publish", content)
        self.succeeds(*submit, *flags)
        self.succeeds("index", *names, "--models", models, "--params", params, "--db", self.scratch / "one.db")
        self.move_away(videos, models)
        return content

    @contextlib.contextmanager
    def web_server(self, folder, tls=None):
        class Handler(http.server.SimpleHTTPRequestHandler):
            def __init__(self, *arguments):
                super().__init__(*arguments, directory=folder)

            def log_message(self, *_):
                pass

        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
            if tls:
                server.socket = tls.wrap_socket(server.socket, server_side=True)
            thread = threading.Thread(target=server.serve_forever)
            thread.start()
            try:
                yield f"{'https' if tls else 'http'}://127.0.0.1:{server.server_port}"
            finally:
                server.shutdown()
                thread.join()

    def test_workers_fetch_what_they_do_not_have(self):
        content = self.submit_published("--segment", 1)
        cache = self.scratch / "cache"
        with self.web_server(content) as url:
            flags = ("--until-empty", "--content", url, "--cache", cache)
            self.finish(*(self.start_worker(*flags) for _ in range(2)))
        self.assertEqual(self.status()["done"], 3)
        for form in ("objects", "sightings"):
            of_workers, of_one = (self.numbered(self.exported(db, form)) for db in (self.url, self.scratch / "one.db"))
            self.assertEqual(of_workers, of_one, form)
        self.assertEqual(list((cache / "tasks").iterdir()), [])
        self.assertEqual(len(list((cache / "files").iterdir())), 6, "three videos, two models, the parameters")

    def test_content_that_is_wrong_is_listed_with_its_reason(self):
        self.videos = self.videos[:1]
        content = self.submit_published()
        video = next(file for file in content.glob("*/*") if file.read_bytes() == self.videos[0].read_bytes())
        video.write_bytes(video.read_bytes()[:-1] + b"x")
        flags = ("--until-empty", "--retry-delay", "0", "--content", content, "--cache", self.scratch / "cache")
        self.finish(self.start_worker(*flags), status=1)
        (task,) = self.status()["tasks"]
        self.assertIn(f"{video}: not the content that was submitted", task["reason"])
        self.assertEqual(self.sql("SELECT count(*) FROM victorious.models"), ["0"])

    @unittest.skipIf(shutil.which("openssl") is None, "openssl is not installed")
    def test_server_whose_certificate_is_not_valid_is_refused(self):
        self.videos = self.videos[:1]
        content = self.submit_published()
        files = program.self_signed(self.scratch, "server", alternative=None)
        tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        tls.load_cert_chain(*files)
        with self.web_server(content, tls) as url:
            worker = self.start_worker("--content", url, "--cache", self.scratch / "cache")
            self.wait_until(lambda: self.events_of(worker).count("released") == 1)
            worker.send_signal(signal.SIGINT)
            said = worker.communicate(timeout=program.TIMEOUT_S)[1]
        self.assertIn(f"waits again: {self.scratch}/videos/0.mkv: {url}/", said)

    def test_video_that_was_replaced_is_refused(self):
        video = Path(self.write("a.mkv", self.videos[0].read_bytes()))
        self.submit(video)
        video.write_bytes(self.videos[1].read_bytes())
        self.finish(self.start_worker("--until-empty", "--retry-delay", "0"), status=1)
        (task,) = self.status()["tasks"]
        self.assertIn(f"{video}: not the video that was submitted", task["reason"])

    def test_process_of_a_lost_attempt_writes_nothing(self):
        self.submit(self.videos[0])
        index = ("index", self.videos[0], "--models", program.models(), "--db", self.url)
        self.assertIn("attempt 1 of task 1 does not run any more", self.succeeds(*index, "--task", "1:1").err)
        self.assertEqual(self.sql("SELECT count(*) FROM victorious.models"), ["0"])
        self.refuses(2, "TASK:ATTEMPT", *index, "--task", "1")
        self.refuses(2, "not JSON", *index, "--targets", "x")

    def source(self) -> dict:
        (source,) = self.status()["sources"]
        return source

    def wait_for_owner(self, workers, part=1) -> subprocess.Popen:
        """That of a source, once some seconds of its part are searched."""
        owners = {worker.pid: worker for worker in workers}

        def is_searched():
            source = self.source()
            pid = int(source["worker"].rpartition(":")[2] or 0)
            return pid in owners and self.covered_s(source["source"], part) > 2 and pid

        pid = self.wait_until(is_searched)
        return owners[pid]

    def covered_s(self, source, part) -> float:
        """How much is searched of the part that an owner has."""
        (seconds,) = self.sql(
            "SELECT coalesce(sum(to_utc_us - from_utc_us), 0) / 1e6 FROM victorious.covered_times WHERE video_id = "
            f"(SELECT id FROM victorious.videos WHERE name = '{source}' ORDER BY id OFFSET {part - 1} LIMIT 1)"
        )
        return float(seconds)

    def test_live_source_goes_on_with_another_worker(self):
        for sent in (signal.SIGKILL, signal.SIGSTOP):
            with self.subTest(sent), streams.Broadcast(program.flight(600) / "flight.ts", seconds=60) as source:
                self.url = self.make_database()
                self.assertIn("1 video submitted, with 1 live source", self.submit(source).err)
                workers = [self.start_worker("--live", "--lease", 6) for _ in range(2)]
                owner = self.wait_for_owner(workers)
                owner.send_signal(sent)
                lost_s = time.monotonic()
                (other,) = (worker for worker in workers if worker is not owner)
                self.wait_until(lambda: self.source()["worker"].endswith(f":{other.pid}"))
                self.assertLess(time.monotonic() - lost_s, 6 + 8, "the lease, and a few seconds")
                self.wait_for_owner([other], part=2)
                self.assertEqual(self.events_of(owner), ["claimed", "lost"])
                self.assertLess(self.source()["behind_s"], 8)
                if sent == signal.SIGSTOP:  # its process went on until the other worker began
                    owner.send_signal(signal.SIGCONT)
                else:
                    self.assertEqual(len(self.source()["gaps"]), 1)
                    self.assertIn("was not indexed", self.succeeds("cluster", "status", "--db", self.url).out)
                self.assert_covered_once()
                self.succeeds("cluster", "end", source, "--db", self.url)
                self.wait_until(lambda: not self.status()["sources"])
                self.wait_until(lambda: self.events_of(other)[-1] == "done")
                for worker in workers:
                    worker.send_signal(signal.SIGINT)
                self.finish(*(worker for worker in workers if sent != signal.SIGKILL or worker is not owner))
                if sent == signal.SIGKILL:
                    owner.communicate()
                videos = self.sql("SELECT name FROM victorious.videos")
                self.assertEqual(videos, [source, source], "one for each owner")
                self.assertGreater(len(self.rows()), 3)
                self.refuses(2, "no such live source", "cluster", "end", source, "--db", self.url)

    def test_password_of_a_camera_is_not_shown(self):
        with streams.Rtsp(program.flight(600) / "flight.ts", seconds=60) as shown:
            self.submit(shown.replace("rtsp://", "rtsp://ann:secret@"))
            worker = self.start_worker("--live", "--lease", 6)
            self.wait_until(lambda: self.rows())
            self.assertEqual(self.source()["source"], shown)
            said = [self.succeeds("cluster", "status", "--db", self.url, *json).out for json in ([], ["--json"])]
            self.refuses(2, "no such live source", "cluster", "end", f"{shown}2", "--db", self.url)
            self.succeeds("cluster", "end", shown, "--db", self.url)
            self.wait_until(lambda: not self.status()["sources"])
            worker.send_signal(signal.SIGINT)
            said.append(worker.communicate(timeout=program.TIMEOUT_S)[1])
        said += [self.exported(self.url, form) for form in ("objects", "sightings")]
        for text in said:
            self.assertIn(shown, text)
            self.assertNotIn("secret", text)

    def test_gap_of_a_live_source_is_searched_from_its_recording(self):
        with streams.Broadcast(program.flight(600) / "flight.ts", seconds=60) as source:
            self.submit(source)
            folder = self.scratch / "recordings"
            command = [program.PROGRAM, "record", source, "--to", folder, "--db", self.url, "--segment", 3]
            recorder = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)
            self.addCleanup(recorder.kill)
            owner = self.start_worker("--live", "--lease", 6)
            self.wait_for_owner([owner])
            owner.kill()
            owner.communicate()
            other = self.start_worker("--live", "--lease", 6)
            self.wait_for_owner([other], part=2)
            self.assertEqual(len(self.source()["gaps"]), 1)
            searcher = self.start_worker("--lease", 6)  # the recorder may enter the last file of the gap after the others
            self.wait_until(lambda: self.source()["gaps"] == [])
            searcher.send_signal(signal.SIGINT)
            self.finish(searcher)
            recorder.kill()  # what it had not completed stays for the next one
            recorder.communicate()
            self.assert_covered_once()
            self.succeeds("cluster", "end", source, "--db", self.url)
            self.wait_until(lambda: not self.status()["sources"])
            other.send_signal(signal.SIGINT)
            self.finish(other)
        covered = self.sql(
            "SELECT v.name FROM victorious.covered_times c JOIN victorious.videos v ON v.id = c.video_id "
            "ORDER BY c.from_utc_us"
        )
        self.assertGreaterEqual(covered.count(source), 2)
        self.assertEqual(covered[-1], source)
        of_files = [name for name in covered if name.startswith(str(folder))]
        self.assertGreater(len(of_files), 1)
        found = {json.loads(row)["video"] for row in self.exported(self.url, "sightings").splitlines()}
        self.assertTrue(found & set(of_files), "what passed meanwhile is found")

    def assert_covered_once(self):
        """No time of the source was searched by two."""
        overlaps = self.sql(
            "SELECT count(*) FROM victorious.covered_times a JOIN victorious.covered_times b ON a.source = b.source AND "
            "(a.video_id, a.from_frame) < (b.video_id, b.from_frame) AND a.from_utc_us < b.to_utc_us - 50000 AND "
            "b.from_utc_us < a.to_utc_us - 50000"
        )
        self.assertEqual(overlaps, ["0"])

    def test_bad_arguments(self):
        models = program.models()
        self.refuses(2, ["--db", "postgresql://"], "submit", self.videos[0], "--models", models, "--db", "x.db")
        self.refuses(2, ["--db", "postgresql://"], "work", "--db", "x.db")
        self.refuses(2, ["--db", "postgresql://"], "cluster", "status", "--db", "x.db")
        self.refuses(2, "nothing to search for", "submit", self.videos[0], "--db", self.url)
        self.refuses(2, "no models", "submit", self.videos[0], "--models", self.scratch, "--db", self.url)
        self.refuses(2, "none.mkv", "submit", "none.mkv", "--models", models, "--db", self.url)
        self.refuses(2, "--every", "submit", self.videos[0], "--models", models, "--db", self.url, "--every", -1)
        self.refuses(2, "quality", "submit", self.videos[0], "--models", models, "--db", self.url, "--quality", "best")
        self.refuses(2, "--db postgresql://", "index", self.videos[0], "--models", models, "--db", "x.db", "--cut", 60)
        index = ("index", self.videos[0], "--models", models, "--db", self.url)
        for frames in ("5", "5:", "5:5", "-1:5", "a:b"):
            self.refuses(2, "FROM:TO", *index, f"--frames={frames}")
        self.refuses(2, "one whole video", *index, "--cut", 60, "--from", 1)
        self.refuses(2, "--budget-ms", *index, "--cut", 60, "--budget-ms", 33)
        self.refuses(2, "no index in this database", "work", "--db", self.url)
        self.refuses(2, "belong together", "work", "--db", self.url, "--content", self.scratch)
        content = ("--content", self.scratch / "none", "--cache", self.scratch / "cache")
        self.refuses(2, ["none", "--publish"], "work", "--db", self.url, *content)
        self.refuses(2, "not a kind of address", "submit", "gopher://h/", "--models", models, "--db", self.url)
        self.refuses(2, "--live and --until-empty", "work", "--db", self.url, "--live", "--until-empty")
        record = ("record", "udp://127.0.0.1:1", "--to", self.scratch / "recordings", "--db", "x.db")
        self.refuses(2, ["--db", "postgresql://"], *record)
        self.refuses(2, "not named as a recording", *index, "--covers", "udp://a:1")
        self.refuses(2, ["--db", "postgresql://"], "cluster", "end", "udp://a:1", "--db", "x.db")
        done = program.run("submit", "none.mkv", self.videos[0], "--models", models, "--db", self.url)
        self.assertEqual(done.status, 2)
        self.assertIn("none.mkv", done.messages()[-1])
        self.assertEqual(self.status()["queued"], 1, "the others are submitted")
        again = self.succeeds("submit", self.videos[0], "--models", models, "--db", self.url, "--json").rows()
        self.assertEqual(again, [{"submitted": 0, "submitted_before": 1, "done": 0, "queued": 1, "running": 0}])


if __name__ == "__main__":
    program.main()
