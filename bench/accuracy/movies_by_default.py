#!/usr/bin/env python3
"""Measures `victorious index` as a user runs it, by default and with all models of a library, on movies with ground truth.

Usage: movies_by_default.py MOVIE... --models DIR [--starts N] [--seed 1] [--params FILE] [--program build/victorious] [--json]

MOVIE is a folder with video.mp4, truth.jsonl and telemetry.csv; DIR a model library. Which frames are searched as a
whole depends on where the video starts: with --starts the movie is indexed N times, from a time that is drawn from its
first 0.7 s, and the truth before is left out. Prints one row per index, and all; with --json an object instead: by
movie, and `all`, the sums of

  found, findable, false_objects      objects, as `victorious evaluate` counts
  detected, clear                     clear truth rows of findable objects, and those of them that are detected
  right, wrong                        sightings
  errors_m, located, inside_ce90      horizontal errors of the places; how many lie within their CE90
  inside_90_ellipsoid                 and in their 90 % ellipsoid
  processor_s, peak_mb                of `index`, the largest of all for memory
  recalls                             recall of each index, by which starts differ
"""

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from movies import Movie, Program

FIRST_S = 0.7  # the longest interval between two searches of whole frames
SUMMED = ("found", "findable", "false_objects", "detected", "clear", "right", "wrong", "located", "inside_ce90",
          "inside_90_ellipsoid", "processor_s", "errors_m", "recalls")  # fmt: skip


def used_by(command: list[str]) -> tuple[float, float]:
    """Runs it. Returns its processor time in seconds, and its peak memory in MB; exits if it fails."""
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=log)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            log.seek(0)
            sys.exit(f"{' '.join(command)}: {log.read().decode().strip()}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def truth_from(movie: Movie, start_s: float, scratch: Path) -> Path:
    """The truth from this time on: a folder with truth.jsonl."""
    rows = [row for row in map(json.loads, movie.truth.read_text().splitlines()) if row["time_s"] >= start_s]
    (scratch / "truth.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return scratch


def measure(program: Program, movie: Movie, start_s: float, arguments: argparse.Namespace) -> dict:
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        db = scratch / "index.db"
        extra = ["--params", str(arguments.params)] if arguments.params else []
        extra += ["--from", f"{start_s:.3f}"] if start_s else []
        extra += ["--telemetry", str(movie.telemetry)] if movie.telemetry else []
        processor_s, peak_mb = used_by([program.path, "index", str(movie.video), "--models", str(arguments.models),
                                        "--db", str(db), *extra])  # fmt: skip
        truth = truth_from(movie, start_s, scratch)
        score = json.loads(program("evaluate", "--db", db, "--truth", truth / "truth.jsonl", "--json"))
        sightings = len(program("export", "--db", db, "--format", "sightings").splitlines())
        clear = sum(Movie.findable_of(truth / "truth.jsonl").values())
    return counts(score, clear, sightings) | {"processor_s": processor_s, "peak_mb": peak_mb}


def counts(score: dict, clear: int, sightings: int) -> dict:
    """The counts behind the fractions of `evaluate`."""
    located, recall = score["located"], score["sighting_recall"] or 0
    errors = [one["error_m"] for one in score["per_object"].values() if one["error_m"] is not None]
    wrong = round((1 - (score["sighting_precision"] or 0)) * sightings) if sightings else 0
    return {key: score[key] for key in ("found", "findable", "false_objects", "located")} | {
        "detected": round(recall * clear), "clear": clear, "right": sightings - wrong, "wrong": wrong, "errors_m": errors,
        "inside_ce90": round((score["inside_ce90"] or 0) * located), "recalls": [recall],
        "inside_90_ellipsoid": round((score["inside_90_ellipsoid"] or 0) * located),
    }  # fmt: skip


def total(results: list[dict]) -> dict:
    summed = {key: sum((one[key] for one in results[1:]), start=results[0][key]) for key in SUMMED}
    rank = sorted(summed["errors_m"])
    quantile = {f"cep{percent}_m": rank[min(len(rank) - 1, percent * len(rank) // 100)] if rank else None for percent in (50, 75, 90)}
    rates = {
        "recall": summed["detected"] / max(1, summed["clear"]),
        "precision": summed["right"] / max(1, summed["right"] + summed["wrong"]),
        "least_recall": min(summed["recalls"]), "greatest_recall": max(summed["recalls"]),
        "peak_mb": max(one["peak_mb"] for one in results), "sightings": summed["right"] + summed["wrong"],
    }  # fmt: skip
    return summed | quantile | rates


def line_of(name: str, one: dict) -> str:
    place = "-" if one["cep50_m"] is None else f"{one['cep50_m']:.2f} / {one['cep90_m']:.2f}"
    return (f"{name:<20} {one['found']:3} of {one['findable']:3} {one['false_objects']:6} {one['recall']:8.3f} {one['precision']:10.3f}"
            f"   {place:>13} {one['inside_ce90']:4} of {one['located']:3} {one['processor_s']:8.1f} s {one['peak_mb']:6.0f} MB")


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("movies", nargs="+", type=Path, metavar="MOVIE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--starts", type=int, default=1, help="1: only from the first frame")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--params", type=Path)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--json", action="store_true")
    return parser.parse_args()


def main() -> None:
    arguments = parse()
    program, draws = Program(arguments.program), random.Random(arguments.seed)
    shown = sys.stderr if arguments.json else sys.stdout
    print("movie                 found      false   recall  precision   CEP 50 / 90 m  in CE90  processor    peak", file=shown)
    results: dict[str, list[dict]] = {}
    for folder in arguments.movies:
        starts = [0.0] + [draws.uniform(0, FIRST_S) for _ in range(arguments.starts - 1)]
        for start_s in starts:
            result = measure(program, Movie(folder), start_s, arguments)
            results.setdefault(folder.name, []).append(result)
            print(line_of(f"{folder.name} {start_s:.2f}", total([result])), file=shown, flush=True)
    every = total([result for of_movie in results.values() for result in of_movie])
    print(line_of("all", every), file=shown)
    if arguments.json:
        print(json.dumps({name: total(of_movie) for name, of_movie in results.items()} | {"all": every}))


if __name__ == "__main__":
    main()
