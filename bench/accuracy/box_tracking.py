#!/usr/bin/env python3
"""Compares box tracking from a video's first frame with OpenCV's CSRT, KCF and MIL in the same run.

Usage: box_tracking.py [--program build/victorious] [--peers build/box-peers] [--data ../shared/data]
                       [--sequences car,david,...] [--json]

Success AUC: the area under the success plot, that is the fraction of frames with an overlap (intersection over union)
above a threshold of 0, 0.05, ... 1, over the frames that contain the object; a frame without a box has overlap 0. If
the object leaves and returns: the number of frames until it is found again (overlap 0.5) after each return, and the
fraction of frames without the object that have a box (false positives). Speed: frames per second of CPU time, including
reading the video.
"""

import argparse
import json
import math
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

PEERS = ["csrt", "kcf", "mil"]
OURS = "victorious"
FOUND_OVERLAP = 0.5

Box = tuple[float, float, float, float]  # x, y, width, height, px


class Sequence(NamedTuple):
    video: str
    truth: str
    corners: bool = False  # the truth has the form x1,y1,x2,y2


SEQUENCES = {
    "boat1": Sequence("uav123_10fps/boat1.mp4", "uav123_10fps/boat1.txt"),
    "truck4_2": Sequence("uav123_10fps/truck4_2.mp4", "uav123_10fps/truck4_2.txt"),
    "S0601": Sequence("uavdt/S0601.mp4", "uavdt/S0601_gt.txt"),
    "Dudek20": Sequence("otb/Dudek20", "otb/Dudek20/groundtruth_rect.txt"),
    "car": Sequence("tld/car/car.mpg", "tld/car/gt.txt", True),
    "david": Sequence("tld/david/david.mpg", "tld/david/gt.txt", True),
    "jumping": Sequence("tld/jumping/jumping.mpg", "tld/jumping/gt.txt", True),
    "pedestrian2": Sequence("tld/pedestrian2/pedestrian2.mpg", "tld/pedestrian2/gt.txt", True),
}


class Followed(NamedTuple):
    boxes: dict[int, Box]  # by frame; frames without a box are absent
    processor_s: float


class Score(NamedTuple):
    auc: float
    frames_a_second: float
    returns: list[int | None]  # for each return, the frames until the object is found again
    absent_frames: int
    false_boxes: int


def read_truth(path: Path, corners: bool) -> list[Box | None]:
    rows = []
    for line in path.read_text().splitlines():
        numbers = [float(word) for word in line.replace("\t", ",").split(",")]
        if any(map(math.isnan, numbers)):
            rows.append(None)
        elif corners:
            rows.append((numbers[0], numbers[1], numbers[2] - numbers[0], numbers[3] - numbers[1]))
        else:
            rows.append(tuple(numbers))
    return rows


def overlap(a: Box, b: Box) -> float:
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return width * height / (a[2] * a[3] + b[2] * b[3] - width * height)


def run(command: list[object]) -> tuple[str, float]:
    """Returns its standard output and its CPU time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def follow_ours(program: Path, video: Path, box: str) -> Followed:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "sightings.jsonl"
        _, processor_s = run([program, "track", video, "--box", box, "--at", 0, "--out", out])
        rows = map(json.loads, out.read_text().splitlines())
        return Followed({row["frame"]: tuple(row["box"]) for row in rows}, processor_s)


def follow_peer(peers: Path, name: str, video: Path, box: str) -> Followed:
    text, processor_s = run([peers, video, box, name])
    boxes = {}
    for line in text.splitlines():
        frame, *numbers = line.split()
        if numbers != ["none"]:
            boxes[int(frame)] = tuple(map(float, numbers))
    return Followed(boxes, processor_s)


def score(truth: list[Box | None], followed: Followed) -> Score:
    overlaps = []
    returns = []
    waiting_since = None
    absent = [frame for frame, box in enumerate(truth) if box is None]
    for frame, box in enumerate(truth):
        if box is None:
            waiting_since = None
            continue
        common = overlap(box, followed.boxes[frame]) if frame in followed.boxes else 0.0
        overlaps.append(common)
        if frame > 0 and truth[frame - 1] is None:
            returns.append(None)
            waiting_since = frame
        if waiting_since is not None and common >= FOUND_OVERLAP:
            returns[-1] = frame - waiting_since
            waiting_since = None
    thresholds = [k / 20 for k in range(21)]
    auc = sum(sum(o > t for o in overlaps) / len(overlaps) for t in thresholds) / len(thresholds)
    false_boxes = sum(frame in followed.boxes for frame in absent)
    return Score(auc, len(truth) / followed.processor_s, returns, len(absent), false_boxes)


def measure(arguments: argparse.Namespace) -> dict[str, dict[str, Score]]:
    folder = arguments.data / "real" / "tracking"
    scores = {}
    for name in arguments.sequences.split(","):
        sequence = SEQUENCES[name]
        truth = read_truth(folder / sequence.truth, sequence.corners)
        box = ",".join(f"{round(number)}" for number in truth[0])
        video = folder / sequence.video
        followed = {OURS: follow_ours(arguments.program, video, box)}
        for peer in PEERS:
            followed[peer] = follow_peer(arguments.peers, peer, video, box)
        scores[name] = {tracker: score(truth, boxes) for tracker, boxes in followed.items()}
    return scores


def returns_text(one: Score) -> str:
    if not one.absent_frames:
        return ""
    waits = ", ".join("never" if wait is None else str(wait) for wait in one.returns)
    return f"found again after {waits} frames; boxes in {one.false_boxes} of {one.absent_frames} frames without it"


def print_table(scores: dict[str, dict[str, Score]]) -> None:
    trackers = [OURS, *PEERS]
    print(f"{'sequence':12}" + "".join(f"{tracker:>12}" for tracker in trackers))
    for name, of_tracker in scores.items():
        print(f"{name:12}" + "".join(f"{of_tracker[tracker].auc:12.3f}" for tracker in trackers))
    for label, value in (("mean AUC", lambda one: one.auc), ("frames/s", lambda one: one.frames_a_second)):
        means = [sum(value(of_tracker[t]) for of_tracker in scores.values()) / len(scores) for t in trackers]
        print(f"{label:12}" + "".join(f"{mean:12.3f}" for mean in means))
    for name, of_tracker in scores.items():
        for tracker, one in of_tracker.items():
            if one.absent_frames:
                print(f"{name}, {tracker}: {returns_text(one)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/victorious"))
    parser.add_argument("--peers", type=Path, default=Path("build/box-peers"))
    parser.add_argument("--data", type=Path, default=Path("../shared/data"))
    parser.add_argument("--sequences", default=",".join(SEQUENCES))
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    scores = measure(arguments)
    if arguments.json:
        print(json.dumps({name: {t: one._asdict() for t, one in s.items()} for name, s in scores.items()}, indent=1))
    else:
        print_table(scores)


if __name__ == "__main__":
    main()
