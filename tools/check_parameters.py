#!/usr/bin/env python3
"""Checks two rules of parameters:

- A test sets each parameter of `index` (docs/parameters.md): a unit test in the folder that owns the parameter, or an
  end-to-end test. The test asserts what the parameter changes; this check only sees that there is one.
- Each field of a struct with a field list is in that list, or its comment says "Not a user parameter" (base/options.h).

Usage: check_parameters.py [ROOT]
Prints one line per finding, "FILE:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator, NamedTuple

import findings
from findings import Finding

PAGE = Path("docs/parameters.md")
SECTION = "## Of `index`"  # the heading begins with it
SOURCES = Path("src/victorious")
END_TO_END = Path("tests/e2e")

# The folder of src/victorious that owns a parameter, by the longest group of its name that stands here. The tests of its
# subfolders count, too.
OWNERS = {
    "video": "input/video",
    "resolution": "jobs",
    "features": "object/features",
    "method": "search/recognize",
    "search": "search/recognize",
    "match": "search/match",
    "cascade": "search/grammar",
    "pose": "search/pose",
    "detect": "search/detect",
    "shape": "jobs",
    "categories": "category/finder",
    "detector": "category/network",
    "daylight": "place/calibrate",
    "telemetry": "input/telemetry",
    "follow": "search/follow",
    "follow.enabled": "jobs",
    "follow.frame_interval_s": "jobs",
    "follow.track": "track",
    "grow": "jobs",
    "tracklets": "place/associate",
    "keep": "jobs",
    "every": "jobs",
    "objects": "place/associate",
    "objects.locate": "place/geolocate",
    "ground": "input/terrain",
}


class Parameter(NamedTuple):
    line: int
    name: str  # dotted, as in --params


def parameters_of(page: str) -> Iterator[Parameter]:
    """The parameters of the section of `index`."""
    in_section = False
    for number, line in enumerate(page.splitlines(), start=1):
        if line.startswith("## "):
            in_section = line.startswith(SECTION)
        elif in_section and (match := re.match(r"\| `([\w.]+)` \|", line)):
            yield Parameter(number, match[1])


def owner_of(name: str) -> str | None:
    groups = name.split(".")
    for length in range(len(groups), 0, -1):
        if owner := OWNERS.get(".".join(groups[:length])):
            return owner
    return None


def is_set(name: str, unit_tests: str, end_to_end_tests: str) -> bool:
    """True if a unit test assigns to the field, or names it as a member; or if a test of either kind has it as a JSON key
    or a keyword, at least by the last part of its name."""
    groups = name.split(".")
    field = re.escape(groups[-1])
    of_unit_test = rf"\.{field}\s*=(?!=)|::{field}\b"
    key = "|".join(re.escape(".".join(groups[first:])) for first in range(len(groups)))
    of_both = rf"""["'](?:{key})["']\s*[:,]|\b{field}=(?!=)"""
    return bool(re.search(f"{of_unit_test}|{of_both}", unit_tests) or re.search(of_both, end_to_end_tests))


def read_all(paths: Iterator[Path]) -> str:
    return "\n".join(path.read_text(encoding="utf-8", errors="replace") for path in sorted(paths))


# An options struct in a header: the comment before it, its name and its body.
STRUCT = re.compile(r"((?:^//[^\n]*\n)*)^struct (\w+Options) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
LISTING = re.compile(r"^ *void List\w*Fields\(FieldList&", re.MULTILINE)
# A function that lists fields, in a source; with the struct if it is a member.
LIST_FUNCTION = re.compile(r"^void (?:(\w+)::)?List\w+\([^)]*FieldList& .*?^\}", re.MULTILINE | re.DOTALL)
# A data member, without its comment.
FIELD = re.compile(r"  (?!using |static )[\w:<>, *]+[ >*](\w+)(?:\s*=\s.*)?;", re.DOTALL)
NOT_OF_USERS = re.compile(r"not (?:a user parameter|user parameters)", re.IGNORECASE)
GROUP = re.compile(r"not user parameters", re.IGNORECASE)  # all fields below the comment, up to an empty line
REST = re.compile(r"not user parameters from here on", re.IGNORECASE)  # all fields below it


class Field(NamedTuple):
    line: int  # of the struct's body, from 0
    name: str
    comment: str


def words_of(comment: str) -> str:
    """The text of a comment on one line."""
    return " ".join(re.sub(r"^ *//[/<]*", "", line).strip() for line in comment.splitlines())


def fields_of(body: str) -> Iterator[Field]:
    """The data members of a struct, each with the comments that are about it."""
    rest = above = statement = after = ""
    first, is_complete = 0, True
    for number, line in enumerate([*body.splitlines(), ""]):
        code, slashes, comment = line.partition("//")
        if is_complete and statement and not (slashes and not code.strip() and len(code) > 2):
            if match := FIELD.fullmatch(statement.rstrip()):
                yield Field(first, match[1], words_of(f"{rest}\n{above}\n{after}"))
            above = above if GROUP.search(words_of(above)) else ""
            statement = after = ""
        if not code.strip():
            if statement:
                after += f"//{comment}\n"
            elif slashes:
                above += f"//{comment}\n"
                rest = above if REST.search(words_of(above)) else rest
            else:
                above = ""
            continue
        first = number if not statement else first
        statement += code if not statement else "\n" + code
        after += f"//{comment}\n" if slashes else ""
        is_complete = statement.rstrip().endswith((";", "{", "}"))


def unlisted_fields(root: Path) -> Iterator[Finding]:
    """The fields of options structs with a field list that are neither in it nor said to be no user parameters."""
    own: dict[str, str] = {}  # the functions that list the fields of a struct
    all_lists = ""
    for path in sorted((root / SOURCES).rglob("*.cc")):
        for match in LIST_FUNCTION.finditer(path.read_text(encoding="utf-8", errors="replace")):
            code = re.sub(r'"(?:[^"\\]|\\.)*"', '""', match[0])
            all_lists += code
            if match[1]:
                own[match[1]] = own.get(match[1], "") + code
    for path in sorted((root / SOURCES).rglob("*.h")):
        text = path.read_text(encoding="utf-8", errors="replace")
        for struct in STRUCT.finditer(text):
            comment, name, body = struct.groups()
            if not LISTING.search(body) or NOT_OF_USERS.search(words_of(comment)):
                continue
            first = text.count("\n", 0, struct.start(3)) + 1
            for field in fields_of(body):
                is_listed = re.search(rf"\b{field.name}\b", own.get(name, "")) or re.search(rf"\.{field.name}\b", all_lists)
                if not is_listed and not NOT_OF_USERS.search(field.comment):
                    message = f'{name}::{field.name}: not in ListFields: list it, or end its comment with "Not a user parameter"'
                    yield Finding(path.relative_to(root), first + field.line, message)


def check(root: Path) -> list[Finding]:
    findings = list(unlisted_fields(root))
    unit_tests: dict[str, str] = {}
    end_to_end_tests = read_all((root / END_TO_END).glob("test_*.py"))
    parameters = list(parameters_of((root / PAGE).read_text(encoding="utf-8")))
    if not parameters:
        findings.append(Finding(PAGE, 1, f"no parameter in the section {SECTION}: print the page again (tools/parameters.sh)"))
    for line, name in parameters:
        owner = owner_of(name)
        if owner is None:
            findings.append(Finding(PAGE, line, f"{name}: no owner: add its group to OWNERS of tools/check_parameters.py"))
            continue
        if owner not in unit_tests:
            unit_tests[owner] = read_all((root / SOURCES / owner).rglob("*_test.cc"))
        if not is_set(name, unit_tests[owner], end_to_end_tests):
            findings.append(
                Finding(PAGE, line, f"{name}: no test of {owner}/ or {END_TO_END} sets it: add one that shows what it changes")
            )
    return findings


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
