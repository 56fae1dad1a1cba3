#!/usr/bin/env python3
"""Tests of quick.py."""

import unittest

import quick

CHANGED = ["src/victorious/search/pose/mlesac.cc", "src/victorious/search/pose/mlesac_test.cc", "src/victorious/types/mesh.h",
           "src/victorious/CMakeLists.txt", "bench/main.cc", "docs/page.md", ""]


class QuickTest(unittest.TestCase):
    def test_folders_are_those_with_a_changed_file(self):
        self.assertEqual(quick.test_folders(CHANGED), ["search/pose", "types"])
        self.assertEqual(quick.test_folders(["README.md", ""]), [])

    def test_targets_are_tests_and_programs(self):
        self.assertEqual(quick.targets(CHANGED, lambda folder: folder == "search/pose"), ["pose_tests", "victorious-bench"])
        self.assertEqual(quick.targets(["docs/page.md"], lambda folder: True), [])

    def test_a_folder_has_tests_if_its_list_says_so(self):
        self.assertTrue(quick.has_tests("search/pose"))
        self.assertFalse(quick.has_tests("none"))


if __name__ == "__main__":
    unittest.main()
