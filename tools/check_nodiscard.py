#!/usr/bin/env python3
"""Checks that the functions that headers declare with a Status or an Expected are [[nodiscard]], so that the compiler
refuses a dropped error (docs/adr/0001-errors-as-values.md).

Usage: check_nodiscard.py [ROOT]
Prints one line per finding, "path:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator

import findings
from findings import Finding

CODE_FOLDERS = ("src", "experiments", "assets/make", "testing", "tests", "bench", "examples")

# A declaration of a function, by its beginning: optional specifiers, the type at the start of a line, the name and "(".
DECLARATION = re.compile(
    r"^[ \t]*(?P<nodiscard>\[\[nodiscard\]\]\s+)?"
    r"(?:(?:static|virtual|inline|constexpr|friend)\s+)*"
    r"(?:Status|(?:std::e|E)xpected<[^;{}()=]*>)\s+(?P<name>\w+)\(",
    re.MULTILINE,
)
NODISCARD_BEFORE = re.compile(r"\[\[nodiscard\]\]\s*$")


def findings_of(text: str, path: Path) -> Iterator[Finding]:
    for match in DECLARATION.finditer(text):
        if match["nodiscard"] or NODISCARD_BEFORE.search(text, 0, match.start()):
            continue
        line = text.count("\n", 0, match.start("name")) + 1
        yield Finding(path, line, f"{match['name']}() returns an error that a caller could drop: write [[nodiscard]] before it")


def check(root: Path) -> list[Finding]:
    return [
        finding
        for folder in CODE_FOLDERS
        for path in sorted((root / folder).rglob("*.h"))
        for finding in findings_of(path.read_text(encoding="utf-8"), path.relative_to(root))
    ]


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
