"""An index in PostgreSQL: the commands take its URL, and print what they print of a file."""

import json
import re
import shutil
import subprocess
import unittest
import urllib.request

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

        # As docs/cluster.md copies a database and restores it: pg_dump reads one moment of it.
        if shutil.which("pg_dump") is None:
            return
        found = self.same("export", "--format", "objects")
        dump = self.scratch / "videos.dump"
        subprocess.run(["pg_dump", "--format", "custom", "--schema", "victorious", "--dbname", self.url, "--file", dump], check=True)
        subprocess.run(["psql", "--quiet", "--dbname", self.url, "--command", "DROP SCHEMA victorious CASCADE"], check=True,
                       stderr=subprocess.DEVNULL)  # fmt: skip
        self.refuses(2, "no index in this database", "search", "--db", self.url)
        subprocess.run(["pg_restore", "--dbname", self.url, "--no-owner", dump], check=True)
        self.assertEqual(self.same("export", "--format", "objects"), found)
        self.assertIn("an index without damage", self.succeeds("doctor", "--check", self.url).out)


# Tries each kind of access to each table, as the role of the connection: "table SELECT", "table UPDATE column".
TRY_EVERYTHING = """
CREATE TEMPORARY TABLE allowed (what text);
DO $$
DECLARE
  tried record;
  is_allowed boolean;
BEGIN
  FOR tried IN
    SELECT relname || ' ' || kind AS what, format(statement, oid::regclass) AS statement
    FROM pg_class CROSS JOIN (VALUES ('SELECT', 'SELECT FROM %s LIMIT 0'), ('INSERT', 'INSERT INTO %s DEFAULT VALUES'),
                                     ('DELETE', 'DELETE FROM %s WHERE false')) AS kinds (kind, statement)
    WHERE relnamespace = 'victorious'::regnamespace AND relkind IN ('r', 'p', 'v') AND (relkind <> 'v' OR kind = 'SELECT')
    UNION ALL
    SELECT relname || ' UPDATE ' || attname, format('UPDATE %s SET %I = DEFAULT WHERE false', c.oid::regclass, attname)
    FROM pg_class c JOIN pg_attribute a ON a.attrelid = c.oid AND attnum > 0 AND NOT attisdropped
    WHERE relnamespace = 'victorious'::regnamespace AND relkind IN ('r', 'p')
  LOOP
    BEGIN
      EXECUTE tried.statement;
      RAISE EXCEPTION 'taken back';
    EXCEPTION WHEN insufficient_privilege THEN is_allowed := false; WHEN OTHERS THEN is_allowed := true;
    END;
    IF is_allowed THEN INSERT INTO allowed VALUES (tried.what); END IF;
  END LOOP;
END $$;
SELECT what FROM allowed
"""

RIGHTS = {
    "reader": {"SELECT": {"reviews", "decisions", "reviewed_tracklets", "thresholds"}},
    "worker": {
        "INSERT": {"videos", "searches", "tracklets", "kept_fits", "search_parts", "video_cuts", "recordings", "models", "kept_frames",
                   "shown_ground", "gaps", "segments", "tasks", "covered_times", "options", "sightings", "task_log", "objects",
                   "association_options"},
        "UPDATE": {"videos", "searches", "tracklets", "kept_fits", "search_parts", "video_cuts", "recordings", "segments", "tasks",
                   "covered_times", "objects", "association_options"},
        "DELETE": {"videos", "searches", "tracklets", "kept_fits", "search_parts", "video_cuts", "recordings", "models", "kept_frames",
                   "shown_ground", "gaps", "objects"},
    },
    "server": {
        "SELECT": {"reviews", "decisions", "reviewed_tracklets", "thresholds", "accounts", "credentials", "jobs", "audit"},
        "INSERT": {"reviews", "decisions", "thresholds", "jobs", "accounts", "credentials", "audit", "tracklet_links", "tracklet_link_ends",
                   "association_options", "kept_fits", "objects"},
        "UPDATE": {"reviews", "decisions", "thresholds", "jobs", "accounts", "credentials", "association_options", "kept_fits", "objects",
                   "tracklets"},
        "DELETE": {"reviews", "decisions", "thresholds", "jobs", "accounts", "credentials", "tracklet_links", "kept_fits", "objects"},
    },
}  # fmt: skip
REVIEW_COLUMNS = {"verdict", "note", "reviewer", "reviewed_utc_us", "is_contested"}
# What everybody of these roles reads: what was found, and what workers do.
FOUND = {"version", "videos", "models", "options", "searches", "objects", "tracklets", "sightings", "kept_frames", "kept_fits", "search_parts",
         "shown_ground", "covered_times", "tasks", "task_log", "video_cuts", "segments", "gaps", "recordings",
         "tracklet_links", "tracklet_link_ends", "association_options"}  # fmt: skip


