#!/usr/bin/env python3
"""Measures the effect of tracked sightings on geolocation with erroneous telemetry.

Usage: followed_places.py MOVIE... --models DIR [--program build/victorious] [--draws 5] [--position-m 0.5]
                          [--attitude-deg 0.05] [--every 10]

MOVIE is a folder with video.mp4, telemetry.csv (exact) and truth.jsonl; DIR contains models made by `model add`. Each
movie is indexed once, with a complete search of every EVERY-th frame only. Then, for each draw, random errors are added
to the stored bearing observations: per-frame errors, and common errors of the flight with the same standard deviations,
which are stored as sigmas. The objects are then geolocated with and without the bearing observations of tracked
sightings. Prints one row per movie and variant, with means over the draws.
"""

import argparse
import contextlib
import json
import math
import random
import shutil
import sqlite3
import subprocess
import tempfile
from pathlib import Path

SIGHT = (
    "camera_latitude_rad camera_longitude_rad camera_altitude_m camera_sigma_m camera_sigma_rad bearing_azimuth_rad "
    "bearing_elevation_rad bearing_sigma_rad range_m range_sigma_m heading_rad"
).split()
EARTH_M = 6371e3
KEYS = ("located", "false_objects", "cep50_m", "cep90_m", "error3d_p50_m", "inside_90_ellipsoid", "inside_ce90")


def shift(database: Path, seed: int, position_m: float, attitude_rad: float, followed: bool) -> None:
    draws = random.Random(seed)

    def error(sigma: float, count: int) -> list[float]:
        return [draws.gauss(0, sigma) for _ in range(count)]

    common_m, common_rad = error(position_m, 3), error(attitude_rad, 2)
    with contextlib.closing(sqlite3.connect(database)) as index, index:
        frames = [row[0] for row in index.execute("SELECT DISTINCT frame FROM sightings ORDER BY frame")]
        own = {frame: (error(position_m, 3), error(attitude_rad, 2)) for frame in frames}
        rows = index.execute(
            "SELECT video_id, tracklet_id, frame, camera_latitude_rad, camera_longitude_rad, camera_altitude_m, "
            "bearing_azimuth_rad, bearing_elevation_rad FROM sightings WHERE camera_latitude_rad IS NOT NULL"
        ).fetchall()
        for video, tracklet, frame, latitude, longitude, altitude, azimuth, elevation in rows:
            north, east, up = (a + b for a, b in zip(own[frame][0], common_m, strict=True))
            side, rise = (a + b for a, b in zip(own[frame][1], common_rad, strict=True))
            index.execute(
                "UPDATE sightings SET camera_latitude_rad=?, camera_longitude_rad=?, camera_altitude_m=?, "
                "camera_sigma_m=?, camera_sigma_rad=?, bearing_azimuth_rad=?, bearing_elevation_rad=? "
                "WHERE video_id=? AND tracklet_id=? AND frame=?",
                (latitude + north / EARTH_M, longitude + east / (EARTH_M * math.cos(latitude)), altitude + up,
                 position_m or None, attitude_rad or None, azimuth + side, elevation + rise, video, tracklet, frame),
            )
        if not followed:
            index.execute(f"UPDATE sightings SET {', '.join(f'{key}=NULL' for key in SIGHT)} WHERE source='tracked'")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("movies", nargs="+", type=Path)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", type=Path, default=Path("build/victorious"))
    parser.add_argument("--draws", type=int, default=5)
    parser.add_argument("--position-m", type=float, default=0.5)
    parser.add_argument("--attitude-deg", type=float, default=0.05)
    parser.add_argument("--every", type=int, default=10)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        params = Path(folder) / "params.json"

        def index(movie: Path, database: Path, **objects) -> None:
            never_s = 1000  # regions are not searched between whole frames: tracked sightings alone lie there
            params.write_text(json.dumps({"follow": {"search_interval_s": never_s}, "objects": objects}))
            subprocess.run(
                [arguments.program, "index", movie / "video.mp4", "--models", arguments.models, "--db", database,
                 "--telemetry", movie / "telemetry.csv", "--every", str(arguments.every), "--params", params],
                check=True, capture_output=True,
            )

        for movie in arguments.movies:
            indexed = Path(folder) / f"{movie.name}.db"
            index(movie, indexed)
            for followed in (False, True):
                scores = []
                for seed in range(1, arguments.draws + 1):
                    database = Path(folder) / f"{movie.name}-{seed}-{followed}.db"
                    shutil.copy(indexed, database)
                    shift(database, seed, arguments.position_m, math.radians(arguments.attitude_deg), followed)
                    index(movie, database, merge_gate_sigma=3.5001)  # changed parameters: recomputes the places
                    scored = subprocess.run(
                        [arguments.program, "evaluate", "--db", database, "--truth", movie / "truth.jsonl", "--json"],
                        check=True, capture_output=True, text=True,
                    )
                    scores.append(json.loads(scored.stdout))
                means = (sum(score[key] or 0 for score in scores) / len(scores) for key in KEYS)
                reported = "  ".join(f"{key} {mean:.3f}" for key, mean in zip(KEYS, means, strict=True))
                print(f"{movie.name:<14} {'with' if followed else 'without':<8} {reported}", flush=True)


if __name__ == "__main__":
    main()
