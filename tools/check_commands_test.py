#!/usr/bin/env python3
"""Tests of check_commands.py on small trees."""

import tempfile
import unittest
from pathlib import Path

import check_commands

SCRIPT = '''import argparse
def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, required=True)
    parser.parse_args()
    raise SystemExit("it ran")
if __name__ == "__main__":
    main()
'''
PAGE = """Measured with `bench/a.py --kills N` and `the --flag`.

    bench/a.py --kills 3 > out

```
tools/b.sh x && build/c_tests --gtest_filter=A.B   # a minute
```
"""


class CommandsTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        (self.root / "bench").mkdir()
        (self.root / "bench/a.py").write_text(SCRIPT)

    def fault(self, command: str) -> str | None:
        return check_commands.fault(command, self.root, self.root / "build")

    def test_commands_of_a_page(self):
        self.assertEqual(sorted(check_commands.commands_of(PAGE)),
                         ["bench/a.py --kills 3", "bench/a.py --kills N", "build/c_tests --gtest_filter=A.B", "tools/b.sh x"])

    def test_arguments_are_parsed_and_nothing_runs(self):
        self.assertIsNone(self.fault("bench/a.py --kills N"))
        self.assertIsNone(self.fault("bench/a.py --kills 1 [--kills 2]"))
        self.assertIn("--gone", self.fault("bench/a.py --kills 1 --gone"))
        self.assertIn("--kills", self.fault("bench/a.py --kills many"))

    def test_a_script_that_does_not_import(self):
        (self.root / "bench/a.py").write_text("import nothing_of_this_name\n" + SCRIPT)
        self.assertIn("nothing_of_this_name", self.fault("bench/a.py --kills 1"))

    def test_missing_files(self):
        self.assertEqual(self.fault("bench/gone.py --kills 1"), "no such file")
        self.assertIn("SKIPPED: build/gone", self.fault("build/gone --json"))

    def test_filters_and_names(self):
        build = self.root / "build"
        build.mkdir()
        for name, text in (("c_tests", 'case "$1" in *A.B) printf "A.\\n  B\\n";; esac'), ("victorious", "echo '  sift   keypoints'")):
            (build / name).write_text(f"#!/bin/sh\n{text}\n")
            (build / name).chmod(0o755)
        self.assertIsNone(self.fault("build/c_tests --gtest_filter=A.B"))
        self.assertIn("names no test", self.fault("build/c_tests --gtest_filter=A.C"))
        self.assertIsNone(self.fault("build/victorious bench sift"))
        self.assertEqual(self.fault("build/victorious bench gone"), "no bench gone")


if __name__ == "__main__":
    unittest.main()
