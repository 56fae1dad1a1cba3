#!/usr/bin/env python3
"""Compares the probability of detection of `export --format coverage` with what is found in simulated flights.

Usage: coverage.py --models DIR --cad DIR [--program build/victorious] [--flights 20] [--first 1] [--frames 20] [--fps 2.5]
                   [--objects 24] [--params FILE] [--work build/coverage] [--fit]

DIR of --models holds CAD models (*.vmodel), and --cad their files (NAME.glb). Flights are simulated: FLIGHTS of them
from number FIRST on, which seeds a town, its light, the height, angle, speed and field of view of the camera, noise and
blur, and OBJECTS of the models at random places along the way. Each is indexed for all models, and the coverage
exported. An object counts as found if the index lists one of its model whose sightings show it.

Prints a table: for each tenth of predicted probability the objects at places with it, and the fraction of them that was
found, with its 95 % interval (Wilson). Flights and indexes that exist in WORK are reused: delete them after a change.
--fit then prints the constants of the model of detection (place/geolocate/view_detection.h) under which these finds are most
likely, of a grid of them, with the logarithm of the likelihood.
"""

import argparse
import csv
import itertools
import json
import math
import random
import sys
from collections import Counter
from pathlib import Path

from movies import Movie, Program, found, lines

REPOSITORY = Path(__file__).resolve().parents[2]
EARTH_M = 6378137.0


def scene_of(number: int, frames: int, fps: float, objects: int, models: dict[str, float], cad: Path) -> dict:
    lot = random.Random(f"coverage {number}")
    names = sorted(models)
    hfov = lot.uniform(16, 26)
    range_m = math.exp(lot.uniform(math.log(80), math.log(420)))
    width_m = 2 * range_m * math.tan(math.radians(hfov / 2))
    start = [lot.uniform(-60, 60), lot.uniform(-50, 50)]
    away = lot.uniform(0, 2 * math.pi)
    length = lot.uniform(0.3, 2) * width_m
    placed = []
    for _ in range(40 * objects):
        if len(placed) == objects:
            break
        name = lot.choice(names)
        along, aside = lot.uniform(-0.6 * width_m, length + 0.6 * width_m), lot.uniform(-0.6, 0.6) * width_m
        x = start[0] + along * math.cos(away) - aside * math.sin(away)
        y = start[1] + along * math.sin(away) + aside * math.cos(away)
        if all(math.hypot(x - o["x_m"], y - o["y_m"]) > 0.65 * (models[name] + models[o["model"]]) for o in placed):
            placed.append({"id": f"{name}-{len(placed)}", "model": name, "file": str((cad / f"{name}.glb").resolve()),
                           "x_m": x, "y_m": y, "heading_deg": lot.uniform(0, 360)})  # fmt: skip
    heading = lot.uniform(0, 360)
    return {
        "assets": str(REPOSITORY / "assets"),
        "seed": number,
        "video": {
            "frames": frames, "fps": fps, "width": 640, "height": 480, "hfov_deg": hfov,
            "noise": lot.choice([0, 0, 0, 0.05]), "grain": lot.choice([0, 2, 4]), "blur_px": lot.choice([0, 0, 0.7]),
        },
        "origin": {"latitude_deg": 48.137, "longitude_deg": 11.575, "altitude_m": 565, "heading_deg": lot.uniform(0, 360)},
        "sun": {
            "azimuth_deg": lot.uniform(0, 360), "elevation_deg": lot.uniform(20, 65), "strength": lot.choice([0.5, 0.8, 1.2]),
            "sky": 0.5, "ground": 0.25,
        },
        "camera": {
            "path": "smooth",
            "aim_m": [start, [start[0] + length * math.cos(away), start[1] + length * math.sin(away)]],
            "from_deg": [heading, heading + lot.choice([0, 0, lot.uniform(-90, 90)])],
            "off_nadir_deg": lot.uniform(10, 60), "range_m": range_m, "roll_deg": lot.uniform(-5, 5),
        },
        "objects": placed,
        "town": {"seed": number, "density": lot.uniform(0.4, 0.9), "squares": [-6, -6, 6, 6]},
    }  # fmt: skip


