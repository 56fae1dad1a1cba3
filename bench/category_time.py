#!/usr/bin/env python3
"""Measures how long `victorious category` trains and classifies, and how large its models are, on Caltech-101.

Usage: category_time.py [--images 30] [--copies 40] [--program build/victorious] [--data DIR] [--json]

Prints:

  train_s, processor_s  wall time and processor time of `category train` on --images images each of airplanes and cars, on two threads
  classify_ms           wall time of one image, on one thread: from the difference of `category classify` for N + 1
                        copies of an image and for one
  pair_mb, all_mb       size of this model, and of one of all categories of the data, of at most --images images each
"""

import argparse
import csv
import json
import os
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "accuracy"))
from detectors import processor_time
from movies import Program

PAIR = ("airplanes", "car_side")


def write_list(path: Path, rows: list[dict]) -> Path:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    return path


def training_rows(listed: list[dict], images: int) -> dict[str, list[dict]]:
    """The first images of each category, those with boxes if it has such."""
    of_category = defaultdict(list)
    for row in listed:
        of_category[row["category"]].append(row)
    return {name: ([row for row in rows if row["x0"]] or rows)[:images] for name, rows in of_category.items()}


class Bench:
    def __init__(self, arguments: argparse.Namespace, scratch: Path):
        self.program, self.images, self.scratch = Program(arguments.program), arguments.data / "caltech101", scratch

    def train(self, rows: list[dict], name: str) -> Path:
        model = self.scratch / name
        self.program("category", "train", "--images", self.images, "--list", write_list(self.scratch / "train.csv", rows),
                     "--out", model, "--threads", 2)  # fmt: skip
        return model

    def classify_s(self, model: Path, rows: list[dict]) -> float:
        start = time.monotonic()
        self.program("category", "classify", "--model", model, "--images", self.images, "--list",
                     write_list(self.scratch / "test.csv", rows), "--threads", 1)  # fmt: skip
        return time.monotonic() - start


def measure(arguments: argparse.Namespace, scratch: Path) -> dict[str, float]:
    bench = Bench(arguments, scratch)
    with (bench.images / "list.csv").open(newline="") as file:
        listed = list(csv.DictReader(file))
    rows = training_rows(listed, arguments.images)
    start, before = time.monotonic(), processor_time()
    pair = bench.train([row for name in PAIR for row in rows[name]], "pair.vcat")
    train_s, processor_s = time.monotonic() - start, processor_time() - before
    one = [row for row in listed if row["category"] == PAIR[0]][-1]
    once_s, more_s = (bench.classify_s(pair, [one] * count) for count in (1, 1 + arguments.copies))
    every = bench.train([row for of_category in rows.values() for row in of_category], "all.vcat")
    return {"train_s": train_s, "processor_s": processor_s, "classify_ms": 1e3 * (more_s - once_s) / arguments.copies,
            "pair_mb": pair.stat().st_size / 1e6, "categories": len(rows), "all_mb": every.stat().st_size / 1e6}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", type=int, default=30)
    parser.add_argument("--copies", type=int, default=40)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("VICTORIOUS_DATA", "../shared/data")))
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        result = measure(arguments, Path(scratch))
    if arguments.json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name:12} {value:.2f}")


if __name__ == "__main__":
    main()
