#!/usr/bin/env python3
"""Measures in how many frames of a real orbit one photo of a shed finds it, with and without growth.

Usage: photo_orbit.py [--data ../shared/data] [--program build/victorious] [--json]

The photo is a box in one frame of the video (`real/orbit/README.md` of the data): frame 60, or frame 200. A sighting is
right if its box holds the middle of the true box and overlaps it by 0.3 (IoU). Prints, for each photo, the frames that are
right and wrong sightings, without growth, with it (the default), and without it but with the views that `model grow` has
learnt from the index with it; and the objects of the index with growth. With --json an object: `frame_60`, `frame_200`,
each with these numbers, and `frames`.
"""

import argparse
import csv
import json
import sys
import tempfile
from pathlib import Path

from movies import Program, lines, overlap

PHOTOS = {60: "158,95,90,45", 200: "150,85,95,75"}
MIN_OVERLAP = 0.3


def read_truth(file: Path) -> dict[int, list[float]]:
    with file.open() as rows:
        return {int(row["frame"]): [float(row[side]) for side in "xywh"] for row in csv.DictReader(rows)}


def is_right(box: list[float], true: list[float]) -> bool:
    x, y = true[0] + true[2] / 2, true[1] + true[3] / 2
    holds = box[0] <= x <= box[0] + box[2] and box[1] <= y <= box[1] + box[3]
    return holds and overlap(box, true) >= MIN_OVERLAP


def judge(program: Program, db: Path, truth: dict[int, list[float]]) -> dict:
    sightings = [one for one in lines(program("export", "--db", db, "--format", "sightings")) if one["frame"] in truth]
    right = [one for one in sightings if is_right(one["box"], truth[one["frame"]])]
    return {"right": len({one["frame"] for one in right}), "wrong": len(sightings) - len(right),
            "objects": len({one["object_id"] for one in sightings})}  # fmt: skip


def measure(program: Program, video: Path, truth: dict[int, list[float]], number: int, folder: Path) -> dict:
    folder.mkdir()
    image, models, off = folder / "photo.png", folder / "models", folder / "off.json"
    off.write_text(json.dumps({"grow": {"enabled": False}}))
    program("frame", video, "--number", number, "--out", image)
    program("model", "add", "shed", image, "--box", PHOTOS[number], "--models", models)
    results = {}
    for name, extra in (("off", ["--params", off]), ("on", [])):
        db = folder / f"{name}.db"
        program("index", video, "--models", models, "--db", db, *extra)
        results[name] = judge(program, db, truth)
    best = lines(program("export", "--db", folder / "on.db", "--format", "objects"))[0]
    program("model", "grow", "shed", "--db", folder / "on.db", "--object", best["object_id"], "--models", models)
    program("index", video, "--models", models, "--db", folder / "learnt.db", "--params", off)
    return results | {"learnt": judge(program, folder / "learnt.db", truth)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path("../shared/data"))
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    truth = read_truth(arguments.data / "real/orbit/shed_roof.csv")
    video = arguments.data / "real/fmv_klv/kwiver_aphill/aphill_240_1fps_crf32.mp4"
    results: dict = {"frames": len(truth)}
    with tempfile.TemporaryDirectory() as scratch:
        for number in PHOTOS:
            one = measure(program, video, truth, number, Path(scratch) / str(number))
            results[f"frame_{number}"] = one
            shown = ", ".join(f"{name} {of['right']} right {of['wrong']} wrong" for name, of in one.items())
            print(f"photo of frame {number}, of {len(truth)} frames: {shown}; {one['on']['objects']} objects",
                  file=sys.stderr if arguments.json else sys.stdout, flush=True)  # fmt: skip
    if arguments.json:
        print(json.dumps(results))


if __name__ == "__main__":
    main()