def place_of(one: dict, scene: dict) -> tuple[float, float]:
    """Latitude and longitude, degrees, of an object of a scene."""
    origin = scene["origin"]
    turn = math.radians(origin["heading_deg"])
    east = one["x_m"] * math.cos(turn) + one["y_m"] * math.sin(turn)
    north = one["y_m"] * math.cos(turn) - one["x_m"] * math.sin(turn)
    latitude = math.radians(origin["latitude_deg"])
    sine2 = math.sin(latitude) ** 2
    normal = EARTH_M / math.sqrt(1 - 0.00669438 * sine2)
    meridian = EARTH_M * (1 - 0.00669438) / (1 - 0.00669438 * sine2) ** 1.5
    return (origin["latitude_deg"] + math.degrees(north / meridian),
            origin["longitude_deg"] + math.degrees(east / normal / math.cos(latitude)))  # fmt: skip


def diagonals_of(folder: Path) -> dict[str, float]:
    """Of the models, from the summary of the exported coverage."""
    summary = json.loads((folder / "coverage.geojson").read_text())["coverage"]
    return {one["model"]: one["diagonal_m"] for one in summary["models"]}


def views_of(folder: Path, scene: dict, place: tuple[float, float], diagonal_m: float) -> list[list[float]]:
    """Of each frame that shows a place of the ground: the unit vector to the camera (east, north, up), the object's
    diagonal in pixels, and the distance from the place to the edge of the frame in pixels."""
    video, ground_m = scene["video"], scene["origin"]["altitude_m"]
    focal = 0.5 * video["width"] / math.tan(math.radians(video["hfov_deg"] / 2))
    views = []
    for row in csv.DictReader((folder / "telemetry.csv").open()):
        state = {key: float(value) for key, value in row.items() if key != "vertical_datum"}
        north = math.radians(place[0] - state["latitude_deg"]) * 6366000
        east = math.radians(place[1] - state["longitude_deg"]) * 6388000 * math.cos(math.radians(place[0]))
        up = ground_m - state["altitude_m"]
        yaw, pitch, roll = (math.radians(state[f"{key}_deg"]) for key in ("yaw", "pitch", "roll"))
        ahead = [math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)]
        level = [math.cos(yaw), -math.sin(yaw), 0.0]
        down = [math.sin(yaw) * math.sin(pitch), math.cos(yaw) * math.sin(pitch), -math.cos(pitch)]
        right = [math.cos(roll) * a + math.sin(roll) * b for a, b in zip(level, down)]
        below = [math.cos(roll) * b - math.sin(roll) * a for a, b in zip(level, down)]
        x, y, z = (sum(a * b for a, b in zip(axis, (east, north, up))) for axis in (right, below, ahead))
        range_m = math.sqrt(east**2 + north**2 + up**2)
        if z <= 0:
            continue
        border_px = min(video["width"] / 2 - abs(x / z) * focal, video["height"] / 2 - abs(y / z) * focal)
        if border_px > 0:
            views.append([-east / range_m, -north / range_m, -up / range_m, diagonal_m * focal / range_m, border_px])
    return views


def flight(program: Program, number: int, work: Path, arguments: argparse.Namespace, sizes: dict[str, float]) -> Path:
    folder = work / f"flight{number}"
    if not (folder / "video.mp4").exists():  # written last
        file = work / f"flight{number}.json"
        scene = scene_of(number, arguments.frames, arguments.fps, arguments.objects, sizes, arguments.cad)
        file.write_text(json.dumps(scene))
        print(f"simulating {file}", file=sys.stderr, flush=True)
        program("simulate", file, "--out", folder)
    return folder


def index(program: Program, folder: Path, library: Path) -> Path:
    db = folder / "index.db"
    done = folder / "index.done"
    if not done.exists():
        for leftover in folder.glob("index.db*"):
            leftover.unlink()
        program("index", folder / "video.mp4", "--models", library, "--db", db, "--telemetry", folder / "telemetry.csv")
        done.touch()
    return db


def tenths(program: Program, folder: Path, library: Path, params: Path | None) -> list[dict]:
    """The features of kind `probability` of a flight's coverage."""
    file = folder / "coverage.geojson"
    program("export", "--db", folder / "index.db", "--format", "coverage", "--models", library, "--out", file, "--force",
            *(["--params", params] if params else []))  # fmt: skip
    return [one for one in json.loads(file.read_text())["features"] if one["properties"]["kind"] == "probability"]


def is_in(ring: list[list[float]], x: float, y: float) -> bool:
    inside = False
    for (x0, y0), (x1, y1) in zip(ring, ring[1:]):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            inside = not inside
    return inside


