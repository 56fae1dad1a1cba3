"""Shared by the measurements on movies: a movie with its truth, the program, and the matching of sightings to truth.

The rules for clear rows, findable objects and pairs are those of `victorious evaluate`.
"""

import hashlib
import json
import math
import subprocess
import sys
from collections import Counter, defaultdict
from pathlib import Path
from typing import Iterator

CLEAR_VISIBLE = 0.5
CLEAR_SIDE_PX = 24
MIN_OVERLAP = 0.4
EARTH_M = 6371e3
MIN_ROWS = 10  # minimum number of clear rows of a findable object


class Movie:
    """A folder with video.mp4 and truth.jsonl; if `models` is given, only their truth."""

    def __init__(self, folder: Path, models: set[str] | None = None):
        self.folder = folder
        self.video = folder / "video.mp4"
        self.truth = folder / "truth.jsonl"
        telemetry = folder / "telemetry.csv"
        self.telemetry = telemetry if telemetry.exists() else None
        self.rows_of = defaultdict(list)  # by object
        self.rows_in = defaultdict(list)  # by frame
        for row in map(json.loads, self.truth.read_text().splitlines()):
            if models is None or row["model"] in models:
                self.rows_of[row["object"]].append(row)
                self.rows_in[row["frame"]].append(row)

    @staticmethod
    def findable_of(truth: Path) -> dict[str, int]:
        """The number of clear rows of each findable object of a truth file."""
        clear = Counter()
        for row in map(json.loads, truth.read_text().splitlines()):
            clear[row["object"]] += is_clear(row)
        return {name: count for name, count in clear.items() if count >= MIN_ROWS}

    def models(self) -> list[str]:
        return sorted({rows[0]["model"] for rows in self.rows_of.values()})

    def findable(self) -> dict[str, int]:
        """The number of clear rows of each findable object."""
        clear = {name: sum(map(is_clear, rows)) for name, rows in sorted(self.rows_of.items())}
        return {name: count for name, count in clear.items() if count >= MIN_ROWS}


class Program:
    """Runs the program; exits with its error message if it fails."""

    def __init__(self, path: str):
        self.path = path

    def run(self, *arguments: object) -> subprocess.CompletedProcess:
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{self.path} {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return done

    def __call__(self, *arguments: object) -> str:
        return self.run(*arguments).stdout


def flight(program: Program, scene: Path, folder: Path) -> Path:
    """The simulated flight of a scene, made once by each build of the program: FOLDER/NAME-KEY."""
    key = hashlib.sha256(Path(program.path).read_bytes() + scene.read_bytes()).hexdigest()[:12]
    made = folder / f"{scene.stem}-{key}"
    if not (made / "video.mp4").exists():
        folder.mkdir(parents=True, exist_ok=True)
        program("simulate", scene, "--out", made)
    return made


def is_clear(row: dict) -> bool:
    return row["visible"] >= CLEAR_VISIBLE and min(row["box"][2:]) >= CLEAR_SIDE_PX


def overlap(a: list[float], b: list[float]) -> float:
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    common = max(0.0, width) * max(0.0, height)
    return common / (a[2] * a[3] + b[2] * b[3] - common)


def pair(movie: Movie, sightings: list[dict]) -> Iterator[tuple[dict, dict | None]]:
    """Yields each sighting with its truth row, or None; greedy by descending score within a frame and model."""
    taken = set()
    for sighting in sorted(sightings, key=lambda s: -s["score"]):
        candidates = [
            row
            for row in movie.rows_in[sighting["frame"]]
            if row["model"] == sighting["model"]
            and (row["object"], row["frame"]) not in taken
            and overlap(row["box"], sighting["box"]) >= MIN_OVERLAP
        ]
        row = max(candidates, key=lambda row: overlap(row["box"], sighting["box"]), default=None)
        if row:
            taken.add((row["object"], row["frame"]))
        yield sighting, row


def lines(text: str) -> list[dict]:
    """Of JSON Lines."""
    return [json.loads(line) for line in text.splitlines()]


def horizontal_m(a: dict, b: dict) -> float:
    north = math.radians(a["latitude_deg"] - b["latitude_deg"])
    east = math.radians(a["longitude_deg"] - b["longitude_deg"]) * math.cos(math.radians(a["latitude_deg"]))
    return EARTH_M * math.hypot(north, east)


def found(program: Program, db: Path, movies: dict[str, Movie]) -> dict[str, list[dict]]:
    """By object of the truth: the objects of the index that show it, each with `error_m` (NaN without a place)."""
    truth_of = defaultdict(Counter)
    for name, movie in movies.items():
        sightings = lines(program("export", "--db", db, "--format", "sightings", "--video", name))
        for sighting, row in pair(movie, sightings):
            truth_of[sighting["object_id"]][row["object"] if row else None] += 1
    objects = defaultdict(list)
    for one in lines(program("export", "--db", db, "--format", "objects")):
        name = truth_of[one["object_id"]].most_common(1)[0][0]
        if name is None:
            continue
        one["error_m"] = math.nan
        if one["latitude_deg"] is not None:
            rows = [row for movie in movies.values() for row in movie.rows_of[name]]
            one["error_m"] = horizontal_m(one, min(rows, key=lambda row: abs(row["time_s"] - one["place_time_s"])))
        objects[name].append(one)
    return objects
