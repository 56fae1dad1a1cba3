#!/usr/bin/env python3
"""Measures an imported detector on aerial pictures with a box for every vehicle ($VICTORIOUS_DATA/real/aerial).

Usage: detectors.py NETWORK --classes FILE [--weights FILE] [--category car] [--split test] [--program build/victorious]
                    [--data DIR] [--score 0.01] [--tile-px N] [--no-tiles]

Imports the network, indexes each picture, and compares the sightings of one category with the boxes of all vehicles.
A sighting and a box whose centre lies in a rectangle of ignore.csv do not count. Prints, for each view and for both:

  pictures, boxes   of the split
  AP50              area under precision over recall, sightings of all pictures ranked by score, IoU 0.5 or more
  recall, precision at the network's own minimum score
  time              processor time of the whole index a picture, s

Exits with 77 if there is no such data.
"""

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

SKIPPED = 77
MIN_IOU = 0.5


def iou(a: list[float], b: list[float]) -> float:
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    common = max(0.0, width) * max(0.0, height)
    return common / (a[2] * a[3] + b[2] * b[3] - common)


def read_boxes(path: Path) -> dict[str, list[list[float]]]:
    boxes = defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            boxes[row["image"]].append([float(row[key]) for key in ("x", "y", "w", "h")])
    return boxes


def is_ignored(box: list[float], ignored: list[list[float]]) -> bool:
    x, y = box[0] + box[2] / 2, box[1] + box[3] / 2
    return any(left <= x < left + width and top <= y < top + height for left, top, width, height in ignored)


def average_precision(ranked: list[bool], boxes: int) -> float:
    """Area under the precision envelope. @param ranked  hits and false alarms, best first"""
    precisions, hits = [], 0
    for rank, hit in enumerate(ranked, start=1):
        hits += hit
        if hit:
            precisions.append(hits / rank)
    area, best = 0.0, 0.0
    for precision in reversed(precisions):
        best = max(best, precision)
        area += best
    return area / boxes if boxes else 0.0


def judge(found: list[dict], boxes: list[list[float]]) -> list[tuple[float, bool]]:
    """Score and hit of each sighting of a picture; a box is found once."""
    free = list(boxes)
    judged = []
    for one in sorted(found, key=lambda sighting: -sighting["score"]):
        best = max(free, key=lambda box: iou(box, one["box"]), default=None)
        hit = best is not None and iou(best, one["box"]) >= MIN_IOU
        if hit:
            free.remove(best)
        judged.append((one["score"], hit))
    return judged


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network", type=Path)
    parser.add_argument("--classes", type=Path, required=True)
    parser.add_argument("--weights", type=Path)
    parser.add_argument("--category", default="car")
    parser.add_argument("--split", default="test")
    parser.add_argument("--program", type=Path, default=Path("build/victorious"))
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("VICTORIOUS_DATA", "../shared/data")))
    parser.add_argument("--score", type=float, default=0.01, help="minimum score of the ranked sightings")
    parser.add_argument("--tile-px", type=int, default=0)
    parser.add_argument("--no-tiles", action="store_true")
    arguments = parser.parse_args()
    aerial = (arguments.data / "real" / "aerial").resolve()
    if not aerial.is_dir():
        print(f"SKIPPED: no outside data at {aerial}")
        return SKIPPED
    with open(aerial / "split.csv", newline="") as file:
        view_of = {row["image"]: row["view"] for row in csv.DictReader(file) if row["split"] == arguments.split}
    boxes, ignored = read_boxes(aerial / "boxes.csv"), read_boxes(aerial / "ignore.csv")
    with tempfile.TemporaryDirectory() as scratch:
        run = lambda *words: subprocess.run(  # noqa: E731
            [arguments.program, *map(str, words)], check=True, capture_output=True, text=True
        ).stdout
        detector, db, params = Path(scratch) / "net.vcat", Path(scratch) / "index.db", Path(scratch) / "params.json"
        weights = ["--weights", arguments.weights] if arguments.weights else []
        made = json.loads(
            run("category", "import", arguments.network, "--classes", arguments.classes, "--out", detector, "--json", *weights)
        )
        own_score = made["settings"]["min_score"]
        params.write_text(
            json.dumps(
                {
                    "detector": {
                        "min_score": arguments.score,
                        "tile_px": arguments.tile_px,
                        "tiles": not arguments.no_tiles,
                    },
                    "keep": {"interval_s": -1},
                }
            )
        )
        pictures = [aerial / name for name in view_of]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run("index", *pictures, "--categories", detector, "--db", db, "--params", params)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        found = defaultdict(list)
        for line in run("export", "--db", db, "--format", "sightings", "--rejected").splitlines():
            one = json.loads(line)
            if one["category"] == arguments.category:
                found[os.path.relpath(one["video"], aerial)].append(one)
    print(f"{arguments.network.name}, {arguments.category}, split {arguments.split}: {seconds / len(pictures):.2f} s a picture")
    for view in ("nadir", "oblique", "both"):
        judged, count, images = [], 0, 0
        for name, own_view in view_of.items():
            if view not in (own_view, "both"):
                continue
            truth = [box for box in boxes[name] if not is_ignored(box, ignored[name])]
            sightings = [one for one in found[name] if not is_ignored(one["box"], ignored[name])]
            judged += judge(sightings, truth)
            count += len(truth)
            images += 1
        judged.sort(key=lambda one: -one[0])
        strong = [hit for score, hit in judged if score >= own_score]
        recall = sum(strong) / count if count else 0
        precision = sum(strong) / len(strong) if strong else 0
        print(
            f"{view:8} {images:3} pictures {count:4} boxes  AP50 {average_precision([hit for _, hit in judged], count):.3f}"
            f"  at score {own_score:g}: recall {recall:.2f} precision {precision:.2f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
