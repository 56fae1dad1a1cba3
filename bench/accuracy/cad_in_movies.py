#!/usr/bin/env python3
"""Measures precision and recall of the search for CAD models in movies with ground truth.

Usage: cad_in_movies.py [MOVIE...] [--program build/victorious] [--models assets/models] [--params FILE]
                        [--tool FILE] [--work build/cad_in_movies] [--json]

MOVIE is a scene (scenes/NAME.json), or a folder with video.mp4 and truth.jsonl; by default all scenes of the project
except the demo and the single images of chapter 3. A scene is simulated into WORK/flights, once by each build of
--program. The models of --models, DIR/NAME.vmodel, are used as they are, or else built in each run from DIR/NAME.glb,
for every model name in the truth; names without such a file are reported and not searched for. Each movie is indexed
once, with all its models together and its telemetry.csv if it exists, into WORK/NAME.db
(`victorious sheet --db WORK/NAME.db --out OUT.jpg` draws the detections).

Prints one row per movie, then rows over all movies, those without and with noise, and each model:

  precision  sighting precision, as counted by `victorious evaluate`
  recall     sighting recall, likewise
  view       fraction of the true positives of clear rows whose view is within 10 degrees (great circle) of the truth
  frames/s   of `victorious index`, including opening the video and writing the index
  clear      number of truth rows over which recall is computed
  then       the recall of each object

Every movie's precision and recall must equal those of `victorious evaluate --json`. --tool names an independent scorer
(--truth, --objects, --sightings, --models, --json; the same keys as `evaluate`), which must agree as well. A
disagreement is reported, and the exit status is 1.

With --json an object instead: by movie and by model, `all`, `without_noise`, `with_noise`: precision, recall, view,
detected, clear; of movies and of `all` also what `evaluate` says of objects (found, findable, false_objects, the mean
ids_per_object), of movies cep50_m, cep75_m, cep90_m, errors_m; and `farthest`: the movie with the largest cep90_m.
"""

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from movies import Movie, Program, flight, is_clear, pair

REPOSITORY = Path(__file__).resolve().parents[2]
RIGHT_VIEW_DEG = 10
TOLERANCE = 1e-6
ROUNDED = 6e-3  # tolerance in metres and degrees, which exports round
HEAD = f"{'':<18}{'precision':>10}{'recall':>8}{'view':>8}{'frames/s':>10}{'clear':>7}"


@dataclass
class Tally:
    """Counts of truth rows and sightings of a movie or model, or their sums."""

    right: int = 0  # true positives: sightings of clear rows
    wrong: int = 0  # false positives
    clear_rows: int = 0  # clear rows of findable objects
    detected: int = 0  # of these, detected
    with_view: int = 0  # true positives with a view
    right_view: int = 0  # of these, close to the true view
    frames: int = 0
    seconds: float = 0

    def add(self, other: "Tally") -> None:
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)

    def precision(self) -> float | None:
        return ratio(self.right, self.right + self.wrong)

    def recall(self) -> float | None:
        return ratio(self.detected, self.clear_rows)

    def line(self, name: str, more: str = "") -> str:
        cells = (
            f"{shown(self.precision()):>10}{shown(self.recall()):>8}{shown(ratio(self.right_view, self.with_view)):>8}"
            f"{shown(ratio(self.frames, self.seconds), 2):>10}{self.clear_rows:>7}"
        )
        return f"{name:<18}{cells}  {more}".rstrip()


@dataclass
class Result:
    """The result of one movie."""

    of_model: dict[str, Tally] = field(default_factory=dict)
    recall_of: dict[str, float] = field(default_factory=dict)  # by findable object
    frames: int = 0
    seconds: float = 0
    score: dict = field(default_factory=dict)  # of `victorious evaluate`

    def total(self) -> Tally:
        total = Tally(frames=self.frames, seconds=self.seconds)
        for tally in self.of_model.values():
            total.add(tally)
        return total


def ratio(part: float, whole: float) -> float | None:
    return part / whole if whole else None


def shown(value: float | None, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def angle_deg(a: dict, b: dict) -> float:
    """The angle between two directions to the camera."""
    p, q = math.radians(a["off_nadir_deg"]), math.radians(b["off_nadir_deg"])
    turn = math.radians(a["azimuth_deg"] - b["azimuth_deg"])
    cosine = math.cos(p) * math.cos(q) + math.sin(p) * math.sin(q) * math.cos(turn)
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))


def simulated(program: Program, movie: Path, work: Path) -> Path:
    """Returns the folder of a movie; simulates it first if it is a scene."""
    if movie.is_dir():
        return movie
    print(f"simulating {movie}", file=sys.stderr, flush=True)
    return flight(program, movie, work / "flights")


