#!/usr/bin/env python3
"""Measures what indexing VIDEOs costs a cluster, and extrapolates it to archives of up to a million hours.

Usage: cost.py VIDEO.mp4... --models DIR [--rounds N] [--quality NAME] [--minutes M] [--days D] [--cores C]
[--core-hour PRICE] [--terabyte-month PRICE]; VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the programs, as for
tests/e2e.

In each round, one worker of one thread indexes a copy of the videos, under other hashes, into the same PostgreSQL
database, which syncs every commit. Telemetry of VIDEO.mp4 is VIDEO.telemetry.csv, or telemetry.csv of its folder.
Prints JSON: `rounds`, what each added; `growth`, the last round over the first one: 1 where the cost of a video does
not depend on what the index holds; `per_hour`, of an hour of video, the mean of all rounds; `archives`: for some
sizes what it takes to index them within D days on machines of C cores, as videos of M minutes. Prices are
assumptions. What a video costs once, whatever its length, counts for each: give videos as long as those of the
archive.
"""

import argparse
import json
import os
import resource
import shutil
import struct
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program
from cluster_soak import Difference, Server, Worker, succeed

HOURS = (1_000, 10_000, 100_000, 1_000_000)
TABLES = ("sightings", "kept_frames", "tracklets", "objects", "kept_fits", "tasks", "task_log")
# The bytes of each table with its parts, indexes and long values.
SIZES = """SELECT parent, sum(pg_total_relation_size(relid)) FROM (
  SELECT t.parent, p.relid FROM unnest(ARRAY[{names}]) t(parent),
    pg_partition_tree(('victorious.' || t.parent)::regclass) p
  UNION SELECT t.parent, ('victorious.' || t.parent)::regclass FROM unnest(ARRAY[{names}]) t(parent)
) parts GROUP BY parent"""


class Database:
    def __init__(self, server: Server):
        self.server = server
        self.url = server.make_database("cost")

    def number(self, statement: str) -> float:
        return float(self.server.query(statement, self.url)[0][0])

    def sample(self) -> dict[str, float]:
        """What only grows, up to now."""
        sizes = self.server.query(SIZES.format(names=",".join(f"'{table}'" for table in TABLES)), self.url)
        return {
            "video_s": self.number("SELECT coalesce(sum(duration_s), 0) FROM victorious.videos"),
            "frames": self.number("SELECT coalesce(sum(frame_count), 0) FROM victorious.videos"),
            "processor_s": processor_s(),
            "server_processor_s": server_processor_s(self.server.pid()),
            "commits": self.number("SELECT xact_commit FROM pg_stat_database WHERE datname = current_database()"),
            "wal_bytes": self.number("SELECT pg_wal_lsn_diff(pg_current_wal_lsn(), '0/0')"),
            **{f"{table}_rows": self.number(f"SELECT count(*) FROM victorious.{table}") for table in TABLES},
            **{f"{table}_bytes": float(size) for table, size in sizes},
        }


def processor_s() -> float:
    """Of the processes that have ended, and of those that they waited for: workers and what they run."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def server_processor_s(pid: int) -> float:
    """Of the server and its sessions that have ended."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def copy_video(video: Path, folder: Path, number: int) -> Path:
    """The same video with another hash: a box of type `free` (ISO 14496-12) at its end."""
    target = folder / f"{video.stem}{number}.mp4"
    shutil.copyfile(video, target)
    target.chmod(0o644)
    with open(target, "ab") as file:
        file.write(struct.pack(">I4sQ", 16, b"free", number))
    for telemetry in (video.with_suffix(".telemetry.csv"), video.parent / "telemetry.csv"):
        if telemetry.exists():
            shutil.copyfile(telemetry, target.with_suffix(".telemetry.csv"))
            break
    return target


