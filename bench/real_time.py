#!/usr/bin/env python3
"""Measures whether a long video at 30 frames/s is indexed faster than it plays, and its memory while it is.

Usage: real_time.py --models DIR [--library DIR] [--size WxH] [--hfov DEG] [--seconds S] [--passes N] [--params FILE]
                    [--program FILE] [--make-stream FILE] [--work DIR]

Simulates a flight of S seconds (default 60) in frames of W x H pixels (640x480; hfov 16 degrees) over a town in which twelve of the CAD models of DIR (NAME.glb) stand, into WORK/flight
unless that folder exists, and plays it N times one after the other (make-stream; default 1, which is the flight itself). All
models of DIR are made into the library, WORK/models by default, unless they are there. The video is indexed by
default twice: `first` makes the relit templates, `again` finds them on disk. Prints JSON; of each run:

  real_time    duration of the video / wall time of `victorious index`, opening it and its start included
  processor_s  processor time
  stages_s     of it, each stage's
  peak_mb      largest resident memory
  memory_mb    its course: [s since the start, resident, of this private], each second; files that are mapped, the
               models and the libraries, are resident, but not private: the system can drop them

`accuracy` is what `victorious evaluate` says of a single pass.
"""

import argparse
import json
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPOSITORY / "bench/accuracy"))
from movies import Program

FPS = 30
SPEED_M_S = 10
NAMES = ["abrams", "humvee", "fire_truck", "mig29", "apache", "tanker_truck", "police_car", "jeep", "blackhawk",
         "semi_tractor", "pickup", "ambulance"]  # fmt: skip
ACCURACY = ("found", "findable", "false_objects", "sighting_recall", "sighting_precision", "cep50_m")


def scene(models: Path, size: tuple[int, int], hfov_deg: float, seconds: int) -> dict:
    path_m = SPEED_M_S * seconds
    step_m = path_m / len(NAMES)
    objects = [
        {
            "id": f"{name}-1", "model": name, "file": str((models / f"{name}.glb").resolve()),
            "x_m": -path_m / 2 + (i + 0.5) * step_m, "y_m": [3, -4, 5][i % 3], "heading_deg": i * 73 % 360,
        }
        for i, name in enumerate(NAMES)
    ]  # fmt: skip
    return {
        "assets": str(REPOSITORY / "assets"),
        "seed": 5,
        "video": {
            "frames": seconds * FPS, "fps": FPS, "width": size[0], "height": size[1], "hfov_deg": hfov_deg, "grain": 2,
        },
        "origin": {"latitude_deg": 48.137, "longitude_deg": 11.575, "altitude_m": 565, "heading_deg": 17},
        "sun": {"azimuth_deg": 112, "elevation_deg": 52, "strength": 0.5, "sky": 0.58, "ground": 0.3},
        "camera": {
            "path": "linear", "aim_m": [[-path_m / 2, 0], [path_m / 2, 0]], "from_deg": 186, "off_nadir_deg": 35,
            "range_m": 125, "roll_deg": 2,
        },
        "objects": objects,
        "town": {"seed": 11, "density": 0.6},
    }  # fmt: skip


def repeat_telemetry(rows: list[str], pass_s: int, passes: int) -> str:
    lines = [rows[0]]
    for number in range(passes):
        for row in rows[1:]:
            seconds, rest = row.split(",", 1)
            lines.append(f"{float(seconds) + number * pass_s:.6f},{rest}")
    return "\n".join(lines) + "\n"


def make_video(program: Program, make_stream: Path, flown: dict, seconds: int, work: Path, passes: int) -> tuple[Path, Path]:
    flight = work / "flight"
    if not (flight / "video.mp4").exists():  # written last
        file = work / "flight.json"
        file.write_text(json.dumps(flown))
        print(f"simulating {file}", file=sys.stderr, flush=True)
        program("simulate", file, "--out", flight)
    telemetry = flight / "telemetry.csv"
    if passes == 1:
        return flight / "video.mp4", telemetry
    stream, long_telemetry = work / f"{passes}.ts", work / f"{passes}.csv"
    subprocess.run([make_stream, flight / "video.mp4", stream, str(passes)], check=True)
    long_telemetry.write_text(repeat_telemetry(telemetry.read_text().splitlines(), seconds, passes))
    return stream, long_telemetry