def noise_of(movie: Path) -> float | None:
    """Returns the fraction of noisy pixels of a scene; None if it is unknown."""
    scene = movie / "scene.json" if movie.is_dir() else movie
    return json.loads(scene.read_text())["video"].get("noise", 0) if scene.exists() else None


class Models:
    """Searchable models, each built on first use."""

    def __init__(self, program: Program, cad: Path, folder: Path):
        self.program, self.cad, self.folder = program, cad, folder

    def has(self, name: str) -> bool:
        return any((self.cad / f"{name}.{ending}").exists() for ending in ("vmodel", "glb"))

    def made_of(self, model: str) -> Path:
        """The file of a model, built if there is none."""
        ready, own = self.cad / f"{model}.vmodel", self.folder / f"{model}.vmodel"
        if ready.exists():
            return ready
        if not own.exists():
            print(f"making a model of {self.cad / model}.glb", file=sys.stderr, flush=True)
            self.program("model", "add", model, self.cad / f"{model}.glb", "--models", self.folder)
        return own

    def library(self, name: str, models: list[str]) -> Path:
        """Makes a library of only these models."""
        library = self.folder / "of" / name
        library.mkdir(parents=True)
        for model in models:
            (library / f"{model}.vmodel").symlink_to(self.made_of(model).resolve())
        return library


def index(program: Program, movie: Movie, library: Path, db: Path, params: Path | None) -> tuple[int, float]:
    """Indexes a movie. Returns the number of searched frames and the duration in seconds."""
    print(f"indexing {movie.video}", file=sys.stderr, flush=True)
    db.unlink(missing_ok=True)
    began = time.monotonic()
    extra = ["--params", params] if params else []
    if movie.telemetry:
        extra += ["--telemetry", movie.telemetry]
    reported = program.run("index", movie.video, "--models", library, "--db", db, *extra).stderr
    seconds = time.monotonic() - began
    return int(re.search(r"(\d+) frames searched", reported)[1]), seconds


def tally(movie: Movie, sightings: list[dict]) -> Result:
    result = Result({model: Tally() for model in movie.models()})
    clear_rows, seen = movie.findable(), Counter()
    for sighting, row in pair(movie, sightings):
        of_model = result.of_model[sighting["model"]]
        if row is None:
            of_model.wrong += 1
        elif is_clear(row):
            of_model.right += 1
            seen[row["object"]] += 1
            if sighting["view"] and row["view"]:
                of_model.with_view += 1
                of_model.right_view += angle_deg(sighting["view"], row["view"]) <= RIGHT_VIEW_DEG
    for name, rows in clear_rows.items():
        of_model = result.of_model[movie.rows_of[name][0]["model"]]
        of_model.clear_rows += rows
        of_model.detected += seen[name]
        result.recall_of[name] = seen[name] / rows
    return result


def differences(own: object, other: object, where: str) -> list[str]:
    """Returns the keys of `other` whose values differ in `own`."""
    if isinstance(other, dict) and isinstance(own, dict):
        return [line for key, value in other.items() for line in differences(own.get(key), value, f"{where} {key}")]
    if isinstance(own, float) and isinstance(other, float):
        tolerance = ROUNDED if where.endswith(("_m", "_deg")) else TOLERANCE
        return [] if abs(own - other) <= tolerance else [f"{where}: {own} here, {other} there"]
    return [] if own == other else [f"{where}: {own} here, {other} there"]


def score_by_tool(tool: Path, movie: Movie, program: Program, db: Path) -> dict:
    command = [sys.executable, tool, "--truth", movie.truth, "--models", ",".join(movie.models()), "--json"]
    for form in ("objects", "sightings"):
        path = db.with_suffix(f".{form}.jsonl")
        program("export", "--db", db, "--format", form, "--out", path)
        command += [f"--{form}", path]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{tool}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def measure(program: Program, movie: Movie, name: str, models: Models, arguments: argparse.Namespace) -> Result:
    db = arguments.work / f"{name}.db"
    frames, seconds = index(program, movie, models.library(name, movie.models()), db, arguments.params)
    sightings = [json.loads(line) for line in program("export", "--db", db, "--format", "sightings").splitlines()]
    result = tally(movie, sightings)
    result.frames, result.seconds = frames, seconds
    flags = ("--db", db, "--truth", movie.truth, "--models", ",".join(movie.models()), "--json")
    score = result.score = json.loads(program("evaluate", *flags))
    total = result.total()
    counted = {"sighting_precision": total.precision(), "sighting_recall": total.recall()}
    disagreements = differences(score, counted, f"{name}: evaluate beside the counts:")
    if arguments.tool:
        reported = score_by_tool(arguments.tool, movie, program, db)
        disagreements += differences(score, reported, f"{name}: evaluate beside {arguments.tool.name}:")
    for line in disagreements:
        print(line, file=sys.stderr, flush=True)
        arguments.disagreed = True
    return result


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("movies", nargs="*", type=Path, metavar="MOVIE", help="scenes, or folders of movies")
    parser.add_argument("--program", default=str(REPOSITORY / "build/victorious"))
    parser.add_argument("--models", type=Path, default=REPOSITORY / "assets/models", help="NAME.vmodel, or CAD files NAME.glb")
    parser.add_argument("--params", type=Path, help="parameters of the index run, JSON")
    parser.add_argument("--tool", type=Path, help="a scorer that must agree")
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/cad_in_movies", help="flights, indexes")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    scenes = sorted((REPOSITORY / "scenes").glob("*.json"))
    scenes = [path for path in scenes if path.stem != "demo" and not path.stem.startswith("chapter3_")]
    arguments.movies = arguments.movies or scenes
    for path in arguments.movies:
        if not (path / "truth.jsonl").exists() and not path.is_file():
            parser.error(f"{path}: neither a scene nor a folder with video.mp4 and truth.jsonl")
    names = [path.stem for path in arguments.movies]
    if len(set(names)) < len(names):
        parser.error("two movies of one name: rename one")
    arguments.disagreed = False
    return arguments