def tenth_at(features: list[dict], model: str, place: tuple[float, float]) -> int | None:
    """Of the predicted probability; None outside of the area."""
    y, x = place
    for one in features:
        if one["properties"]["model"] == model and any(
            is_in(polygon[0], x, y) and not any(is_in(hole, x, y) for hole in polygon[1:])
            for polygon in one["geometry"]["coordinates"]
        ):
            return round(10 * one["properties"]["min_probability"])
    return None


def wilson(count: int, of: int) -> tuple[float, float]:
    """The 95 % interval of a rate."""
    z2 = 1.96**2
    middle = (count + z2 / 2) / (of + z2)
    half = 1.96 / (of + z2) * math.sqrt(count * (of - count) / of + z2 / 4)
    return max(0.0, middle - half), min(1.0, middle + half)


def independent(views: list[list[float]], angle_deg: float = 15, ratio: float = 1.5) -> list[tuple[float, float]]:
    """Size and border of each independent view, px, as PlaceViews::Add of place/geolocate/view_detection.cc has them."""
    kept = []
    for x, y, z, size, border in views:
        for one in kept:
            cosine = one[0] * x + one[1] * y + one[2] * z
            if cosine > math.cos(math.radians(angle_deg)) and max(size / one[3], one[3] / size) < ratio:
                one[3], one[4] = max(one[3], size), max(one[4], border)
                break
        else:
            kept.append([x, y, z, size, border])
    return [(one[3], one[4]) for one in kept]


def log_likelihood(looks: list[tuple[list[tuple[float, float]], bool]], half: float, slope: float, ceiling: float, edge: float) -> float:
    total = 0.0
    for views, is_found in looks:
        missed = math.prod(1 - min(1, border / (edge * size)) / (1 + (half / size) ** slope) for size, border in views)
        probability = min(0.999, max(0.001, ceiling * (1 - missed)))
        total += math.log(probability if is_found else 1 - probability)
    return total


def fit(looks: list[tuple[list[tuple[float, float]], bool]]):
    grid = itertools.product(range(36, 62, 2), (3, 3.5, 4, 4.5, 5, 6), (0.86, 0.88, 0.9, 0.92, 0.94, 0.96), (0.1, 0.15, 0.2, 0.3))
    best = max(((log_likelihood(looks, *one), one) for one in grid))
    print(f"{len(looks)} objects in view: half_size_px {best[1][0]}, slope {best[1][1]}, ceiling {best[1][2]}, "
          f"border_fraction {best[1][3]}: log likelihood {best[0]:.1f}")  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--cad", type=Path, required=True)
    parser.add_argument("--program", default=REPOSITORY / "build/victorious")
    parser.add_argument("--flights", type=int, default=20)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--fps", type=float, default=2.5)
    parser.add_argument("--objects", type=int, default=24)
    parser.add_argument("--params", type=Path)
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/coverage")
    parser.add_argument("--fit", action="store_true")
    arguments = parser.parse_args()
    program, work = Program(str(arguments.program)), arguments.work
    work.mkdir(parents=True, exist_ok=True)
    sizes = {one["name"]: one["length_m"] for one in lines(program("model", "list", "--models", arguments.models, "--json"))}
    tried, hit = Counter(), Counter()
    looks = []
    for number in range(arguments.first, arguments.first + arguments.flights):
        folder = flight(program, number, work, arguments, sizes)
        index(program, folder, arguments.models)
        scene = json.loads((work / f"flight{number}.json").read_text())
        names = {name for name, objects in found(program, folder / "index.db", {"video.mp4": Movie(folder)}).items() if objects}
        features = tenths(program, folder, arguments.models, arguments.params)
        diagonals = diagonals_of(folder)
        for one in scene["objects"]:
            place = place_of(one, scene)
            views = independent(views_of(folder, scene, place, diagonals[one["model"]]))
            if views:
                looks.append((views, one["id"] in names))
            tenth = tenth_at(features, one["model"], place)
            if tenth is None:
                continue
            tried[tenth] += 1
            hit[tenth] += one["id"] in names
    print(f"{'predicted':<12}{'objects':>8}{'found':>7}{'95 %':>14}")
    for tenth in sorted(tried):
        low, high = wilson(hit[tenth], tried[tenth])
        print(f"{tenth / 10:.1f} to {tenth / 10 + 0.1:.1f}{tried[tenth]:>9}{hit[tenth] / tried[tenth]:>7.2f}   {low:.2f} to {high:.2f}")
    if arguments.fit:
        fit(looks)


if __name__ == "__main__":
    main()
