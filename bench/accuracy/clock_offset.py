#!/usr/bin/env python3
"""Measures the clock offset that `victorious telemetry --estimate-offset` finds in simulated flights.

Usage: clock_offset.py [SCENE...] [--none SCENE...] [--shifts 0.4 -0.25 0.037] [--noise-deg 0.1]
                       [--program build/victorious] [--flights build/flights] [--json]

SCENE: scenes/NAME.json (default: swerve_noise, shaken); flights that this build of the program made before are taken
from the folder --flights. The times of the exact telemetry are shifted, and the right estimate is the shift with the
opposite sign; once with exact angles, and once with normal errors in the angles of each row. The flights --none
(default: straight) change their motion too little for an estimate. Prints for each the error and its sigma, s.
"""

import argparse
import csv
import json
import random
import sys
import tempfile
from pathlib import Path

from movies import Program, flight
from noisy_telemetry import spoil


def shift(telemetry: Path, shifted: Path, by_s: float) -> None:
    with telemetry.open(newline="") as file:
        rows = list(csv.DictReader(file))
    with shifted.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(row | {"time_s": float(row["time_s"]) + by_s} for row in rows)


def summary(estimates: list[dict]) -> dict:
    found = [one for one in estimates if one["error_s"] is not None]
    largest = {key: max((abs(one[key]) for one in found), default=None) for key in ("error_s", "sigma_s")}
    return {"cases": len(estimates), "estimates": len(found), "of": estimates} | largest


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    parser.add_argument("--none", nargs="*", type=Path, default=[Path("scenes/straight.json")], metavar="SCENE")
    parser.add_argument("--shifts", nargs="+", type=float, default=[0.4, -0.25, 0.037], metavar="S")
    parser.add_argument("--noise-deg", type=float, default=0.1)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--flights", type=Path, default=Path("build/flights"))
    parser.add_argument("--json", action="store_true", help="print an object: exact, noisy and none")
    arguments = parser.parse_args()
    program, draws = Program(arguments.program), random.Random(1)
    scenes = arguments.scenes or [Path(f"scenes/{name}.json") for name in ("swerve_noise", "shaken")]
    shown = sys.stderr if arguments.json else sys.stdout

    def estimates(group: str, scenes: list[Path], noise_deg: float) -> dict:
        results = []
        for scene in scenes:
            folder = flight(program, scene, arguments.flights)
            for by_s in arguments.shifts:
                with tempfile.TemporaryDirectory() as scratch:
                    noisy, shifted = Path(scratch) / "noisy.csv", Path(scratch) / "shifted.csv"
                    spoil(folder / "telemetry.csv", noisy, [0.0] * 6, draws, 0, noise_deg, tell=False)
                    shift(noisy if noise_deg else folder / "telemetry.csv", shifted, by_s)
                    said = json.loads(program("telemetry", shifted, "--video", folder / "video.mp4", "--estimate-offset", "--json"))
                offset_s = said["time_offset_s"]
                error_s = None if offset_s is None else offset_s + by_s
                results.append({"scene": scene.stem, "shift_s": by_s, "error_s": error_s, "sigma_s": said["sigma_s"]})
                text = said["status"] if error_s is None else f"error {error_s:+.4f} s, sigma {said['sigma_s']:.4f} s"
                print(f"{group:<6} {scene.stem:<14} {by_s:+.3f} s: {text}", file=shown, flush=True)
        return summary(results)

    groups = {"exact": estimates("exact", scenes, 0), "noisy": estimates("noisy", scenes, arguments.noise_deg),
              "none": estimates("none", arguments.none, 0)}  # fmt: skip
    if arguments.json:
        print(json.dumps(groups))


if __name__ == "__main__":
    main()
