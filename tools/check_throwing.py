#!/usr/bin/env python3
"""Checks that the product calls no function of the standard library that throws on what stands outside of the program: a
path that is too long, a folder that goes away while it is listed, a text that is no number. Errors are values
(docs/adr/0001-errors-as-values.md): a thrown one is reported as an internal error, without what would be right.

Files: functions of std::filesystem get a std::error_code; folders are listed by base/folder.h. Numbers: base/text.h, or
std::from_chars; strtod and its kin, which do not throw, depend on the locale and take half a text for a number.

Usage: check_throwing.py [ROOT]
Prints one line per finding, "path:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator

import findings
from findings import Finding

SOURCES = Path("src/victorious")
TOOLS = ("bench", "experiments", "assets/make", "examples")  # only for the lists of folders
LISTS_FOLDERS = Path("src/victorious/base/folder.cc")

OF_STATUS = (
    "exists", "is_block_file", "is_character_file", "is_directory", "is_fifo", "is_other", "is_regular_file", "is_socket",
    "is_symlink",
)
CALLS = (
    *OF_STATUS,
    "absolute", "canonical", "copy", "copy_file", "copy_symlink", "create_directories", "create_directory",
    "create_directory_symlink", "create_hard_link", "create_symlink", "current_path", "equivalent", "file_size",
    "hard_link_count", "is_empty", "last_write_time", "permissions", "proximate", "read_symlink", "relative", "remove",
    "remove_all", "rename", "resize_file", "space", "status", "symlink_status", "temp_directory_path", "weakly_canonical",
)
CALL = re.compile(rf"\b(?:fs|filesystem)::(?P<name>{'|'.join(CALLS)})\s*\(")
OF_ENTRY = re.compile(rf"(?:\.|->)(?P<name>{'|'.join(OF_STATUS)}|file_size|last_write_time|hard_link_count|refresh)\(\s*\)")
ITERATOR = re.compile(r"\b(?:recursive_)?directory_iterator\b")
ERROR_CODE = re.compile(r"\bstd::error_code\s*&?\s*(\w+)")
FILE_STATUS = re.compile(r"\bfile_status\s*&?\s*(\w+)")
NUMBER = re.compile(r"\b(?:sto(?:i|l|ll|ul|ull|f|d|ld)(?=\()|strto(?:d|f|l|ll|ul|ull|ld|imax|umax)|ato(?:i|l|ll|f)|v?sscanf)\b")
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"|"(?:[^"\\\n]|\\.)*"', re.DOTALL)


def without_comments(text: str) -> str:
    """The text with blanks for comments and text literals; lines keep their numbers."""
    return COMMENT_OR_TEXT.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def last_argument(text: str, at: int) -> tuple[str, int]:
    """The last argument of the call whose first argument begins at `at`, and the number of arguments."""
    depth, begin, count = 1, at, 1
    while at < len(text):
        if text[at] in "([{":
            depth += 1
        elif text[at] in ")]}":
            depth -= 1
            if depth == 0:
                break
        elif text[at] == "," and depth == 1:
            begin, count = at + 1, count + 1
        at += 1
    return text[begin:at].strip(), count


def findings_of(source: str, path: Path) -> Iterator[Finding]:
    text = without_comments(source)

    def finding(match: re.Match[str], message: str) -> Finding:
        return Finding(path, text.count("\n", 0, match.start()) + 1, message)

    for match in ITERATOR.finditer(text):
        if path != LISTS_FOLDERS:
            yield finding(match, f"{match[0]} throws in a loop: use ListFolder() of base/folder.h")
    if any(path.is_relative_to(folder) for folder in TOOLS):
        return
    errors, states = set(ERROR_CODE.findall(text)), set(FILE_STATUS.findall(text))
    for match in CALL.finditer(text):
        argument, count = last_argument(text, match.end())
        is_of_status = match["name"] in OF_STATUS and count == 1 and argument in states
        if argument not in errors and not is_of_status:
            yield finding(match, f"{match['name']}() throws: give it a std::error_code as the last argument")
    for match in OF_ENTRY.finditer(text):
        yield finding(match, f"{match['name']}() throws: give it a std::error_code")
    for match in NUMBER.finditer(text):
        yield finding(match, f"{match[0]} throws, or depends on the locale: use ParseNumber() or ParseInteger() of base/text.h")


def check(root: Path) -> list[Finding]:
    return sorted(
        finding
        for folder in (SOURCES, *TOOLS)
        for path in (root / folder).rglob("*")
        if path.suffix in (".h", ".cc", ".cu") and not path.stem.endswith("_test")
        for finding in findings_of(path.read_text(encoding="utf-8"), path.relative_to(root))
    )


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
