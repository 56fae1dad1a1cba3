#!/usr/bin/env python3
"""Measures how the time and the memory of `victorious index` grow with the number of CAD models.

Usage: model_growth.py --models LIBRARY --movie DIR [--factor N ...] [--program FILE] [--work DIR]

LIBRARY is a folder of models (`victorious model add`), DIR has video.mp4 and telemetry.csv. For each factor N (default
1, 4 and 16) the movie is indexed by default for all models under N names each, so that each object in the movie is
found and tracked N times: more than N different models would cost. Each index runs twice; the second, which finds the
relit templates on disk, counts. Prints JSON, of each factor:

  models, wall_s, processor_s, peak_mb
  growth       processor time / that of the first factor
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent


def link_models(library: Path, copies: int, folder: Path, names: list[str] | None = None) -> int:
    """Links to each model, or to those named, under other names. Returns how many."""
    folder.mkdir(parents=True, exist_ok=True)
    for leftover in folder.iterdir():
        leftover.unlink()
    files = sorted(library.glob("*.vmodel"))
    if not files:
        sys.exit(f"--models {library}: has no .vmodel: give a folder that `victorious model add` made")
    if missing := set(names or ()) - {file.stem for file in files}:
        sys.exit(f"--models {library}: has no {', '.join(sorted(missing))}")
    files = [file for file in files if not names or file.stem in names]
    for file in files:
        for copy in range(copies):
            (folder / f"{file.stem}-{copy}.vmodel").symlink_to(file.resolve())
    return len(files) * copies


def index(program: Path, movie: Path, models: Path, work: Path) -> dict:
    for leftover in work.glob("index.db*"):
        leftover.unlink()
    command = [
        program, "index", movie / "video.mp4", "--telemetry", movie / "telemetry.csv", "--models", models,
        "--db", work / "index.db", "--cache", work / "cache",
    ]  # fmt: skip
    log = work / "index.log"
    begun = time.monotonic()
    with log.open("w") as messages:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=messages)
        _, status, used = os.wait4(process.pid, 0)  # of this run alone
    wall_s = time.monotonic() - begun
    if status != 0:
        sys.exit(f"index {movie}: {log.read_text().strip()}")
    return {
        "wall_s": round(wall_s, 1),
        "processor_s": round(used.ru_utime + used.ru_stime, 1),
        "peak_mb": round(used.ru_maxrss / 1024),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--movie", type=Path, required=True)
    parser.add_argument("--factor", type=int, nargs="+", default=[1, 4, 16])
    parser.add_argument("--program", type=Path, default=REPOSITORY / "build/victorious")
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/model_growth")
    arguments = parser.parse_args()
    results = []
    for factor in arguments.factor:
        folder = arguments.work / "models"
        models = link_models(arguments.models, factor, folder)
        for name in ("relit templates", "measured"):
            print(f"{models} models: {name}", file=sys.stderr, flush=True)
            run = index(arguments.program, arguments.movie, folder, arguments.work)
        first = results[0]["processor_s"] if results else run["processor_s"]
        results.append({"models": models, **run, "growth": round(run["processor_s"] / first, 2)})
    print(json.dumps(results))


if __name__ == "__main__":
    main()
