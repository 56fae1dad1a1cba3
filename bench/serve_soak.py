#!/usr/bin/env python3
"""Kills `victorious serve` at random while its jobs index drawn flights and a client reviews what they find; checks that
nothing is lost and nothing doubled.

Usage: serve_soak.py [--kills N] [--seed SEED] [--videos V] [--frames F] [--keep DIR]; VICTORIOUS_PROGRAM and
VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e.

The flights are uploaded, and a job for each indexes it. The server is killed (SIGKILL) after random times, 3 s on
average, and started again, until N kills; jobs are asked for, one after the other, until then. At the end, once all jobs
have ended:
- each job is done, by its list;
- each review that was answered with 200 is the one decision about its object, unless a later one was on its way when the
  server was killed;
- the sightings of each video are those of one `victorious index` that nobody disturbs;
- `victorious doctor --check` finds no damage.
Prints JSON: kills, jobs, reviews. Exit status 1 and the reason at the first difference.
"""

import argparse
import collections
import contextlib
import http.client
import json
import random
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.parse
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program
from cluster_soak import Difference, succeed

PAUSE_S = 3  # between two kills, on average
WAIT_S = 600  # for the end of the jobs
ANSWER_S = 60


class Soak:
    def __init__(self, arguments, folder: Path):
        self.random = random.Random(arguments.seed)
        self.wanted_kills = arguments.kills
        self.db = folder / "index.db"
        self.db.touch()
        self.videos = []
        for i in range(arguments.videos):
            flight = program.make_flight(self.made(folder / f"flight{i}"), arguments.frames + i)
            self.videos.append(flight / "flight.mp4")
        self.models = program.make_models(folder / "flight0", folder / "models")
        self.kills = 0
        self.jobs: list[int] = []
        self.uploads: list[str] = []
        self.confirmed: dict[int, str] = {}  # note by object
        self.on_the_way: dict[int, set[str]] = collections.defaultdict(set)  # later ones, without an answer
        self.asked = 0
        self.answered = 0

    @staticmethod
    def made(folder: Path) -> Path:
        folder.mkdir()
        return folder

    def start(self) -> program.Server:
        return program.Server(self.db, "--models", self.models)

    def ask(self, server: program.Server, method: str, path: str, body: bytes | None = None, kind="application/json"):
        """The answer's body; None if the server is killed meanwhile."""
        port = urllib.parse.urlsplit(server.url).port
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=ANSWER_S)
        try:
            with contextlib.closing(connection):
                connection.request(method, f"/api/v1{path}", body, {"Content-Type": kind})
                answer = connection.getresponse()
                content = answer.read()
        except (ConnectionError, http.client.HTTPException):
            return None
        if answer.status != 200:
            raise Difference(f"{method} {path}: {answer.status}: {content[:200]!r}")
        return json.loads(content)

    def upload(self, server: program.Server):
        for i, video in enumerate(self.videos):
            path = f"/uploads?name=video{i}.mp4"
            self.uploads.append(self.ask(server, "POST", path, video.read_bytes(), "application/octet-stream")["id"])

    def next_job(self, server: program.Server):
        """Asks for a job unless two wait already. An answer that is lost is looked for in the list."""
        found = self.ask(server, "GET", "/jobs")
        if found is None:
            return
        self.jobs = sorted(one["id"] for one in found["jobs"])
        waiting = sum(one["state"] in ("queued", "running") for one in found["jobs"])
        if waiting < 2 and len(self.jobs) < len(self.uploads):
            job = {"kind": "index", "upload": self.uploads[len(self.jobs)]}
            self.ask(server, "POST", "/jobs", json.dumps(job).encode())

    def review(self, server: program.Server):
        found = self.ask(server, "GET", "/objects?limit=50")
        if not found or not found["objects"]:
            return
        number = self.random.choice(found["objects"])["id"]
        self.asked += 1
        note = f"note {self.asked}"
        verdict = self.random.choice(("accepted", "rejected"))
        body = json.dumps({"verdict": verdict, "note": note}).encode()
        self.on_the_way[number].add(note)
        if self.ask(server, "PUT", f"/objects/{number}/review", body):
            self.confirmed[number] = note
            self.on_the_way[number].clear()
            self.answered += 1

    def kill_and_go_on(self):
        uploaded = False
        while self.kills < self.wanted_kills:
            with self.start() as server:
                if not uploaded:
                    self.upload(server)
                    uploaded = True
                end = time.monotonic() + self.random.expovariate(1 / PAUSE_S)
                # The last request is on its way when the server is killed.
                while time.monotonic() < end:
                    self.next_job(server)
                    self.review(server)
                    time.sleep(0.02)
                killer = subprocess.Popen(["sh", "-c", f"sleep 0.00{self.random.randrange(10)}; kill -KILL {server.process.pid}"])
                self.review(server)
                killer.wait()
                server.process.wait()
                self.kills += 1

    def end_jobs(self):
        with self.start() as server:
            end = time.monotonic() + WAIT_S
            while True:
                self.next_job(server)
                jobs = self.ask(server, "GET", "/jobs")["jobs"]
                if len(jobs) == len(self.uploads) and all(one["state"] not in ("queued", "running") for one in jobs):
                    break
                if time.monotonic() > end:
                    raise Difference(f"the jobs do not end: {jobs}")
                time.sleep(0.1)
            for job in jobs:
                if job["state"] != "done":
                    raise Difference(f"a job has not ended well: {job}")
            for number, note in self.confirmed.items():
                decisions = self.ask(server, "GET", f"/objects/{number}/decisions")["decisions"]
                notes = [one["note"] for one in decisions]
                if len(notes) != 1 or notes[0] not in {note, *self.on_the_way[number]}:
                    raise Difference(f"object {number} has the notes {notes}, not {note} or {self.on_the_way[number]}")

    def check(self):
        succeed("doctor", "--check", self.db)
        for i, video in enumerate(self.videos):
            stored = next(Path(f"{self.db}.uploads").glob(f"*/video{i}.mp4"))
            alone = self.db.with_name("alone.db")
            for file in alone.parent.glob("alone.db*"):
                file.unlink()
            succeed("index", stored, "--models", self.models, "--db", alone)
            rows = [
                [(one["frame"], one["model"], one["box"]) for one in succeed("export", "--db", db, "--format", "sightings",
                                                                            "--video", stored).rows()]
                for db in (self.db, alone)
            ]  # fmt: skip
            if sorted(rows[0]) != sorted(rows[1]) or not rows[0]:
                raise Difference(f"{video}: {len(rows[0])} sightings, undisturbed {len(rows[1])}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--videos", type=int, default=8)
    parser.add_argument("--frames", type=int, default=60, help="of the first video; each has one more")
    parser.add_argument("--keep", type=Path, help="folder of the flights and the index (default: a temporary one)")
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="victorious-soak-", dir=arguments.keep))
    soak = Soak(arguments, folder)
    difference = None
    try:
        soak.kill_and_go_on()
        soak.end_jobs()
        soak.check()
    except Difference as found:
        difference = str(found)
    report = {"kills": soak.kills, "jobs": len(soak.jobs), "reviews_asked": soak.asked, "reviews_answered": soak.answered,
              "objects_reviewed": len(soak.confirmed)}  # fmt: skip
    print(json.dumps(report))
    if difference:
        print(f"serve_soak.py: {difference}; the index: {folder}", file=sys.stderr)
        return 1
    if not arguments.keep:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
