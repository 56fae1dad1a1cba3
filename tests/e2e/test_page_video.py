"""The page in a real browser: box and frame belong together, the views of a model turn."""

import contextlib
import shutil
import sqlite3
import subprocess

import page
import program

DRAW_NUMBERS = program.built("draw_numbers", "VICTORIOUS_DRAW_NUMBERS")


class PageTest(page.PageTest):
    def index_numbers(self, name):
        """An index of a video in whose frames their numbers are drawn."""
        video, db = self.scratch / name, self.scratch / f"{name}.db"
        subprocess.run([DRAW_NUMBERS, video], check=True)
        self.succeeds("index", video, "--models", program.models(), "--db", db)
        return db

    def test_overlay_belongs_to_its_frame(self):
        """At a varying rate with B-frames; with an edit list that leaves out the first frames."""
        for name in ("numbers.mp4", "numbers.edit.mp4"):
            with self.subTest(name):
                self.drive("frames", self.index_numbers(name))

    def test_time_line_shows_what_was_searched(self):
        self.drive("coverage", self.index(program.flight() / "flight.mp4", "--to", "0.3"))

    def test_copies_show_the_same_frames(self):
        """Remuxed (H.264 in MPEG-TS) and encoded again (MPEG-1)."""
        for name in ("numbers.ts", "numbers.mpg"):
            with self.subTest(name):
                self.drive("copies", self.index_numbers(name), "--models", program.models())

    def test_zoom(self):
        """Zoom and pan, native pixels, brightness, magnifier, full screen; what is drawn and clicked follows."""
        models = self.scratch / "models"
        shutil.copytree(program.models(), models)
        self.drive("zoomed", self.index(program.flight() / "flight.mp4"), "--models", models)

    def test_shows_a_format_that_the_browser_cannot_play(self):
        video = self.scratch / "frames"
        video.mkdir()
        for name in ("1.png", "2.png", "3.png"):
            shutil.copy(program.flight() / "crate.png", video / name)
        self.drive("images", self.index(video))

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


if __name__ == "__main__":
    program.main()
