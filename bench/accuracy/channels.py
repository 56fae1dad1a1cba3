#!/usr/bin/env python3
"""Trains the detector by channels on aerial pictures with a box for every vehicle, and measures it on others.

Usage: channels.py [--seeds 1 2 3] [--program build/victorious] [--data DIR] [--params FILE] [--threads 2]
                   [--score 0.01] [--copies 8] [--sightings FILE] [--json]

Data: $VICTORIOUS_DATA/real/aerial: its train split, all classes as the one category `vehicle`, with the rectangles of
ignore.csv as `ignored`; and its test split. For each seed: `category train`, `index` of all pictures, `export`. A
sighting and a box whose centre lies in a rectangle of ignore.csv do not count. Prints for each seed, and their mean:

  AP50         area under precision over recall, sightings ranked by probability, IoU 0.5 or more; by view, and by
               the longer side of the boxes (others, and what matches them, are left out; all sightings count)
  calibration  share of right sightings of those from probability 0.5 on, and their mean probability
  time         processor time of the training; processor time and wall time of a search of 1920 x 1080 px, from
               the difference of `index` for N + 1 copies of one such picture and for one, with their decoding

With --json an object instead, in which `mean` also has the least and the greatest of the seeds.
With --sightings, those of the last seed are left there, for other scorers. Exits with 77 if there is no such data.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from detectors import SKIPPED, average_precision, iou, is_ignored, processor_time, read_boxes, time_of_search

MIN_IOU = 0.5
SIZES = ((16, 1e9), (16, 32), (32, 64), (64, 1e9))
VIEWS = ("nadir", "oblique", "both")


def write_list(path: Path, splits: dict, boxes: dict, ignored: dict) -> None:
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["image", "category", "x0", "y0", "x1", "y1"])
        for name, row in splits.items():
            if row["split"] != "train":
                continue
            for category, some in (("vehicle", boxes[name]), ("ignored", ignored[name])):
                for x, y, width, height in some:
                    writer.writerow([name, category, x, y, x + width, y + height])
            if not boxes[name] and not ignored[name]:
                writer.writerow([name, "background", "", "", "", ""])


def judge(found: list[dict], truth: list[list[float]], smallest: float, largest: float) -> list[tuple[float, bool]]:
    """Score and hit of each sighting of a picture; those that match a box of another size are left out."""
    taken, judged = set(), []
    for one in sorted(found, key=lambda sighting: -sighting["score"]):
        best, k = max(((iou(one["box"], box), k) for k, box in enumerate(truth)), default=(0, -1))
        is_counted = best < MIN_IOU or smallest <= max(truth[k][2:]) < largest
        hit = best >= MIN_IOU and k not in taken
        if hit:
            taken.add(k)
        if is_counted:
            judged.append((one["score"], hit))
    return judged


class Bench:
    def __init__(self, arguments: argparse.Namespace, aerial: Path, scratch: Path):
        self.arguments, self.aerial, self.scratch = arguments, aerial, scratch
        with open(aerial / "split.csv", newline="") as file:
            self.splits = {row["image"]: row for row in csv.DictReader(file)}
        self.boxes, self.ignored = read_boxes(aerial / "boxes.csv"), read_boxes(aerial / "ignore.csv")
        write_list(scratch / "train.csv", self.splits, self.boxes, self.ignored)

    def run(self, *words) -> str:
        return subprocess.run([self.arguments.program, *map(str, words)], check=True, capture_output=True, text=True).stdout

    def train(self, seed: int) -> float:
        before = processor_time()
        params = ["--params", self.arguments.params] if self.arguments.params else []
        self.run("category", "train", "--images", self.aerial, "--list", self.scratch / "train.csv", "--seed", seed,
                 "--out", self.scratch / "cars.vcat", "--threads", self.arguments.threads, "--force", *params)  # fmt: skip
        return processor_time() - before

    def index(self, videos: list[Path], score: float) -> str:
        db, params = self.scratch / "index.db", self.scratch / "params.json"
        db.unlink(missing_ok=True)
        params.write_text(json.dumps({"categories": {"min_probability": score}, "keep": {"interval_s": -1}}))
        self.run("index", *videos, "--categories", self.scratch / "cars.vcat", "--db", db, "--params", params,
                 "--threads", self.arguments.threads)  # fmt: skip
        return self.run("export", "--db", db, "--format", "sightings", "--rejected")

    def sightings(self) -> dict[str, list[dict]]:
        pictures = sorted(self.aerial / name for name, row in self.splits.items() if row["split"] == "test")
        found, lines = defaultdict(list), []
        names = sorted(os.listdir(self.aerial / "images"))
        for line in self.index(pictures, self.arguments.score).splitlines():
            one = json.loads(line)
            name = os.path.relpath(one["video"], self.aerial)
            found[name].append(one)
            lines.append(json.dumps(one | {"frame": names.index(os.path.basename(name))}))
        if self.arguments.sightings:
            self.arguments.sightings.write_text("\n".join(lines) + "\n")
        return found

    def score(self, found: dict[str, list[dict]]) -> dict:
        result = {}
        for view in VIEWS:
            for smallest, largest in SIZES:
                judged, count = [], 0
                for name, row in self.splits.items():
                    if row["split"] != "test" or view not in (row["view"], "both"):
                        continue
                    truth = [box for box in self.boxes[name] if not is_ignored(box, self.ignored[name])]
                    own = [one for one in found[name] if not is_ignored(one["box"], self.ignored[name])]
                    judged += judge(own, truth, smallest, largest)
                    count += sum(smallest <= max(box[2:]) < largest for box in truth)
                judged.sort(key=lambda one: -one[0])
                ap = average_precision([hit for _, hit in judged], count)
                size = f"{smallest} px and more" if largest > 1e6 else f"{smallest} to {largest} px"
                result[f"{view}, {size}"] = {"boxes": count, "ap50": ap}
                if view == "both" and (smallest, largest) == SIZES[0]:
                    likely = [(p, hit) for p, hit in judged if p >= 0.5]
                    result["calibration"] = {
                        "sightings": len(likely),
                        "right": sum(hit for _, hit in likely) / max(1, len(likely)),
                        "mean_probability": sum(p for p, _ in likely) / max(1, len(likely)),
                        "recall": sum(hit for _, hit in likely) / max(1, count),
                    }
        return result

    def speed(self) -> dict:
        processor, wall = time_of_search(lambda folder: self.index([folder], 0.5), self.aerial, self.arguments.copies, self.scratch)
        return {"processor_s": processor, "wall_s": wall, "threads": self.arguments.threads}


def mean_of(results: list[dict], train_s: list[float]) -> dict:
    """Of the seeds, with the least and the greatest."""

    def of(values: list[float]) -> dict[str, float]:
        return {"mean": sum(values) / len(values), "least": min(values), "greatest": max(values)}

    sizes = [key for key in results[0] if key != "calibration"]
    calibration = {key: of([one["calibration"][key] for one in results]) for key in results[0]["calibration"]}
    return {key: of([one[key]["ap50"] for one in results]) | {"boxes": results[0][key]["boxes"]} for key in sizes} | {
        "calibration": calibration, "train_s": of(train_s)}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--program", type=Path, default=Path("build/victorious"))
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("VICTORIOUS_DATA", "../shared/data")))
    parser.add_argument("--params", type=Path, help="parameters of `category train`")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--score", type=float, default=0.01, help="minimum probability of the ranked sightings")
    parser.add_argument("--copies", type=int, default=8, help="of the picture that is timed")
    parser.add_argument("--sightings", type=Path)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    aerial = (arguments.data / "real" / "aerial").resolve()
    if not aerial.is_dir():
        print(f"SKIPPED: no outside data at {aerial}")
        return SKIPPED
    shown = sys.stderr if arguments.json else sys.stdout
    results, train_s = [], []
    with tempfile.TemporaryDirectory() as scratch:
        bench = Bench(arguments, aerial, Path(scratch))
        for seed in arguments.seeds:
            train_s.append(bench.train(seed))
            results.append(bench.score(bench.sightings()))
            print(f"seed {seed}: trained in {train_s[-1]:.0f} s of processor time; calibration "
                  + json.dumps({key: round(value, 3) for key, value in results[-1]["calibration"].items()}), file=shown)  # fmt: skip
            for key, value in results[-1].items():
                if key != "calibration":
                    print(f"  {key:28} {value['boxes']:4} boxes  AP50 {value['ap50']:.3f}", file=shown, flush=True)
        mean, speed = mean_of(results, train_s), bench.speed()
        print("mean of the seeds", file=shown)
        for key, value in mean.items():
            if "boxes" in value:
                print(f"  {key:28} AP50 {value['mean']:.3f}", file=shown)
        print("search of 1920 x 1080 px: " + json.dumps({key: round(value, 3) for key, value in speed.items()}), file=shown)
    if arguments.json:
        print(json.dumps({"seeds": results, "mean": mean, "speed": speed}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
