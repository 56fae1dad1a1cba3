#!/usr/bin/env python3
"""Builds and runs the unit tests of the source folders that differ from a commit, and the checks that compile nothing.

Usage: quick.py [COMMIT]   (default: the commit where the branch left origin/main; without that branch, HEAD)
Exits with the status of what failed first. `make test` is the whole.
"""

import subprocess
import sys
from pathlib import Path

from findings import library_of, read_levels

ROOT = Path(__file__).resolve().parent.parent
SOURCES = "src/victorious/"
# Programs beside src/victorious, by the folder of their sources.
TARGETS = {"experiments/": "victorious-experiment", "bench/": "victorious-bench", "web/": "victorious_page"}


def test_folders(paths: list[str]) -> list[str]:
    """The folders of layers.toml with a changed file, sorted; each has one test program."""
    levels = read_levels(ROOT)
    inside = [path.removeprefix(SOURCES) for path in paths if path.startswith(SOURCES)]
    return sorted({library_of(path, levels) for path in inside} - {None})


def name_of(folder: str) -> str:
    return folder.rpartition("/")[2]


def targets(paths: list[str], has_tests) -> list[str]:
    """What is built: the tests of the changed folders, and the programs whose own folders have changed.

    has_tests: whether a folder has a test program.
    """
    of_tests = [f"{name_of(folder)}_tests" for folder in test_folders(paths) if has_tests(folder)]
    of_programs = [target for start, target in TARGETS.items() if any(path.startswith(start) for path in paths)]
    return of_tests + of_programs


def git(*arguments: str) -> str | None:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else None


def changed_paths(commit: str) -> list[str]:
    differing = git("diff", "--name-only", "--diff-filter=d", commit)
    if differing is None:
        sys.exit(f"quick.py: {commit}: no such commit: give one that `git log` shows")
    return (differing + (git("ls-files", "--others", "--exclude-standard") or "")).split("\n")


def has_tests(folder: str) -> bool:
    lists = ROOT / SOURCES / folder / "CMakeLists.txt"
    return lists.is_file() and "victorious_tests(" in lists.read_text(encoding="utf-8")


def run(*command: str) -> None:
    print("+", " ".join(command), file=sys.stderr, flush=True)
    status = subprocess.run(command, cwd=ROOT).returncode
    if status != 0:
        sys.exit(status)


def main(arguments: list[str]) -> None:
    if len(arguments) > 1 or arguments[:1] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    commit = arguments[0] if arguments else (git("merge-base", "HEAD", "origin/main") or "HEAD").strip()
    paths = changed_paths(commit)
    run("tools/check.sh")
    wanted = targets(paths, has_tests)
    if not wanted:
        print(f"No source folder differs from {commit}: nothing is built.", file=sys.stderr)
        return
    run("cmake", "--build", "build", "--target", *wanted)
    folders = [folder for folder in test_folders(paths) if has_tests(folder)]
    if folders:
        run("ctest", "--preset", "release", "-R", f"^({'|'.join(map(name_of, folders))})/")


if __name__ == "__main__":
    main(sys.argv[1:])
