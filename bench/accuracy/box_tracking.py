#!/usr/bin/env python3
"""Compares box tracking from a video's first frame with OpenCV's CSRT, KCF and MIL in the same run.

Usage: box_tracking.py [--program build/victorious] [--peers build/box-peers] [--data ../shared/data]
                       [--sequences car,david,...] [--movies MOVIE...] [--json]

With --movies, folders with video.mp4 and truth.jsonl, each of their objects is tracked instead, from the first frame in
which it is clear; the frames in which it is clear are judged.

Success AUC: the area under the success plot, that is the fraction of frames with an overlap (intersection over union)
above a threshold of 0, 0.05, ... 1, over the frames that contain the object; a frame without a box has overlap 0. If
the object leaves and returns: the number of frames until it is found again (overlap 0.5) after each return, and the
fraction of frames without the object that have a box (false positives). Speed: frames per second of CPU time, including
reading the video. With --json an object: of each sequence and tracker these figures, their means, and by how much the
mean AUC of ours is above the largest of the others (`lead`).
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from movies import MIN_ROWS, Movie, Program, is_clear, overlap

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


def compare(video: Path, truth: list[Box | None], arguments: argparse.Namespace) -> dict[str, Score]:
    """The trackers' scores, each from the true box of the first frame."""
    box = ",".join(f"{round(number)}" for number in truth[0])
    followed = {OURS: follow_ours(arguments.program, video, box)}
    for peer in PEERS:
        followed[peer] = follow_peer(arguments.peers, peer, video, box)
    return {tracker: score(truth, boxes) for tracker, boxes in followed.items()}


def measure_sequences(arguments: argparse.Namespace) -> dict[str, dict[str, Score]]:
    folder = arguments.data / "real" / "tracking"
    scores = {}
    for name in arguments.sequences.split(","):
        sequence = SEQUENCES[name]
        scores[name] = compare(folder / sequence.video, read_truth(folder / sequence.truth, sequence.corners), arguments)
    return scores


def measure_movie(folder: Path, arguments: argparse.Namespace) -> dict[str, dict[str, Score]]:
    program, movie = Program(str(arguments.program)), Movie(folder)
    clear = {name: {row["frame"]: tuple(row["box"]) for row in rows if is_clear(row)} for name, rows in movie.rows_of.items()}
    clear = {name: boxes for name, boxes in clear.items() if len(boxes) >= MIN_ROWS}
    with tempfile.TemporaryDirectory() as scratch:
        images = {}
        for number in range(min(map(min, clear.values())), max(map(max, clear.values())) + 1):
            images[number] = Path(scratch) / f"{number:06}.png"
            program("frame", movie.video, "--number", number, "--out", images[number])
        scores = {}
        for name, boxes in clear.items():
            first, last = min(boxes), max(boxes)
            video = Path(scratch) / name
            video.mkdir()
            for number in range(first, last + 1):
                os.link(images[number], video / images[number].name)
            truth = [boxes.get(number) for number in range(first, last + 1)]
            scores[f"{folder.name}/{name}"] = compare(video, truth, arguments)
    return scores


def mean_of(scores: dict[str, dict[str, Score]]) -> dict[str, dict[str, float]]:
    return {tracker: {key: sum(getattr(of[tracker], key) for of in scores.values()) / len(scores)
                      for key in ("auc", "frames_a_second")} for tracker in (OURS, *PEERS)}  # fmt: skip


def returns_text(one: Score) -> str:
    if not one.absent_frames:
        return ""
    waits = ", ".join("never" if wait is None else str(wait) for wait in one.returns)
    return f"found again after {waits} frames; boxes in {one.false_boxes} of {one.absent_frames} frames without it"


def print_table(scores: dict[str, dict[str, Score]]) -> None:
    trackers = [OURS, *PEERS]
    print(f"{'sequence':32}" + "".join(f"{tracker:>12}" for tracker in trackers))
    for name, of_tracker in scores.items():
        print(f"{name:32}" + "".join(f"{of_tracker[tracker].auc:12.3f}" for tracker in trackers))
    means = mean_of(scores)
    for label, key in (("mean AUC", "auc"), ("frames/s", "frames_a_second")):
        print(f"{label:32}" + "".join(f"{means[tracker][key]:12.3f}" for tracker in trackers))
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
    parser.add_argument("--movies", nargs="+", type=Path, default=[], metavar="MOVIE")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    scores: dict[str, dict[str, Score]] = {}
    for folder in arguments.movies:
        scores |= measure_movie(folder, arguments)
    if not arguments.movies:
        scores = measure_sequences(arguments)
    if arguments.json:
        rows = {name: {tracker: one._asdict() for tracker, one in of.items()} for name, of in scores.items()}
        mean = mean_of(scores)
        lead = mean[OURS]["auc"] - max(mean[peer]["auc"] for peer in PEERS)
        print(json.dumps(rows | {"mean": mean, "lead": lead}, indent=1))
    else:
        print_table(scores)


if __name__ == "__main__":
    main()
