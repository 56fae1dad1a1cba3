"""The page in a real browser: triage by mouse and keys, the list, the map, what axe and narrow windows find."""

import contextlib
import json
import shutil
import sqlite3

import page
import program
import tiles


class PageTest(page.PageTest):
    def index_placed(self):
        """An index of the drawn flight, with places of its objects."""
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        db = self.index(video)
        self.place_objects(db, video)
        return db

    def test_triage(self):
        db = self.index_placed()
        self.drive("triage", db, "--models", program.models())

    def test_links(self):
        """A link finds its object after a new search from nothing, which gives it another id."""
        db = self.index(program.flight() / "flight.mp4")
        before = self.drive("link", db)
        self.index(program.flight() / "flight.mp4", "--redo")
        self.drive("link", db, inputs=(json.loads(before)["link"], before))

    def test_accessible(self):
        """axe finds nothing in the main states."""
        db = self.index_placed()
        models = self.scratch / "models"
        shutil.copytree(program.models(), models)
        self.drive("accessible", db, "--models", models)

    def test_tablet(self):
        """Narrow windows, and a laptop's at 200 %."""
        db = self.index_placed()
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
        self.join_first_objects(db)
        self.drive("videos", db, "--models", program.models())

    def join_first_objects(self, db):
        """Makes the first object of the first video and one of the second the same, seen there for longer."""
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            ((model, one),) = index.execute("SELECT model_id, object_id FROM tracklets WHERE video_id = 1 ORDER BY id LIMIT 1").fetchall()
            ((two, tracklet),) = index.execute(
                "SELECT object_id, id FROM tracklets WHERE video_id = 2 AND model_id = ? ORDER BY id LIMIT 1", (model,)
            ).fetchall()
            index.execute("UPDATE tracklets SET object_id = ?, last_time_s = last_time_s + 0.5 WHERE id = ?", (one, tracklet))
            index.execute("DELETE FROM objects WHERE id = ? AND id NOT IN (SELECT object_id FROM tracklets)", (two,))

    def test_many_objects(self):
        """3000 drawn rows: ten are of the model "rare"."""
        self.drive("many", self.draw_index([(2 if n % 300 == 7 else 1, 1 - n / 3100) for n in range(1, 3001)]))

    def test_thresholds(self):
        """Twenty objects of "common" with scores from 0.99 down to 0.04, four of "rare"."""
        self.drive("thresholds", self.draw_index([*((1, 0.99 - 0.05 * n) for n in range(20)), *((2, 0.1 * n) for n in range(1, 5))]))

    def test_grouping(self):
        """Objects are joined and split by a person: three of "common", one of "rare"."""
        self.drive("grouping", self.draw_index([(1, 0.9), (1, 0.8), (2, 0.7), (1, 0.6)]))

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


if __name__ == "__main__":
    program.main()
