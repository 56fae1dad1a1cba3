#!/usr/bin/env python3
"""Measures precision and recall of the search for crops of a movie's own objects in the whole movie.

Usage: crops_in_movie.py MOVIE... [--program build/victorious] [--seeds N] [--params FILE] [--work DIR] [--json]

MOVIE is a folder with video.mp4 and truth.jsonl. For each object, a box is cut out of one frame and becomes a model of
one photo; the movie is indexed with all these models and scored. The frame is the one with the median box among those
in which the object is fully visible; then, for each seed, a random one among those in which more than 0.9 of the object
is visible. Prints the totals of `victorious evaluate --json`, the same counts per object (true positives, false
positives, clear rows), and every false positive with its overlap with the true box. With --json the totals as an
object, by movie and choice of frames: `median`, `seed_1`, ...
"""

import argparse
import json
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import TextIO

from movies import Movie, Program, is_clear, overlap, pair

CROP_VISIBLE = 0.9


def choose_rows(movie: Movie, seed: int | None) -> list[dict]:
    """One row per model; none for an object that is never fully visible."""
    chosen = {}
    for name, rows in sorted(movie.rows_of.items()):
        full = [row for row in rows if row["visible"] > CROP_VISIBLE]
        if not full or rows[0]["model"] in chosen:
            continue
        if seed is None:
            most = max(row["visible"] for row in full)
            fullest = [row for row in full if row["visible"] >= min(most, 0.99)]
            fullest.sort(key=lambda row: row["box"][2] * row["box"][3])
            row = fullest[len(fullest) // 2]
        else:
            row = random.Random(f"{seed} {name}").choice(full)
        chosen[row["model"]] = row
    return list(chosen.values())


def index_crops(program: Program, movie: Movie, rows: list[dict], params: str | None, work: Path) -> Path:
    """Indexes the movie with the crops as models. Returns the index."""
    work.mkdir(parents=True)
    for row in rows:
        image = work / f"{row['model']}.png"
        program("frame", movie.video, "--number", row["frame"], "--out", image)
        box = ",".join(str(side) for side in row["box"])
        program("model", "add", row["model"], image, "--box", box, "--models", work / "models")
    db = work / "index.db"
    extra = ["--params", params] if params else []
    program("index", movie.video, "--models", work / "models", "--db", db, *extra)
    return db


def ratio(part: int, whole: int) -> str:
    return f"{part / whole:6.3f}" if whole else "     -"


def report(program: Program, movie: Movie, rows: list[dict], db: Path, shown_on: TextIO) -> dict:
    """Prints the counts. Returns the totals of `evaluate`."""
    models = sorted(row["model"] for row in rows)
    score = json.loads(program("evaluate", "--db", db, "--truth", movie.truth, "--models", ",".join(models), "--json"))
    sightings = [json.loads(line) for line in program("export", "--db", db, "--format", "sightings").splitlines()]
    right, wrong, clear = Counter(), Counter(), Counter()
    wrong_ones = []
    for sighting, row in pair(movie, sightings):
        if row is None:
            wrong[sighting["model"]] += 1
            wrong_ones.append(sighting)
        elif is_clear(row):
            right[sighting["model"]] += 1
    for name, clear_rows in movie.findable().items():
        clear[movie.rows_of[name][0]["model"]] += clear_rows
    for row in rows:
        model, box = row["model"], ",".join(str(side) for side in row["box"])
        print(
            f"  {model:<20} frame {row['frame']:>3} box {box:<16} precision"
            f" {ratio(right[model], right[model] + wrong[model])} recall {ratio(right[model], clear[model])}"
            f"  right {right[model]:>3} wrong {wrong[model]:>3} clear {clear[model]:>3}",
            file=shown_on,
        )
    for sighting in sorted(wrong_ones, key=lambda s: (s["model"], s["frame"])):
        there = movie.rows_in[sighting["frame"]]
        own = max((overlap(r["box"], sighting["box"]) for r in there if r["model"] == sighting["model"]), default=0.0)
        box = ",".join(f"{side:.0f}" for side in sighting["box"])
        print(
            f"  wrong: {sighting['model']} in frame {sighting['frame']} at {box}, score {sighting['score']:.3f},"
            f" {sighting['matches']} matches, overlap with the truth {own:.2f}",
            file=shown_on,
        )
    shown = {key: "-" if score[key] is None else f"{score[key]:.3f}" for key in ("sighting_precision", "sighting_recall")}
    print(f"  all: sighting precision {shown['sighting_precision']}, recall {shown['sighting_recall']}\n", file=shown_on, flush=True)
    return score


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("movies", nargs="+", type=Path, metavar="MOVIE")
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--seeds", type=int, default=3, help="random choices of frames besides the median one")
    parser.add_argument("--params", help="parameters of the index run, JSON")
    parser.add_argument("--work", type=Path, help="keep images, models and indexes here (a new folder)")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    if arguments.work and arguments.work.exists():
        parser.error(f"--work {arguments.work}: exists already; name a new folder")
    program = Program(arguments.program)
    shown_on = sys.stderr if arguments.json else sys.stdout
    scores: dict[str, dict[str, dict]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.work or Path(scratch)
        for folder in arguments.movies:
            movie = Movie(folder)
            for seed in [None, *range(1, arguments.seeds + 1)]:
                choice = "median" if seed is None else f"seed {seed}"
                print(f"{folder.name}, {choice}:", file=shown_on)
                rows = choose_rows(movie, seed)
                db = index_crops(program, movie, rows, arguments.params, work / folder.name / choice.replace(" ", "-"))
                scores.setdefault(folder.name, {})[choice.replace(" ", "_")] = report(program, movie, rows, db, shown_on)
    if arguments.json:
        print(json.dumps(scores))


if __name__ == "__main__":
    main()
