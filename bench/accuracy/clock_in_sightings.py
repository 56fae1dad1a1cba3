#!/usr/bin/env python3
"""Measures how well the sightings of parked CAD objects tell the offset of telemetry's clock.

Usage: clock_in_sightings.py INDEX.db TELEMETRY.csv

INDEX.db is an index of one video, made by `victorious index` with TELEMETRY.csv, whose times are right and whose rows
have one interval. For each track, the point that fits its lines of sight and ranges best is found with the telemetry as
it is, and with its times changed by half a second either way: each line keeps its direction in the camera, and the
camera is where the telemetry says that it was then. Prints for each track the mean square of the residuals in standard
deviations with the right times and with late ones, and how far the point moves; then the standard error of the offset
that follows from all (errors of ten neighbouring lines are taken for one).
"""

import argparse
import csv
import math
import sqlite3
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

from movies import EARTH_M

STEP_S = 0.5
MIN_LINES = 10
CORRELATED = 10
MIN_SIGMA_RAD = math.radians(0.05)
Vector = tuple[float, ...]

SIGHTINGS = """
SELECT tracklet_id, time_s, bearing_azimuth_rad, bearing_elevation_rad, bearing_sigma_rad, range_m, range_sigma_m
FROM sightings WHERE bearing_azimuth_rad IS NOT NULL AND range_m IS NOT NULL AND source = 'recognised'
"""


def dot(a: Vector, b: Vector) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def direction(azimuth: float, elevation: float) -> Vector:
    """East, north, up."""
    return math.sin(azimuth) * math.cos(elevation), math.cos(azimuth) * math.cos(elevation), math.sin(elevation)


class Camera:
    def __init__(self, telemetry: Path):
        with telemetry.open(newline="") as file:
            self.rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        for before, row in pairwise(self.rows):
            row["yaw_deg"] -= 360 * round((row["yaw_deg"] - before["yaw_deg"]) / 360)
        self.begin_s, self.end_s = self.rows[0]["time_s"], self.rows[-1]["time_s"]

    def at(self, time_s: float) -> tuple[Vector, tuple[Vector, Vector, Vector]]:
        """Its place, m, and its axes: right, up and forward."""
        interval_s = self.rows[1]["time_s"] - self.begin_s
        index = min(max(0, int((time_s - self.begin_s) / interval_s)), len(self.rows) - 2)
        row, after, first = self.rows[index], self.rows[index + 1], self.rows[0]
        part = (time_s - row["time_s"]) / interval_s
        now = {name: row[name] + part * (after[name] - row[name]) for name in row}
        east = math.radians(now["longitude_deg"] - first["longitude_deg"]) * math.cos(math.radians(first["latitude_deg"]))
        north = math.radians(now["latitude_deg"] - first["latitude_deg"])
        place = (EARTH_M * east, EARTH_M * north, now["altitude_m"] - first["altitude_m"])
        yaw, pitch, roll = (math.radians(now[f"{name}_deg"]) for name in ("yaw", "pitch", "roll"))
        level, above = direction(yaw + math.pi / 2, 0), direction(yaw, pitch + math.pi / 2)
        right = tuple(math.cos(roll) * a - math.sin(roll) * b for a, b in zip(level, above, strict=True))
        up = tuple(math.sin(roll) * a + math.cos(roll) * b for a, b in zip(level, above, strict=True))
        return place, (right, up, direction(yaw, pitch))


def solve(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Of three equations, by Gauss's elimination."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for i in range(3):
        pivot = max(range(i, 3), key=lambda j: abs(rows[j][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for j in set(range(3)) - {i}:
            factor = rows[j][i] / rows[i][i]
            rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i], strict=True)]
    return [rows[i][3] / rows[i][i] for i in range(3)]


def fit(lines: list[tuple], camera: Camera, offset_s: float) -> tuple[float, list[float]]:
    """The sum of squares of the residuals in standard deviations, and the point."""
    matrix, right, seen = [[0.0] * 3 for _ in range(3)], [0.0] * 3, []
    for time_s, in_camera, sigma_rad, range_m, sigma_m in lines:
        place, axes = camera.at(time_s + offset_s)
        line = tuple(sum(in_camera[k] * axes[k][i] for k in range(3)) for i in range(3))
        across, along = (sigma_rad * range_m) ** -2, sigma_m**-2
        seen.append((place, line, across, along, range_m))
        for i in range(3):
            weights = [across * ((i == j) - line[i] * line[j]) + along * line[i] * line[j] for j in range(3)]
            right[i] += dot(tuple(weights), place) + along * line[i] * range_m
            matrix[i] = [a + b for a, b in zip(matrix[i], weights, strict=True)]
    point = solve(matrix, right)
    cost = 0.0
    for place, line, across, along, range_m in seen:
        to_point = tuple(a - b for a, b in zip(point, place, strict=True))
        far = dot(line, to_point)
        cost += across * (dot(to_point, to_point) - far * far) + along * (far - range_m) ** 2
    return cost, point


def tracks(index: Path, camera: Camera) -> dict[int, list[tuple]]:
    lines = defaultdict(list)
    with sqlite3.connect(f"file:{index}?mode=ro", uri=True) as database:
        for track, time_s, azimuth, elevation, sigma_rad, range_m, sigma_m in database.execute(SIGHTINGS):
            if camera.begin_s + STEP_S <= time_s <= camera.end_s - STEP_S:
                in_camera = tuple(dot(axis, direction(azimuth, elevation)) for axis in camera.at(time_s)[1])
                sigma_rad = max(sigma_rad or 0, MIN_SIGMA_RAD)
                lines[track].append((time_s, in_camera, sigma_rad, range_m, sigma_m or 0.01 * range_m))
    return {track: of_track for track, of_track in lines.items() if len(of_track) >= MIN_LINES}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("index", type=Path)
    parser.add_argument("telemetry", type=Path)
    arguments = parser.parse_args()
    camera = Camera(arguments.telemetry)
    curvature = 0.0
    for track, lines in tracks(arguments.index, camera).items():
        (early, _), (exact, place), (late, moved) = (fit(lines, camera, s) for s in (-STEP_S, 0, STEP_S))
        curvature += (early - 2 * exact + late) / STEP_S**2 / CORRELATED
        print(f"track {track}: {len(lines)} lines, {exact / len(lines):.2f}, {late / len(lines):.2f}, "
              f"moved by {math.dist(place, moved):.2f} m")  # fmt: skip
    sigma_s = math.sqrt(2 / curvature) if curvature > 0 else math.inf
    print(f"standard error of the offset: {sigma_s:.3g} s")


if __name__ == "__main__":
    main()
