#!/usr/bin/env python3
"""Checks that every benchmark runs and reports as documented: smoke_test.py PROGRAM. Does not assess the times."""

import functools
import json
import re
import subprocess
import sys
import unittest

PROGRAM = ""
# Why a benchmark cannot run here: the reasons of tools/scratch_postgres.sh and of OpenNearestDevice.
ABSENT = {
    "queue": ("no PostgreSQL server", "no PostGIS"),
    "device": ("built without CUDA", "no CUDA device", "compute capability"),
}


def run(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=600)


@functools.cache
def names() -> list[str]:
    """The benchmarks that the program has, by its help: "NAME ... {sift,match,...}"."""
    return re.search(r"\{([a-z]+(?:,[a-z]+)+)\}", run("--help").stdout)[1].split(",")


class Smoke(unittest.TestCase):
    def test_every_benchmark_reports_medians_and_ratios(self):
        self.assertIn("cascade", names())
        for name in names():
            done = run(name, "--quick", "--json")
            if any(reason in done.stderr for reason in ABSENT.get(name, ())):
                print(f"SKIPPED: {name}: {done.stderr.strip()}")
                continue
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads(done.stdout)
            self.assertTrue(report)
            for key, entry in report.items():
                self.assertTrue(key.startswith(name), key)
                self.assertGreater(entry["median_ms"], 0, key)
                for peer, median_ms in entry["peers"].items():
                    self.assertAlmostEqual(entry[f"ratio_to_{peer}"], median_ms / entry["median_ms"], places=6)

    def test_text_has_a_line_a_comparison(self):
        done = run("cascade", "--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual([line.split()[0] for line in lines], ["cascade_0.8", "cascade_0.95"])

    def test_help_says_what_each_measures(self):
        described = re.findall(r"^  ([a-z]+) {2,}\S", run("--help").stdout, re.MULTILINE)
        self.assertEqual(set(names()) - set(described), set())

    def test_an_option_of_another_benchmark_is_one_line_and_status_2(self):
        for words in (["sift", "--large"], ["sift", "--cache", "x"]):
            done = run(*words, "--quick")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(len(done.stderr.splitlines()), 1)
            self.assertIn("is for the benchmark", done.stderr)

    def test_unknown_name_is_one_line_and_status_2(self):
        done = run("speed")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1)
        for word in ["speed", *names()]:
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop()
    unittest.main()
