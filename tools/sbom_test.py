#!/usr/bin/env python3
"""Tests sbom.py on the program whose path is the argument. Skipped where no Debian package is installed."""

import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

PROGRAM = sys.argv.pop()


@unittest.skipUnless(shutil.which("dpkg-query"), "no Debian packages")
class Sbom(unittest.TestCase):
    def test_has_what_is_linked_and_what_the_page_is_made_of(self):
        command = [sys.executable, Path(__file__).resolve().parent / "sbom.py", PROGRAM]
        bill = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        self.assertEqual((bill["bomFormat"], bill["specVersion"]), ("CycloneDX", "1.5"))
        parts = {part["name"]: part for part in bill["components"]}
        urls = [part["purl"] for part in bill["components"]]
        self.assertEqual(len(set(urls)), len(urls), "each version once")
        installed = subprocess.run(
            ["dpkg-query", "--show", "--showformat=${Version}", "libsqlite3-0"], check=True, capture_output=True, text=True
        ).stdout
        self.assertEqual(parts["libsqlite3-0"]["version"], installed)
        self.assertTrue(parts["libavcodec59"]["purl"].startswith("pkg:deb/debian/libavcodec59@"))
        self.assertTrue(parts["preact"]["purl"].startswith("pkg:npm/preact@"))
        self.assertNotIn("typescript", parts, "it only builds the page")


if __name__ == "__main__":
    unittest.main()
