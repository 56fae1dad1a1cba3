#!/usr/bin/env python3
"""Compares what workers write who share each video, segment by segment, with what one process writes.

Usage: segments.py VIDEO.mp4... --models DIR [--workers W] [--segment SECONDS] [--restart FRAMES] [--quality NAME]
[--keep DIR]; VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e. Needs PostgreSQL.

Each video is indexed by one process of one thread into a file, then by W workers of one thread, who start together,
into a PostgreSQL database of its own. Short videos are cut by short segments, and tracks that restart every FRAMES
frames. Telemetry of VIDEO.mp4 is VIDEO.telemetry.csv, or telemetry.csv of its folder. Prints JSON, one object per
video: segments, sightings, seconds of both, and `equal`, whether the exports are the same bytes but for the ids of
objects. Exit status 1 at a difference.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
from cluster_soak import Difference, Server, Worker, exports, numbered, succeed


def place_video(video: Path, folder: Path) -> Path:
    """A link to the video, with its telemetry where `index` looks for it."""
    target = folder / video.name
    target.symlink_to(video.resolve())
    for telemetry in (video.with_suffix(".telemetry.csv"), video.parent / "telemetry.csv"):
        if telemetry.exists():
            shutil.copyfile(telemetry, target.with_suffix(".telemetry.csv"))
            break
    return target


def compare(arguments, video: Path, server: Server, folder: Path, number: int) -> dict:
    params = folder / "params.json"
    params.write_text(json.dumps({"follow": {"restart_interval_frames": arguments.restart}}))
    options = ["--models", arguments.models, "--params", params]
    if arguments.quality:
        options += ["--quality", arguments.quality]
    place = folder / str(number)
    place.mkdir()
    link = place_video(video, place)
    os.environ["XDG_CACHE_HOME"] = str(place / "cache")
    begun = time.monotonic()
    succeed("index", link, *options, "--db", place / "one.db", "--threads", 1)
    one_s = time.monotonic() - begun
    url = server.make_database(f"segments{number}")
    succeed("submit", link, *options, "--db", url, "--segment", arguments.segment)
    os.environ["XDG_CACHE_HOME"] = str(place / "cache_of_workers")
    begun = time.monotonic()
    workers = [Worker(url, place / f"worker{i}.log", "--until-empty") for i in range(arguments.workers)]
    for worker in workers:
        worker.process.wait()
        worker.check_end()
    workers_s = time.monotonic() - begun
    status = json.loads(succeed("cluster", "status", "--db", url, "--json").out)
    if status["done"] != 1 or status["gaps"]:
        raise Difference(f"{video}: not indexed: {json.dumps(status)}")
    of_one, of_workers = exports(place / "one.db"), exports(url)
    forms = ("objects", "sightings")
    return {
        "video": str(video),
        "segments": status["segments"]["done"],
        "sightings": len(of_one["sightings"].splitlines()),
        "one_process_s": round(one_s, 1),
        "workers_s": round(workers_s, 1),
        "equal": all(numbered(of_one[form]) == numbered(of_workers[form]) for form in forms),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("videos", nargs="+", type=Path)
    parser.add_argument("--models", required=True, type=Path)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--segment", type=float, default=2)
    parser.add_argument("--restart", type=int, default=10)
    parser.add_argument("--quality", default="")
    parser.add_argument("--keep", type=Path, help="the indexes and logs are kept in this folder")
    arguments = parser.parse_args()
    are_equal = True
    with tempfile.TemporaryDirectory() as scratch, Server() as server:
        folder = arguments.keep or Path(scratch)
        folder.mkdir(exist_ok=True)
        for number, video in enumerate(arguments.videos):
            compared = compare(arguments, video, server, folder, number)
            are_equal = are_equal and compared["equal"]
            print(json.dumps(compared), flush=True)
    return 0 if are_equal else 1


if __name__ == "__main__":
    sys.exit(main())
