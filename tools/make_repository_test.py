#!/usr/bin/env python3
"""Tests of make_repository.sh: apt itself reads the repository, of small packages made here."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parent / "make_repository.sh"


def control(name: str, version: str) -> str:
    return f"Package: {name}\nVersion: {version}\nArchitecture: amd64\nMaintainer: a <a@b>\nDescription: small\n"


class RepositoryTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        self.packages = self.folder / "build"
        self.packages.mkdir()

    def pack(self, name: str, version: str) -> None:
        tree = self.folder / f"{name}_{version}"
        (tree / "DEBIAN").mkdir(parents=True)
        (tree / "DEBIAN/control").write_text(control(name, version))
        subprocess.run(["dpkg-deb", "--root-owner-group", "--build", tree, self.packages], check=True, capture_output=True)

    def make(self, folder: str = "repository", **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run([SCRIPT, self.packages, f"{self.folder}/{folder}"], capture_output=True, text=True,
                              env=os.environ | environment)  # fmt: skip

    def apt(self, command: str, *arguments: str, trust: str = "trusted=yes", status: int = 0) -> str:
        """apt with folders of its own, which knows this repository and no other."""
        (self.folder / "sources.list").write_text(f"deb [{trust}] file:{self.folder}/repository ./\n")
        for name in ("lists/partial", "cache/archives/partial", "parts", "keys"):
            (self.folder / "apt" / name).mkdir(parents=True, exist_ok=True)
        (self.folder / "apt/status").touch()
        options = {"Dir::Etc::sourcelist": self.folder / "sources.list", "Dir::Etc::sourceparts": self.folder / "apt/parts",
                   "Dir::State::lists": self.folder / "apt/lists", "Dir::State::status": self.folder / "apt/status",
                   "Dir::Cache": self.folder / "apt/cache", "APT::Architecture": "amd64", "APT::Sandbox::User": "",
                   "APT::Get::List-Cleanup": "0"}  # fmt: skip
        words = [word for name, value in options.items() for word in ("-o", f"{name}={value}")]
        done = subprocess.run([command, *words, *arguments], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout

    def test_apt_trusts_the_key_that_signed(self):
        self.pack("victorious", "0.1.0")
        home = self.folder / "gnupg"
        home.mkdir(mode=0o700)
        made = ["gpg", "--batch", "--passphrase", "", "--quick-generate-key", "a <a@b>", "rsa2048", "sign", "never"]
        subprocess.run(made, check=True, capture_output=True, env=os.environ | {"GNUPGHOME": str(home)})
        done = self.make(GNUPGHOME=str(home), SIGN_KEY="a <a@b>")
        self.assertEqual(done.returncode, 0, done.stderr)
        trust = f"signed-by={self.folder}/repository/victorious.asc"
        self.apt("apt-get", "update", trust=trust)
        self.assertIn("Candidate: 0.1.0", self.apt("apt-cache", "policy", "victorious", trust=trust))
        signed = self.folder / "repository/InRelease"
        signed.write_text(signed.read_text().replace("Label: VICTORIOUS", "Label: VICTORIOUZ"))
        self.apt("apt-get", "update", "-o", "APT::Update::Error-Mode=any", trust=trust, status=100)

    def test_no_folder_of_others_is_replaced(self):
        self.pack("victorious", "0.1.0")
        (self.folder / "mine").mkdir()
        (self.folder / "mine/notes").touch()
        for folder, words in (("mine", "is no repository"), ("build", "holds the packages"), (".", "holds the packages")):
            done = self.make(folder)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(words, done.stderr)
        self.assertTrue((self.folder / "mine/notes").exists())
        self.assertTrue(any(self.packages.iterdir()))
        for _ in range(2):
            self.assertEqual(self.make("repository/").returncode, 0)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir() if path.name.startswith("repository")), ["repository"])

    def test_apt_finds_the_newest_version(self):
        for version in ("0.1.0", "0.2.0"):
            self.pack("victorious", version)
        self.pack("libvictorious0.1", "0.2.0")
        self.assertEqual(self.make().stdout, f"{self.folder}/repository: 3 packages\n")
        self.apt("apt-get", "update")
        self.assertIn("Candidate: 0.2.0", self.apt("apt-cache", "policy", "victorious"))
        self.assertIn("Description: small", self.apt("apt-cache", "show", "libvictorious0.1"))

    def test_a_second_run_replaces_the_first(self):
        self.pack("victorious", "0.1.0")
        self.make()
        (self.folder / "repository/pool/stale.deb").touch()
        self.make()
        self.assertEqual([path.name for path in (self.folder / "repository/pool").iterdir()], ["victorious_0.1.0_amd64.deb"])

    def test_no_packages_leave_the_repository_as_it_is(self):
        self.pack("victorious", "0.1.0")
        self.make()
        for package in self.packages.iterdir():
            package.unlink()
        done = self.make()
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no *.deb: make package builds them", done.stderr)
        self.assertTrue((self.folder / "repository/Packages").exists())


if __name__ == "__main__":
    unittest.main()