def resident_mb(process: int) -> tuple[float, float] | None:
    """All, and of this private; None once the process has ended."""
    try:
        status = Path(f"/proc/{process}/status").read_text()
    except OSError:
        return None
    found = [re.search(rf"^{name}:\s+(\d+)", status, re.MULTILINE) for name in ("VmRSS", "RssAnon")]
    return tuple(int(one[1]) / 1024 for one in found) if all(found) else None


def index(program: Program, video: Path, telemetry: Path, library: Path, work: Path, db: Path, params: Path | None) -> dict:
    for leftover in work.glob(f"{db.name}*"):
        leftover.unlink()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.monotonic()
    log = work / f"{db.stem}.log"  # not a pipe, which an hour's progress would fill
    process = subprocess.Popen(
        [program.path, "index", video, "--telemetry", telemetry, "--models", library, "--db", db, "--cache", work / "cache",
         "--json", *(["--params", params] if params else [])],
        stdout=subprocess.PIPE, stderr=log.open("w"), text=True,
    )  # fmt: skip
    course = []
    while process.poll() is None:
        time.sleep(1)
        if (memory := resident_mb(process.pid)) is not None:
            course.append([round(time.monotonic() - begun), *(round(one) for one in memory)])
    if process.returncode != 0:
        sys.exit(f"index {video}: {log.read_text().strip()}")
    wall_s = time.monotonic() - begun
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "wall_s": round(wall_s, 1),
        "processor_s": round(used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime, 1),
        "stages_s": {name: round(s, 2) for name, s in json.loads(process.stdout.read())["stages_s"].items()},
        "peak_mb": max(memory for _, memory, _ in course),
        "memory_mb": course,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--library", type=Path, help="models of DIR (default: WORK/models)")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--hfov", type=float, default=16)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--passes", type=int, default=1)
    parser.add_argument("--params", type=Path, help="of index")
    parser.add_argument("--program", default=str(REPOSITORY / "build/victorious"))
    parser.add_argument("--make-stream", type=Path, default=REPOSITORY / "build/make-stream")
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build/real_time")
    arguments = parser.parse_args()
    program, work = Program(arguments.program), arguments.work
    library = arguments.library or work / "models"
    for folder in (work, library):
        folder.mkdir(parents=True, exist_ok=True)
    files = sorted(arguments.models.glob("*.glb"))
    for file in files:
        if not (library / f"{file.stem}.vmodel").exists():
            print(f"adding {file.stem}", file=sys.stderr, flush=True)
            program("model", "add", file.stem, file, "--models", library)
    seconds, passes = arguments.seconds, arguments.passes
    flown = scene(arguments.models, tuple(map(int, arguments.size.split("x"))), arguments.hfov, seconds)
    video, telemetry = make_video(program, arguments.make_stream, flown, seconds, work, passes)
    result = {"models": len(files), "size": arguments.size, "passes": passes, "video_s": passes * seconds, "frames_per_s": FPS}
    for name in ("first", "again"):
        print(f"indexing {video}: {name}", file=sys.stderr, flush=True)
        run = index(program, video, telemetry, library, work, work / f"{name}.db", arguments.params)
        result[name] = {"real_time": round(result["video_s"] / run["wall_s"], 2)} | run
    if passes == 1:
        truth = work / "flight/truth.jsonl"
        scored = json.loads(program("evaluate", "--db", work / "again.db", "--truth", truth, "--json"))
        result["accuracy"] = {name: scored[name] for name in ACCURACY}
    print(json.dumps(result))


if __name__ == "__main__":
    main()
