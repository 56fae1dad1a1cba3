#!/usr/bin/env python3
"""Measures an imported detector on aerial pictures with a box for every vehicle ($VICTORIOUS_DATA/real/aerial).

Usage: detectors.py NETWORK --classes FILE [--weights FILE] [--category car] [--split test] [--program build/victorious]
                    [--data DIR] [--score 0.01] [--tile-px N] [--no-tiles] [--copies N] [--json]

Imports the network, indexes each picture, and compares the sightings of one category with the boxes of all vehicles.
A sighting and a box whose centre lies in a rectangle of ignore.csv do not count. Prints, for each view and for both:

  pictures, boxes   of the split
  AP50              area under precision over recall, sightings of all pictures ranked by score, IoU 0.5 or more
  recall, precision at the network's own minimum score
  time              processor time of the whole index a picture, s; with --copies, also of a search of 1920 x 1080 px,
                    from the difference of `index` for N + 1 copies of one such picture and for one, with their decoding

Exits with 77 if there is no such data.
"""

import argparse
import csv
import json
import os
import resource
import shutil
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

from movies import Program, lines

SKIPPED = 77
MIN_IOU = 0.5
LARGE_PICTURE = "images/minsk_DJI_0005-0018.jpg"  # 1920 x 1080 px


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


def processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def time_of_search(index: Callable[[Path], object], aerial: Path, copies: int, scratch: Path) -> tuple[float, float]:
    """Processor time and wall time of one search of 1920 x 1080 px: what N copies of a picture take more than one."""
    spent = []
    for count in (1, 1 + copies):
        folder = scratch / f"copies{count}"
        folder.mkdir(exist_ok=True)
        for i in range(count):
            shutil.copyfile(aerial / LARGE_PICTURE, folder / f"{i:03}.jpg")
        before, start = processor_time(), time.monotonic()
        index(folder)
        spent.append((processor_time() - before, time.monotonic() - start))
    processor, wall = ((b - a) / copies for a, b in zip(*spent))
    return processor, wall


class Detector:
    """The imported network."""

    def __init__(self, arguments: argparse.Namespace, scratch: Path):
        self.program, self.scratch, self.arguments = Program(arguments.program), scratch, arguments
        weights = ["--weights", arguments.weights] if arguments.weights else []
        made = self.program("category", "import", arguments.network, "--classes", arguments.classes, "--out",
                            scratch / "net.vcat", "--json", *weights)  # fmt: skip
        self.own_score = json.loads(made)["settings"]["min_score"]

    def index(self, *videos: Path, **settings) -> Path:
        db, params = self.scratch / "index.db", self.scratch / "params.json"
        db.unlink(missing_ok=True)
        tiles = {"tile_px": self.arguments.tile_px, "tiles": not self.arguments.no_tiles}
        params.write_text(json.dumps({"detector": tiles | settings, "keep": {"interval_s": -1}}))
        self.program("index", *videos, "--categories", self.scratch / "net.vcat", "--db", db, "--params", params)
        return db


def score(found: dict, boxes: dict, ignored: dict, pictures: list[str], own_score: float) -> dict:
    judged, count = [], 0
    for name in pictures:
        truth = [box for box in boxes[name] if not is_ignored(box, ignored[name])]
        judged += judge([one for one in found[name] if not is_ignored(one["box"], ignored[name])], truth)
        count += len(truth)
    judged.sort(key=lambda one: -one[0])
    strong = [hit for probability, hit in judged if probability >= own_score]
    return {"pictures": len(pictures), "boxes": count, "ap50": average_precision([hit for _, hit in judged], count),
            "recall": sum(strong) / count if count else 0, "precision": sum(strong) / len(strong) if strong else 0}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network", type=Path)
    parser.add_argument("--classes", type=Path, required=True)
    parser.add_argument("--weights", type=Path)
    parser.add_argument("--category", default="car")
    parser.add_argument("--split", default="test")
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("VICTORIOUS_DATA", "../shared/data")))
    parser.add_argument("--score", type=float, default=0.01, help="minimum score of the ranked sightings")
    parser.add_argument("--tile-px", type=int, default=0)
    parser.add_argument("--no-tiles", action="store_true")
    parser.add_argument("--copies", type=int, default=0, help="of the picture that is timed; 0: none is")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    aerial = (arguments.data / "real" / "aerial").resolve()
    if not aerial.is_dir():
        print(f"SKIPPED: no outside data at {aerial}")
        return SKIPPED
    with open(aerial / "split.csv", newline="") as file:
        view_of = {row["image"]: row["view"] for row in csv.DictReader(file) if row["split"] == arguments.split}
    boxes, ignored = read_boxes(aerial / "boxes.csv"), read_boxes(aerial / "ignore.csv")
    shown = sys.stderr if arguments.json else sys.stdout
    with tempfile.TemporaryDirectory() as scratch:
        detector = Detector(arguments, Path(scratch))
        before = processor_time()
        db = detector.index(*(aerial / name for name in view_of), min_score=arguments.score)
        results: dict[str, object] = {"picture_s": (processor_time() - before) / len(view_of)}
        found = defaultdict(list)
        for one in lines(detector.program("export", "--db", db, "--format", "sightings", "--rejected")):
            if one["category"] == arguments.category:
                found[os.path.relpath(one["video"], aerial)].append(one)
        print(f"{arguments.network.name}, {arguments.category}, split {arguments.split}: {results['picture_s']:.2f} s a picture",
              file=shown)  # fmt: skip
        for view in ("nadir", "oblique", "both"):
            pictures = [name for name, own_view in view_of.items() if view in (own_view, "both")]
            results[view] = one = score(found, boxes, ignored, pictures, detector.own_score)
            print(f"{view:8} {one['pictures']:3} pictures {one['boxes']:4} boxes  AP50 {one['ap50']:.3f}  at score "
                  f"{detector.own_score:g}: recall {one['recall']:.2f} precision {one['precision']:.2f}", file=shown)  # fmt: skip
        if arguments.copies:
            results["search_s"] = time_of_search(detector.index, aerial, arguments.copies, Path(scratch))[0]
            print(f"search of 1920 x 1080 px: {results['search_s']:.2f} s of processor time", file=shown)
    if arguments.json:
        print(json.dumps(results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
