#!/usr/bin/env python3
"""Checks that a test sets each parameter of `index` (docs/parameters.md): a unit test in the folder that owns the
parameter, or an end-to-end test. The test asserts what the parameter changes; this check only sees that there is one.

Usage: check_parameters.py [ROOT]
Prints one line per finding, "docs/parameters.md:line: problem: remedy"; exits with 1 if there is any.
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
    "video": "video",
    "features": "features",
    "method": "recognize",
    "search": "recognize",
    "match": "match",
    "cascade": "grammar",
    "pose": "pose",
    "detect": "detect",
    "categories": "recognize",
    "daylight": "calibrate",
    "telemetry": "telemetry",
    "follow": "pipeline",
    "follow.track": "track",
    "tracklets": "associate",
    "keep": "pipeline",
    "every": "pipeline",
    "objects": "associate",
    "objects.locate": "geolocate",
    "ground": "terrain",
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


def check(root: Path) -> list[Finding]:
    findings = []
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
