#!/usr/bin/env python3
"""Measures what two drones over one town at the same time know together, compared with each alone.

Usage: two_drones.py --models DIR [--program build/victorious] [--scenes scenes] [--flights 6] [--seed 1] [--frames 60]
                     [--every 5] [--position-m 2] [--attitude-deg 0.5] [--keep DIR] [--json]

DIR contains models of the scenes' objects, made by `model add`. Flight k uses the k-th of five scenes (cyclically), in
four of which objects drive: the first drone flies as the scene says, the second sees the same objects at the same times
from another side (70 to 110 degrees), from 0.9 to 1.15 of the range. Each has telemetry with UTC and its own errors, as
those of noisy_telemetry.py. Each video is indexed alone, and both in one index. Prints one row per flight, and the
total: the objects that both drones find alone, those of them that have one identity in the common index, and the root mean square error of their places by each
drone alone and by both; `ratio` is that of both over that of the better drone.
With --json the total as an object, with the ratio of each flight.
"""

import argparse
import csv
import datetime
import json
import math
import random
import sys
import tempfile
from pathlib import Path

from movies import Movie, Program, found
from noisy_telemetry import latin_normals, scaled, spoil, turned

SCENES = ("driving", "straight_noise", "circle_noise", "swerve_noise", "straight")


def sun_at(when: datetime.datetime, latitude_deg: float, longitude_deg: float) -> tuple[float, float]:
    """Azimuth and elevation of the sun, degrees, to about half a degree (the equation of time and the declination by
    their first harmonics: NOAA's solar calculator, simplified)."""
    day = math.tau * (when.timetuple().tm_yday - 1 + (when.hour - 12) / 24) / 365
    equation_min = 229.18 * (0.000075 + 0.001868 * math.cos(day) - 0.032077 * math.sin(day)
                             - 0.014615 * math.cos(2 * day) - 0.040849 * math.sin(2 * day))
    declination = 0.006918 - 0.399912 * math.cos(day) + 0.070257 * math.sin(day)
    hour = math.radians((when.hour * 60 + when.minute + equation_min + 4 * longitude_deg) / 4 - 180)
    latitude = math.radians(latitude_deg)
    elevation = math.asin(math.sin(latitude) * math.sin(declination)
                          + math.cos(latitude) * math.cos(declination) * math.cos(hour))
    azimuth = math.atan2(-math.sin(hour) * math.cos(declination),
                         math.sin(declination) * math.cos(latitude)
                         - math.cos(declination) * math.sin(latitude) * math.cos(hour))
    return math.degrees(azimuth) % 360, math.degrees(elevation)


def start_of(scene: dict) -> datetime.datetime:
    """A time of the year 2026 at which the sun stands over the scene as it is lit."""
    origin, sun = scene["origin"], scene["sun"]

    def apart(when: datetime.datetime) -> float:
        azimuth, elevation = sun_at(when, origin["latitude_deg"], origin["longitude_deg"])
        turn = (azimuth - sun["azimuth_deg"] + 180) % 360 - 180
        return math.hypot(turn * math.cos(math.radians(elevation)), elevation - sun["elevation_deg"])

    year = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
    times = (year + datetime.timedelta(days=day, minutes=minute) for day in range(0, 365, 4) for minute in range(0, 1440, 8))
    return min(times, key=apart)


def read_scene(source: Path, frames: int) -> dict:
    scene = json.loads(source.read_text())
    scene["assets"] = str((source.parent / scene.get("assets", "../assets")).resolve())
    video = scene["video"]
    if frames < video["frames"]:  # of the whole flight
        video["fps"] *= (frames - 1) / (video["frames"] - 1)
        video["frames"] = frames
    return scene


def from_other_side(scene: dict, draws: random.Random) -> dict:
    scene = json.loads(json.dumps(scene))
    camera = scene["camera"]
    by_deg = draws.choice((-1, 1)) * draws.uniform(70, 110)
    for key in ("from_deg", "start_deg"):
        if key in camera:
            camera[key] = turned(camera[key], by_deg)
    camera["range_m"] = scaled(camera["range_m"], draws.uniform(0.9, 1.15))
    scene["seed"] += 1  # of the noise
    return scene


