#!/usr/bin/env python3
"""Kills workers of a cluster, their processes and PostgreSQL at random, stops workers past their lease, and cuts the
network, while they index drawn flights; checks that nothing is lost and nothing doubled.

Usage: cluster_soak.py [--kills N] [--seed SEED] [--seconds LIMIT] [--pause SECONDS] [--workers W] [--segments]
[--keep DIR]; VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e. Needs PostgreSQL, and the rights of
its user.

Rounds, each on a new database, until N kills: the flights are submitted; workers index them, are killed (SIGKILL) or
stopped (SIGSTOP) at random moments, at most HITS_OF_ROUND times, and replaced; a task that has failed, because its workers
were killed three times without progress, is submitted again. At the end of a round:
- the log has every task done exactly once, every attempt claimed once and ended once, the last one as done;
- the exports are those of one worker that nobody disturbs, byte for byte; objects and sightings are those of one
  process that indexes into a file, but for the ids of objects;
- `victorious doctor --check` finds no damage.
With --segments, workers share each video, second by second. A segment whose processes are killed three times is left out;
of a round with such gaps, the log is checked alone.
The seed draws what is hit and when; what that meets depends on the machine. Prints JSON: kills by kind, rounds, tasks,
attempts, and `stops`, those of workers past their lease and cuts of the network. Exit status 1 and the folder of the
workers' logs at the first difference.
"""

import argparse
import collections
import contextlib
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program

FRAMES = (60, 25, 45, 30, 50, 20)  # of the videos
FORMATS = ("objects", "sightings", "geojson", "kml")
LEASE_S = 4  # the shortest that `work` takes
WAIT_S = 240  # for the end of a task, or of the server's recovery, without hits
# What is hit, and how often. "index": the process that a worker runs; "backend": one process of PostgreSQL, which then
# ends all its connections; "server": all of PostgreSQL; "stop": a worker and its process, until its lease is over;
# "stop_worker": the worker alone; "network": between all workers and PostgreSQL, until their leases are over.
HITS = {"worker": 10, "index": 4, "backend": 2, "server": 2, "stop": 2, "stop_worker": 1, "network": 1}
HITS_OF_ROUND = 60  # then it is left to end: hits that come faster than tasks end would let none be compared
NO_CONNECTION = 2  # exit status of psql: there is none, or it was lost
# SIGSTOP kills nothing.
STOPS = ("stop", "stop_worker", "network")
# Of --segments: tracks restart, and segments end, each second at 10 frames per second.
SEGMENT_S = 1
SEGMENT_PARAMS = {"follow": {"restart_interval_frames": 10}}


class Difference(Exception):
    """What should not be."""


class Server:
    """PostgreSQL that syncs its commits and is started again when it is killed, as a context manager."""

    def __enter__(self) -> "Server":
        script = program.REPOSITORY / "tools" / "scratch_postgres.sh"
        settings = ("fsync=on", "synchronous_commit=on", "full_page_writes=on", "recovery_init_sync_method=syncfs")
        self.process = subprocess.Popen(
            [script, "--restart", *settings], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.url = self.process.stdout.readline().strip()
        if not self.url.startswith("postgresql://"):
            sys.exit(f"cluster_soak.py: {self.url}")
        self.folder = Path(self.url.partition("?host=")[2])
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(timeout=WAIT_S)

    def pid(self) -> int:
        return int((self.folder / "data/postmaster.pid").read_text().split()[0])

    def query(self, statement: str, url: str = "") -> list[list[str]]:
        """The rows; waits while the server starts again."""
        command = ["psql", url or self.url, "--quiet", "--no-align", "--tuples-only", "--field-separator=\t"]
        end = time.monotonic() + WAIT_S
        while True:
            done = subprocess.run([*command, "--command", statement], capture_output=True, text=True)
            if done.returncode == 0:
                return [line.split("\t") for line in done.stdout.splitlines()]
            if done.returncode != NO_CONNECTION or time.monotonic() > end:
                raise Difference(f"{statement}: {done.stderr}")
            time.sleep(0.1)

    def make_database(self, name: str) -> str:
        if not self.query(f"SELECT 1 FROM pg_database WHERE datname = '{name}'"):
            self.query(f"CREATE DATABASE {name}")
        base, _, parameters = self.url.partition("?")
        return f"{base.rpartition('/')[0]}/{name}?{parameters}"


class Network:
    """Between workers and the server, on a port of its own: forwards bytes, but while it is cut."""

    def __init__(self, socket_path: Path):
        self.socket_path = socket_path
        self.cut_until = 0.0
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def cut(self, seconds: float):
        self.cut_until = time.monotonic() + seconds

    def wait(self):
        while (left := self.cut_until - time.monotonic()) > 0:
            time.sleep(min(left, 0.1))

    def accept(self):
        while True:
            client = self.listener.accept()[0]
            self.wait()
            server = socket.socket(socket.AF_UNIX)
            try:
                server.connect(str(self.socket_path))
            except OSError:  # the server is being started
                client.close()
                continue
            for source, target in ((client, server), (server, client)):
                threading.Thread(target=self.forward, args=(source, target), daemon=True).start()

    def forward(self, source: socket.socket, target: socket.socket):
        with contextlib.suppress(OSError):
            while data := source.recv(1 << 16):
                self.wait()
                target.sendall(data)
        self.wait()
        for end in (source, target):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)


