#!/usr/bin/env python3
"""Makes a large index (make-large-index, beside the program) with accounts in a temporary folder, serves it by TLS, and
measures the server with many users at once by serve_users.mjs, whose JSON it prints.

Usage: serve_users.py [--users N] [--seconds S] [--sockets N] [--videos N] [--objects N] [--sightings N]; VICTORIOUS_PROGRAM
names the program, as for tests/e2e. Needs Node.js and openssl.

Default: 50 users, 24 s, in the second half of them beside 1000 connections of another client that say nothing; 1000 videos of 50
objects of 100 sightings, 5 million in all.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program

PASSWORD = "correct horse battery"


def add_users(db: Path, count: int) -> None:
    for number in range(1, count + 1):
        done = program.run("user", "add", f"user-{number}", "--role", "analyst", "--db", db, input=PASSWORD + "\n")
        if done.status != 0:
            sys.exit(f"serve_users.py: {done.err.strip()}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--users", type=int, default=50)
    parser.add_argument("--seconds", type=int, default=24)
    parser.add_argument("--sockets", type=int, default=1000)
    parser.add_argument("--videos", type=int, default=1000)
    parser.add_argument("--objects", type=int, default=50, help="of a video")
    parser.add_argument("--sightings", type=int, default=100, help="of an object")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        db = folder / "large.db"
        sizes = (arguments.videos, arguments.objects, arguments.sightings)
        subprocess.run([program.PROGRAM.parent / "make-large-index", db, *map(str, sizes)], check=True, stdout=sys.stderr)
        add_users(db, arguments.users)
        certificate, key = program.self_signed(folder, "server")
        load = (arguments.users, arguments.seconds, arguments.sockets)
        with program.Server(db, "--tls-cert", certificate, "--tls-key", key) as server:
            command = ["node", program.REPOSITORY / "bench/serve_users.mjs", server.url, PASSWORD, *map(str, load)]
            return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
