"""`evaluate` agrees with the independent scorer of the project's data."""

import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

import program

DATA = Path(os.environ.get("VICTORIOUS_DATA", program.REPOSITORY / "../shared/data"))
TOOL = DATA.parent / "tools" / "score.py"


@unittest.skipUnless(TOOL.exists(), f"SKIPPED: no tool at {TOOL}")
class ScoreTest(program.ProgramTest):
    def test_evaluate_equals_the_tool(self):
        truth = program.flight() / "truth.jsonl"
        files = []
        for form in ("objects", "sightings"):
            files += [f"--{form}", self.write(form, self.export(program.index(), form))]
        for flags in ([], ["--models", "crate,truck"], ["--models", "sign"]):
            reported = subprocess.run(
                [sys.executable, TOOL, "--truth", truth, *files, *flags, "--json"],
                capture_output=True, text=True, check=True,
            ).stdout  # fmt: skip
            own = self.succeeds("evaluate", "--db", program.index(), "--truth", truth, *flags, "--json").out
            self.same(json.loads(own), json.loads(reported), " ".join(flags))

    def same(self, own, reported, where):
        if isinstance(reported, dict):
            self.assertEqual(set(own), set(reported), where)
            for key, value in reported.items():
                self.same(own[key], value, f"{where} {key}")
        elif isinstance(reported, float):
            self.assertAlmostEqual(own, reported, places=6, msg=where)
        else:
            self.assertEqual(own, reported, where)


if __name__ == "__main__":
    program.main()
