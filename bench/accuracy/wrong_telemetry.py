#!/usr/bin/env python3
"""Measures what wrong telemetry costs: finds, places, and whether the errors that are stated cover the ones that are made.

Usage: wrong_telemetry.py MOVIE... --models DIR [--program build/victorious] [--every 5] [--case NAME]... [--work DIR]

MOVIE is a folder with video.mp4, telemetry.csv and truth.jsonl. DIR contains models of the truth's objects, made by
`model add`. Each movie is indexed with its exact telemetry, and once with that of each case:

  late       all times too large by 0.3, 1 and 3 s
  yaw        yaw too large by 5 degrees, and too small
  hfov       field of view too wide by 20 %, and too narrow
  other      the telemetry of the next movie; left out with one movie only

Prints one row for each movie and case:

  found      true objects found, of those findable (as `victorious evaluate` counts)
  false      false objects
  placed     found objects with a place
  error      median and largest horizontal error of the places, m
  CE90       their median
  covered    places within their CE90
  said       what `index` reported of the telemetry: clock, yaw and field of view corrected, clock unknown, field of view in
             doubt, another flight's, places rejected

and at the end, for each case over all movies, the places within CE90.
"""

import argparse
import csv
import json
import re
import statistics
import tempfile
from pathlib import Path
from typing import Callable

from movies import Program

Row = dict[str, str]
OTHER = "other flight"


def late(seconds: float) -> Callable[[Row], None]:
    def spoil(row: Row) -> None:
        row["time_s"] = f"{float(row['time_s']) + seconds:.6f}"

    return spoil


def turned(degrees: float) -> Callable[[Row], None]:
    def spoil(row: Row) -> None:
        row["yaw_deg"] = f"{(float(row['yaw_deg']) + degrees) % 360:.6f}"

    return spoil


def widened(factor: float) -> Callable[[Row], None]:
    def spoil(row: Row) -> None:
        row["hfov_deg"] = f"{float(row['hfov_deg']) * factor:.6f}"

    return spoil


CASES: dict[str, Callable[[Row], None]] = {
    "exact": lambda row: None,
    "late 0.3 s": late(0.3),
    "late 1 s": late(1),
    "late 3 s": late(3),
    "yaw +5": turned(5),
    "yaw -5": turned(-5),
    "hfov +20 %": widened(1.2),
    "hfov -20 %": widened(0.8),
    OTHER: lambda row: None,
}

SAID = [
    (r"its clock is ([\d.]+ s \w+)", "clock {}"),
    (r"offset of its clock is unknown", "clock unknown"),
    (r"yaw of the telemetry is ([\d.]+) degrees too (\w+)", "yaw {} {}"),
    (r"its field of view is (\d+ %) too (\w+)", "field {} {}"),
    (r"its field of view may be wrong", "field in doubt"),
    (r"field of view is about (\d+ %) too (\w+)", "field {} {}"),
    (r"it belongs to another flight", "another's, not used"),
    (r"may belong to another", "may be another's"),
]


def rows_of(movie: Path) -> list[Row]:
    with (movie / "telemetry.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[Row], spoil: Callable[[Row], None], path: Path) -> None:
    changed = [dict(row) for row in rows]
    for row in changed:
        spoil(row)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, changed[0].keys())
        writer.writeheader()
        writer.writerows(changed)


def remarks(log: str, objects: list[dict]) -> str:
    said = []
    for pattern, text in SAID:
        match = re.search(pattern, log)
        if match:
            said.append(text.format(*match.groups()))
    rejected = sum("latitude_deg" not in one or one["latitude_deg"] is None for one in objects)
    if rejected:
        said.append(f"{rejected} without place")
    return ", ".join(said) or "-"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("movies", nargs="+", type=Path, metavar="MOVIE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--every", type=int, default=5)
    parser.add_argument("--case", action="append", choices=list(CASES), help="only these")
    parser.add_argument("--work", type=Path, help="telemetry and indexes stay here")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    print(f"{'movie':<14}{'case':<14}{'found':>7}{'false':>6}{'placed':>7}{'error, m':>16}{'CE90, m':>9}{'covered':>9}  said")
    models = sorted(path.stem for path in arguments.models.glob("*.vmodel"))
    covered: dict[str, list[bool]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.work or Path(scratch)
        work.mkdir(parents=True, exist_ok=True)
        for number, movie in enumerate(arguments.movies):
            for case in arguments.case or CASES:
                if case == OTHER and len(arguments.movies) == 1:
                    continue
                given = arguments.movies[(number + 1) % len(arguments.movies)] if case == OTHER else movie
                stem = re.sub(r"\W+", "_", f"{movie.name} {case}")
                telemetry, database = work / f"{stem}.csv", work / f"{stem}.db"
                write(rows_of(given), CASES[case], telemetry)
                database.unlink(missing_ok=True)
                log = program.run("index", movie / "video.mp4", "--telemetry", telemetry, "--models", arguments.models,
                                  "--db", database, "--every", arguments.every).stderr
                score = json.loads(program("evaluate", "--db", database, "--truth", movie / "truth.jsonl", "--models",
                                           ",".join(models), "--json"))
                exported = program("export", "--db", database, "--format", "objects").splitlines()
                objects = [json.loads(line) for line in exported]
                errors = [one["error_m"] for one in score["per_object"].values() if one["error_m"] is not None]
                inside = round((score["inside_ce90"] or 0) * score["located"])
                covered.setdefault(case, []).extend([True] * inside + [False] * (score["located"] - inside))
                radii = [one["ce90_m"] for one in objects if one.get("ce90_m") is not None]
                error = f"{statistics.median(errors):8.2f}{max(errors):8.2f}" if errors else f"{'-':>16}"
                radius = f"{statistics.median(radii):9.2f}" if radii else f"{'-':>9}"
                found = f"{score['found']}/{score['findable']}"
                within = f"{inside}/{score['located']}"
                print(f"{movie.name:<14}{case:<14}{found:>7}{score['false_objects']:>6}{score['located']:>7}{error}{radius}"
                      f"{within:>9}  {remarks(log, objects)}", flush=True)
    for case, inside in covered.items():
        print(f"{case}: {sum(inside)} of {len(inside)} places within CE90")


if __name__ == "__main__":
    main()
