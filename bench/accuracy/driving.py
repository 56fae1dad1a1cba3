#!/usr/bin/env python3
"""Measures how objects that drive are found, placed and followed, in simulated flights.

Usage: driving.py [SCENE...] --models DIR [--program build/victorious] [--noisy] [--seed 1] [--position-m 0.5]
                  [--attitude-deg 0.1] [--keep DIR] [--json]

SCENE is a file of scenes/; without one those in which objects drive. DIR contains models of their objects, made by
`model add`. Each flight is simulated and indexed by default, with exact telemetry, or with --noisy with the errors of
noisy_telemetry.py: white noise in each row, and a common error of the same size. Prints one row per flight:

  found      objects found, of those findable, and false objects (as `victorious evaluate` counts)
  ids        identities per object
  density    quartiles of the fraction of clear frames in which an object is reported
  CEP        quantiles of the horizontal error, m, and the places within their CE90
  speed      largest error of the speed at the last sighting, m/s, by the truth of 0.4 s
  course     largest error of the course of what drives faster than 1 m/s, degrees
"""

import argparse
import json
import math
import random
import sys
import tempfile
from pathlib import Path

from movies import EARTH_M, Movie, Program, found
from noisy_telemetry import spoil

SCENES = ("driving", "driving_noise", "driving_pairs")
MIN_SPEED_M_S = 1


def true_motion(rows: list[dict], time_s: float) -> tuple[float, float]:
    """Speed, m/s, and course, degrees, about this time."""
    rows = sorted(rows, key=lambda row: row["time_s"])
    at = min(range(len(rows)), key=lambda i: abs(rows[i]["time_s"] - time_s))
    first, last = rows[max(0, at - 2)], rows[min(len(rows) - 1, at + 2)]
    north = math.radians(last["latitude_deg"] - first["latitude_deg"])
    east = math.radians(last["longitude_deg"] - first["longitude_deg"]) * math.cos(math.radians(first["latitude_deg"]))
    duration_s = last["time_s"] - first["time_s"]
    return EARTH_M * math.hypot(north, east) / duration_s, math.degrees(math.atan2(east, north)) % 360


def motion_errors(program: Program, db: Path, movie: Movie) -> tuple[float, float]:
    """The largest errors of speed and course, of the objects with a place."""
    speed, course = 0.0, 0.0
    for name, objects in found(program, db, {str(movie.video): movie}).items():
        for one in objects:
            if one["place_time_s"] is None:
                continue
            true_speed, true_course = true_motion(movie.rows_of[name], one["place_time_s"])
            speed = max(speed, abs((one["speed_m_s"] or 0) - true_speed))
            if true_speed > MIN_SPEED_M_S and one["course_deg"] is not None:
                course = max(course, abs((one["course_deg"] - true_course + 180) % 360 - 180))
    return speed, course


def measure(program: Program, scene: Path, folder: Path, arguments, draws: random.Random) -> dict:
    if not (folder / "video.mp4").exists():
        program("simulate", scene, "--out", folder)
    telemetry = folder / "telemetry.csv"
    if arguments.noisy:
        exact, telemetry = telemetry, folder / "noisy.csv"
        common = [draws.gauss(0, 1) for _ in range(6)]
        spoil(exact, telemetry, common, draws, arguments.position_m, arguments.attitude_deg, tell=False)
    movie = Movie(folder)
    db = folder / f"{telemetry.stem}.db"
    db.unlink(missing_ok=True)
    program("index", movie.video, "--telemetry", telemetry, "--models", arguments.models, "--db", db)
    score = json.loads(program("evaluate", "--db", db, "--truth", movie.truth, "--json"))
    speed, course = motion_errors(program, db, movie)
    inside = round((score["inside_ce90"] or 0) * score["located"])
    return score | {"inside": inside, "speed_m_s": speed, "course_deg": course}


def line_of(name: str, score: dict) -> str:
    return (
        f"{name:<16} {score['found']:3} of {score['findable']:2} {score['false_objects']:6} "
        f"{score['ids_per_object']:6.2f}   {score['density_p25']:.2f} / {score['density_p50']:.2f} / "
        f"{score['density_p75']:.2f}   {score['cep50_m']:.2f} / {score['cep90_m']:.2f}  {score['inside']:3} of {score['located']:2}"
        f"   {score['speed_m_s']:5.2f} {score['course_deg']:6.1f}"
    )


def summary(scores: list[dict]) -> dict:
    """Sums of the counts, and the largest errors."""
    summed = {key: sum(score[key] for score in scores) for key in ("found", "findable", "false_objects", "inside", "located")}
    largest = ("cep50_m", "cep90_m", "speed_m_s", "course_deg", "ids_per_object")
    return summed | {key: max(score[key] or 0 for score in scores) for key in largest}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--noisy", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--position-m", type=float, default=0.5)
    parser.add_argument("--attitude-deg", type=float, default=0.1)
    parser.add_argument("--json", action="store_true", help="print an object: what the rows show, by flight")
    parser.add_argument("--keep", type=Path, help="flights and indexes stay here; what is there is not flown again")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    draws = random.Random(arguments.seed)
    scenes = arguments.scenes or [Path("scenes") / f"{name}.json" for name in SCENES]
    shown = sys.stderr if arguments.json else sys.stdout
    print("flight            found      false    ids   density                CEP 50 / 90  in CE90    speed course", file=shown)
    scores = {}
    with tempfile.TemporaryDirectory() as scratch:
        for scene in scenes:
            folder = (arguments.keep or Path(scratch)) / scene.stem
            folder.mkdir(parents=True, exist_ok=True)
            scores[scene.stem] = measure(program, scene, folder, arguments, draws)
            print(line_of(scene.stem, scores[scene.stem]), file=shown, flush=True)
    if arguments.json:
        print(json.dumps(scores | {"all": summary(list(scores.values()))}))


if __name__ == "__main__":
    main()
