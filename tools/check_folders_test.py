#!/usr/bin/env python3
"""Tests of check_folders.py on small trees with at most one violation each."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import check_folders

ARCHITECTURE = "| 0 | `base/` | errors |\n| 3 | `match/` | matches |\n\n| `bench/` | speed |\n"


class CheckFoldersTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        self.put("layers.toml", "[levels]\nbase = 0\nmatch = 3\n")
        self.put("ARCHITECTURE.md", ARCHITECTURE)
        self.put("README.md", "[base](src/victorious/base/README.md), [web](https://example.com/none)\n")
        self.put("bench/main.cc", "")
        self.put("src/victorious/base/README.md", "| `error.h` | errors |\n- `text/`: texts\n")
        self.put("src/victorious/base/error.h", "")
        self.put("src/victorious/base/text/utf8.h", "")
        self.put("src/victorious/match/README.md", "Returns matches.\n")

    def put(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text, encoding="utf-8")

    def assert_finds(self, *expected):
        self.assertEqual([str(finding) for finding in check_folders.check(self.root)], list(expected))

    def test_consistent_documents_are_accepted(self):
        self.assert_finds()

    def test_folder_without_a_row(self):
        self.put("ARCHITECTURE.md", ARCHITECTURE.replace("| 3 | `match/` | matches |\n", ""))
        self.assert_finds("ARCHITECTURE.md:1: has no row for match/: add | 3 | `match/` | what it is |")

    def test_row_without_a_folder(self):
        self.put("ARCHITECTURE.md", "| 4 | [`magic/`](magic) | wands |\n" + ARCHITECTURE)
        (self.root / "magic").mkdir()
        self.assert_finds("ARCHITECTURE.md:1: lists magic/, which layers.toml does not: take the row out")

    def test_row_with_another_level(self):
        self.put("ARCHITECTURE.md", ARCHITECTURE.replace("| 3 |", "| 2 |"))
        self.assert_finds("ARCHITECTURE.md:2: gives match/ level 2: layers.toml says 3")

    def test_two_rows_of_one_folder(self):
        self.put("ARCHITECTURE.md", ARCHITECTURE + "| 0 | `base/` | again |\n")
        self.assert_finds("ARCHITECTURE.md:5: lists base/ again, after line 1")

    def test_missing_folder_beside_the_sources(self):
        (self.root / "bench/main.cc").unlink()
        (self.root / "bench").rmdir()
        self.assert_finds("ARCHITECTURE.md:4: lists bench/, which is no folder: take the row out")

    def test_folder_without_a_readme(self):
        (self.root / "src/victorious/match/README.md").unlink()
        self.put("src/victorious/match/match.h", "")
        self.assert_finds(
            "src/victorious/match/README.md:1: is missing: say what goes in, what comes out, the method and its source"
        )

    def test_a_folder_of_folders_has_a_readme_too(self):
        self.put("layers.toml", '[levels]\nbase = 0\nmatch = 3\n"input/video" = 3\n')
        self.put("ARCHITECTURE.md", ARCHITECTURE + "| 3 | `input/video/` | frames |\n")
        self.put("src/victorious/input/video/README.md", "| `reader.h` | frames |\n")
        self.put("src/victorious/input/video/reader.h", "")
        missing = "src/victorious/input/README.md:1: is missing: say what goes in, what comes out, the method and its source"
        self.assert_finds(missing)
        self.put("src/victorious/input/README.md", "[`video/`](video/README.md)\n")
        self.assert_finds()

    def test_readme_lists_missing_files(self):
        for row, name in (("| `none.h` | none |", "none.h"), ("- `sub/none.cc`: none", "sub/none.cc"), ("- `none/`", "none/")):
            self.put("src/victorious/match/README.md", row + "\n")
            self.assert_finds(
                f"src/victorious/match/README.md:1: lists {name}, which is not in match/: take the line out"
            )

    def test_readme_with_a_table_lists_all_headers_that_other_folders_include(self):
        self.put("src/victorious/base/file.h", "")
        self.put("src/victorious/match/match.cc", '#include "victorious/base/file.h"\n')
        self.assert_finds("src/victorious/base/README.md:1: lists headers, but not file.h, which other folders include")
        self.put("src/victorious/base/README.md", "| `error.h`, `file.h` | errors; files |\n- `text/`: texts\n")
        self.assert_finds()

    def test_complete_list_lacks_a_file(self):
        self.put("web/README.md", "| `src/main.tsx` | the entry |\n| `src/logic/` | functions |\n")
        self.put("web/src/main.tsx", "")
        self.put("web/src/main.test.tsx", "")
        self.put("web/src/logic/area.ts", "")
        self.assert_finds()
        self.put("web/src/me.ts", "")
        self.put("testing/README.md", "| file |\n")
        self.put("testing/data.h", "")
        self.assert_finds(
            "testing/README.md:1: does not list data.h: add a row",
            "web/README.md:2: does not list src/me.ts: add a row",
        )

    def test_complete_list_has_a_file_that_does_not_exist(self):
        self.put("testing/README.md", "| `data.h` | external data |\n")
        self.assert_finds("testing/README.md:1: lists data.h, which does not exist: take it out")

    def test_broken_links(self):
        self.put("README.md", "[a](docs/none.md#part) [b](ARCHITECTURE.md#levels) [c](#here)\n")
        self.assert_finds("README.md:1: links docs/none.md, which does not exist")
        self.put("README.md", "")
        self.put("src/victorious/match/README.md", "[a](../base/error.h) [b](../../docs/none.md)\n")
        self.assert_finds("src/victorious/match/README.md:1: links ../../docs/none.md, which does not exist")

    def test_exit_status_is_1_with_findings(self):
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            self.assertEqual(check_folders.main([str(self.root)]), 0)
            self.put("ARCHITECTURE.md", "")
            self.assertEqual(check_folders.main([str(self.root)]), 1)
        self.assertEqual(len(output.getvalue().splitlines()), 2)


if __name__ == "__main__":
    unittest.main()
