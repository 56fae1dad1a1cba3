#!/usr/bin/env python3
"""Compares the recall predicted by `model show --findable` with the recall in simulated flights.

Usage: findable.py [--program build/victorious] [--models assets/models] [--scene scenes/circle_noise.json]
                   [--names jeep,tank,jet] [--frames 24] [--far 1,1.8,2.7] [--noise 0,0.07]
                   [--directions 24] [--work build/findable] [--json]

The scene is simulated with FRAMES frames, for each distance factor of FAR and each noise level, into a folder of WORK
unless that folder exists, and indexed with its telemetry. Prints one row per flight and model: the median size of the
clear rows (the longer side of their box), the measured recall, and the recall predicted for that size, that noise and
the scene's sun. Then the mean absolute error, and the mean of prediction minus measurement. With --json an object
instead: by model, a list of its rows: noise, far, size_px, rows, found, foretold.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path

from movies import Movie, Program, pair

REPOSITORY = Path(__file__).resolve().parents[2]
VISIBLE = 0.5
MIN_ROWS = 8


def flight(program: Program, scene: dict, work: Path, far: float, noise: float, frames: int) -> Path:
    folder = work / f"far{far:g}_noise{noise:g}"
    if (folder / "video.mp4").exists():  # written last
        return folder
    changed = json.loads(json.dumps(scene))
    changed["video"] |= {"frames": frames, "fps": 2, "noise": noise}
    changed["camera"]["range_m"] = changed["camera"]["range_m"] * far
    file = work / f"{folder.name}.json"
    file.write_text(json.dumps(changed))
    print(f"simulating {file}", file=sys.stderr, flush=True)
    program("simulate", file, "--out", folder)
    return folder


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=REPOSITORY / "build/victorious")
    parser.add_argument("--models", type=Path, default=REPOSITORY / "assets/models")
    parser.add_argument("--scene", type=Path, default=REPOSITORY / "scenes/circle_noise.json")
    parser.add_argument("--names", default="jeep,tank,jet")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--far", default="1,1.8,2.7")
    parser.add_argument("--noise", default="0,0.07")
    parser.add_argument("--directions", type=int, default=24)
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/findable")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    program, work, names = Program(str(arguments.program)), arguments.work, arguments.names.split(",")
    scene = json.loads(arguments.scene.read_text())
    scene["assets"] = str((arguments.scene.parent / scene.get("assets", "../assets")).resolve())
    library = work / "models"
    library.mkdir(parents=True, exist_ok=True)
    for name in names:
        if not (library / f"{name}.vmodel").exists():
            program("model", "add", name, arguments.models / f"{name}.glb", "--models", library)

    errors = []
    report: dict[str, list[dict]] = {name: [] for name in names}
    shown_on = sys.stderr if arguments.json else sys.stdout
    print(f"{'model':<12}{'noise':>6}{'size':>7}{'rows':>6}{'found':>8}{'foretold':>10}", file=shown_on)
    for noise in map(float, arguments.noise.split(",")):
        for far in map(float, arguments.far.split(",")):
            folder = flight(program, scene, work, far, noise, arguments.frames)
            movie, db = Movie(folder, set(names)), work / f"{folder.name}.db"
            db.unlink(missing_ok=True)
            program("index", movie.video, "--models", library, "--db", db, "--telemetry", movie.telemetry)
            exported = program("export", "--db", db, "--format", "sightings")
            seen = {
                (row["object"], row["frame"])
                for _, row in pair(movie, [json.loads(line) for line in exported.splitlines()])
                if row
            }
            for name in names:
                rows = [
                    r for rows in movie.rows_of.values() for r in rows if r["model"] == name and r["visible"] >= VISIBLE
                ]
                if len(rows) < MIN_ROWS:
                    continue
                size = round(statistics.median(max(row["box"][2:]) for row in rows))
                found = sum((row["object"], row["frame"]) in seen for row in rows) / len(rows)
                shown = program("model", "show", name, "--models", library, "--json", "--findable", "--size-px", size,
                                "--noise", noise, "--directions", arguments.directions, "--sun", scene["sun"]["elevation_deg"])  # fmt: skip
                foretold = json.loads(shown)["findable"]["found"]
                errors.append(foretold - found)
                report[name].append({"noise": noise, "far": far, "size_px": size, "rows": len(rows), "found": found,
                                     "foretold": foretold})  # fmt: skip
                print(f"{name:<12}{noise:>6g}{size:>7}{len(rows):>6}{found:>8.2f}{foretold:>10.2f}", file=shown_on, flush=True)
    print(f"mean error {statistics.mean(map(abs, errors)):.2f}, foretold less found {statistics.mean(errors):+.2f}", file=shown_on)
    if arguments.json:
        print(json.dumps(report))


if __name__ == "__main__":
    main()