def fractions(total: Tally) -> dict:
    return {"precision": total.precision(), "recall": total.recall(), "view": ratio(total.right_view, total.with_view),
            "detected": total.detected, "clear": total.clear_rows}  # fmt: skip


def objects_of(scores: list[dict]) -> dict:
    """What `evaluate` says of the objects of these movies."""
    ids = [one["ids"] for score in scores for one in score["per_object"].values() if one["ids"]]
    return {key: sum(score[key] for score in scores) for key in ("found", "findable", "false_objects")} | {
        "ids_per_object": ratio(sum(ids), len(ids))}  # fmt: skip


def place_of(score: dict) -> dict:
    errors = [one["error_m"] for one in score["per_object"].values() if one["error_m"] is not None]
    return {key: score[key] for key in ("cep50_m", "cep75_m", "cep90_m")} | {"errors_m": errors}


def report_of(results: dict[str, Result], pooled: dict[str, Tally]) -> dict:
    """What --json prints."""
    places = {name: place_of(result.score) for name, result in results.items()}
    report = {name.replace(" ", "_"): fractions(total) for name, total in pooled.items()}
    for name, result in results.items():
        report[name] = fractions(result.total()) | objects_of([result.score]) | places[name]
    report["all"] |= objects_of([result.score for result in results.values()])
    farthest = max(places, key=lambda name: places[name]["cep90_m"] or 0, default=None)
    return report | ({"farthest": {"movie": farthest} | places[farthest]} if farthest else {})


def run(arguments: argparse.Namespace, program: Program, models: Models) -> tuple[dict[str, Result], dict[str, Tally]]:
    """Prints one row per movie. Returns the results by movie, and the sums."""
    pooled: dict[str, Tally] = {"all": Tally(), "without noise": Tally(), "with noise": Tally()}
    results: dict[str, Result] = {}
    shown_on = sys.stderr if arguments.json else sys.stdout
    print(HEAD, file=shown_on, flush=True)
    for path in arguments.movies:
        folder = simulated(program, path, arguments.work)
        named = Movie(folder).models()
        movie = Movie(folder, {name for name in named if models.has(name)})
        for name in sorted(set(named) - set(movie.models())):
            print(f"{path}: no {arguments.models / name}.vmodel or .glb: not searched for", file=sys.stderr, flush=True)
        if not movie.models():
            continue
        result = results[path.stem] = measure(program, movie, path.stem, models, arguments)
        recalls = "  ".join(f"{name} {shown(value)}" for name, value in result.recall_of.items())
        print(result.total().line(path.stem, recalls), file=shown_on, flush=True)
        noise = noise_of(path)
        pooled["all"].add(result.total())
        if noise is not None:
            pooled["with noise" if noise else "without noise"].add(result.total())
        for model, of_model in result.of_model.items():
            pooled.setdefault(model, Tally()).add(of_model)
    return results, pooled


def main() -> int:
    arguments = parse()
    arguments.work.mkdir(parents=True, exist_ok=True)
    program = Program(arguments.program)
    with tempfile.TemporaryDirectory() as scratch:
        results, pooled = run(arguments, program, Models(program, arguments.models, Path(scratch)))
    if arguments.json:
        print(json.dumps(report_of(results, pooled)))
        return 1 if arguments.disagreed else 0
    print()
    for name, total in pooled.items():
        if total.clear_rows:
            print(total.line(name))
    return 1 if arguments.disagreed else 0


if __name__ == "__main__":
    sys.exit(main())