def add_utc(telemetry: Path, start: datetime.datetime) -> None:
    with telemetry.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["utc"] = (start + datetime.timedelta(seconds=float(row["time_s"]))).isoformat().replace("+00:00", "Z")
    with telemetry.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def best_error_m(objects: list[dict]) -> float:
    return min((one["error_m"] for one in objects if not math.isnan(one["error_m"])), default=math.nan)


def rms(errors: list[float]) -> float:
    return math.sqrt(sum(error**2 for error in errors) / len(errors)) if errors else math.nan


def to_better(errors: list[tuple[float, float, float]]) -> float:
    """The error of both drones together over that of the better one of this flight."""
    first, second, both = (rms(list(column)) for column in zip(*errors))
    return both / min(first, second)


def line_of(name: str, seen: int, one_identity: int, errors: list[tuple[float, float, float]]) -> str:
    first, second, both = (rms(list(column)) for column in zip(*errors)) if errors else (math.nan,) * 3
    return (f"{name:<20} {seen:9} {one_identity:12}   {first:7.2f} {second:7.2f} {both:7.2f}"
            f"   {both / min(first, second):5.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--scenes", type=Path, default=Path("scenes"))
    parser.add_argument("--flights", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--every", type=int, default=5)
    parser.add_argument("--position-m", type=float, default=2)
    parser.add_argument("--attitude-deg", type=float, default=0.5)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--keep", type=Path, help="flights and indexes stay here; what is there is not flown again")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    draws = random.Random(arguments.seed)
    common = [latin_normals(arguments.flights, draws) for _ in range(2)]
    shown = sys.stderr if arguments.json else sys.stdout
    print(f"{'flight':<20} seen by 2 one identity   rms m: A       B    both   ratio", file=shown)
    total_seen, total_one, total_errors, ratios = 0, 0, [], []
    with tempfile.TemporaryDirectory() as scratch:
        for k in range(arguments.flights):
            name = SCENES[k % len(SCENES)]
            folder = (arguments.keep or Path(scratch)) / f"{k + 1}-{name}"
            scene = read_scene(arguments.scenes / f"{name}.json", arguments.frames)
            movies = {}
            for drone, flown in enumerate((scene, from_other_side(scene, random.Random(1000 * arguments.seed + k)))):
                place = folder / "ab"[drone]
                place.mkdir(parents=True, exist_ok=True)
                video = place / f"{'ab'[drone]}.mp4"
                if not video.exists():
                    (place / "scene.json").write_text(json.dumps(flown))
                    program("simulate", place / "scene.json", "--out", place)
                    (place / "video.mp4").rename(video)
                noisy = video.with_suffix(".telemetry.csv")
                spoil(place / "telemetry.csv", noisy, common[drone][k],
                      random.Random(10 * arguments.seed + k + 5 * drone), arguments.position_m,
                      arguments.attitude_deg, tell=True)
                add_utc(noisy, start_of(scene))
                movies[str(video)] = Movie(place)
            indexes = {}
            for label, videos in (("a", list(movies)[:1]), ("b", list(movies)[1:]), ("both", list(movies))):
                db = folder / f"{label}.db"
                db.unlink(missing_ok=True)
                program("index", *videos, "--models", arguments.models, "--db", db, "--every", arguments.every,
                        "--keep-features", "none")
                indexes[label] = found(program, db, {video: movies[video] for video in videos})
            seen = [one for one in indexes["a"] if one in indexes["b"]]
            one_identity = sum(len(indexes["both"][one]) == 1 for one in seen)
            errors = [tuple(best_error_m(indexes[label][one]) for label in ("a", "b", "both")) for one in seen]
            errors = [one for one in errors if not any(map(math.isnan, one))]
            print(line_of(folder.name, len(seen), one_identity, errors), file=shown, flush=True)
            ratios += [to_better(errors)] if errors else []
            total_seen += len(seen)
            total_one += one_identity
            total_errors += errors
    print(line_of("all", total_seen, total_one, total_errors), file=shown)
    if arguments.json:
        print(json.dumps({"seen": total_seen, "one_identity": total_one, "ratios": ratios,
                          "mean_ratio": sum(ratios) / max(1, len(ratios)), "largest_ratio": max(ratios, default=0),
                          "worse": sum(ratio > 1 for ratio in ratios), "flights": len(ratios)}))  # fmt: skip


if __name__ == "__main__":
    main()
