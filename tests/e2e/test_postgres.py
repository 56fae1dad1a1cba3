"""An index in PostgreSQL: the commands take its URL, and print what they print of a file."""

import json
import subprocess
import unittest

import program


class Postgres:
    """A scratch server (tools/scratch_postgres.sh and its flags), as a context manager."""

    def __init__(self, *flags):
        self.flags = flags

    def __enter__(self) -> "Postgres":
        self.process = subprocess.Popen(
            [program.REPOSITORY / "tools" / "scratch_postgres.sh", *self.flags],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.url = self.process.stdout.readline().strip()
        if not self.url.startswith("postgresql://"):
            status = self.process.wait()
            self.__exit__()
            assert status == program.SKIPPED, "tools/scratch_postgres.sh failed"
            raise unittest.SkipTest(f"SKIPPED: {self.url}")
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait(timeout=program.TIMEOUT_S)


class PostgresTest(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.url = cls.enterClassContext(Postgres()).url

    def same(self, *command) -> str:
        """What a command prints of the database, which is what it prints of the file."""
        of_database = self.succeeds(*command, "--db", self.url).out
        self.assertEqual(of_database, self.succeeds(*command, "--db", program.index()).out, command)
        return of_database

    def test_database_holds_what_a_file_holds(self):
        self.refuses(2, ["no index in this database", "victorious index"], "search", "--db", self.url)
        flight = program.flight()
        self.succeeds("index", flight / "flight.mkv", "--models", program.models(), "--db", self.url)
        self.assertGreater(len(self.same("export", "--format", "objects").splitlines()), 1)
        self.assertGreater(len(self.same("export", "--format", "sightings").splitlines()), 10)
        for form in ("coco", "geojson", "kml", "mot"):
            self.same("export", "--format", form)
        self.same("export", "--format", "sightings", "--model", "truck", "--from", "0.2", "--to", "1")
        self.same("search", "--json")
        self.same("search", "--image", flight / "truck.png", "--json")
        self.same("evaluate", "--truth", flight / "truth.jsonl", "--json")
        sheets = [self.scratch / "database.png", self.scratch / "file.png"]
        for sheet, db in zip(sheets, (self.url, program.index())):
            self.succeeds("sheet", "--db", db, "--out", sheet)
        self.assertEqual(*(sheet.read_bytes() for sheet in sheets))
        described = json.loads(self.succeeds("doctor", self.url, "--json").out)
        self.assertEqual((described["kind"], len(described["videos"])), ("index", 1))
        self.assertIn("an index without damage", self.succeeds("doctor", "--check", self.url).out)
        drawn = [self.scratch / "database.mp4", self.scratch / "file.mp4"]
        for video, db in zip(drawn, (self.url, program.index())):
            self.succeeds("export", "--db", db, "--format", "video", "--out", video)
        self.assertEqual(*(video.read_bytes() for video in drawn))

        again = self.succeeds("index", flight / "flight.mkv", "--models", program.models(), "--db", self.url)
        self.same("export", "--format", "sightings")
        self.assertEqual(again.status, 0, "nothing is left to do")


class AddressTest(program.ProgramTest):
    def test_errors_name_the_database_without_its_password(self):
        for command in (["search"], ["export", "--format", "objects"], ["evaluate", "--truth", program.flight() / "truth.jsonl"]):
            said = self.refuses(2, ["postgresql://me@127.0.0.1:1/videos", "start the server"], *command,
                                "--db", "postgresql://me:secret@127.0.0.1:1/videos")  # fmt: skip
            self.assertNotIn("secret", said)
        self.refuses(2, "postgresql://", "search", "--db", "postgresql://host:port/x%")
        for command in (["serve"], ["user", "list"]):
            said = self.refuses(2, ["postgresql://me@127.0.0.1:1/videos", "start the server"], *command,
                                "--db", "postgresql://me:secret@127.0.0.1:1/videos")  # fmt: skip
            self.assertNotIn("secret", said)


if __name__ == "__main__":
    program.main()
