"""A full disk: exit status 1, a one-line error, no partial output; the work resumes when there is space again.

Uses a small file system if the system allows mounting one (in a mount namespace, so that it is removed with the
program), and the file size limit otherwise.
"""

import resource
import signal
import subprocess
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()
CRATE = program.flight() / "crate.png"
NO_RIGHT = 77
ON_A_SMALL_DISK = f"""
place=$1; size=$2; listing=$3; shift 3
mount -t tmpfs -o size="$size" none "$place" 2>/dev/null || exit {NO_RIGHT}
"$@"; status=$?
ls -A "$place" >"$listing"
exit $status
"""


class FileLimitTest(program.ProgramTest):
    def refuses_beyond(self, limit, *arguments):
        def limited():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        before = self.files().keys()
        self.refuses(1, "", *arguments, preexec_fn=limited)
        return self.files().keys() - before

    def test_results(self):
        for arguments in (
            ("model", "add", "crate", CRATE, "--models", self.scratch / "models"),
            ("features", CRATE, "--out", self.scratch / "features.txt"),
            ("export", "--db", INDEX, "--format", "sightings", "--out", self.scratch / "sightings.jsonl"),
            ("sheet", "--db", INDEX, "--out", self.scratch / "sheet.png"),
            ("frame", VIDEO, "--number", "0", "--out", self.scratch / "frame.png"),
        ):
            with self.subTest(arguments[0]):
                self.assertEqual(self.refuses_beyond(1000, *arguments), set())
                self.succeeds(*arguments)

    def test_index_resumes_when_there_is_space(self):
        size = INDEX.stat().st_size
        for limit in (30_000, size // 2):
            with self.subTest(limit):
                db = self.scratch / f"{limit}.db"
                command = ("index", VIDEO, "--models", MODELS, "--db", db)
                self.refuses_beyond(limit, *command)
                self.refuses_beyond(limit, *command)
                self.succeeds(*command)
                for form in ("objects", "sightings"):
                    self.assertEqual(self.export(db, form), self.export(INDEX, form))

    def test_standard_output(self):
        for arguments in (
            ("export", "--db", INDEX, "--format", "sightings"),
            ("search", "--db", INDEX, "--json"),
            ("params",),
        ):
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run(
                    [program.PROGRAM, *map(str, arguments)], stdout=full, stderr=subprocess.PIPE, text=True, check=False
                )
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, r"\Aerror: .*standard output.*\n\Z")

    def test_closed_output(self):
        """As in `victorious export ... | head -1`: a closed pipe is not reported as an error."""
        with subprocess.Popen(
            [program.PROGRAM, "export", "--db", INDEX, "--format", "coco"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as export:
            export.stdout.close()
            reported = export.stderr.read()
            self.assertIn(export.wait(), (0, -signal.SIGPIPE))
        self.assertEqual(reported, b"")


class SmallDiskTest(program.ProgramTest):
    def on_a_small_disk(self, size, *arguments):
        """Returns the outcome and the names of the files left on the disk."""
        place, listing = self.scratch / "disk", self.scratch / "listing"
        place.mkdir(exist_ok=True)
        command = [place, size, listing, program.PROGRAM, *arguments]
        for namespace in (["unshare", "-m"], ["unshare", "-rm"]):
            done = subprocess.run(
                [*namespace, "sh", "-c", ON_A_SMALL_DISK, "sh", *map(str, command)],
                capture_output=True, text=True, check=False,
            )  # fmt: skip
            if listing.exists():
                return program.Outcome(done.returncode, done.stdout, done.stderr), listing.read_text().split()
        self.skipTest("SKIPPED: no right to mount a file system here")

    def test_results(self):
        place = self.scratch / "disk"
        for arguments, names in (
            (("model", "add", "crate", CRATE, "--models", place), []),
            (("features", CRATE, "--out", place / "features.txt"), []),
            (("export", "--db", INDEX, "--format", "sightings", "--out", place / "sightings.jsonl"), []),
            (
                ("index", VIDEO, "--models", MODELS, "--db", place / "index.db"),
                ["index.db", "index.db-wal", "index.db-shm"],  # the write-ahead log contains commits: it is part of the index
            ),
        ):
            for size in (4096, 8192):
                with self.subTest(f"{arguments[0]} {size}"):
                    done, left = self.on_a_small_disk(size, *arguments)
                    self.assertEqual(done.status, 1, done.err)
                    self.assertEqual(len(done.messages()), 1, done.err)
                    self.assertRegex(done.messages()[0], r"^error: .*[Nn]o space left")
                    self.assertLessEqual(set(left), set(names), done.err)


if __name__ == "__main__":
    program.main()
