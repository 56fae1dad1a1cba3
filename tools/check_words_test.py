#!/usr/bin/env python3
"""Tests of check_words.py on single files."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import check_words


class CheckWordsTest(unittest.TestCase):
    def found(self, text):
        """The identifiers that are reported in `text`."""
        return [finding.message.split(":")[0] for finding in check_words.check_text(Path("a.cc"), text)]

    def test_private_words_in_every_spelling(self):
        for name in ("stance", "kStance", "StanceOfBox", "stance_rad", "sight", "SightOptions", "ReadSights", "likeness",
                     "told_frame", "ScoutViews", "picture_px", "Things", "kLikest"):  # fmt: skip
            self.assertEqual(self.found(f"int {name} = 0;"), [name])

    def test_accepted_words_that_contain_them(self):
        for name in ("distance_m", "instances", "MeshInstance", "sighting", "Sightings", "shared", "kMostlyInside", "at_least"):
            self.assertEqual(self.found(f"int {name} = 0;"), [])

    def test_bounds(self):
        for name in ("least_matches", "kLeastMatches", "most_views", "MostViews", "kMost_m"):
            expected = [] if name == "kMost_m" else [name]
            self.assertEqual(self.found(f"int {name} = 0;"), expected, name)
        self.assertEqual(self.found("inlier_share kInlierShare share shareable"), ["inlier_share", "kInlierShare"])

    def test_exceptions(self):
        self.assertEqual(self.found("least_squares LinearLeastSquares line_of_sight LinesOfSight kLeastSignificantBit"), [])

    def test_names_of_tests(self):
        self.assertEqual(self.found("TEST(Stance, IsTold) {}\nTEST_F(A, Sight) {}\nTYPED_TEST(A, TellsB) {}\n"),
                         ["Stance", "IsTold", "Sight", "TellsB"])  # fmt: skip
        self.assertEqual(self.found("TEST(Linker, WhatMovesIsFound) {}\nTEST_P(\n    Linker, ButNotHere) {}"),
                         ["WhatMovesIsFound", "ButNotHere"])  # fmt: skip
        self.assertEqual(self.found("TEST(A, LineOfSightMatches) {}\nTEST(A, IsSomewhat) {}\nTEST(A, MostViews) {}"), [])

    def test_comments_and_texts_are_not_checked(self):
        self.assertEqual(self.found('// sight\n/* told\n*/ f("sight \\" told", \'"\');\nauto q = R"(sight")";\n'), [])
        self.assertEqual(self.found("int a = 1'000'000; int sight = 2'000;"), ["sight"])

    def test_lines_are_counted_through_comments_and_texts(self):
        text = '/* one\ntwo */\nauto q = R"(\n)"; int sight;\n'
        self.assertEqual([finding.line for finding in check_words.check_text(Path("a.cc"), text)], [4])

    def test_tree_and_exit_status(self):
        with tempfile.TemporaryDirectory() as scratch:
            source = Path(scratch) / "src/a.h"
            source.parent.mkdir()
            source.write_text("int sight;\nint told;\n", encoding="utf-8")
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                self.assertEqual(check_words.main([scratch]), 1)
                source.write_text("int bearing;\n", encoding="utf-8")
                self.assertEqual(check_words.main([scratch]), 0)
            self.assertEqual(
                output.getvalue(),
                'src/a.h:1: sight: "sight": the field says bearing observation\n'
                'src/a.h:2: told: "told": the field says given or measured\n',
            )


if __name__ == "__main__":
    unittest.main()
