#!/usr/bin/env python3
"""Compares the documents that list folders and files with what is there: ARCHITECTURE.md's tables, the README.md of
every source folder, of testing/ and of web/, and the links of them.

Usage: check_folders.py [ROOT]
Prints one line per finding, "path:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator

import findings
from findings import Finding, library_of, read_levels

SOURCES = Path("src/victorious")
ARCHITECTURE = Path("ARCHITECTURE.md")

LEVEL_ROW = re.compile(r"^\| *(\d+) *\| *\[?`([a-z_/]+)/`")  # | 3 | `match/` | ...
FOLDER_ROW = re.compile(r"^\| *\[?`([A-Za-z_./-]+/)`")  # | `bench/` | ...
FILE_ROW = re.compile(r"^(?:\| *\[?`[^|]*|- *\[?`[^`]*`)")  # | `klv.h`, `klv_packets.h` | ... and - `locate.h`: ...
FILE = re.compile(r"`([A-Za-z0-9_/]+(?:\.h|\.cc|/))`")
LISTED = re.compile(r"`([A-Za-z0-9_./]+(?:\.(?:h|tsx?)|/))`")
INCLUDE = re.compile(r'^#include "victorious/([a-z0-9_/]+\.h)"', re.MULTILINE)
LINK = re.compile(r"\]\((?!https?:|mailto:|#)([^)#\s]+)(?:#[^)]*)?\)")

# README.md files that list every file of a folder with a name like this. Paths in them are relative to the README.
COMPLETE_LISTS = {
    Path("testing/README.md"): (Path("testing"), re.compile(r".*\.h")),
    Path("web/README.md"): (Path("web/src"), re.compile(r"[^.]+\.tsx?")),  # neither tests nor declarations
}


def numbered(root: Path, path: Path) -> Iterator[tuple[int, str]]:
    if (root / path).is_file():
        yield from enumerate((root / path).read_text(encoding="utf-8").splitlines(), start=1)


def check_levels(root: Path) -> Iterator[Finding]:
    """ARCHITECTURE.md has one row per folder of layers.toml, with its level."""
    levels = read_levels(root)
    rows: dict[str, int] = {}
    for line, text in numbered(root, ARCHITECTURE):
        if not (match := LEVEL_ROW.match(text)):
            continue
        level, name = int(match[1]), match[2]
        if name not in levels:
            yield Finding(ARCHITECTURE, line, f"lists {name}/, which layers.toml does not: take the row out")
        elif level != levels[name]:
            yield Finding(ARCHITECTURE, line, f"gives {name}/ level {level}: layers.toml says {levels[name]}")
        if name in rows:
            yield Finding(ARCHITECTURE, line, f"lists {name}/ again, after line {rows[name]}")
        rows.setdefault(name, line)
    for name in levels:
        if name not in rows:
            yield Finding(ARCHITECTURE, 1, f"has no row for {name}/: add | {levels[name]} | `{name}/` | what it is |")


def check_top_folders(root: Path) -> Iterator[Finding]:
    """The folders beside src/victorious that ARCHITECTURE.md lists exist."""
    for line, text in numbered(root, ARCHITECTURE):
        match = FOLDER_ROW.match(text)
        if match and not (root / match[1]).is_dir():
            yield Finding(ARCHITECTURE, line, f"lists {match[1]}, which is no folder: take the row out")


def interfaces(root: Path) -> dict[str, set[str]]:
    """The headers of each source folder that other folders include, by folder."""
    levels = read_levels(root)
    headers: dict[str, set[str]] = {}
    for path in sorted((root / SOURCES).rglob("*.h")) + sorted((root / SOURCES).rglob("*.cc")):
        includer = library_of(path.relative_to(root / SOURCES).as_posix(), levels)
        for header in INCLUDE.findall(path.read_text(encoding="utf-8")):
            folder = library_of(header, levels)
            if folder and folder != includer:
                headers.setdefault(folder, set()).add(header.removeprefix(f"{folder}/"))
    return headers


def check_readmes(root: Path) -> Iterator[Finding]:
    """Every source folder has a README.md, and so has a folder of folders. The files and folders that it lists exist; if it lists headers in a table, then
    all that other folders include."""
    included = interfaces(root)
    levels = read_levels(root)
    names = sorted(levels.keys() | {name.rpartition("/")[0] for name in levels} - {""})
    for name in names:
        folder = root / SOURCES / name
        readme = SOURCES / name / "README.md"
        if not (root / readme).is_file():
            yield Finding(readme, 1, "is missing: say what goes in, what comes out, the method and its source")
        last_row, listed = 0, []
        for line, text in numbered(root, readme):
            row = FILE_ROW.match(text)
            files = FILE.findall(row[0]) if row else []
            for file in files:
                if not (folder / file).exists():
                    yield Finding(readme, line, f"lists {file}, which is not in {name}/: take the line out")
            if files and text.startswith("|"):
                last_row = line
                listed += files
        if any(file.endswith(".h") for file in listed):
            for header in sorted(included.get(name, set())):
                if not any(header == file or (file.endswith("/") and header.startswith(file)) for file in listed):
                    yield Finding(readme, last_row, f"lists headers, but not {header}, which other folders include")


def check_complete_lists(root: Path) -> Iterator[Finding]:
    """Each README.md of COMPLETE_LISTS lists its files, and the files and folders that it lists exist."""
    for readme, (folder, name_pattern) in COMPLETE_LISTS.items():
        listed, last_row = set(), 1
        for line, text in numbered(root, readme):
            row = FILE_ROW.match(text)
            for name in LISTED.findall(row[0]) if row else []:
                last_row = line
                listed.add(readme.parent / name)
                if not (root / readme.parent / name).exists():
                    yield Finding(readme, line, f"lists {name}, which does not exist: take it out")
        for path in sorted(path.relative_to(root) for path in (root / folder).glob("*")):
            if name_pattern.fullmatch(path.name) and path not in listed:
                yield Finding(readme, last_row, f"does not list {path.relative_to(readme.parent)}: add a row")


def check_links(root: Path) -> Iterator[Finding]:
    """Relative links lead to a file or a folder."""
    readmes = [*sorted((root / SOURCES).rglob("README.md")), *(root / path for path in COMPLETE_LISTS)]
    for path in (path.relative_to(root) for path in (*sorted(root.glob("*.md")), *readmes)):
        for line, text in numbered(root, path):
            for target in LINK.findall(text):
                if not (root / path.parent / target).exists():
                    yield Finding(path, line, f"links {target}, which does not exist")


def check(root: Path) -> list[Finding]:
    return [
        *check_levels(root),
        *check_top_folders(root),
        *check_readmes(root),
        *check_complete_lists(root),
        *check_links(root),
    ]


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
