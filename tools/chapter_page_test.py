#!/usr/bin/env python3
"""Tests of chapter_page.py: from reports to the page."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import chapter_page


def filter_row(setting: str, trials: str, ratio: float, name: str) -> dict:
    return {"setting": setting, "trials": trials, "ratio": ratio, "filter": name, "true before": 100.0,
            "true kept %": 98.76, "false before": 500.0, "false after": 2.0, "near after": 1.0,
            "false % of kept matches": 1.94, "false before / after": 250.0, "ms per trial": 0.1}


def report_of(name: str) -> dict:
    if name == "chapter3.filters":
        rows = [filter_row(setting, trials, ratio, which)
                for setting in ("thesis", "ours") for trials in ("all 4", "unseen 2") for ratio in (0.6, 0.95)
                for which in ("cascade", "cascade, table 3.1", "cascade, learnt thresholds",
                              "cascade, learnt, all measures in each stage")]
    elif name == "figure5.2":
        rows = [{"setting": name, "recall": recall, "precision": 1.0, "ids per object": 1.0}
                for name, recall in (("default", 1.0), ("every = 4", 0.75))]
    elif name == "figure5.3":
        rows = [{"objects of": "all"} | {f"{what}, {percent} %": percent / 100
                                         for what in ("in view", "first to last") for percent in (25, 50, 75)}]
    elif name in ("figure5.4", "figure5.5"):
        rows = [{"objects": "jeep", "CEP 50 %, m": 0.01, "75 %, m": 0.02, "90 %, m": 0.03,
                 "thesis: 50 / 75 / 90 %, m": "0.8 / 1.42 / 1.88"}]
    elif name == "chapter3.sweeps":
        rows = [{"setting": setting, "difficulty": "blur", "value": 1.0, "filter": which, "true before": 10.0,
                 "false before": 20.0, "true kept %": 90.0, "false after": 0.0}
                for setting in ("thesis", "ours")
                for which in ("neighbours (Video Google)", "first stage alone", "cascade", "cascade, R from scale",
                              "cascade, then MLESAC", "MLESAC alone", "OpenCV's homography alone")]
    else:
        counts = {f"{whose}: {what}": 3.0 for whose in ("thesis setting reproduced", "ours") for what in ("true", "false")}
        rows = [{"ratio": 0.8, "filtering": stage, "when": when} | counts
                for stage, when in (("none", "before"), ("third", "after"))]
    return {"experiment": name, "title": f"Title of {name}", "notes": ["A note."], "rows": rows}


class PageTest(unittest.TestCase):
    def make(self, chapter: str, folder: Path, image_bytes: int) -> subprocess.CompletedProcess:
        results = folder / "results"
        results.mkdir()
        for name, _, _, images in chapter_page.CHAPTERS[chapter].sections:
            (results / f"{name}.json").write_text(json.dumps(report_of(name)))
            for image in images:
                (results / image).write_bytes(b"x" * image_bytes)
        # All reports exist, so the program is never run.
        return subprocess.run([sys.executable, chapter_page.__file__, chapter, "/nowhere", "--results", results, "--docs",
                               folder / "docs"], capture_output=True, text=True, check=False)

    def test_every_section_is_on_the_page(self):
        said = {"3": "98.76 %, 1.97 %, 250", "5": "| settings with a recall of 1, of 2 | >= 27 | 26 | 1 |"}
        for number, chapter in chapter_page.CHAPTERS.items():
            with self.subTest(number), tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                run = self.make(number, folder, 10)
                self.assertEqual(run.returncode, 0, run.stderr)
                page = (folder / "docs" / f"chapter{number}.md").read_text()
                for experiment, heading, _, images in chapter.sections:
                    self.assertIn(f"## {heading}\n", page)
                    self.assertIn(f"Title of {experiment}", page)
                    for image in images:
                        self.assertIn(f"(images/chapter{number}/{image})", page)
                        self.assertTrue((folder / "docs" / "images" / f"chapter{number}" / image).exists())
                self.assertIn(said[number], page)

    def test_large_images_are_refused(self):
        with tempfile.TemporaryDirectory() as name:
            run = self.make("3", Path(name), chapter_page.MAX_IMAGE_BYTES + 1)
            self.assertEqual(run.returncode, 1)
            self.assertIn("must be at most", run.stderr)

    def test_pivot_puts_names_in_columns(self):
        rows = [{"x": 1, "name": "a", "v": 5}, {"x": 1, "name": "b", "v": 6}, {"x": 2, "name": "a", "v": 7}]
        self.assertEqual(chapter_page.pivot(rows, ["x"], "name", lambda row: row["v"], ["a", "b"]),
                         [{"x": 1, "a": 5, "b": 6}, {"x": 2, "a": 7}])


if __name__ == "__main__":
    unittest.main()
