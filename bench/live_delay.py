#!/usr/bin/env python3
"""Measures how soon the sightings of a live stream reach an open page: a drawn flight of 12 s at 10 frames/s is sent
over TCP as it would be filmed, indexed (--every 3) and served; each event of the server is compared with the time of the
newest frame whose sightings it shows.

Usage: live_delay.py; VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the programs, as for tests/e2e. Prints JSON:
`newest_s`, the age of the newest sighting in an event; `oldest_s`, the age of the oldest one in it;
median and maximum of each.
"""

import json
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program

FRAMES = 120
DURATION_S = FRAMES / 10


def send(listener: socket.socket, video: bytes, began: list[float]):
    connection, _ = listener.accept()
    began.append(time.monotonic())
    sent = 0
    with connection:
        while sent < len(video):
            due = int((time.monotonic() - began[0]) / DURATION_S * len(video)) + 20_000
            connection.sendall(video[sent:due])
            sent = max(sent, min(due, len(video)))
            time.sleep(0.02)


def listen(url: str, seen: list[tuple[float, float]]):
    for line in urllib.request.urlopen(url + "/api/v1/events"):
        if not line.startswith(b"data:") or b"newest_object" not in line:
            continue
        try:
            answer = json.load(urllib.request.urlopen(url + "/api/v1/videos/1/sightings?limit=10000"))
        except urllib.error.HTTPError:
            continue  # the video is not in the index yet
        if answer["sightings"]:
            seen.append((time.monotonic(), max(one["time_s"] for one in answer["sightings"])))


def main():
    video = (program.flight(FRAMES) / "flight.mkv").read_bytes()
    began: list[float] = []
    seen: list[tuple[float, float]] = []
    with tempfile.TemporaryDirectory() as folder, socket.create_server(("127.0.0.1", 0)) as listener:
        db = Path(folder) / "live.db"
        db.touch()
        threading.Thread(target=send, args=(listener, video, began), daemon=True).start()
        with program.Server(db) as server:
            threading.Thread(target=listen, args=(server.url, seen), daemon=True).start()
            source = f"tcp://127.0.0.1:{listener.getsockname()[1]}"
            command = [program.PROGRAM, "index", source, "--models", program.models(), "--db", db, "--every", "3"]
            subprocess.run(list(map(str, command)), check=True, capture_output=True)
            time.sleep(1)
    newest = [at - began[0] - time_s for at, time_s in seen]
    oldest = [at - began[0] - before for (at, _), (_, before) in zip(seen[1:], seen)]
    figures = {"newest_s": newest, "oldest_s": oldest}
    rounded = {name: {"median": round(statistics.median(all_), 2), "max": round(max(all_), 2)} for name, all_ in figures.items()}
    print(json.dumps({"events": len(seen), **rounded}))


main()
