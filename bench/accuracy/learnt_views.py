#!/usr/bin/env python3
"""Measures what one photo of an object finds while a camera circles around it, and what that teaches for another flight.

Usage: learnt_views.py [--flights 1] [--first 1] [--program build/victorious] [--keep DIR] [--json]

In each flight the camera goes once around ten vehicles that stand in a drawn town, two pairs of them twins. Each vehicle has
one photo, taken from one side in other light and another town. A second flight passes the same vehicles at another place from
the opposite side. Draws follow from the number of the flight. Prints a row per flight, and all:

  off, on    recall of sightings of the first flight, without and with `grow.enabled` (the default)
  wrong      sightings of the first flight that show no object of the model, without and with it
  found      vehicles found in the first flight, and objects that are none; identities a vehicle
  photo      vehicles found in the second flight with the photos
  learnt     the same, with what `model grow` has learnt from the first
  processor  time of `index` with growth over that without

With --json an object instead: the sums of all flights, the two recalls, and `cost`, the ratio of processor times.
"""

import argparse
import json
import random
import sys
import tempfile
from pathlib import Path

from movies import Movie, Program, flight, found, is_clear, lines, pair
from movies_by_default import used_by

REPOSITORY = Path(__file__).resolve().parents[2]
SINGLES = ("fire_engine", "helicopter", "pickup", "police_car", "tank", "ambulance", "bus", "excavator")
TWINS = ("jeep", "tanker")
CENTRE_M = [48, 48]
COLUMNS, SPACING_M = 4, (14, 15)
SUMS = ("findable", "found", "false_objects", "identities", "clear", "off", "on", "wrong_off", "wrong_on", "photo", "learnt", "other",
        "processor_off", "processor_on")  # fmt: skip
GROWTH_OFF = {"grow": {"enabled": False}}


def scene_of(lot: random.Random, vehicles: list[dict], camera: dict, frames: int, tile: str) -> dict:
    """The vehicles on squares of this kind, in a town that is drawn anew."""
    return {
        "assets": str(REPOSITORY / "assets"), "seed": lot.randrange(1000),
        "video": {"frames": frames, "fps": 4, "width": 960, "height": 720, "hfov_deg": 26, "grain": 1.5},
        "origin": {"latitude_deg": 47.4, "longitude_deg": 8.55, "altitude_m": 430, "heading_deg": lot.uniform(0, 360)},
        "sun": {"azimuth_deg": lot.uniform(0, 360), "elevation_deg": lot.uniform(30, 60), "strength": 0.5, "sky": 0.5, "ground": 0.3},
        "camera": {"path": "linear", "aim_m": [CENTRE_M, CENTRE_M], "range_m": 130, "roll_deg": 0} | camera,
        "objects": vehicles,
        "town": {"seed": lot.randrange(1000), "density": 0.6, "columns_per_street": 100, "rows_per_street": 100,
                 "tiles": [{"tile": tile, "column": column, "row": row} for column in range(1, 4) for row in range(1, 4)]},
    }  # fmt: skip


def vehicles_of(lot: random.Random) -> list[dict]:
    names = [*lot.sample(SINGLES, 6), *TWINS, *TWINS]
    lot.shuffle(names)
    vehicles = []
    for i, name in enumerate(names):
        row, column = divmod(i, COLUMNS)
        number = 1 + sum(one["model"] == name for one in vehicles)
        vehicles.append({"id": f"{name}-{number}", "model": name, "x_m": CENTRE_M[0] + SPACING_M[0] * (column - 1.5) + lot.uniform(-1, 1),
                         "y_m": CENTRE_M[1] + SPACING_M[1] * (row - 1) + lot.uniform(-1, 1), "heading_deg": lot.uniform(0, 360)})  # fmt: skip
    return vehicles


def write(path: Path, content: dict) -> Path:
    path.write_text(json.dumps(content))
    return path


def add_photos(program: Program, movie: Movie, models: Path) -> None:
    """A model of the first vehicle of each kind, from the first frame."""
    image = models.parent / "photo.png"
    program("frame", movie.video, "--number", 0, "--out", image)
    for name in movie.models():
        row = movie.rows_of[f"{name}-1"][0]
        if row["frame"] != 0:
            sys.exit(f"{movie.folder}: {name}-1 is not in the first frame")
        program("model", "add", name, image, "--box", ",".join(map(str, row["box"])), "--models", models)


