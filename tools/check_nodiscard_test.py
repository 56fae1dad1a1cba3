#!/usr/bin/env python3
"""Tests of check_nodiscard.py on small headers."""

import unittest
from pathlib import Path

import check_nodiscard


def names(text):
    """The functions that the check reports."""
    return [finding.message.split("(")[0] for finding in check_nodiscard.findings_of(text, Path("a.h"))]


class CheckNodiscardTest(unittest.TestCase):
    def test_a_result_that_could_be_dropped_is_reported(self):
        self.assertEqual(names("Status Write(int a);\n"), ["Write"])
        self.assertEqual(names("  virtual Expected<std::vector<int>> Read() const = 0;\n"), ["Read"])
        self.assertEqual(names("static inline std::expected<A, B> Make(\n    int a);\n"), ["Make"])
        self.assertEqual(names("Expected<std::map<int,\n                  int>>\nLongName(int a);\n"), ["LongName"])

    def test_the_line_is_that_of_the_name(self):
        (finding,) = check_nodiscard.findings_of("// a\n\nStatus Write();\n", Path("a.h"))
        self.assertTrue(str(finding).startswith("a.h:3: "), finding)

    def test_nodiscard_on_the_line_or_before_it_is_accepted(self):
        self.assertEqual(names("[[nodiscard]] static Status Write();\n[[nodiscard]]\nExpected<int> Read();\n"), [])

    def test_what_declares_no_function_is_accepted(self):
        self.assertEqual(names("Status status_;\nusing A = Expected<int>;\nExpected<int> value = Read();\n"), [])
        self.assertEqual(names("  /// Status Write(): never fails\n  std::function<Status(int)> write;\n"), [])


if __name__ == "__main__":
    unittest.main()
