#!/usr/bin/env python3
"""Tests of check_throwing.py on small sources."""

import unittest
from pathlib import Path

import check_throwing


def found(text, path="src/victorious/a/a.cc"):
    """The first words of the findings."""
    return [finding.message.split()[0] for finding in check_throwing.findings_of(text, Path(path))]


class CheckThrowingTest(unittest.TestCase):
    def test_a_call_without_an_error_code_is_reported(self):
        self.assertEqual(found("if (fs::exists(path)) {}"), ["exists()"])
        self.assertEqual(found("std::filesystem::rename(a, b);\nfs::absolute(\n    path)"), ["rename()", "absolute()"])
        self.assertEqual(found("std::error_code error;\nfs::remove(folder / Name(error, 1));"), ["remove()"])
        self.assertEqual(found("entry.is_directory() && at->file_size()"), ["is_directory()", "file_size()"])

    def test_a_call_with_one_is_accepted(self):
        self.assertEqual(found("std::error_code absent;\nfs::file_size(path / F(a, b), absent);"), [])
        self.assertEqual(found("void F(std::error_code& error) { fs::current_path(error); }"), [])
        self.assertEqual(found("const fs::file_status status = S();\nfs::is_directory(status);"), [])
        self.assertEqual(found("std::error_code e;\nentry.is_directory(e);"), [])

    def test_folders_are_listed_in_one_place(self):
        loop = "for (const auto& entry : fs::directory_iterator(folder, error)) {}"
        self.assertEqual(found(loop), ["directory_iterator"])
        self.assertEqual(found(loop, "src/victorious/base/folder.cc"), [])
        self.assertEqual(found(loop + "fs::exists(a);", "bench/a.cc"), ["directory_iterator"])

    def test_numbers(self):
        self.assertEqual(found("std::stoll(id); strtod(text, &end); std::atoi(text);"), ["stoll", "strtod", "atoi"])
        self.assertEqual(found("std::store(a); history(1); stop(2); from_chars(a, b, c);"), [])

    def test_comments_and_texts_are_not_read(self):
        self.assertEqual(found('// fs::exists(path)\nLog("std::stoi(a)");\n/* strtod */'), [])


if __name__ == "__main__":
    unittest.main()
