#!/usr/bin/env python3
"""Measures how much of N workers is left when they share one PostgreSQL server: T1 / (N TN), where TN is the time that N
workers take to index the same drawn flights, each worker held to the same quota of processor time.

Usage: cluster_efficiency.py [--workers N]... [--runs R] [--videos V] [--frames F] [--quota Q]; VICTORIOUS_PROGRAM and
VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e. Needs PostgreSQL and, for the quotas, root and control groups.

Each worker has one thread and Q of a core, so that N workers run side by side on a machine that has fewer cores: leave
PostgreSQL some of them. Time is counted from the start of the workers to the end of the last task, by the log of the queue: the
start of a worker, 0.2 s of processor time, is part of it, so that V sets how much it weighs. V should be a multiple of each
N. Each run has every N in turn, on databases of their own. Prints JSON: seconds of each run, and median and range
of T1 / (N TN) over the runs, as `workers_N`.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program
from cluster_soak import Server, Worker, succeed

CGROUPS = Path("/sys/fs/cgroup")
PERIOD_US = 20_000
LIMIT_S = 1800


class Quota:
    """A control group of limited processor time, as a context manager; version 1 or 2 of Linux's interface. Its weight is
    that of ten others, so that it gets its quota beside other work."""

    def __init__(self, name: str, cores: float):
        is_second = (CGROUPS / "cgroup.controllers").exists()
        self.group = (CGROUPS if is_second else CGROUPS / "cpu") / name
        quota_us = round(cores * PERIOD_US)
        if is_second:
            self.limits = {"cpu.max": f"{quota_us} {PERIOD_US}", "cpu.weight": "1000"}
        else:
            self.limits = {
                "cpu.cfs_period_us": str(PERIOD_US),
                "cpu.cfs_quota_us": str(quota_us),
                "cpu.shares": "10240",
            }

    def __enter__(self) -> "Quota":
        self.group.mkdir()
        for name, limit in self.limits.items():
            (self.group / name).write_text(limit)
        return self

    def __exit__(self, *_):
        while True:
            try:
                return self.group.rmdir()
            except OSError:  # its processes are still ending
                time.sleep(0.1)

    def add(self, pid: int) -> None:
        (self.group / "cgroup.procs").write_text(str(pid))


def index_all(server: Server, url: str, workers: int, quota: float, folder: Path) -> float:
    """The seconds that the workers take for what was submitted."""
    quotas = [Quota(f"victorious-{os.getpid()}-{i}", quota) for i in range(workers)]
    begun = time.time()
    running = []
    try:
        for i, group in enumerate(quotas):
            group.__enter__()
            running.append(Worker(url, folder / f"worker{i}.log", "--until-empty"))
            group.add(running[-1].process.pid)
        for worker in running:
            worker.process.wait(timeout=LIMIT_S)
            worker.check_end()
    finally:
        for worker in running:
            worker.process.kill()
            worker.process.wait()
        for group in quotas[: len(running)]:
            group.__exit__()
    ((ended,),) = server.query("SELECT extract(epoch FROM max(at)) FROM victorious.task_log WHERE event = 'done'", url)
    return float(ended) - begun


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, action="append", help="1 2 4 8 if not given")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--videos", type=int, default=32)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--quota", type=float, default=0.18)
    arguments = parser.parse_args()
    counts = sorted({1, *(arguments.workers or (2, 4, 8))})
    seconds: dict[int, list[float]] = {count: [] for count in counts}
    with tempfile.TemporaryDirectory() as scratch, Server() as server:
        folder = Path(scratch)
        videos = []
        for i in range(arguments.videos):
            flight = folder / f"flight{i}"
            flight.mkdir()
            program.make_flight(flight, arguments.frames)
            videos.append(flight / "flight.mkv")
        models = program.make_models(folder / "flight0", folder / "models")
        for run in range(arguments.runs):
            for count in counts:
                url = server.make_database(f"run{run}_{count}")
                succeed("submit", *videos, "--models", models, "--db", url)
                logs = folder / f"run{run}_{count}"
                logs.mkdir()
                seconds[count].append(index_all(server, url, count, arguments.quota, logs))
                done = json.loads(succeed("cluster", "status", "--db", url, "--json").out)["done"]
                if done != len(videos):
                    sys.exit(f"cluster_efficiency.py: {done} of {len(videos)} videos were indexed")
                print(f"run {run + 1}, {count} workers: {seconds[count][-1]:.1f} s", file=sys.stderr, flush=True)
    rows = {}
    for count in counts:
        efficiencies = [one / (count * many) for one, many in zip(seconds[1], seconds[count], strict=True)]
        rows[f"workers_{count}"] = {
            "seconds": [round(one, 1) for one in seconds[count]],
            "efficiency": round(statistics.median(efficiencies), 3),
            "range": [round(min(efficiencies), 3), round(max(efficiencies), 3)],
        }
    print(json.dumps({"quota": arguments.quota, "videos": arguments.videos, "frames": arguments.frames} | rows))


if __name__ == "__main__":
    main()
