#!/usr/bin/env python3
"""Tests of results.py, results_table.py, results_page.py and intervals.py, on a small tree with a table of its own."""

import contextlib
import io
import json
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import intervals
import results
import results_page
import results_table

TABLE = """
[group]
search = ["match", "pose"]
[topic.speed]
heading = "Speed"
rooms = ["search"]
"""
ROWS = """
[[run]]
name = "one"
command = '''echo '{"a.b": {"share": 0.5}, "found": 3, "of": 4, "nothing": null, "errors": [1, 2, 3, 4, 5, 6]}' '''
seconds = 2
  [[run.row]]
  name = "half"
  what = "a share"
  value = "{a_b[share]:.1%}"
  limits = {"a_b[share]" = ">= 0.6"}
  rate = ["found", "of"]
  [[run.row]]
  name = "middle"
  what = "errors"
  value = "{errors[0]:.1f}; {errors:.0f}; {nothing:.2f}"
  sample = "errors"
[[run]]
name = "other"
command = "echo found 7 of them"
output = 'found (?P<count>\\d+)'
rooms = ["store"]
seconds = 1
  [[run.row]]
  name = "seven"
  what = "count"
  value = "{count}"
[[run]]
name = "absent"
command = "false"
needs = ["$DATA/none"]
  [[run.row]]
  name = "none"
  what = "nothing"
  value = "{none}"
"""


class ResultsTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        self.write("bench/results/table.toml", TABLE)
        self.write("bench/results/rows/speed.toml", ROWS)
        self.write("bench/results/measured.json", "{}")
        self.write("docs/results.md", "")
        self.write("src/victorious/pose/pose.cc", "int a;\n")
        self.write("src/victorious/pose/pose_test.cc", "int a;\n")
        self.git("init", "-q")
        self.commit()

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def git(self, *arguments: str) -> None:
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=self.root, check=True)

    def commit(self) -> None:
        self.git("add", "-A")
        self.git("commit", "-qm", "all")
        results_table.tracked.cache_clear()
        results_table.differing.cache_clear()

    def run_tool(self, *arguments: str) -> str:
        said = io.StringIO()
        with contextlib.redirect_stdout(said), unittest.mock.patch("sys.argv", ["results.py", "--root", str(self.root), *arguments]):
            self.status = results.main()
        return said.getvalue()

    def measured(self) -> dict:
        return json.loads((self.root / "bench/results/measured.json").read_text())

    def test_measures_cheapest_first_and_skips_by_name(self):
        said = self.run_tool()
        self.assertEqual(self.status, 0)
        self.assertLess(said.index("other:"), said.index("one:"))
        self.assertIn("SKIPPED: absent: $DATA/none", said)
        half = self.measured()["half"]
        self.assertEqual((half["value"], half["cases"], half["interval"], half["missed"]), ("50.0 %", 4, "30.1 to 95.4 %", True))
        self.assertEqual(self.measured()["middle"]["interval"], "median 1 to 6")
        self.assertEqual(self.measured()["middle"]["value"], "1.0; 1, 2, 3, 4, 5, 6; -")
        self.assertEqual(self.measured()["seven"]["value"], "7")

    def test_fresh_rows_are_not_measured_again(self):
        self.run_tool()
        self.commit()
        self.assertNotIn("one:", self.run_tool())
        self.assertIn("one:", self.run_tool("--again"))

    def test_only_sources_of_a_row_make_it_stale(self):
        self.run_tool()
        self.write("src/victorious/pose/pose_test.cc", "int b;\n")
        self.commit()
        self.assertIn("3 of 4 figures are of these sources", self.run_tool("--count"))
        self.write("src/victorious/pose/pose.cc", "int b;\n")
        self.commit()
        self.assertIn("1 of 4 figures are of these sources, 3 are stale", self.run_tool("--count"))
        self.assertIn("fresh       1 s other / seven: 7", self.run_tool("--list"))

    def test_a_figure_of_uncommitted_sources_stays_stale(self):
        self.write("src/victorious/pose/pose.cc", "int b;\n")
        results_table.differing.cache_clear()
        self.run_tool("one")
        self.assertTrue(self.measured()["half"]["commit"].endswith("+"))
        self.assertIn("0 of 2 figures", self.run_tool("--count", "one"))

    def test_limit_and_failures(self):
        self.assertIn("one: 2 s: beyond --limit", self.run_tool("--limit", "2", "o*"))
        self.assertEqual(set(self.measured()), {"seven"})
        self.write("bench/results/rows/speed.toml", ROWS.replace("{count}", "{counted}"))
        self.assertIn("FAILED: other: no such value", self.run_tool("--again", "other"))
        self.assertEqual(self.status, 1)

    def test_a_kept_output_is_read_again_if_it_is_of_the_same_sources(self):
        self.run_tool()
        self.write("bench/results/rows/speed.toml", ROWS.replace("{count}", "{count} in all").replace("found 7", "found 8"))
        self.run_tool("--reread")
        self.assertEqual(self.measured()["seven"]["value"], "7 in all")
        self.write("src/victorious/store/store.cc", "int b;\n")
        self.commit()
        self.write("bench/results/rows/speed.toml", ROWS)
        self.assertNotIn("other:", self.run_tool("--reread"))

    def test_a_topic_of_no_heading_is_refused(self):
        self.write("bench/results/rows/stray.toml", ROWS)
        with self.assertRaisesRegex(ValueError, "stray"):
            results_table.read_table(self.root)

    def test_page_marks_stale_figures_and_is_checked_without_the_marks(self):
        self.run_tool()
        text = (self.root / "docs/results.md").read_text()
        self.assertIn("| a share (`half`) | - | 50.0 % **missed** | 30.1 to 95.4 %, n = 4 |", text)
        self.assertNotIn("| **stale** ", text)
        self.write("src/victorious/pose/pose.cc", "int b;\n")
        self.commit()
        self.assertEqual(results_page.check(self.root), 0)
        results_page.write(self.root)
        self.assertEqual((self.root / "docs/results.md").read_text().count("| **stale** "), 2)
        self.write("docs/results.md", text.replace("50.0", "51.0"))
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(results_page.check(self.root), 1)

    def test_the_table_is_refused_by_name(self):
        for wrong in (("\"half\"", "\"middle\""), ("value = \"{count}\"", ""), (">= 0.6", "> 0.6"), ("rate =", "rates =")):
            with self.subTest(wrong), self.assertRaises(ValueError):
                self.write("bench/results/rows/speed.toml", ROWS.replace(*wrong))
                results_table.read_table(self.root)


class IntervalsTest(unittest.TestCase):
    def test_wilson(self):
        low, high = intervals.wilson(34, 36)
        self.assertAlmostEqual(low, 0.8186, places=3)
        self.assertAlmostEqual(high, 0.9846, places=3)
        self.assertAlmostEqual(intervals.wilson(0, 10)[0], 0)

    def test_median_by_order_statistics(self):
        self.assertIsNone(intervals.median_of([1, 2, 3, 4, 5]))
        self.assertEqual(intervals.median_of(list(range(10))), (1, 8))


if __name__ == "__main__":
    unittest.main()
