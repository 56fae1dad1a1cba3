#!/usr/bin/env python3
"""Measures the accuracy of the camera poses that `victorious navigate` estimates.

Usage: landmark_navigation.py MOVIE --models DIR [--landmarks truth|DB] [--case NAME...] [--seeds N]
                              [--program build/victorious] [--params FILE] [--work build/landmark_navigation] [--json]

MOVIE is a folder with video.mp4, telemetry.csv (exact) and truth.jsonl; DIR contains the models of its objects.
Landmarks are the static objects of the truth at their exact places, or the objects of an index DB. Cases:

  drift    telemetry with errors of 10 m along each axis and 3 degrees in yaw, pitch and roll (sigmas), plus a random
           walk of 0.5 m and 0.15 degrees per second
  noise    the same, plus 2 m and 0.5 degrees of white noise in each row
  ramp     telemetry exact in the first frame; the error grows to 10 m and 3 degrees in the last frame
  none     no telemetry, only the field of view
  moved    as drift, and the landmark visible longest is given 50 m from its true place
  unmoved  as none, and the landmark visible longest is given 50 m from its true place
  indexed  as drift, and the landmarks are the objects of an index of MOVIE, which is made with the exact telemetry

Prints one row per case and seed, with errors of the position (m) and of the attitude (degrees) over all frames: median
and 95 % quantile for the telemetry and for the result; the fraction of frames whose truth lies in the 90 % ellipsoid of
the position, and in the 90 % sphere of the attitude; the number of frames with a landmark; the median time per frame in
ms while landmarks are tracked, and the CPU time. With --json an object instead: of each case a list, by seed.
"""

import argparse
import csv
import json
import math
import random
import re
import sys
from pathlib import Path

from movies import Movie, Program

REPOSITORY = Path(__file__).resolve().parents[2]
CASES = ("drift", "noise", "ramp", "none", "moved", "unmoved", "indexed")
CHI_SQUARED_90_OF_3 = 6.2513886
EQUATOR_M, FLATTENING = 6378137.0, 1 / 298.257223563


def metres_per_degree(latitude_deg: float) -> tuple[float, float]:
    """Metres east and north."""
    sine = math.sin(math.radians(latitude_deg))
    squared = FLATTENING * (2 - FLATTENING)
    across = EQUATOR_M / math.sqrt(1 - squared * sine * sine)
    along = across * (1 - squared) / (1 - squared * sine * sine)
    return math.radians(across * math.cos(math.radians(latitude_deg))), math.radians(along)


def moved(row: dict, east: float, north: float, up: float) -> dict:
    by_east, by_north = metres_per_degree(float(row["latitude_deg"]))
    return row | {
        "latitude_deg": float(row["latitude_deg"]) + north / by_north,
        "longitude_deg": float(row["longitude_deg"]) + east / by_east,
        "altitude_m": float(row["altitude_m"]) + up,
    }


def apart(row: dict, truth: dict) -> list[float]:
    by_east, by_north = metres_per_degree(float(truth["latitude_deg"]))
    return [
        (float(row["longitude_deg"]) - float(truth["longitude_deg"])) * by_east,
        (float(row["latitude_deg"]) - float(truth["latitude_deg"])) * by_north,
        float(row["altitude_m"]) - float(truth["altitude_m"]),
    ]


def product(a: list, b: list) -> list:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def attitude(row: dict) -> list:
    """The rotation enu_from_camera, as defined in docs/formats/telemetry.md."""
    yaw, pitch, roll = (math.radians(float(row[key])) for key in ("yaw_deg", "pitch_deg", "roll_deg"))
    about_up = [[math.cos(yaw), math.sin(yaw), 0], [-math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]]
    about_right = [[1, 0, 0], [0, math.cos(pitch), -math.sin(pitch)], [0, math.sin(pitch), math.cos(pitch)]]
    level = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    about_axis = [[math.cos(roll), -math.sin(roll), 0], [math.sin(roll), math.cos(roll), 0], [0, 0, 1]]
    return product(product(about_up, about_right), product(level, about_axis))


