#!/usr/bin/env python3
"""Measures the places that `victorious track` gives the objects in user boxes, in simulated flights.

Usage: box_places.py [SCENE...] [--program build/victorious] [--flights build/flights] [--json]

SCENE: scenes/NAME.json (default: four of them); flights that this build of the program made before are taken from the
folder --flights. Each object with at least ten clear frames is tracked from its true box in the middle one of them,
with exact telemetry: an object that stands without a type, an object that drives as the type that its model is. Prints
for each the error of its last place (m), its CE90, its speed and the true one (m/s), or why it has no place.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from driving import MIN_SPEED_M_S, true_motion
from movies import MIN_ROWS, Movie, Program, flight, horizontal_m, is_clear, lines

SCENES = ("demo", "straight", "circle", "swerve_noise")
TYPES = {"jeep": "car", "tank": "tank", "helicopter": "helicopter", "jet": "airplane"}


def measure(program: Program, movie: Movie, name: str, scratch: Path) -> dict | None:
    """Of one object; None if it is seen in too few frames."""
    rows = sorted(movie.rows_of[name], key=lambda row: row["frame"])
    clear = [row for row in rows if is_clear(row)]
    if len(clear) < MIN_ROWS:
        return None
    start = clear[len(clear) // 2]
    true_speed = true_motion(rows, start["time_s"])[0]
    drives = true_speed > MIN_SPEED_M_S
    kind = ["--type", TYPES.get(start["model"], start["model"])] if drives else []
    said = program("track", movie.video, "--box", ",".join(map(str, start["box"])), "--at", start["time_s"], "--telemetry",
                   movie.telemetry, "--out", scratch / "box.jsonl", "--force", "--json", *kind)  # fmt: skip
    result = {"drives": drives, "frames": len(clear), "true_speed_m_s": true_speed, "no_place": json.loads(said)["no_place"]}
    placed = [one for one in lines((scratch / "box.jsonl").read_text()) if one["latitude_deg"] is not None]
    if not placed:
        return result | {"error_m": None, "ce90_m": None, "speed_m_s": None}
    last = max(placed, key=lambda one: one["frame"])
    error_m = horizontal_m(last, min(rows, key=lambda row: abs(row["time_s"] - last["time_s"])))
    return result | {"error_m": error_m, "ce90_m": last["ce90_m"], "speed_m_s": last["speed_m_s"]}


def summary(results: list[dict]) -> dict:
    placed = [one for one in results if one["error_m"] is not None]
    errors = [one["error_m"] for one in placed]
    inside = sum(one["error_m"] <= one["ce90_m"] for one in placed)
    return {
        "boxes": len(results), "located": len(placed), "unplaced": len(results) - len(placed), "errors_m": errors,
        "inside": inside, "outside": len(placed) - inside,
        "least_m": min(errors, default=None), "largest_m": max(errors, default=None),
    }  # fmt: skip


def line_of(name: str, one: dict) -> str:
    if one["error_m"] is None:
        return f"{name:<26} {one['frames']:4} frames  no place: {one['no_place']}"
    return (f"{name:<26} {one['frames']:4} frames {one['error_m']:7.2f} m  CE90 {one['ce90_m']:6.2f} m  "
            f"{one['speed_m_s'] or 0:4.1f} m/s (true {one['true_speed_m_s']:.1f})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--flights", type=Path, default=Path("build/flights"))
    parser.add_argument("--json", action="store_true", help="print an object: what the rows show, by scene and object")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    shown = sys.stderr if arguments.json else sys.stdout
    results: dict[str, dict[str, dict]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for scene in arguments.scenes or [Path("scenes") / f"{name}.json" for name in SCENES]:
            movie = Movie(flight(program, scene, arguments.flights))
            of_scene = results.setdefault(scene.stem, {})
            for name in sorted(movie.rows_of):
                if (one := measure(program, movie, name, Path(scratch))) is not None:
                    of_scene[name] = one
                    print(line_of(f"{scene.stem} {name}", one), file=shown, flush=True)
    every = [one for of_scene in results.values() for one in of_scene.values()]
    groups = {"standing": summary([one for one in every if not one["drives"]]),
              "driving": summary([one for one in every if one["drives"]])}  # fmt: skip
    for name, one in groups.items():
        print(f"{name}: {one['inside']} of {one['located']} within CE90; {one['unplaced']} without a place", file=shown)
    if arguments.json:
        print(json.dumps(results | groups))


if __name__ == "__main__":
    main()
