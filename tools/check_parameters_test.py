#!/usr/bin/env python3
"""Tests of check_parameters.py on a small tree."""

import tempfile
import unittest
from pathlib import Path

import check_parameters

PAGE = """# Parameters

## Of `index`; `match` takes the same file

| parameter | default | range | unit | what it does |
| --- | --- | --- | --- | --- |
| `cascade.radius_px` | 75.0 | 1 to 100000 | px | R |
| `follow.track.missed_frames` | 5 | 0 to 10000 | frames | kept without a box |

## Of `track`

| parameter | default | range | unit | what it does |
| --- | --- | --- | --- | --- |
| `box.lost_confidence` | 0.35 | 0 to 1 |  | lost below it |
"""
RADIUS = "docs/parameters.md:7: cascade.radius_px: no test of search/grammar/ or tests/e2e sets it: add one that shows what it changes"
MISSED = (
    "docs/parameters.md:8: follow.track.missed_frames: no test of track/ or tests/e2e sets it: "
    "add one that shows what it changes"
)

OPTIONS = """#pragma once

/// Of the cascade.
struct CascadeOptions {
  double radius_px = 75;
  std::uint64_t seed = 1;  ///< as named in another string
  std::optional<double> cap;  ///< listed by another struct
  VoteOptions votes;  ///< Not a user parameter
  int samples =
      60000;  ///< of the training: a comment that goes on. Not a
              ///< user parameter
  /// Two that belong together. Not user parameters: they follow from
  /// the spacing of the views.
  double height_m = 1;
  std::vector<double> height_sigma_m = {1, 2};

  void ListFields(FieldList& fields);
  [[nodiscard]] bool IsValid() const { return radius_px > 0; }

  int last = 3;  ///< of all
};

struct NoOptions {
  int field = 3;
};
"""
LISTS = """void CascadeOptions::ListFields(FieldList& fields) {
  fields.Add("radius_px", radius_px, {.reason = "the last, by seed"});
}

void VoteOptions::ListSearchFields(FieldList& fields) {
  fields.Add("cap", cascade.cap, {});
}
"""


class CheckParametersTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        self.put("docs/parameters.md", PAGE)

    def put(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text, encoding="utf-8")

    def findings(self):
        return [str(finding) for finding in check_parameters.check(self.root)]

    def test_a_parameter_that_no_test_sets_is_reported(self):
        self.assertEqual(self.findings(), [RADIUS, MISSED])

    def test_a_unit_test_of_the_owner_sets_it(self):
        for text in ("options.radius_px = 3;", "Filter({.radius_px = 3})", "&CascadeOptions::radius_px"):
            self.put("src/victorious/search/grammar/cascade_test.cc", text)
            self.assertEqual(self.findings(), [MISSED], text)
        for text in ("EXPECT_EQ(options.radius_px == 3);", "other_radius_px = 3;", ".radius_px_squared = 9"):
            self.put("src/victorious/search/grammar/cascade_test.cc", text)
            self.assertEqual(self.findings(), [RADIUS, MISSED], text)

    def test_the_test_of_another_folder_does_not_count(self):
        self.put("src/victorious/search/pose/rank_nfa_test.cc", ".radius_px = 6")
        self.put("src/victorious/search/follow/follower_test.cc", "track.missed_frames = 6")
        self.assertEqual(self.findings(), [RADIUS, MISSED])

    def test_an_end_to_end_test_sets_it_by_its_key(self):
        for text in ("'{\"cascade.radius_px\": 9}'", "'{\"cascade\": {\"radius_px\": 9}}'", "self.count(crate, radius_px=9)"):
            self.put("tests/e2e/test_match.py", text)
            self.assertEqual(self.findings(), [MISSED], text)

    def test_a_new_group_needs_an_owner(self):
        self.put("docs/parameters.md", PAGE.replace("cascade.radius_px", "shadows.softness_m"))
        self.assertEqual(self.findings()[0], "docs/parameters.md:7: shadows.softness_m: no owner: "
                                             "add its group to OWNERS of tools/check_parameters.py")  # fmt: skip

    def test_the_longest_group_decides(self):
        self.assertEqual(check_parameters.owner_of("follow.track.missed_frames"), "track")
        self.assertEqual(check_parameters.owner_of("follow.enabled"), "jobs")
        self.assertEqual(check_parameters.owner_of("every"), "jobs")

    def test_a_page_without_the_section_is_reported(self):
        self.put("docs/parameters.md", "# Parameters\n")
        self.assertEqual(len(self.findings()), 1)

    def test_a_field_is_listed_or_said_to_be_no_user_parameter(self):
        self.put("src/victorious/search/grammar/cascade_test.cc", ".radius_px = 6")
        self.put("src/victorious/track/track_test.cc", ".missed_frames = 6")
        self.put("src/victorious/search/grammar/cascade.h", OPTIONS)
        self.put("src/victorious/search/grammar/cascade.cc", LISTS)
        unlisted = "not in ListFields: list it, or end its comment with \"Not a user parameter\""
        self.assertEqual(
            self.findings(),
            [f"src/victorious/search/grammar/cascade.h:{line}: CascadeOptions::{name}: {unlisted}" for line, name in ((6, "seed"), (20, "last"))],
        )

    def test_the_comment_of_a_struct_covers_its_fields(self):
        self.put("src/victorious/search/grammar/cascade.h", OPTIONS.replace("/// Of the cascade.", "/// Not user parameters."))
        self.assertEqual(self.findings(), [RADIUS, MISSED])


if __name__ == "__main__":
    unittest.main()
