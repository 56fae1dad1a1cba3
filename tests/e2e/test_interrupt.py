"""`index`, stopped at any moment by the user or by SIGKILL, resumes, with the same final result as without the stop."""

import contextlib
import random
import signal
import sqlite3
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import program

FRAMES = 100
SEED = 20240611
VIDEO = program.flight(FRAMES) / "flight.mkv"


def contents(path):
    """The content of the index including kept frames, which the exports do not show."""
    with contextlib.closing(sqlite3.connect(path)) as db:
        columns = [row[1] for row in db.execute("PRAGMA table_info(tracklets)")]
        columns.remove("revision")  # counts the commits
        return [
            db.execute(query).fetchall()
            for query in (
                "SELECT * FROM objects ORDER BY id",
                f"SELECT {', '.join(columns)} FROM tracklets ORDER BY id",
                "SELECT * FROM sightings ORDER BY video_id, frame, tracklet_id",
                "SELECT video_id, frame, time_s, keypoints, descriptors FROM kept_frames ORDER BY video_id, frame",
                "SELECT video_id, model_id, next_frame, finished FROM searches ORDER BY video_id, model_id",
                "SELECT frame_count, duration_s FROM videos",
            )
        ]


def command(db):
    # Every frame is kept, so that a commit happens every 32 frames.
    params = db.parent / "params.json"
    params.write_text('{"keep.interval_s": 0}')
    return ["index", VIDEO, "--models", program.models(), "--db", db, "--params", params, "--threads", "2"]


class InterruptTest(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        """Makes the index of a run without a stop, and measures its duration."""
        folder = tempfile.TemporaryDirectory(prefix="victorious-e2e-")
        cls.addClassCleanup(folder.cleanup)
        cls.whole = Path(folder.name) / "whole.db"
        begin = time.monotonic()
        done = program.run(*command(cls.whole))
        assert done.status == 0, done.err
        cls.duration_s = time.monotonic() - begin

    def setUp(self):
        super().setUp()
        self.db = self.scratch / "index.db"

    def start(self):
        return subprocess.Popen(
            [program.PROGRAM, *map(str, command(self.db))], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    def next_frame(self):
        """The progress of the search at its last commit."""
        with contextlib.suppress(sqlite3.OperationalError):
            with contextlib.closing(sqlite3.connect(f"file:{self.db}?mode=ro", uri=True, timeout=5)) as db:
                return db.execute("SELECT coalesce(max(next_frame), 0) FROM searches").fetchone()[0]
        return 0

    def wait_for_commit_after(self, frame, process):
        while process.poll() is None and self.next_frame() <= frame:
            time.sleep(0.01)

    def assert_same_as_whole(self):
        for form in ("objects", "sightings", "mot", "coco"):
            self.assertEqual(self.export(self.db, form), self.export(self.whole, form), form)
        self.assertEqual(contents(self.db), contents(self.whole))

    def test_killed_at_any_moment(self):
        moments = random.Random(SEED)
        kills = [moments.uniform(0, 0.5 * self.duration_s) for _ in range(5)]
        for delay_s in sorted(kills):  # the first during opening, the last after a commit
            with self.start() as process:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(delay_s)
                process.kill()
            self.export_while_unfinished()
        with self.start() as process:
            self.wait_for_commit_after(self.next_frame(), process)
            process.kill()
        self.succeeds(*command(self.db))
        self.assert_same_as_whole()
        self.assertIn("0 frames searched", self.succeeds(*command(self.db)).err)
        self.assertEqual(sorted(path.name for path in self.scratch.glob("index*")), ["index.db"])

    def export_while_unfinished(self):
        """The index after a kill can be read, if it exists."""
        done = program.run("export", "--db", self.db, "--format", "sightings")
        if done.status != 0:
            self.assertEqual((done.status, len(done.messages())), (2, 1), done.err)
            self.assertRegex(done.err, "[Nn]o such file|empty")

    def test_stopped_by_the_user(self):
        for stop in (signal.SIGINT, signal.SIGTERM):
            done = self.next_frame()
            with self.start() as process:
                self.wait_for_commit_after(done, process)
                process.send_signal(stop)
                out, err = process.communicate(timeout=program.TIMEOUT_S)
            if process.returncode == 0:
                break  # it had finished before
            outcome = program.Outcome(process.returncode, out, err)
            self.assertEqual(outcome.status, 128 + stop, err)
            self.assertEqual(len(outcome.messages()), 1, err)
            self.assertRegex(outcome.messages()[0], r"error: .*flight.mkv: stopped at frame \d+; run again to resume")
            self.assertEqual([path.name for path in self.scratch.glob("index*")], ["index.db"])
            self.assertGreater(self.next_frame(), done)
        self.succeeds(*command(self.db))
        self.assert_same_as_whole()

    def test_concurrent_readers(self):
        with self.start() as process:
            self.wait_for_commit_after(0, process)
            while process.poll() is None:
                self.assertEqual(program.run("export", "--db", self.db, "--format", "objects").status, 0)
            self.assertEqual(process.returncode, 0)


if __name__ == "__main__":
    program.main()
