#!/usr/bin/env python3
"""Measures the rate of false positives in videos without the objects.

Usage: false_objects.py [VIDEO...] --models DIR [--program build/victorious] [--flights 10] [--first 1] [--frames 60]
                        [--fps 1] [--params FILE] [--work build/false_objects] [--json]

All models of DIR (*.vmodel, or else CAD files, *.glb) are searched for together in videos that do not contain them:
FLIGHTS simulated flights of FRAMES frames at FPS frames/s over towns without them, from number FIRST on, and each
VIDEO. The flight number seeds the town and its parked vehicles, the sun, the height, off-nadir angle, speed and
rotation of the camera, noise, blur and sensor noise. The vehicles of assets/models parked in the towns are of other
makes than those of DIR, but similar (distractors). Flights that exist in WORK are reused, models made there of CAD
files, and what the same program has counted in a video with the same models and parameters: a run that was stopped
goes on.

Prints one row per video: frames, duration in seconds, sightings, objects, and frames/s of `victorious index`. Then, per
kind of video and in total: false objects, false objects per hour, and the 95 % upper limit of the Poisson rate; with
--json these as an object instead, with `videos`: the counts of each, and `curve`: the false objects an hour by the least
score that counts. `sightings` and `objects` are without weak finds, whose number is `weak`; `scores` are of both.
"""

import argparse
import hashlib
import json
import math
import random
import re
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from movies import Program

REPOSITORY = Path(__file__).resolve().parents[2]
CURVE = (0, 0.1, 0.25, 0.5, 0.75, 0.9)  # scores


@dataclass
class Tally:
    frames: int = 0
    seconds: float = 0
    sightings: int = 0
    objects: int = 0
    weak: int = 0
    scores: list[float] = field(default_factory=list)  # of objects and weak finds

    def add(self, other: "Tally"):
        for name in vars(self):
            setattr(self, name, getattr(self, name) + getattr(other, name))

    def hourly(self) -> float:
        return self.objects / self.seconds * 3600

    def below(self) -> float:
        """95 % upper limit of the objects an hour."""
        return upper_limit(self.objects) / self.seconds * 3600

    def curve(self) -> dict[str, float]:
        """Objects an hour that score as much, by score."""
        return {str(least): sum(score >= least for score in self.scores) / self.seconds * 3600 for least in CURVE}


def upper_limit(count: int, confidence: float = 0.95) -> float:
    """The mean of the Poisson distribution that exceeds COUNT with this probability."""
    below, above = 0.0, 2.0 * count + 20

    def share(mean: float) -> float:
        return sum(math.exp(-mean + k * math.log(mean) - math.lgamma(k + 1)) for k in range(count + 1))

    for _ in range(80):
        middle = (below + above) / 2
        below, above = (middle, above) if share(middle) > 1 - confidence else (below, middle)
    return above


def empty_town(number: int, frames: int, fps: float) -> dict:
    lot = random.Random(number)
    start = [lot.uniform(-80, 80), lot.uniform(-60, 60)]
    away = lot.uniform(0, 2 * math.pi)
    length = min(lot.uniform(1, 5) * frames / fps, 120)
    heading = lot.uniform(0, 360)
    return {
        "assets": str(REPOSITORY / "assets"),
        "seed": number,
        "video": {
            "frames": frames, "fps": fps, "width": 640, "height": 480, "hfov_deg": 16,
            "noise": lot.choice([0, 0, 0.05, 0.1, 0.15]), "grain": lot.choice([0, 2, 4]), "blur_px": lot.choice([0, 0, 0.7]),
        },
        "origin": {"latitude_deg": 48.137, "longitude_deg": 11.575, "altitude_m": 565, "heading_deg": lot.uniform(0, 360)},
        "sun": {
            "azimuth_deg": lot.uniform(0, 360), "elevation_deg": lot.uniform(15, 65), "strength": lot.choice([0.5, 1.2, 2]),
            "sky": 0.55, "ground": 0.3,
        },
        "camera": {
            "path": "smooth",
            "aim_m": [start, [start[0] + length * math.cos(away), start[1] + length * math.sin(away)]],
            "from_deg": [heading, heading + lot.uniform(-120, 120)],
            "off_nadir_deg": lot.uniform(10, 60), "range_m": lot.uniform(90, 200), "roll_deg": lot.uniform(-8, 8),
        },
        "town": {"seed": number, "density": lot.uniform(0.5, 1), "squares": [-10, -9, 10, 9]},
    }  # fmt: skip


def flight(program: Program, number: int, work: Path, frames: int, fps: float) -> Path:
    folder = work / f"town{number}_{frames}_{fps:g}"
    if not (folder / "video.mp4").exists():  # written last
        file = work / f"{folder.name}.json"
        file.write_text(json.dumps(empty_town(number, frames, fps)))
        print(f"simulating {file}", file=sys.stderr, flush=True)
        program("simulate", file, "--out", folder)
    return folder / "video.mp4"


