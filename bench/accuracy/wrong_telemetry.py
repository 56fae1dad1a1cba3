#!/usr/bin/env python3
"""Measures what wrong telemetry costs: finds, places, and whether the errors that are stated cover the ones that are made.

Usage: wrong_telemetry.py MOVIE... --models DIR [--program build/victorious] [--every 5] [--case NAME]... [--draws N]
                          [--work DIR] [--json]

MOVIE is a folder with video.mp4, telemetry.csv and truth.jsonl. DIR contains models of the truth's objects, made by
`model add`. Each movie is indexed with its exact telemetry, and once with that of each case:

  late       all times too large by 0.3, 1 and 3 s: the telemetry begins and ends later than the video
  log late   the same of telemetry that begins 8 s before the video and ends 8 s after it, as the log of a whole flight
  held back  each row has the position and attitude of 0.3, 1 and 3 s before; it begins and ends with the video
  yaw        yaw too large by 5 degrees, and too small
  hfov       field of view too wide by 20 %, and too narrow
  other      the telemetry of the next movie; left out with one movie only

With --draws N, N times each, and with a common error of the flight in addition: 2 m in each axis of the position and
0.5 degrees in yaw, pitch and roll (standard deviations), which the default errors of places assume. Its components are
drawn from a Latin hypercube over movies and draws.

Prints one row for each movie, draw and case:

  found      true objects found, of those findable (as `victorious evaluate` counts)
  false      false objects
  placed     found objects with a place
  error      median and largest horizontal error of the places, m
  CE90       their median
  covered    places within their CE90
  said       what `index` reported of the telemetry: clock, yaw and field of view corrected, clock unknown, field of view in
             doubt, another flight's, places rejected

and at the end, for each case over all movies, and for all cases, the places within CE90; with --json an object instead:
of each case and of `all`, the sums over all movies and the largest of their median errors.
"""

import argparse
import csv
import json
import math
import random
import re
import statistics
import sys
import tempfile
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Callable

from movies import EARTH_M, Program
from noisy_telemetry import latin_normals

Row = dict[str, float]
Rows = list[Row]
OTHER = "other flight"
LOG_S = 8
LATE_S = (0.3, 1, 3)
COMMON_M = 2
COMMON_DEG = 0.5


def late(rows: Rows, seconds: float) -> Rows:
    return [row | {"time_s": row["time_s"] + seconds} for row in rows]


def extended(rows: Rows, seconds: float) -> Rows:
    """Before the first and after the last row, the motion goes on as it is there: mirrored in time and in value."""

    def mirrored(end: Row, other: Row) -> Row:
        return {name: other[name] if name == "hfov_deg" else 2 * end[name] - other[name] for name in end}

    first, last = rows[0], rows[-1]
    before = [mirrored(first, row) for row in rows[1:] if row["time_s"] - first["time_s"] <= seconds]
    after = [mirrored(last, row) for row in rows[:-1] if last["time_s"] - row["time_s"] <= seconds]
    return before[::-1] + rows + after[::-1]


def held_back(rows: Rows, seconds: float) -> Rows:
    return [row for row in late(extended(rows, seconds), seconds)
            if rows[0]["time_s"] - 1e-6 <= row["time_s"] <= rows[-1]["time_s"] + 1e-6]  # fmt: skip


def turned(rows: Rows, degrees: float) -> Rows:
    return [row | {"yaw_deg": row["yaw_deg"] + degrees} for row in rows]


def widened(rows: Rows, factor: float) -> Rows:
    return [row | {"hfov_deg": row["hfov_deg"] * factor} for row in rows]


def biased(rows: Rows, normals: list[float]) -> Rows:
    """Moved by one vector, and turned in yaw, pitch and roll by the same angles in each row."""
    north, east, up = (normal * COMMON_M for normal in normals[:3])
    metre_deg = math.degrees(1 / EARTH_M)
    added = dict(zip(("yaw_deg", "pitch_deg", "roll_deg"), (normal * COMMON_DEG for normal in normals[3:]), strict=True))
    added |= {
        "latitude_deg": north * metre_deg,
        "longitude_deg": east * metre_deg / math.cos(math.radians(rows[0]["latitude_deg"])),
        "altitude_m": up,
    }
    return [row | {name: row[name] + change for name, change in added.items()} for row in rows]


CASES: dict[str, Callable[[Rows], Rows]] = (
    {"exact": lambda rows: rows}
    | {f"late {s} s": partial(late, seconds=s) for s in LATE_S}
    | {"log": partial(extended, seconds=LOG_S)}
    | {f"log late {s} s": lambda rows, s=s: late(extended(rows, LOG_S), s) for s in LATE_S}
    | {f"held back {s} s": partial(held_back, seconds=s) for s in LATE_S}
    | {
        "yaw +5": partial(turned, degrees=5),
        "yaw -5": partial(turned, degrees=-5),
        "hfov +20 %": partial(widened, factor=1.2),
        "hfov -20 %": partial(widened, factor=0.8),
        OTHER: lambda rows: rows,
    }
)

