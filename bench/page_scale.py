#!/usr/bin/env python3
"""page_scale.py VICTORIOUS [--postgres] [--api] [--videos N] [--objects N] [--sightings N] [--decided N]: makes a large
index (make-large-index, beside the program) in a temporary folder, or with --postgres in a scratch server of PostgreSQL,
serves it, and measures the page by page_scale.mjs, whose JSON it prints.

Default: 1000 videos of 50 objects; in a file 100 sightings of each object, 5 million in all, in PostgreSQL 20, 1 million.
Of the objects, 2000 are decided: every second one is accepted. --api measures the routes alone, without a browser. The
server of PostgreSQL has 256 MB of buffers, and statistics, as after a while of its autovacuum.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
BATCH = 500  # objects of a request


def decide(url: str, count: int) -> None:
    """Reviews the best objects: the odd ones are accepted, the others rejected."""
    cursor, done = None, 0
    while done < count:
        page = f"{url}/api/v1/objects?sort=rank&limit={BATCH}" + (f"&cursor={cursor}" if cursor else "")
        with urllib.request.urlopen(page) as answer:
            found = json.load(answer)
        for one in found["objects"][: count - done]:
            body = json.dumps({"verdict": "accepted" if done % 2 else "rejected"}).encode()
            request = urllib.request.Request(f"{url}/api/v1/objects/{one['id']}/review", body,
                                             {"Content-Type": "application/json"}, method="PUT")  # fmt: skip
            urllib.request.urlopen(request).close()
            done += 1
        cursor = found["next_cursor"]
        if cursor is None:
            return


def measure(arguments, index: str) -> None:
    command = [arguments.victorious, "serve", "--db", index, "--listen", "127.0.0.1:0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            url = next(word for word in server.stdout.readline().split() if word.startswith("http")).rstrip("/")
            decide(url, arguments.decided)
            flags = ["--api"] if arguments.api else []
            subprocess.run(["node", REPOSITORY / "bench" / "page_scale.mjs", url, *flags], check=True)
        finally:
            server.terminate()


def fill(arguments, index: str, sightings: int) -> None:
    make = Path(arguments.victorious).resolve().parent / "make-large-index"
    numbers = [str(one) for one in (arguments.videos, arguments.objects, arguments.sightings or sightings)]
    subprocess.run([make, index, *numbers], check=True, stdout=sys.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("victorious")
    parser.add_argument("--postgres", action="store_true")
    parser.add_argument("--api", action="store_true")
    parser.add_argument("--videos", type=int, default=1000)
    parser.add_argument("--objects", type=int, default=50)
    parser.add_argument("--sightings", type=int)
    parser.add_argument("--decided", type=int, default=2000)
    arguments = parser.parse_args()
    if not arguments.postgres:
        with tempfile.TemporaryDirectory() as folder:
            index = str(Path(folder) / "large.db")
            fill(arguments, index, 100)
            measure(arguments, index)
        return 0
    script = [REPOSITORY / "tools" / "scratch_postgres.sh", "shared_buffers=256MB", "autovacuum=on", "max_wal_size=4GB"]
    with subprocess.Popen(script, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as postgres:
        url = postgres.stdout.readline().strip()
        if not url.startswith("postgresql://"):
            print(f"page_scale.py: {url}", file=sys.stderr)
            return 1
        fill(arguments, url, 20)
        subprocess.run(["psql", url, "--quiet", "--command", "VACUUM ANALYZE"], check=True)
        measure(arguments, url)
        postgres.stdin.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
