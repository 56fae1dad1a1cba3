#!/usr/bin/env python3
"""Measures how fast `victorious index` searches movies for a few CAD models, by default, as a user sees it the first time.

Usage: index_speed.py MOVIE... --models LIBRARY --names NAME... [--program FILE]

MOVIE is a folder with video.mp4 and telemetry.csv, of one row a frame; LIBRARY a folder of models (`victorious model add`),
of which NAME... are searched for. Each movie is indexed with an empty cache, so that relit templates are made. Prints
JSON, of each movie:

  frames_per_s           frames of the video / wall time of `index`: opening it, and the estimate of the sun included
  wall_s, processor_s, peak_mb
"""

import argparse
import json
import tempfile
from pathlib import Path

from model_growth import REPOSITORY, index, link_models


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("movies", nargs="+", type=Path, metavar="MOVIE")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--names", nargs="+", required=True)
    parser.add_argument("--program", type=Path, default=REPOSITORY / "build/victorious")
    arguments = parser.parse_args()
    results = {}
    for movie in arguments.movies:
        with tempfile.TemporaryDirectory() as name:
            work = Path(name)
            link_models(arguments.models, 1, work / "models", arguments.names)
            used = index(arguments.program, movie, work / "models", work)
        frames = len((movie / "telemetry.csv").read_text().splitlines()) - 1
        results[movie.name] = {"frames_per_s": round(frames / used["wall_s"], 2)} | used
    print(json.dumps(results))


if __name__ == "__main__":
    main()