def digest_of(*files: Path | None) -> str:
    """Of the content of files; folders stand for the files in them."""
    digest = hashlib.sha256()
    for file in files:
        for one in sorted(file.iterdir()) if file and file.is_dir() else [file]:
            digest.update(one.read_bytes() if one else b"none")
    return digest.hexdigest()


def count(program: Program, video: Path, library: Path, db: Path, params: Path | None, origin: str) -> tuple[Tally, float]:
    """What `index` finds in the video, and how long it takes, s. Origin: the digest of what it depends on."""
    kept = db.with_suffix(".counts.json")
    if kept.exists() and (before := json.loads(kept.read_text()))["origin"] == origin:
        return Tally(**before["tally"]), before["took_s"]
    tally, took = count_anew(program, video, library, db, params)
    kept.write_text(json.dumps({"origin": origin, "tally": vars(tally), "took_s": took}))
    return tally, took


def count_anew(program: Program, video: Path, library: Path, db: Path, params: Path | None) -> tuple[Tally, float]:
    for leftover in db.parent.glob(f"{db.name}*"):
        leftover.unlink()
    telemetry = video.parent / "telemetry.csv"
    begun = time.monotonic()
    reported = program.run("index", video, "--models", library, "--db", db,
                       *(["--telemetry", telemetry] if telemetry.exists() else []),
                       *(["--params", params] if params else [])).stderr  # fmt: skip
    took = time.monotonic() - begun
    sightings = program("export", "--db", db, "--format", "sightings").splitlines()
    objects = program("export", "--db", db, "--format", "objects").splitlines()
    listed = [json.loads(line) for line in program("export", "--db", db, "--format", "objects", "--weak").splitlines()]
    for one in listed:
        print(f"  {video}: {one['model']}, score {one['score']:.3f}, {one['frames']} frames", file=sys.stderr, flush=True)
    frames = int(re.search(r"(\d+) frames searched", reported)[1])
    frame_rate = json.loads(program("doctor", video, "--json"))["frame_rate"]
    scores = [one["score"] for one in listed]
    return Tally(frames, frames / frame_rate, len(sightings), len(objects), len(listed) - len(objects), scores), took


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("videos", nargs="*", type=Path, metavar="VIDEO")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--program", default=REPOSITORY / "build/victorious")
    parser.add_argument("--flights", type=int, default=10)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--fps", type=float, default=1)
    parser.add_argument("--params", type=Path)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/false_objects")
    arguments = parser.parse_args()
    program, work = Program(str(arguments.program)), arguments.work
    work.mkdir(parents=True, exist_ok=True)
    is_ready = any(arguments.models.glob("*.vmodel"))
    library = arguments.models if is_ready else work / "models"
    for file in [] if is_ready else sorted(arguments.models.glob("*.glb")):
        if not (library / f"{file.stem}.vmodel").exists():
            print(f"adding {file.stem}", file=sys.stderr, flush=True)
            program("model", "add", file.stem, file, "--models", library)
    print(f"{len(list(library.glob('*.vmodel')))} models", file=sys.stderr)

    origin = digest_of(Path(program.path), library, arguments.params)
    shown = sys.stderr if arguments.json else sys.stdout
    counts: dict[str, dict] = {}
    of_kind = {"empty town": Tally(), "video": Tally(), "together": Tally()}
    print(f"{'':<40}{'frames':>8}{'seconds':>9}{'sightings':>11}{'objects':>9}{'frames/s':>10}", file=shown)
    towns = [flight(program, n, work, arguments.frames, arguments.fps) for n in range(arguments.first, arguments.first + arguments.flights)]
    for kind, videos in (("empty town", towns), ("video", arguments.videos)):
        for video in videos:
            name = video.parent.name if kind == "empty town" else video.stem
            tally, took = count(program, video, library, work / f"{name}.db", arguments.params, origin)
            counts[name] = dict(vars(tally))
            of_kind[kind].add(tally)
            of_kind["together"].add(tally)
            print(f"{name:<40}{tally.frames:>8}{tally.seconds:>9.0f}{tally.sightings:>11}{tally.objects:>9}"
                  f"{tally.frames / took:>10.2f}", file=shown, flush=True)  # fmt: skip
    for kind, tally in of_kind.items():
        if tally.seconds:
            print(f"{kind}: {tally.objects} false objects in {tally.frames} frames, {tally.seconds:.0f} s: "
                  f"{tally.hourly():.1f} an hour, below {tally.below():.1f} with 95 %; {tally.weak} weak finds", file=shown)  # fmt: skip
    if arguments.json:
        print(json.dumps({kind.replace(" ", "_"): vars(tally) | {"hourly": tally.hourly(), "below": tally.below(), "curve": tally.curve()}
                          for kind, tally in of_kind.items() if tally.seconds} | {"videos": counts}))  # fmt: skip


if __name__ == "__main__":
    main()