SAID = [
    (r"its clock is ([\d.]+ s \w+)", "clock {}"),
    (r"offset of its clock is unknown.*recorded apart", "clock unknown, apart"),
    (r"offset of its clock is unknown(?!.*recorded apart)", "clock unknown"),
    (r"its yaw is ([\d.]+) degrees too (\w+)", "yaw {} {}"),
    (r"yaw of the telemetry is ([\d.]+) degrees too (\w+)", "yaw {} {}"),
    (r"its field of view is (\d+ %) too (\w+)", "field {} {}"),
    (r"its field of view may be wrong", "field in doubt"),
    (r"field of view is about (\d+ %) too (\w+)", "field {} {}"),
    (r"it belongs to another flight", "another's, not used"),
    (r"may belong to another", "may be another's"),
]


def rows_of(movie: Path) -> Rows:
    """With a yaw that does not jump by 360 degrees."""
    with (movie / "telemetry.csv").open(newline="") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    for before, row in pairwise(rows):
        row["yaw_deg"] -= 360 * round((row["yaw_deg"] - before["yaw_deg"]) / 360)
    return rows


def write(rows: Rows, path: Path) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        for row in rows:
            row = row | {"yaw_deg": row["yaw_deg"] % 360}
            writer.writerow({name: f"{value:.10f}" for name, value in row.items()})


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


class Measurement:
    """Indexes a movie with spoilt telemetry, prints its row, and counts the places within CE90 for each case."""

    def __init__(self, arguments: argparse.Namespace, work: Path):
        self.program = Program(arguments.program)
        self.arguments, self.work = arguments, work
        self.names = ",".join(sorted(path.stem for path in arguments.models.glob("*.vmodel")))
        self.sums: dict[str, dict[str, float]] = {}
        self.shown = sys.stderr if arguments.json else sys.stdout
        print(f"{'movie':<16}{'case':<16}{'found':>7}{'false':>6}{'placed':>7}{'error, m':>16}{'CE90, m':>9}"
              f"{'covered':>9}  said", file=self.shown)

    def run(self, movie: Path, label: str, case: str, rows: Rows) -> None:
        stem = re.sub(r"\W+", "_", f"{label} {case}".replace("+", "plus").replace("-", "minus"))
        telemetry, database = self.work / f"{stem}.csv", self.work / f"{stem}.db"
        write(CASES[case](rows), telemetry)
        database.unlink(missing_ok=True)
        log = self.program.run("index", movie / "video.mp4", "--telemetry", telemetry, "--models", self.arguments.models,
                               "--db", database, "--every", self.arguments.every).stderr
        score = json.loads(self.program("evaluate", "--db", database, "--truth", movie / "truth.jsonl", "--models",
                                        self.names, "--json"))
        objects = [json.loads(line) for line in self.program("export", "--db", database, "--format", "objects").splitlines()]
        errors = [one["error_m"] for one in score["per_object"].values() if one["error_m"] is not None]
        inside = round((score["inside_ce90"] or 0) * score["located"])
        median = statistics.median(errors) if errors else 0
        for name in (case, "all"):
            sums = self.sums.setdefault(name, dict.fromkeys(("found", "findable", "false_objects", "located", "inside", "median_m"), 0))
            for key in ("found", "findable", "false_objects", "located"):
                sums[key] += score[key]
            sums["inside"] += inside
            sums["median_m"] = max(sums["median_m"], median)
        radii = [one["ce90_m"] for one in objects if one.get("ce90_m") is not None]
        error = f"{median:8.2f}{max(errors):8.2f}" if errors else f"{'-':>16}"
        radius = f"{statistics.median(radii):9.2f}" if radii else f"{'-':>9}"
        found = f"{score['found']}/{score['findable']}"
        within = f"{inside}/{score['located']}"
        print(f"{label:<16}{case:<16}{found:>7}{score['false_objects']:>6}{score['located']:>7}{error}{radius}"
              f"{within:>9}  {remarks(log, objects)}", file=self.shown, flush=True)

    def print_sums(self) -> None:
        if self.arguments.json:
            print(json.dumps({re.sub(r"\W+", "_", name.replace("+", "plus ").replace("-", "minus ")): sums
                              for name, sums in self.sums.items()}))  # fmt: skip
            return
        for name, sums in self.sums.items():
            print(f"{name}: {sums['inside']} of {sums['located']} places within CE90")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("movies", nargs="+", type=Path, metavar="MOVIE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--every", type=int, default=5)
    parser.add_argument("--case", action="append", choices=list(CASES), help="only these")
    parser.add_argument("--draws", type=int, default=0, help="of a common error of the flight; 0: none")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--work", type=Path, help="telemetry and indexes stay here")
    arguments = parser.parse_args()
    movies, draws = arguments.movies, max(1, arguments.draws)
    normals = latin_normals(len(movies) * draws, random.Random(arguments.seed))
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.work or Path(scratch)
        work.mkdir(parents=True, exist_ok=True)
        measurement = Measurement(arguments, work)
        for flight, common in enumerate(normals):
            draw, number = divmod(flight, len(movies))
            movie = movies[number]
            for case in arguments.case or CASES:
                if case == OTHER and len(movies) == 1:
                    continue
                rows = rows_of(movies[(number + 1) % len(movies)] if case == OTHER else movie)
                if arguments.draws:
                    rows = biased(rows, common)
                label = f"{movie.name} {draw + 1}" if arguments.draws else movie.name
                measurement.run(movie, label, case, rows)
        measurement.print_sums()


if __name__ == "__main__":
    main()
