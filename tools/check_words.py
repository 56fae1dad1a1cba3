#!/usr/bin/env python3
"""Checks the words of identifiers and of names of tests: words that the field has another word for must not come back
(docs/glossary.md). Comments and texts are not checked.

Usage: check_words.py [ROOT]
Prints one line per finding, "path:line: identifier: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator

import findings
from findings import Finding

SOURCES = ("src", "tests", "testing", "experiments", "bench", "examples", "assets")
CODE_ENDINGS = (".h", ".cc", ".cu")

# A word of an identifier, in lower case -> the field's word. Identifiers are split at underscores and capitals.
WORDS = {
    "stance": "object pose",
    "stances": "object poses",
    "sight": "bearing observation",
    "sights": "bearing observations",
    "likeness": "NCC score",
    "told": "given or measured",
    "likest": "nearest",
    "picture": "image",
    "pictures": "images",
    "thing": "object",
    "things": "objects",
    "scout": "hypothesis or coarse view",
    "scouts": "hypotheses or coarse views",
}
FIRST_WORDS = {"least": "min_", "most": "max_"}  # of identifiers with more than one word, `k` apart
LAST_WORDS = {"share": "_fraction"}  # units apart
UNITS = {"px", "m", "s", "us", "rad", "deg"}

# A test is named Subject.WhatIsAsserted: a noun and a verb, not a relative clause or a riddle.
TEST_WORDS = {
    "alike": "equal or similar",
    "anew": "again",
    "tell": "give or estimate",
    "tells": "gives or estimates",
    "whatever": "for any",
}
FIRST_TEST_WORDS = {"but", "what", "where", "which", "who", "whose"}

# Sequences of words with an accepted meaning.
EXCEPTIONS = (
    ("least", "squares"),
    ("line", "of", "sight"),
    ("lines", "of", "sight"),
    ("most", "significant"),
    ("least", "significant"),
)

HIDDEN = re.compile(  # comments, raw strings, strings, characters (not the separators of digits)
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\'',
    re.DOTALL,
)
TEST_NAME = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\(\s*(?P<suite>\w+),\s*(?P<name>\w+)\)", re.MULTILINE)
IDENTIFIER = re.compile(r"\b[A-Za-z_]\w*\b")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z][a-z]*|[a-z]+|\d+")


def words_of(identifier: str) -> list[str]:
    """kLeastSquares_m -> least, squares, m."""
    words = [word.lower() for word in WORD.findall(identifier)]
    is_constant = re.match(r"k[A-Z]", identifier) is not None
    return words[1:] if is_constant else words


def without(words: list[str], phrase: tuple[str, ...]) -> list[str]:
    for start in range(len(words) - len(phrase) + 1):
        if tuple(words[start : start + len(phrase)]) == phrase:
            return words[:start] + words[start + len(phrase) :]
    return words


def remedy(identifier: str) -> str | None:
    """The field's word for the first private word of an identifier, if it has one."""
    words = words_of(identifier)
    for phrase in EXCEPTIONS:
        words = without(words, phrase)
    for word in words:
        if word in WORDS:
            return f'"{word}": the field says {WORDS[word]}'
    while words and words[-1] in UNITS:
        words.pop()
    if len(words) > 1 and words[0] in FIRST_WORDS:
        return f'"{words[0]}" as a bound: use {FIRST_WORDS[words[0]]}'
    if len(words) > 1 and words[-1] in LAST_WORDS:
        return f'"{words[-1]}": use {LAST_WORDS[words[-1]]}'
    return None


def blank(match: re.Match) -> str:
    return "\n" * match[0].count("\n") + " "


def test_remedy(name: str) -> str | None:
    """The remedy for the name of a test, if it needs one."""
    words = words_of(name)
    for phrase in EXCEPTIONS:
        words = without(words, phrase)
    if words and words[0] in FIRST_TEST_WORDS:
        return f'"{words[0]}": name what is asserted, as a subject and a verb'
    for word in words:
        if remedies := WORDS.get(word) or TEST_WORDS.get(word):
            return f'"{word}": the field says {remedies}'
    return None


def check_text(path: Path, text: str) -> Iterator[Finding]:
    visible = HIDDEN.sub(blank, text)
    for match in TEST_NAME.finditer(visible):
        for name in (match["suite"], match["name"]):
            if message := test_remedy(name):
                yield Finding(path, visible.count("\n", 0, match.start()) + 1, f"{name}: {message}")
    code = TEST_NAME.sub(blank, visible)
    for number, line in enumerate(code.splitlines(), start=1):
        for identifier in dict.fromkeys(IDENTIFIER.findall(line)):
            if message := remedy(identifier):
                yield Finding(path, number, f"{identifier}: {message}")


def check(root: Path) -> list[Finding]:
    findings = []
    for path in sorted(path for folder in SOURCES for path in (root / folder).rglob("*")):
        if path.suffix in CODE_ENDINGS and path.is_file():
            text = path.read_text(encoding="utf-8", errors="replace")
            findings += check_text(path.relative_to(root), text)
    return findings


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
