#!/usr/bin/env python3
"""Compares the speed of two builds: compare_builds.py BASE BUILD [NAME...] [--rounds N] [--slower RATIO].

BASE and BUILD are `victorious-bench` programs, the one before a change and the one with it, each beside its
`victorious`. In each round both run every named benchmark (default: match search locate associate track), one after the
other, and who begins alternates: what else the machine does then costs both alike. Prints, for each figure, the median
of the rounds of both in ms, and the median of the ratio BUILD / BASE with its lowest and highest. A figure is slower,
or faster, if all rounds agree and the median differs by more than RATIO (default 1.05). Exit status 1 if a figure is
slower, 2 if a program fails.
"""

import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path

STAGES = ["match", "search", "locate", "associate", "track"]


def medians_ms(program: Path, name: str) -> dict[str, float]:
    """The times that a benchmark reports, by figure."""
    done = subprocess.run([program, name, "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{program} {name}: {done.stderr.strip() or f'exit status {done.returncode}'}", file=sys.stderr)
        sys.exit(2)
    return {figure: entry["median_ms"] for figure, entry in json.loads(done.stdout).items()}


def judge(ratios: list[float], slower: float) -> str:
    median = statistics.median(ratios)
    if median > slower and min(ratios) > 1:
        return "slower"
    if median < 1 / slower and max(ratios) < 1:
        return "faster"
    return ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", type=Path)
    parser.add_argument("build", type=Path)
    parser.add_argument("names", nargs="*", default=STAGES)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--slower", type=float, default=1.05)
    arguments = parser.parse_args()
    if arguments.rounds < 1 or arguments.slower <= 1:
        parser.error("--rounds is at least 1, --slower above 1")
    for program in (arguments.base, arguments.build):
        if not program.is_file():
            parser.error(f"{program}: no such program; give a victorious-bench")

    rounds: dict[str, list[tuple[float, float]]] = {}  # by figure: ms of base and build
    for i in range(arguments.rounds):
        for name in arguments.names:
            order = [arguments.base, arguments.build] if i % 2 == 0 else [arguments.build, arguments.base]
            measured = {program: medians_ms(program, name) for program in order}
            for figure, build_ms in measured[arguments.build].items():
                if figure in measured[arguments.base]:
                    rounds.setdefault(figure, []).append((measured[arguments.base][figure], build_ms))

    any_slower = False
    print(f"{'figure':32} {'base ms':>10} {'build ms':>10}   ratio (lowest to highest)")
    for figure, times in rounds.items():
        ratios = [build / base for base, build in times]
        verdict = judge(ratios, arguments.slower)
        any_slower |= verdict == "slower"
        base_ms, build_ms = (statistics.median(one) for one in zip(*times))
        print(f"{figure:32} {base_ms:10.3f} {build_ms:10.3f}   {statistics.median(ratios):.3f} "
              f"({min(ratios):.3f} to {max(ratios):.3f}) {verdict}".rstrip())
    return 1 if any_slower else 0


if __name__ == "__main__":
    sys.exit(main())
