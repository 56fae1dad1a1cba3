"""The page in a real browser: jobs, workers, live streams, accounts, and what several tabs and persons do."""

import shutil

import page
import program
import streams
from test_postgres import Postgres


class PageTest(page.PageTest):
    def test_jobs(self):
        db, models = self.scratch / "index.db", self.scratch / "models"
        db.touch()
        models.mkdir()
        photos = ",".join(str(program.flight() / f"{name}.png") for name in ("crate", "truck"))
        self.drive("jobs", db, "--models", models, inputs=(photos, program.flight() / "flight.mp4"))

    def test_first_steps(self):
        """From an empty folder, without a flag, to the first finds."""
        folder = self.scratch / "nothing"
        folder.mkdir()
        self.drive("steps", None, cwd=folder, inputs=(program.flight() / "crate.png", program.flight() / "flight.mp4"))
        self.assertEqual(sorted(one.name for one in folder.glob("*.vmodel")), [])
        self.assertEqual([one.name for one in (folder / "models").glob("*.vmodel")], ["crate.vmodel"])

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

    def test_live_sources(self):
        """A transport stream by UDP, RTSP and SRT, sent as it would be filmed."""
        flight = program.flight(300)
        for kind in (streams.Udp, streams.Rtsp, streams.Srt):
            with self.subTest(kind.__name__), kind(flight / "flight.ts", seconds=120) as source:
                db = self.scratch / f"{kind.__name__}.db"
                db.touch()
                self.drive("live", db, "--models", program.models(), inputs=(source,))

    def test_accounts(self):
        db = self.index(program.flight() / "flight.mp4")
        password = "correct horse battery"
        for name, role in (("ann", "analyst"), ("bob", "viewer")):
            self.succeeds("user", "add", name, "--role", role, "--db", db, input=password)
        self.drive("accounts", db, "--models", program.models(), inputs=(password,))

    def test_tabs(self):
        self.drive("tabs", self.index(program.flight() / "flight.mp4"))

    def test_notes(self):
        """Letters typed right after an object is selected belong to its note, also where the browser draws late."""
        self.drive("notes", self.draw_index([(1, 0.9), (1, 0.8)]))


if __name__ == "__main__":
    program.main()