class Worker:
    """`victorious work` on one thread. Its log is `log`."""

    def __init__(self, url: str, log: Path, *flags: str | int):
        command = [program.PROGRAM, "work", "--db", url, "--threads", 1, *flags]
        self.log = log
        with open(log, "a", encoding="utf-8") as file:
            self.process = subprocess.Popen(list(map(str, command)), stderr=file, stdout=subprocess.DEVNULL)
        self.is_killed = False

    def children(self) -> list[int]:
        try:
            tasks = list(Path(f"/proc/{self.process.pid}/task").iterdir())
            return [int(pid) for task in tasks for pid in (task / "children").read_text().split()]
        except (FileNotFoundError, ProcessLookupError):
            return []

    def is_running(self) -> bool:
        return self.process.poll() is None

    def check_end(self):
        """A worker that nobody killed ends well, or because it has found no server at its start."""
        said = self.log.read_text(encoding="utf-8").splitlines()
        is_at_start = len([line for line in said if "worker " in line]) == 0
        if not self.is_killed and self.process.returncode != 0 and not is_at_start:
            raise Difference(f"a worker ended with {self.process.returncode}: {self.log}: {said[-1:]}")


def send(pid: int, sent: signal.Signals) -> bool:
    try:
        os.kill(pid, sent)
    except ProcessLookupError:
        return False
    return True


def exports(db) -> dict[str, str]:
    return {form: succeed("export", "--db", db, "--format", form).out for form in FORMATS}


def succeed(*arguments) -> program.Outcome:
    done = program.run(*arguments)
    if done.status != 0:
        raise Difference(f"{' '.join(map(str, arguments))}: {done.err}")
    return done


def numbered(lines: str) -> list[dict]:
    """The rows, with the ids of objects replaced by the order in which they come first."""
    numbers: dict[int, int] = {}
    rows = map(json.loads, lines.splitlines())
    return [row | {"object_id": numbers.setdefault(row["object_id"], len(numbers))} for row in rows]


