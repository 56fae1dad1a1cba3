#!/usr/bin/env python3
"""Measures how often the truth lies in the confidence ellipsoids of places, in simulated flights with noisy telemetry.

Usage: noisy_telemetry.py --models DIR [--program build/victorious] [--scenes scenes] [--flights 10] [--seed 1]
                          [--frames 60] [--every 5] [--position-m 2] [--attitude-deg 0.5] [--tell] [--keep DIR] [--json]

DIR contains models of the scenes' objects, made by `model add`. Flight k uses the k-th scene (cyclically) with its own
seeds: another town, objects rotated and moved by up to 1.5 m, another azimuth and range of the camera. Errors are added
to its telemetry: white noise of --position-m per axis of the position and --attitude-deg per axis of the attitude in
each row, plus a common error of the flight with the same sigmas. The common error dominates, and ten flights are few,
so each of its six components is drawn once from each tenth of the normal distribution (a Latin hypercube). The flight
is indexed and evaluated with this telemetry; with --tell, the telemetry contains the sigmas. Prints one row per flight,
and the total; with --json the total as an object instead.
"""

import argparse
import csv
import json
import math
import random
import statistics
import sys
import tempfile
from pathlib import Path

from movies import EARTH_M, Program

SCENES = ("straight", "circle", "shaken", "straight_noise", "swerve_noise", "circle_noise", "shaken_noise")


def turned(angles, by: float):
    return [angle + by for angle in angles] if isinstance(angles, list) else angles + by


def scaled(lengths, by: float):
    return [length * by for length in lengths] if isinstance(lengths, list) else lengths * by


def vary(scene: dict, assets: Path, draws: random.Random, frames: int) -> dict:
    scene["assets"] = str(assets)
    scene["seed"] = draws.randrange(1, 10**6)
    scene["town"]["seed"] = draws.randrange(1, 10**6)
    video = scene["video"]
    if frames < video["frames"]:
        video["fps"] *= (frames - 1) / (video["frames"] - 1)
        video["frames"] = frames
    for thing in scene["objects"]:
        if "path_m" in thing:
            continue
        thing["heading_deg"] = draws.uniform(0, 360)
        for axis in ("x_m", "y_m"):
            thing[axis] += draws.uniform(-1.5, 1.5)
    camera = scene["camera"]
    for key in ("from_deg", "start_deg"):
        if key in camera:
            camera[key] = turned(camera[key], draws.uniform(-40, 40))
    if "range_m" in camera:
        camera["range_m"] = scaled(camera["range_m"], draws.uniform(0.9, 1.1))
    return scene


def latin_normals(flights: int, draws: random.Random) -> list[list[float]]:
    """Six standard normal numbers per flight, as a Latin hypercube: each number has one flight in every quantile interval."""
    columns = []
    for _ in range(6):
        stretches = list(range(flights))
        draws.shuffle(stretches)
        columns.append([statistics.NormalDist().inv_cdf((stretch + draws.random()) / flights) for stretch in stretches])
    return [list(row) for row in zip(*columns, strict=True)]


def spoil(exact: Path, noisy: Path, common: list[float], draws: random.Random, position_m: float, attitude_deg: float,
          tell: bool) -> None:
    with exact.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        north, east, up, yaw, pitch, roll = (shared + draws.gauss(0, 1) for shared in common)
        latitude = float(row["latitude_deg"])
        metre_deg = math.degrees(1 / EARTH_M)
        row["latitude_deg"] = latitude + north * position_m * metre_deg
        row["longitude_deg"] = (
            float(row["longitude_deg"]) + east * position_m * metre_deg / math.cos(math.radians(latitude))
        )
        row["altitude_m"] = float(row["altitude_m"]) + up * position_m
        for name, error in (("yaw_deg", yaw), ("pitch_deg", pitch), ("roll_deg", roll)):
            row[name] = float(row[name]) + error * attitude_deg
        if tell:
            row["sigma_position_m"], row["sigma_attitude_deg"] = position_m, attitude_deg
    with noisy.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def line_of(name: str, scores: list[dict]) -> str:
    def total(key: str) -> int:
        return sum(score[key] or 0 for score in scores)

    located = total("located")

    def share(key: str) -> str:
        inside = sum(round((score[key] or 0) * score["located"]) for score in scores)
        return f"{inside:4} of {located:3}"

    errors = sorted(
        one["error_m"] for score in scores for one in score["per_object"].values() if one["error_m"] is not None
    )
    middle = f"{errors[len(errors) // 2]:8.2f}" if errors else "       -"
    return (
        f"{name:<20} {total('found'):3} of {total('findable'):3} {total('false_objects'):3}  "
        f"{middle} {max(errors, default=math.nan):8.2f}  {share('inside_90_ellipsoid')}  {share('inside_ce90')}"
    )


def sums(scores: list[dict]) -> dict:
    def inside(key: str) -> int:
        return sum(round((score[key] or 0) * score["located"]) for score in scores)

    objects = [one for score in scores for one in score["per_object"].values()]
    return {key: sum(score[key] for score in scores) for key in ("found", "findable", "false_objects", "located")} | {
        "inside_90_ellipsoid": inside("inside_90_ellipsoid"), "inside_ce90": inside("inside_ce90"),
        "errors_m": [one["error_m"] for one in objects if one["error_m"] is not None],
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--scenes", type=Path, default=Path("scenes"))
    parser.add_argument("--flights", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--every", type=int, default=5)
    parser.add_argument("--position-m", type=float, default=2)
    parser.add_argument("--attitude-deg", type=float, default=0.5)
    parser.add_argument("--tell", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--keep", type=Path, help="flights and indexes stay here; what is there is not flown again")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    shown = sys.stderr if arguments.json else sys.stdout
    print(f"{'flight':<20} found      false   error m: median, largest   in the ellipsoid, in CE90", file=shown)
    scores = []
    shared = latin_normals(arguments.flights, random.Random(arguments.seed))
    with tempfile.TemporaryDirectory() as scratch:
        for k in range(1, arguments.flights + 1):
            name = SCENES[(k - 1) % len(SCENES)]
            folder = (arguments.keep or Path(scratch)) / f"{k}-{name}"
            folder.mkdir(parents=True, exist_ok=True)
            source = arguments.scenes / f"{name}.json"
            draws = random.Random(k)
            scene = json.loads(source.read_text())
            assets = (source.parent / scene.get("assets", "../assets")).resolve()
            scene_file = folder / "scene.json"
            text = json.dumps(vary(scene, assets, draws, arguments.frames))
            is_flown = (folder / "video.mp4").exists() and scene_file.exists() and scene_file.read_text() == text
            scene_file.write_text(text)
            if not is_flown:  # the video is written last
                program("simulate", scene_file, "--out", folder)
            noisy = folder / ("given.csv" if arguments.tell else "noisy.csv")
            spoil(folder / "telemetry.csv", noisy, shared[k - 1], random.Random(1000 * arguments.seed + k),
                  arguments.position_m, arguments.attitude_deg, arguments.tell)
            database = folder / f"{noisy.stem}.db"
            database.unlink(missing_ok=True)
            program("index", folder / "video.mp4", "--telemetry", noisy, "--models", arguments.models, "--db", database,
                    "--every", arguments.every)
            scored = program("evaluate", "--db", database, "--truth", folder / "truth.jsonl", "--json")
            scores.append(json.loads(scored))
            print(line_of(folder.name, scores[-1:]), file=shown, flush=True)
    print(line_of("all", scores), file=shown)
    if arguments.json:
        print(json.dumps(sums(scores)))


if __name__ == "__main__":
    main()
