#!/usr/bin/env python3
"""Checks that the commands which the pages and the table of measurements name exist and accept their arguments.

Usage: check_commands.py [ROOT] [BUILD]
Of a Python script with argparse: it is imported and its arguments are parsed, no more. Of a test program: its filter
names a test. Of `victorious bench` and `experiment`: the name is in their help. Commands are read from README.md,
CONTRIBUTING.md, docs/*.md, docs/results/*.md and bench/results/rows; placeholders such as N and [--json] are
understood. A program that is not built is SKIPPED, by name. The flags of `victorious` itself are checked by
tests/e2e/test_documents.py. Prints one line per finding.
"""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from results_table import ROWS, read_table

FENCED = re.compile(r"^```[a-z]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"^    ((?:bench|tools|build)/.*)$", re.MULTILINE)
INLINE = re.compile(r"`([^`\n]+)`")
ARGPARSE = re.compile(r"^ +parser = argparse\.ArgumentParser\(", re.MULTILINE)
START = re.compile(r"^(?:bench|tools|build)/[\w./-]+")
NUMBERS = {"N", "SECONDS"}  # placeholders of numbers
ENDS = re.compile(r"\s(?:&&|\|\||[|;>]|\d?>&?\d?|>>)\s?|\s+#\s")
# Parses the arguments of the script argv[1], and ends.
PARSE_ONLY = """
import argparse, runpy, sys
def stop(parse):
    def parse_and_end(self, *args, **kwargs):
        parse(self, *args, **kwargs)
        raise SystemExit(0)
    return parse_and_end
argparse.ArgumentParser.parse_args = stop(argparse.ArgumentParser.parse_args)
sys.argv = sys.argv[1:]
sys.path.insert(0, sys.argv[0].rpartition("/")[0])
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def commands_of(text: str) -> Iterator[str]:
    """The commands in a page that begin with a script or a program of this tree."""
    blocks = [line for block in FENCED.findall(text) for line in block.replace("\\\n", " ").splitlines()]
    rest = FENCED.sub("", text)
    for line in [*blocks, *INDENTED.findall(rest), *INLINE.findall(rest)]:
        for part in ENDS.split(line):
            if START.match(part.strip()):
                yield part.strip()


def arguments_of(command: str) -> list[str]:
    """Its words, as a user would type them: without brackets and dots, with 1 for a number."""
    words = shlex.split(re.sub(r"[\[\]]|\.\.\.", " ", command) if "--gtest" not in command else command)
    return ["1" if word in NUMBERS else word for word in words]


def run(*command: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(list(map(str, command)), cwd=cwd, capture_output=True, text=True, timeout=60, check=False)


def python_fault(script: Path, arguments: list[str], root: Path) -> str | None:
    if not ARGPARSE.search(script.read_text(encoding="utf-8")) or not arguments:
        return None  # a bare name is not a command line
    done = run(sys.executable, "-c", PARSE_ONLY, script, *arguments, cwd=root)
    return None if done.returncode == 0 else done.stderr.strip().splitlines()[-1]


def test_fault(program: Path, arguments: list[str], root: Path) -> str | None:
    filters = [word for word in arguments if word.startswith("--gtest_filter=")]
    done = run(program, *filters, "--gtest_list_tests", cwd=root)
    return None if "\n  " in done.stdout else f"{' '.join(filters)} names no test"


def name_fault(program: Path, arguments: list[str], root: Path) -> str | None:
    """Of `victorious bench NAME` and `victorious experiment NAME`."""
    if len(arguments) < 2 or arguments[0] not in ("bench", "experiment") or not arguments[1].islower():
        return None
    known = run(program, arguments[0], "--help", cwd=root)
    if known.returncode != 0 or arguments[1].startswith("-"):
        return None
    return None if re.search(rf"(?<![\w.-]){re.escape(arguments[1])}(?![\w-])", known.stdout) else f"no {arguments[0]} {arguments[1]}"


def fault(command: str, root: Path, build: Path) -> str | None:
    """Why the command cannot work, or None; a text that begins with SKIPPED if that cannot be said."""
    try:
        words = arguments_of(command)
    except ValueError as error:
        return str(error)
    path = root / words[0]
    if words[0].startswith("build/"):
        path = build / words[0].removeprefix("build/")
        if not path.is_file():
            return f"SKIPPED: {words[0]} is not built" if words[1:] else None
        return (test_fault if path.name.endswith("_tests") else name_fault)(path, words[1:], root)
    if "*" not in words[0] and not path.exists():
        return "no such file"
    return python_fault(path, words[1:], root) if path.suffix == ".py" else None


def documents(root: Path) -> list[Path]:
    return [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").glob("*.md")), *sorted((root / "docs/results").glob("*.md"))]


def all_commands(root: Path) -> dict[str, str]:
    """Each command, and where it stands."""
    found: dict[str, str] = {}
    for run_of_table in read_table(root):
        for command in commands_of(f"```\n{run_of_table.command}\n```\n"):
            found.setdefault(command, f"{ROWS}: {run_of_table.name}")
    for document in documents(root):
        for command in commands_of(document.read_text(encoding="utf-8")):
            found.setdefault(command, str(document.relative_to(root)))
    return found


def main(arguments: list[str]) -> int:
    root = Path(arguments[0] if arguments else ".").resolve()
    build = Path(arguments[1]).resolve() if len(arguments) > 1 else root / "build"
    for variable, name in (("VICTORIOUS_PROGRAM", "victorious"), ("VICTORIOUS_DRAW_FLIGHT", "draw_flight")):
        if (build / name).exists():
            os.environ.setdefault(variable, str(build / name))
    commands = all_commands(root)
    with ThreadPoolExecutor(2) as pool:
        faults = list(pool.map(lambda command: fault(command, root, build), commands))
    for (command, where), why in zip(commands.items(), faults):
        if why:
            print(f"{why} ({command})" if why.startswith("SKIPPED") else f"{where}: {command}: {why}")
    return 1 if any(why and not why.startswith("SKIPPED") for why in faults) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
