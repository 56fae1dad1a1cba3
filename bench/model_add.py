#!/usr/bin/env python3
"""Measures how long `victorious model add` takes for CAD files, each by default and alone.

Usage: model_add.py FILE... [--program FILE]

Prints JSON: `least_s`, `median_s` and `greatest_s`, the wall time of an addition, and `seconds` of each file.
"""

import argparse
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPOSITORY / "bench/accuracy"))
from movies import Program


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--program", default=str(REPOSITORY / "build/victorious"))
    arguments = parser.parse_args()
    program, seconds = Program(arguments.program), {}
    with tempfile.TemporaryDirectory() as library:
        for file in arguments.files:
            begun = time.monotonic()
            program("model", "add", file.stem, file, "--models", library)
            seconds[file.stem] = round(time.monotonic() - begun, 1)
            print(f"{file.stem}: {seconds[file.stem]} s", file=sys.stderr, flush=True)
    all_s = list(seconds.values())
    print(json.dumps({"least_s": min(all_s), "median_s": statistics.median(all_s), "greatest_s": max(all_s), "seconds": seconds}))


if __name__ == "__main__":
    main()