class Round:
    """One database, its workers and what hits them."""

    def __init__(self, soak: "Soak", number: int):
        self.soak = soak
        self.server = soak.server
        self.random = soak.random
        self.url = self.server.make_database(f"round{number}")
        self.folder = soak.folder / f"round{number}"
        self.folder.mkdir()
        self.workers: list[Worker] = []
        self.started = 0
        self.stopped: list[tuple[float, list[int]]] = []  # when they go on, and who

    def start_worker(self) -> Worker:
        self.started += 1
        flags = ("--lease", LEASE_S, "--retry-delay", 0)
        return Worker(self.soak.network_url(self.url), self.folder / f"worker{self.started}.log", *flags)

    def counts(self) -> dict[str, int]:
        statement = "SELECT state, count(*) FROM victorious.tasks WHERE parent IS NULL GROUP BY state"
        rows = self.server.query(statement, self.url)
        return collections.defaultdict(int, {state: int(count) for state, count in rows})

    def hit(self, kind: str) -> bool:
        """Returns whether somebody was hit."""
        if kind == "server":
            try:
                return send(self.server.pid(), signal.SIGKILL)
            except (FileNotFoundError, IndexError, ValueError):
                return False  # it is being started
        if kind == "backend":
            statement = (
                "SELECT pid FROM pg_stat_activity "
                "WHERE datname = current_database() AND pid <> pg_backend_pid() ORDER BY pid"
            )
            pids = [int(row[0]) for row in self.server.query(statement, self.url)]
            return bool(pids) and send(self.random.choice(pids), signal.SIGKILL)
        if kind == "network":
            self.soak.network.cut(LEASE_S + self.random.uniform(0.5, 3))
            return True
        victim = self.random.choice(self.workers)
        children = victim.children()
        if kind == "worker":
            victim.is_killed = True
            return send(victim.process.pid, signal.SIGKILL)
        if kind == "index":
            return bool(children) and send(children[0], signal.SIGKILL)
        pids = [victim.process.pid, *(children if kind == "stop" else [])]
        if not children or any(victim.process.pid in they for _, they in self.stopped):
            return False
        self.stopped.append((time.monotonic() + LEASE_S + self.random.uniform(0.5, 3), pids))
        return all([send(pid, signal.SIGSTOP) for pid in pids])

    def wake(self, everyone: bool = False):
        now = time.monotonic()
        for end, pids in self.stopped:
            if everyone or end <= now:
                for pid in pids:
                    send(pid, signal.SIGCONT)
        self.stopped = [(end, pids) for end, pids in self.stopped if not everyone and end > now]

    def replace_ended(self):
        for i, worker in enumerate(self.workers):
            if not worker.is_running():
                worker.check_end()
                self.workers[i] = self.start_worker()

    def run(self):
        self.soak.submit(self.url)
        self.workers = [self.start_worker() for _ in range(self.soak.workers)]
        try:
            self.disturb()
            self.wake(everyone=True)
            self.end_workers()
        finally:
            self.wake(everyone=True)
            for worker in self.workers:
                worker.is_killed = True
                worker.process.kill()
                worker.process.wait()
        self.check_log()
        (gaps,) = self.server.query("SELECT count(*) FROM victorious.gaps", self.url)
        if gaps != ["0"]:
            self.soak.figures["rounds_with_gaps"] += 1
            return
        self.soak.check_results(self.url, self.folder)

    def disturb(self):
        """Hits until all tasks are done, and waits for those that are left."""
        hit_at = time.monotonic() + self.soak.draw_pause_s()
        last_event = time.monotonic()
        last_counts = collections.defaultdict(int)
        hits = 0
        while (counts := self.counts())["done"] < len(FRAMES):
            self.wake()
            self.replace_ended()
            is_open = any(counts[state] for state in ("queued", "running", "waiting"))
            if counts["failed"] and not is_open:
                self.soak.figures["submitted_again"] += counts["failed"]
                self.soak.submit(self.url)
            now = time.monotonic()
            if counts != last_counts:
                last_event, last_counts = now, counts
            if now >= hit_at and hits < HITS_OF_ROUND and self.soak.goes_on():
                kind = self.random.choices(list(HITS), HITS.values())[0]
                hit_at = now + self.soak.draw_pause_s()
                if self.hit(kind):
                    self.soak.hits[kind] += 1
                    hits += 1
                    last_event = now
            if now > last_event + WAIT_S:
                raise Difference(f"the tasks do not end: {dict(counts)}")
            time.sleep(0.2)

    def end_workers(self):
        for worker in self.workers:
            send(worker.process.pid, signal.SIGINT)
        for worker in self.workers:
            worker.process.wait(timeout=WAIT_S)
            worker.check_end()

    def check_log(self):
        rows = self.server.query("SELECT task_id, attempt, event FROM victorious.task_log ORDER BY id", self.url)
        parts = {int(row[0]) for row in self.server.query("SELECT id FROM victorious.tasks WHERE parent > 0", self.url)}
        tasks = collections.defaultdict(list)
        for task, attempt, event in rows:
            tasks[int(task)].append((int(attempt), event))
        if len(set(tasks) - parts) != len(FRAMES):
            raise Difference(f"{len(set(tasks) - parts)} of {len(FRAMES)} tasks in the log")
        for task, events in tasks.items():
            claims, ends = events[::2], events[1::2]
            attempts = list(range(1, len(events) // 2 + 1))
            if (
                [attempt for attempt, _ in claims] != attempts
                or [attempt for attempt, _ in ends] != attempts
                or any(event != "claimed" for _, event in claims)
                # A segment is queued again if it was left out, or its cut made anew.
                or any(event not in ("released", "failed", "lost") for _, event in ends[:-1] if task not in parts)
                or (ends[-1][1] != "done" and task not in parts)
            ):
                raise Difference(f"the log of task {task}: {events}")
            self.soak.figures["attempts"] += len(attempts)
            self.soak.figures["tasks"] += 1


class Soak:
    def __init__(self, arguments, server: Server, folder: Path):
        self.server = server
        self.folder = folder
        self.kills_wanted = arguments.kills
        self.end = time.monotonic() + arguments.seconds
        self.pause_s = arguments.pause
        self.workers = arguments.workers
        self.random = random.Random(arguments.seed)
        self.hits = dict.fromkeys(HITS, 0)
        self.figures = collections.defaultdict(int)
        self.network = Network(server.folder / ".s.PGSQL.5432")
        self.flags = []
        if arguments.segments:
            (folder / "params.json").write_text(json.dumps(SEGMENT_PARAMS), encoding="utf-8")
            self.flags = ["--params", folder / "params.json"]
        self.submit_flags = [*self.flags, *(["--segment", SEGMENT_S] if arguments.segments else [])]
        self.videos = []
        for i, frames in enumerate(FRAMES):
            flight = folder / f"flight{i}"
            flight.mkdir()
            program.make_flight(flight, frames)
            self.videos.append(flight / "flight.mkv")
        self.models = program.make_models(folder / "flight0", folder / "models")
        self.wanted, self.rows = self.make_reference()

    def kills(self) -> int:
        return sum(count for kind, count in self.hits.items() if kind not in STOPS)

    def goes_on(self) -> bool:
        return self.kills() < self.kills_wanted and time.monotonic() < self.end

    def draw_pause_s(self) -> float:
        return self.random.expovariate(1 / self.pause_s)

    def network_url(self, url: str) -> str:
        return f"postgresql://victorious@127.0.0.1:{self.network.port}/{url.partition('?')[0].rpartition('/')[2]}"

    def submit(self, url: str):
        """Waits while the server starts again."""
        for _ in range(WAIT_S):
            done = program.run("submit", *self.videos, "--models", self.models, "--db", url, *self.submit_flags)
            if done.status == 0:
                return
            time.sleep(1)
        raise Difference(f"submit: {done.err}")

    def make_reference(self):
        """The exports of one worker, and the rows of one process that indexes into a file."""
        url = self.server.make_database("reference")
        self.submit(url)
        worker = Worker(url, self.folder / "reference.log", "--until-empty")
        worker.process.wait(timeout=program.TIMEOUT_S)
        worker.check_end()
        db = self.folder / "one.db"
        succeed("index", *self.videos, "--models", self.models, "--db", db, *self.flags)
        rows = {form: numbered(lines) for form, lines in exports(db).items() if form in ("objects", "sightings")}
        return exports(url), rows

    def check_results(self, url: str, folder: Path):
        succeed("doctor", "--check", url)
        for form, lines in exports(url).items():
            if lines != self.wanted[form]:
                (folder / f"{form}.workers").write_text(lines, encoding="utf-8")
                (folder / f"{form}.one").write_text(self.wanted[form], encoding="utf-8")
                raise Difference(f"the {form} of the workers are not those of one: {folder}")
            if form in self.rows and numbered(lines) != self.rows[form]:
                raise Difference(f"the {form} of the workers are not those of one process")
        if len(self.rows["objects"]) < 3:
            raise Difference("too few objects to compare")

    def run(self):
        while self.goes_on():
            self.figures["rounds"] += 1
            Round(self, self.figures["rounds"]).run()
            print(f"round {self.figures['rounds']}: {self.kills()} kills", file=sys.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=500, help="SIGKILLs in all (default: 500)")
    parser.add_argument("--seed", type=int, default=1, help="of what is hit and when (default: 1)")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="hit nobody after this time")
    parser.add_argument("--pause", type=float, default=1, help="seconds between two hits, on average (default: 1)")
    parser.add_argument("--workers", type=int, default=3, help="at once (default: 3)")
    parser.add_argument("--segments", action="store_true", help="workers share each video")
    parser.add_argument("--keep", type=Path, help="folder of the flights, models and logs (default: a temporary one)")
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="victorious-soak-", dir=arguments.keep))
    begun = time.monotonic()
    with Server() as server:
        soak = Soak(arguments, server, folder)
        try:
            soak.run()
            difference = None
        except Difference as found:
            difference = str(found)
    seconds = round(time.monotonic() - begun)
    report = {"seed": arguments.seed, "kills": soak.kills(), "stops": sum(soak.hits[kind] for kind in STOPS), **soak.hits,
              "rounds_with_gaps": 0, **soak.figures, "seconds": seconds}  # fmt: skip
    print(json.dumps(report))
    if difference:
        print(f"cluster_soak.py: round {soak.figures['rounds']}: {difference}; the logs: {folder}", file=sys.stderr)
        return 1
    if not arguments.keep:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
