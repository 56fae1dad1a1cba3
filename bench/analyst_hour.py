#!/usr/bin/env python3
"""An analyst's hour in a browser, each step timed: find the demo's objects, add two videos, box one thing and find it in
the other video, follow it, drop a photo, draw an area on the map, export, and review 200 finds by keyboard.

Usage: analyst_hour.py DEMO MAKE_LARGE_INDEX [SCREENSHOTS]; DEMO is the folder that `make demo` writes, and stays as it is.
VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e; VICTORIOUS_WEB the built page. Prints
JSON: the seconds of each step, `review_ms`: median and maximum of an item. Needs Node.js and /usr/bin/chromium.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/e2e"))
import program

LIMIT_S = 3600


def boxed_frame(truth: Path) -> dict:
    """A frame in the middle of the video that shows the crate whole."""
    rows = [json.loads(line) for line in truth.read_text().splitlines()]
    whole = [row for row in rows if row["model"] == "crate" and row["visible"] > 0.99]
    return max(whole, key=lambda row: row["pixels"])


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    demo, make_large_index = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    shots = Path(sys.argv[3]).resolve() if len(sys.argv) == 4 else None
    web = ["--web", os.environ["VICTORIOUS_WEB"]] if "VICTORIOUS_WEB" in os.environ else []
    os.chdir(demo.parent)  # the index names its video relative to this folder
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(demo / "index.db", folder / "index.db")
        shutil.copytree(demo / "models", folder / "models")
        shutil.copy(program.flight() / "flight.mp4", folder / "one.mp4")
        shutil.copy(program.flight(56) / "flight.mp4", folder / "other.mp4")
        large = folder / "large.db"
        subprocess.run([make_large_index, large, "10", "50", "5"], check=True, stdout=subprocess.DEVNULL)
        row = boxed_frame(program.flight() / "truth.jsonl")
        inputs = {
            "one": str(folder / "one.mp4"),
            "other": str(folder / "other.mp4"),
            "photo": str(program.flight() / "truck.png"),
            "frame": row["frame"],
            "box": row["box"],
            "shots": str(shots) if shots else None,
        }
        if shots:
            shots.mkdir(parents=True, exist_ok=True)
        with (
            program.Server(folder / "index.db", "--models", folder / "models", *web) as first,
            program.Server(large, *web) as second,
        ):
            command = ["node", ROOT / "bench/analyst_hour.mjs", first.url, second.url, json.dumps(inputs)]
            done = subprocess.run(list(map(str, command)), timeout=LIMIT_S, check=False)
    sys.exit(done.returncode)


if __name__ == "__main__":
    main()
