#!/usr/bin/env python3
"""Runs experiments that compare the program with data, and prints the figures of their tables that results.md shows.

Usage: experiment_figures.py NAME... --out DIR [--data DIR] [--frames N] [--program build/victorious]

NAME is an experiment of `victorious experiment list`, one of those below; DIR gets its report. --data is the folder of
external data, --frames shortens simulated flights. Prints a JSON object:

  chapter3.filters      our setting, flights on which no threshold was learnt, all ratios together: by `table` (3.1) and
                        `learnt`: kept_percent of the true matches, false_percent of the matches left, reduction factor
                        of the false ones
  figure3.18            by object, `plain` or `painted`: found, frames, elsewhere (found at a wrong place)
  figure-calibration    calibration errors of all movies: reported, detections; held_out: the largest of a movie
  figure5.2             settings, of them recall_1 and precision_1
  figure5.3             quartiles of the density of all movies and settings: density25, density50, density75
  table-brighton        with the ground given: least and largest distance of a single photo's place, of their CE90;
                        of all methods: comparisons, inside
  table-cheyenne        by `ml` with all lines: errors_m and turns_deg of the stares, those that turn most first; inside
  table-control-points  with the surveyed height: `beach` and `river` by `ml` with all images, `raw` and `stated`: one
                        image, raw telemetry with the default sigma and with 3 degrees
  table-object-pose     of all movies, by what is known of the camera: view50_deg, view90_deg, distance50_percent,
                        distance90_percent, sightings
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path

from movies import Program

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "tools"))
from chapter_page import match_counts  # noqa: E402

Rows = list[dict]


def the(rows: Rows, **wanted: object) -> dict:
    """The only row with these values; _ stands for a blank in names of columns."""
    found = [row for row in rows if all(row[name.replace("_", " ")] == value for name, value in wanted.items())]
    if len(found) != 1:
        sys.exit(f"{len(found)} rows with {wanted}: expected one")
    return found[0]


def filters(rows: Rows) -> dict:
    def together(name: str) -> dict:
        mine = [row for row in rows if row["setting"] == "ours" and row["trials"].startswith("unseen") and row["filter"] == name]
        return dict(zip(("kept_percent", "false_percent", "reduction"), match_counts(mine), strict=True))

    return {"table": together("cascade, table 3.1"), "learnt": together("cascade, learnt, all measures in each stage")}


def real_objects(rows: Rows) -> dict:
    figures: dict[str, dict] = {}
    for row in rows:
        figures.setdefault(row["object"].replace(" ", "_"), {})[row["paint"]] = {
            "found": round(row["found"] * row["frames"]), "frames": round(row["frames"]), "share": row["found"],
            "elsewhere": row["elsewhere"]}  # fmt: skip
    return figures


def calibration(rows: Rows) -> dict:
    every = the(rows, movie="all")
    held_out = [row["cross-validated calibration error"] for row in rows if row["movie"] != "all"]
    return {"reported": every["calibration error of reported"], "detections": every["calibration error"],
            "held_out": max((error for error in held_out if error != "-"), default=None)}  # fmt: skip


def settings(rows: Rows) -> dict:
    return {"settings": len(rows)} | {f"{key}_1": sum(row[key] == 1 for row in rows) for key in ("recall", "precision")}


def density(rows: Rows) -> dict:
    every = the(rows, objects_of="all movies and settings")
    return {f"density{percent}": every[f"in view, {percent} %"] for percent in (25, 50, 75)}


def brighton(rows: Rows) -> dict:
    given = [row for row in rows if row["ground"] == "given"]
    distances = [row["photos alone: max distance from joint place, m"] for row in given]
    ce90 = [row["their CE90, min m"] for row in given]
    inside, comparisons = zip(*(map(int, row["within their CE90"].split(" of ")) for row in rows), strict=True)
    return {"least_m": min(distances), "largest_m": max(distances), "least_ce90_m": min(ce90), "largest_ce90_m": max(ce90),
            "inside": sum(inside), "comparisons": sum(comparisons)}  # fmt: skip


def cheyenne(rows: Rows) -> dict:
    of_stare: dict[str, dict] = {}  # of those by `ml`, that with most lines
    for row in rows:
        if row["method"] == "ml" and row["lines"] > of_stare.get(row["packets"], {"lines": 0})["lines"]:
            of_stare[row["packets"]] = row
    stares = sorted(of_stare.values(), key=lambda row: -row["turn, deg"])
    return {"errors_m": [row["in space, m"] for row in stares], "turns_deg": [row["turn, deg"] for row in stares],
            "inside": sum(row["in the 90 % ellipsoid"] == "yes" for row in stares), "stares": len(stares)}  # fmt: skip


def control_points(rows: Rows) -> dict:
    def place(site: str, method: str) -> dict:
        mine = [row for row in rows if row["site and cameras"] == site and row["method"] == method and row["ground"] == "surveyed height"]
        row = max(mine, key=lambda row: row["images"])
        return {"median_m": row["error along the ground, median m"], "largest_m": row["max m"], "ce90_m": row["CE90, median m"],
                "inside": round(row["in the 90 % ellipsoid"]), "points": round(row["points located"])}  # fmt: skip

    return {"beach": place("beach, solved poses", "ml"), "river": place("river, pose from the other crosses", "ml"),
            "raw": place("beach, telemetry", "ground"), "stated": place("beach, telemetry, stated 3 deg", "ground")}  # fmt: skip


def object_pose(rows: Rows) -> dict:
    columns = {"view50_deg": "view error 50 %, deg", "view90_deg": "90 %", "distance50_percent": "distance error 50 %, %",
               "distance90_percent": "90 %, %", "sightings": "sightings"}  # fmt: skip
    return {row["camera data"].replace(" ", "_"): {key: row[column] for key, column in columns.items()}
            for row in rows if row["movie"] == "all"}  # fmt: skip


FIGURES: dict[str, Callable[[Rows], dict]] = {
    "chapter3.filters": filters, "figure3.18": real_objects, "figure-calibration": calibration, "figure5.2": settings,
    "figure5.3": density, "table-brighton": brighton, "table-cheyenne": cheyenne, "table-control-points": control_points,
    "table-object-pose": object_pose,
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", choices=sorted(FIGURES), metavar="NAME")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--frames", type=int)
    parser.add_argument("--program", default="build/victorious")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    figures: dict = {}
    for name in arguments.names:
        given = {"--data": arguments.data, "--frames": arguments.frames}
        options = [word for option, value in given.items() if value is not None for word in (option, value)]
        program("experiment", name, "--out", arguments.out, *options)
        figures |= FIGURES[name](json.loads((arguments.out / f"{name}.json").read_text())["rows"])
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