def turn_deg(row: dict, truth: dict) -> float:
    a, b = attitude(row), attitude(truth)
    trace = sum(a[i][j] * b[i][j] for i in range(3) for j in range(3))
    return math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1) / 2))))


def squared_sigmas(error: list[float], row: dict) -> float:
    """The squared Mahalanobis distance error' covariance^-1 error, by Gaussian elimination."""
    axes = ("east", "north", "up")
    matrix = [[0.0] * 3 + [error[i]] for i in range(3)]
    for i in range(3):
        for j in range(i, 3):
            matrix[i][j] = matrix[j][i] = float(row[f"covariance_{axes[i]}_{axes[j]}_m2"])
    for i in range(3):
        for j in range(i + 1, 3):
            factor = matrix[j][i] / matrix[i][i]
            matrix[j] = [a - factor * b for a, b in zip(matrix[j], matrix[i])]
    solved = [0.0] * 3
    for i in (2, 1, 0):
        solved[i] = (matrix[i][3] - sum(matrix[i][j] * solved[j] for j in range(i + 1, 3))) / matrix[i][i]
    return sum(a * b for a, b in zip(error, solved))


def quantile(values: list[float], share: float) -> float:
    return sorted(values)[round(share * (len(values) - 1))]


def read_table(path: Path) -> list[dict]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def spoiled(rows: list[dict], case: str, seed: int) -> list[dict]:
    """Writes telemetry with the errors of the case."""
    draw = random.Random(seed)
    if case == "ramp":
        offset = [draw.choice((-1, 1)) * size for size in (6, 6, 5, 1.7, 1.7, 1.7)]  # norms of 10 m and 3 degrees
    else:
        offset = [draw.gauss(0, size) for size in (10, 10, 10, 3, 3, 3)]
    result = []
    for i, row in enumerate(rows):
        share = i / max(1, len(rows) - 1) if case == "ramp" else 1
        off = [share * value for value in offset]
        if case == "noise":
            off = [value + draw.gauss(0, size) for value, size in zip(off, (2, 2, 2, 0.5, 0.5, 0.5))]
        row = moved(row, *off[:3])
        for key, value in zip(("yaw_deg", "pitch_deg", "roll_deg"), off[3:]):
            row[key] = float(row[key]) + value
        result.append(row)
        if case != "ramp" and i + 1 < len(rows):
            root_s = math.sqrt(float(rows[i + 1]["time_s"]) - float(rows[i]["time_s"]))
            steps = (0.5, 0.5, 0.5, 0.15, 0.15, 0.15)
            offset = [value + draw.gauss(0, size * root_s) for value, size in zip(offset, steps)]
    return result


def write_table(rows: list[dict], path: Path) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def true_landmarks(movie: Movie, models: Path) -> list[dict]:
    """The static objects, ordered by the number of frames that show them."""
    keys = ("latitude_deg", "longitude_deg", "altitude_m", "heading_deg")
    objects = sorted(movie.rows_of.values(), key=len, reverse=True)
    still = [rows for rows in objects if all(rows[0][key] == row[key] for row in rows for key in keys)]
    return [
        {"model": rows[0]["model"], "sigma_heading_deg": 0} | {key: rows[0][key] for key in keys}
        for rows in still
        if (models / f"{rows[0]['model']}.vmodel").exists()
    ]


def landmarks_of(program: Program, movie: Movie, case: str, work: Path, arguments: argparse.Namespace) -> str | Path:
    """The list or the index that `navigate` reads."""
    if case == "indexed":
        db = work / "index.db"
        db.unlink(missing_ok=True)
        program("index", movie.video, "--models", arguments.models, "--db", db, "--telemetry", movie.telemetry)
        return db
    if arguments.landmarks != "truth":
        return arguments.landmarks
    known = true_landmarks(movie, arguments.models)
    if case in ("moved", "unmoved"):
        known[0] = moved(known[0], 30, 40, 0)
    landmarks = work / "landmarks.jsonl"
    landmarks.write_text("".join(json.dumps(landmark) + "\n" for landmark in known))
    return landmarks


def quantiles(metres: list[float], degrees: list[float]) -> dict[str, float]:
    return {f"{name}{percent}": quantile(values, percent / 100)
            for name, values in (("m", metres), ("deg", degrees)) for percent in (50, 95)}  # fmt: skip


