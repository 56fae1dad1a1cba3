"""A read-only folder or file: exit status 1, a one-line error with its name, no files left behind.

Root can write anywhere, so for root the program runs as user nobody.
"""

import os
import subprocess
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()
CRATE = program.flight() / "crate.png"
NOBODY = 65534
AS_NOBODY = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.geteuid() == 0 else {}


def may_run_as_nobody() -> bool:
    """Checks that user nobody can start the program and cannot write to read-only folders."""
    try:
        return subprocess.run([program.PROGRAM, "--version"], capture_output=True, check=False, **AS_NOBODY).returncode == 0
    except OSError:
        return False


@unittest.skipUnless(may_run_as_nobody(), "SKIPPED: the program cannot be run by one who may not write everywhere")
class ReadOnlyTest(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        for path in (program.flight(), MODELS.parent, INDEX.parent):
            path.chmod(0o755)
        INDEX.chmod(0o644)

    def setUp(self):
        super().setUp()
        self.scratch.chmod(0o755)
        self.folder = self.scratch / "folder"
        self.folder.mkdir()

    def lock(self):
        for path in self.folder.iterdir():
            path.chmod(0o444)
        self.folder.chmod(0o555)
        self.addCleanup(self.folder.chmod, 0o755)

    def refuses_to_write(self, *arguments):
        before = self.files()
        self.refuses(1, self.folder, *arguments, **AS_NOBODY)
        self.assertEqual(self.files(), before)

    def test_results(self):
        self.lock()
        for arguments in (
            ("model", "add", "x", CRATE, "--models", self.folder),
            ("model", "add", "x", CRATE, "--models", self.folder / "models"),
            ("features", CRATE, "--out", self.folder / "features.txt"),
            ("export", "--db", INDEX, "--format", "mot", "--out", self.folder / "mot.txt"),
            ("sheet", "--db", INDEX, "--out", self.folder / "sheet.png"),
            ("index", VIDEO, "--models", MODELS, "--db", self.folder / "index.db"),
        ):
            with self.subTest(arguments[0]):
                self.refuses_to_write(*arguments)

    def test_index_is_read_only(self):
        db = self.folder / "index.db"
        db.write_bytes(INDEX.read_bytes())
        self.lock()
        self.refuses_to_write("index", VIDEO, "--models", MODELS, "--db", db)
        before = self.files()
        for arguments in (
            ("search", "--db", db),
            ("search", "--db", db, "--image", CRATE),
            ("export", "--db", db, "--format", "sightings"),
            ("doctor", db),
        ):
            self.assertEqual(self.succeeds(*arguments, **AS_NOBODY).err, "")
        self.assertEqual(self.files(), before)

    def test_library_is_read_only(self):
        (self.folder / "crate.vmodel").write_bytes((MODELS / "crate.vmodel").read_bytes())
        self.lock()
        self.succeeds("model", "list", "--models", self.folder, **AS_NOBODY)
        self.refuses_to_write("model", "remove", "crate", "--models", self.folder)

    def test_unreadable_files(self):
        secret = self.write("secret/photo.png", CRATE.read_bytes())
        secret.chmod(0)
        for folder in (self.scratch, self.folder):
            folder.chmod(0o777)  # else this is what is refused
        for arguments in (
            ("model", "add", "x", secret, "--models", self.folder / "models"),
            ("index", secret, "--models", MODELS, "--db", self.scratch / "index.db"),
            ("search", "--db", secret),
        ):
            with self.subTest(arguments[0]):
                self.refuses(1, secret, *arguments, **AS_NOBODY)


if __name__ == "__main__":
    program.main()