def measure(arguments, server: Server, folder: Path) -> list[dict]:
    database = Database(server)
    options = ["--quality", arguments.quality] if arguments.quality else []
    rounds = []
    for number in range(arguments.rounds):
        place = folder / str(number)
        place.mkdir()
        videos = []
        for i, video in enumerate(arguments.videos):
            (place / str(i)).mkdir()
            videos.append(copy_video(video, place / str(i), number))
        succeed("submit", *videos, "--models", arguments.models, "--db", database.url, *options)
        server.query("VACUUM ANALYZE", database.url)
        os.environ["XDG_CACHE_HOME"] = str(place / "cache")  # templates are made again, as for other videos
        before, begun = database.sample(), time.monotonic()
        worker = Worker(database.url, folder / "worker.log", "--until-empty")
        worker.process.wait()
        worker.check_end()
        seconds = time.monotonic() - begun
        time.sleep(1)  # the server publishes its counters when a session ends
        after = database.sample()
        if after["video_s"] <= before["video_s"]:
            raise Difference(f"nothing was indexed: {(folder / 'worker.log').read_text()}")
        rounds.append({"seconds": seconds} | {key: after[key] - before[key] for key in after})
        print(f"round {number + 1} of {arguments.rounds}: {seconds:.0f} s", file=sys.stderr)
    return rounds


def per_hour(rounds: list[dict], minutes: float) -> dict:
    total = {key: sum(one[key] for one in rounds) for key in rounds[0]}
    hours = total["video_s"] / 3600
    tasks = 60 / minutes
    # The first submission of a task and its two events; the measured videos are shorter than those of an archive.
    rows = {table: total[f"{table}_rows"] / hours for table in TABLES} | {"tasks": tasks, "task_log": 2 * tasks}
    kept = {table: total[f"{table}_bytes"] / hours / 1e6 for table in TABLES if table not in ("tasks", "task_log")}
    return {
        "core_hours": total["processor_s"] / 3600 / hours,
        "server_core_hours": total["server_processor_s"] / 3600 / hours,
        "tasks": tasks,
        "rows": sum(rows.values()),
        "sightings": rows["sightings"],
        "bytes_a_sighting": total["sightings_bytes"] / max(1, total["sightings_rows"]),
        "megabytes": sum(kept.values()),
        "megabytes_of_kept_frames": kept["kept_frames"],
        "wal_megabytes": total["wal_bytes"] / hours / 1e6,
        "transactions": total["commits"] / hours,
    }


def growth(first: dict, last: dict) -> dict:
    return {key: last[key] / first[key] for key in first if first[key] > 0}


def archive(hours: int, hour: dict, arguments) -> dict:
    seconds = arguments.days * 86_400
    core_hours, terabytes = hours * hour["core_hours"], hours * hour["megabytes"] / 1e6
    return {
        "hours": hours,
        "core_hours": core_hours,
        "machines": core_hours / (arguments.days * 24) / arguments.cores,
        "server_cores": hours * hour["server_core_hours"] / (arguments.days * 24),
        "tasks_per_s": hours * hour["tasks"] / seconds,
        "transactions_per_s": hours * hour["transactions"] / seconds,
        "rows_per_s": hours * hour["rows"] / seconds,
        "wal_megabytes_per_s": hours * hour["wal_megabytes"] / seconds,
        "sightings": hours * hour["sightings"],
        "terabytes": terabytes,
        "terabytes_of_kept_frames": hours * hour["megabytes_of_kept_frames"] / 1e6,
        "price_of_cores": core_hours * arguments.core_hour,
        "price_of_storage_a_month": terabytes * arguments.terabyte_month,
    }


def rounded(value):
    if isinstance(value, dict):
        return {key: rounded(one) for key, one in value.items()}
    if isinstance(value, list):
        return [rounded(one) for one in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("videos", nargs="+", type=Path, metavar="VIDEO.mp4")
    parser.add_argument("--models", required=True, metavar="DIR")
    parser.add_argument("--rounds", type=int, default=2, help="copies of the videos (default: 2)")
    parser.add_argument("--quality", default="", help="as of `victorious submit`")
    parser.add_argument("--minutes", type=float, default=10, help="of a video of the archive (default: 10)")
    parser.add_argument("--days", type=float, default=30, help="to index the archive in (default: 30)")
    parser.add_argument("--cores", type=int, default=64, help="of a machine (default: 64)")
    parser.add_argument("--core-hour", type=float, default=0.04, help="price (default: 0.04)")
    parser.add_argument("--terabyte-month", type=float, default=100, help="price (default: 100)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, Server() as server:
        rounds = measure(arguments, server, Path(folder))
    hour = per_hour(rounds, arguments.minutes)
    report = {
        "rounds": rounds,
        "growth": growth(rounds[0], rounds[-1]),
        "per_hour": hour,
        "archives": [archive(hours, hour, arguments) for hours in HOURS],
    }
    print(json.dumps(rounded(report), indent=1))


if __name__ == "__main__":
    main()