def index(program: Program, movie: Movie, models: Path, db: Path, params: Path | None = None) -> float:
    command = [program.path, "index", movie.video, "--telemetry", movie.telemetry, "--models", models, "--db", db]
    return used_by(list(map(str, [*command, *(["--params", params] if params else [])])))[0]


def count_found(program: Program, movie: Movie, db: Path) -> int:
    return len(set(found(program, db, {str(movie.video): movie})) & set(movie.findable()))


def measure(program: Program, number: int, folder: Path) -> dict:
    lot = random.Random(number)
    vehicles = vehicles_of(lot)
    side_deg = lot.uniform(0, 360)
    off_nadir_deg = lot.uniform(35, 45)

    def fly(name: str, from_deg: list[float], frames: int, tile: str) -> Movie:
        scene = scene_of(lot, vehicles, {"from_deg": from_deg, "off_nadir_deg": off_nadir_deg}, frames, tile)
        return Movie(flight(program, write(folder / f"{name}.json", scene), folder))

    photos = fly("photos", [side_deg, side_deg + 1], 2, "yard")
    orbit = fly("orbit", [side_deg - 20, side_deg + 340], 240, "apron")
    opposite = fly("opposite", [side_deg + 165, side_deg + 195], 40, "parking")
    models = folder / "models"
    add_photos(program, photos, models)
    off = write(folder / "off.json", GROWTH_OFF)
    one: dict = {"clear": sum(orbit.findable().values())}
    for name, params in (("off", off), ("on", None)):
        db = folder / f"orbit_{name}.db"
        one[f"processor_{name}"] = index(program, orbit, models, db, params)
        shows = [row for _, row in pair(orbit, lines(program("export", "--db", db, "--format", "sightings")))]
        one |= {name: sum(row is not None and is_clear(row) for row in shows), f"wrong_{name}": shows.count(None)}
    grown = folder / "orbit_on.db"
    score = json.loads(program("evaluate", "--db", grown, "--truth", orbit.truth, "--json"))
    of_truth = found(program, grown, {str(orbit.video): orbit})
    one |= {"findable": score["findable"], "found": score["found"], "false_objects": score["false_objects"],
            "identities": sum(map(len, of_truth.values()))}  # fmt: skip
    photo = folder / "photo.db"
    index(program, opposite, models, photo)
    best = {}
    for row in lines(program("export", "--db", grown, "--format", "objects")):
        best.setdefault(row["model"], row["object_id"])
    for name, object_id in best.items():
        program("model", "grow", name, "--db", grown, "--object", object_id, "--models", models)
    learnt = folder / "learnt.db"
    index(program, opposite, models, learnt)
    return one | {"other": len(opposite.findable()), "photo": count_found(program, opposite, photo),
                  "learnt": count_found(program, opposite, learnt)}  # fmt: skip


def line_of(name: str, one: dict) -> str:
    return (f"{name:<6} {one['off'] / one['clear']:6.3f} {one['on'] / one['clear']:6.3f} {one['wrong_off']:5} {one['wrong_on']:5}"
            f"  {one['found']:3} of {one['findable']:3} {one['false_objects']:4} {one['identities'] / max(1, one['found']):6.2f}"
            f"  {one['photo']:3} {one['learnt']:4} of {one['other']:3} {one['processor_on'] / one['processor_off']:6.2f}")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flights", type=int, default=1)
    parser.add_argument("--first", type=int, default=1, help="number of the first flight")
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--keep", type=Path, help="keeps videos, models and indexes here (a new folder)")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    shown = sys.stderr if arguments.json else sys.stdout
    print("flight    off     on  wrong          found false  ids     photo learnt     processor", file=shown)
    total = dict.fromkeys(SUMS, 0)
    with tempfile.TemporaryDirectory() as scratch:
        for number in range(arguments.first, arguments.first + arguments.flights):
            folder = (arguments.keep or Path(scratch)) / f"flight_{number}"
            folder.mkdir(parents=True)
            one = measure(program, number, folder)
            print(line_of(str(number), one), file=shown, flush=True)
            total = {key: total[key] + one[key] for key in SUMS}
    print(line_of("all", total), file=shown)
    if arguments.json:
        print(json.dumps(total | {"recall_off": total["off"] / total["clear"], "recall_on": total["on"] / total["clear"],
                                  "cost": total["processor_on"] / total["processor_off"]}))  # fmt: skip


if __name__ == "__main__":
    main()