def measure(program: Program, movie: Movie, case: str, seed: int, arguments: argparse.Namespace) -> dict:
    """Of no frame, if no landmark was recognised."""
    work = arguments.work / f"{movie.folder.name}_{case}_{seed}"
    work.mkdir(parents=True, exist_ok=True)
    truth = read_table(movie.telemetry)
    flags = ["--hfov", truth[0]["hfov_deg"]]
    given = None
    if case not in ("none", "unmoved"):
        given = spoiled(truth, case, seed)
        write_table(given, work / "telemetry.csv")
        flags = ["--telemetry", work / "telemetry.csv"]
    landmarks = landmarks_of(program, movie, case, work, arguments)
    if arguments.params:
        flags += ["--params", arguments.params]
    out = work / "camera.csv"
    said = program.run(
        "navigate", movie.video, "--landmarks", landmarks, "--models", arguments.models, "--out", out, *flags
    ).stderr
    (work / "said.txt").write_text(said)
    rows = read_table(out)
    errors = [apart(row, true) for row, true in zip(rows, truth)]
    if not errors:
        return {"frames": 0}
    turns = [turn_deg(row, true) for row, true in zip(rows, truth)]
    inside = sum(squared_sigmas(error, row) <= CHI_SQUARED_90_OF_3 for error, row in zip(errors, rows)) / len(rows)
    held = sum(
        turn <= math.sqrt(CHI_SQUARED_90_OF_3) * float(row["sigma_attitude_deg"]) for turn, row in zip(turns, rows)
    ) / len(rows)
    ms, cpu_ms = re.search(r"([\d.]+) ms per frame while landmarks are tracked, ([\d.]+)", said).groups()
    before = None
    if given:
        off = [math.hypot(*apart(row, true)) for row, true in zip(given, truth)]
        before = quantiles(off, [turn_deg(row, true) for row, true in zip(given, truth)])
    return quantiles([math.hypot(*error) for error in errors], turns) | {
        "given": before, "inside": inside, "held": held, "seen": sum(int(row["landmarks"]) > 0 for row in rows),
        "frames": len(rows), "ms": float(ms), "cpu_ms": float(cpu_ms),
    }  # fmt: skip


def line_of(case: str, seed: int, one: dict) -> str:
    if not one["frames"]:
        return f"{case:<8}{seed:>5}  no landmark recognised"

    def shown(of: dict) -> str:
        return f"{of['m50']:7.2f}{of['m95']:7.2f}{of['deg50']:6.2f}"

    before = f"{shown(one['given'])}{one['given']['deg95']:7.2f}" if one["given"] else f"{'-':>27}"
    return (
        f"{case:<8}{seed:>5}{before} |{shown(one)}{one['deg95']:6.2f} |{one['inside']:6.2f}{one['held']:6.2f}"
        f"{one['seen']:6}/{one['frames']}{one['ms']:>7}{one['cpu_ms']:>6}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("movie", type=Path, metavar="MOVIE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--landmarks", default="truth")
    parser.add_argument("--case", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--program", default=str(REPOSITORY / "build/victorious"))
    parser.add_argument("--params", type=Path)
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/landmark_navigation")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    movie = Movie(arguments.movie)
    if not movie.telemetry:
        parser.error(f"{arguments.movie}: has no telemetry.csv, by which to tell errors")
    shown = sys.stderr if arguments.json else sys.stdout
    print(f"{'':<13}{'given: m':>8}{'':>6}{'deg':>6}{'':>7} |{'found: m':>9}{'':>5}{'deg':>6}{'':>6} | inside", file=shown)
    results: dict[str, list[dict]] = {}
    for case in arguments.case:
        for seed in range(1, (arguments.seeds if case not in ("none", "unmoved") else 1) + 1):
            one = measure(Program(arguments.program), movie, case, seed, arguments)
            results.setdefault(case, []).append(one)
            print(line_of(case, seed, one), file=shown, flush=True)
    if arguments.json:
        print(json.dumps(results))


if __name__ == "__main__":
    sys.exit(main())