class RolesTest(program.ProgramTest):
    """The roles of docs/cluster.md, by the statements that stand there."""

    @classmethod
    def setUpClass(cls):
        cls.url = cls.enterClassContext(Postgres()).url

    def setUp(self):
        super().setUp()
        self.sql(self.url, "DROP SCHEMA IF EXISTS victorious CASCADE")
        self.video = self.scratch / "flight.mp4"
        self.video.write_bytes((program.flight() / "flight.mp4").read_bytes())
        self.succeeds("index", self.video, "--models", program.models(), "--db", self.url)
        rights = (program.REPOSITORY / "docs" / "cluster.md").read_text().split("## Rights")[1].split("\n## ")[0]
        self.blocks = re.findall(r"^```\n(GRANT .*?)^```", rights, re.MULTILINE | re.DOTALL)
        self.assertEqual(len(self.blocks), len(RIGHTS))
        for role, block in zip(RIGHTS, self.blocks):
            self.sql(self.url, f"DO $$ BEGIN CREATE ROLE {role} LOGIN; EXCEPTION WHEN duplicate_object THEN END $$; {block}")

    def sql(self, url, statement) -> list[str]:
        command = ["psql", url, "--quiet", "--no-align", "--tuples-only", "--set=ON_ERROR_STOP=1", "--command", statement]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def of(self, role) -> str:
        return self.url.replace("victorious@", f"{role}@")

    def test_each_table_as_each_role(self):
        parts = re.compile(r"sightings_\d+ SELECT")  # of a table whose rights count
        for role, rights in RIGHTS.items():
            tried = [line for line in self.sql(self.of(role), TRY_EVERYTHING) if not parts.fullmatch(line)]
            allowed = {kind: {} for kind in ("SELECT", "INSERT", "UPDATE", "DELETE")}
            for table, kind, *column in map(str.split, tried):
                allowed[kind].setdefault(table, set()).update(column)
            for kind, tables in allowed.items():
                expected = rights.get(kind, set()) | (FOUND if kind == "SELECT" else set())
                self.assertEqual(set(tables), expected, f"{role} {kind}")
            columns = allowed["UPDATE"].get("objects", set())
            if role == "worker":
                self.assertEqual(columns & (REVIEW_COLUMNS | {"id", "model_id"}), set())
                refused = "INSERT INTO victorious.objects (id, model_id, verdict) VALUES (9, 1, 'accepted')"
                command = ["psql", self.of(role), "--command", refused]
                done = subprocess.run(command, check=False, capture_output=True, text=True)
                self.assertIn("permission denied", done.stderr)
            if role == "server":
                self.assertEqual(columns & (REVIEW_COLUMNS | {"id", "model_id"}), REVIEW_COLUMNS)
                self.assertEqual(allowed["UPDATE"]["tracklets"], {"object_id"})

    def test_each_role_does_its_work(self):
        server, worker, reader = (self.of(role) for role in ("server", "worker", "reader"))
        (number, *_) = (row["object_id"] for row in self.succeeds("search", "--db", reader, "--json").rows())
        with program.Server(server, "--uploads", self.scratch / "u", "--copies", self.scratch / "c") as page:
            request = urllib.request.Request(
                f"{page.url}/api/v1/objects/{number}/review", b'{"verdict": "rejected", "note": "a shadow", "reviewer": "ann"}',
                {"Content-Type": "application/json"}, method="PUT",
            )  # fmt: skip
            self.assertEqual(urllib.request.urlopen(request).status, 200)
        self.succeeds("user", "add", "ann", "--role", "admin", "--db", server, input="correct horse battery")
        models = ("--models", program.models(), "--db", worker)
        self.succeeds("index", self.video, *models, "--redo")
        kept = self.sql(self.url, "SELECT o.verdict, o.note, d.reviewer FROM victorious.objects o JOIN victorious.decisions d"
                                  " ON d.object_id = o.id")  # fmt: skip
        self.assertEqual(kept, ["rejected|a shadow|ann"], "the review follows the object that was found again")
        other = self.scratch / "other.mkv"
        other.write_bytes((program.flight() / "flight.mkv").read_bytes())
        self.succeeds("submit", other, *models, "--segment", 1)
        self.succeeds("submit", "udp://127.0.0.1:9", *models)
        self.succeeds("work", "--db", worker, "--until-empty", "--threads", 2)
        self.succeeds("cluster", "end", "udp://127.0.0.1:9", "--db", worker)
        status = json.loads(self.succeeds("cluster", "status", "--db", reader, "--json").out)
        self.assertEqual(status["done"], 1, status)
        self.assertGreater(len(self.succeeds("export", "--db", reader, "--format", "objects").rows()), 1)
        of_one_model = "SELECT min(id) || ' ' || max(id) FROM victorious.objects GROUP BY model_id HAVING count(*) > 1"
        first, second = self.sql(self.url, of_one_model)[0].split()
        self.succeeds("object", "join", first, second, "--db", server)
        self.refuses(1, "permission denied", "object", "split", first, "--video", other, "--db", worker)
        self.refuses(1, "permission denied", "index", self.video, "--models", program.models(), "--db", reader, "--redo")


class AddressTest(program.ProgramTest):
    def test_errors_name_the_database_without_its_password(self):
        for command in (["search"], ["export", "--format", "objects"], ["evaluate", "--truth", program.flight() / "truth.jsonl"]):
            said = self.refuses(1, ["postgresql://me@127.0.0.1:1/videos", "start the server"], *command,
                                "--db", "postgresql://me:secret@127.0.0.1:1/videos")  # fmt: skip
            self.assertNotIn("secret", said)
        self.refuses(2, "postgresql://", "search", "--db", "postgresql://host:port/x%")
        for command in (["serve"], ["user", "list"]):
            said = self.refuses(1, ["postgresql://me@127.0.0.1:1/videos", "start the server"], *command,
                                "--db", "postgresql://me:secret@127.0.0.1:1/videos")  # fmt: skip
            self.assertNotIn("secret", said)


if __name__ == "__main__":
    program.main()
