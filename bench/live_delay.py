#!/usr/bin/env python3
"""Measures how soon the sightings of live streams reach an open page, and whether the page says how far it is behind.

Usage: live_delay.py [--streams N] [--stream FILE.ts] [--models DIR]; VICTORIOUS_PROGRAM and VICTORIOUS_DRAW_FLIGHT name the
programs, as for tests/e2e. By default two streams of a drawn flight of 12 s at 10 frames/s, searched for its two models;
`make-stream` makes a stream of any video:

    build/make-stream demo/flight/video.mp4 demo.ts 3
    bench/live_delay.py --stream demo.ts --models demo/models

Each stream is sent by RTSP, each frame at its time, and watched by a job of one `victorious serve`, as the page asks for
it. A sighting has reached the page when it answers the request that follows the server's event. Prints JSON:
`sighting_s`, from the frame's time to that moment: median, 90 %, maximum, and the fraction that took at most 1 s;
`behind_s`, what the jobs say at most, and `said_less_s`, by how much the largest delay of a sighting of a stream exceeds
the largest that its job says; `frames`, how many of each stream were searched or passed over.
"""

import argparse
import contextlib
import json
import statistics
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/e2e"))
import program
import streams

FRAMES = 120
PACKET = 188
WAIT_S = 120  # for what is behind when the streams end


def stamps(stream: bytes):
    """The presentation time of each transport packet that begins a frame, s; None for others."""
    for at in range(0, len(stream), PACKET):
        packet = stream[at : at + PACKET]
        begin = 4 + (1 + packet[4] if packet[3] & 0x20 else 0)
        payload = packet[begin:]
        if not packet[1] & 0x40 or payload[:3] != b"\0\0\1" or payload[3] & 0xF0 != 0xE0 or not payload[7] & 0x80:
            yield None
            continue
        a, b, c, d, e = payload[9:14]
        yield ((a >> 1 & 7) << 30 | b << 22 | c >> 1 << 15 | d << 7 | e >> 1) / 90_000


class Camera(streams.Rtsp):
    """Sends each frame at its time; `began` is when the first one was sent."""

    def __init__(self, stream: Path):
        content = stream.read_bytes()
        times = [one for one in stamps(content) if one is not None]
        super().__init__(stream, times[-1] - times[0])
        self.due, first = [], times[0]
        due = 0.0
        for number, one in enumerate(stamps(content)):
            due = due if one is None else one - first
            if number % (len(self.packets[0]) // PACKET) == 0:
                self.due.append(due)
        self.began = None

    def in_time(self):
        self.began = time.monotonic()
        for number, packet in enumerate(self.packets):
            rest = self.began + self.due[number] - time.monotonic()
            if rest > 0 and self.is_ending.wait(rest):
                return
            yield number, packet


class Page:
    """What an open page sees: the delay of each sighting, and what the jobs say."""

    def __init__(self, url: str, cameras: dict[str, Camera]):
        self.url, self.cameras = url, cameras
        self.delays: dict[str, dict[tuple, float]] = {name: {} for name in cameras}
        self.behind: dict[str, list[float]] = {name: [] for name in cameras}
        threading.Thread(target=self.listen, daemon=True).start()

    def get(self, path: str):
        with urllib.request.urlopen(f"{self.url}/api/v1{path}") as answer:
            return json.load(answer)

    def listen(self):
        kind = b""
        for line in urllib.request.urlopen(self.url + "/api/v1/events"):
            if line.startswith(b"event:"):
                kind = line.split(b":")[1].strip()
            elif line.startswith(b"data:") and kind == b"index":
                self.read_sightings()
            elif line.startswith(b"data:") and kind == b"jobs":
                for job in json.loads(line[5:])["jobs"]:
                    if job["behind_s"] is not None and job["title"] in self.behind:
                        self.behind[job["title"]].append(job["behind_s"])

    def read_sightings(self):
        for video in self.get("/videos")["videos"]:
            camera, delays = self.cameras.get(video["name"]), self.delays.get(video["name"])
            if camera is None:
                continue
            seen = self.get(f"/videos/{video['id']}/sightings?limit=10000")["sightings"]
            now = time.monotonic()
            for one in seen:
                delays.setdefault((one["frame"], one["model_id"], *one["box"]), now - camera.began - one["time_s"])


def post(server: str, **job):
    request = urllib.request.Request(f"{server}/api/v1/jobs", json.dumps(job).encode(), {"Content-Type": "application/json"})
    with urllib.request.urlopen(request) as answer:
        return json.load(answer)["id"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--streams", type=int, default=2)
    parser.add_argument("--stream", type=Path, help="transport stream (default: a drawn flight)")
    parser.add_argument("--models", type=Path, help="model library (default: that of the drawn flight)")
    arguments = parser.parse_args()
    stream = arguments.stream or program.flight(FRAMES) / "flight.ts"
    models = arguments.models or program.models()
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        db = Path(folder) / "live.db"
        db.touch()
        made = [Camera(stream) for _ in range(arguments.streams)]
        cameras = {stack.enter_context(camera): camera for camera in made}
        server = stack.enter_context(program.Server(db, "--models", models))
        page = Page(server.url, cameras)
        jobs = [post(server.url, kind="live", url=url) for url in cameras]
        end = time.monotonic() + made[0].seconds + WAIT_S
        while time.monotonic() < end:
            found = {job["id"]: job for job in page.get("/jobs")["jobs"]}
            if all(found[number]["state"] not in ("queued", "running") for number in jobs):
                break
            time.sleep(0.2)
        time.sleep(1)
    delays = sorted(delay for of_stream in page.delays.values() for delay in of_stream.values())
    if not delays:
        sys.exit(f"live_delay.py: no sighting: {found}")
    least = [max(page.delays[url].values()) - max(page.behind[url], default=0) for url in cameras if page.delays[url]]
    print(
        json.dumps(
            {
                "streams": arguments.streams,
                "seconds": round(made[0].seconds, 1),
                "sightings": len(delays),
                "sighting_s": {
                    "median": round(statistics.median(delays), 2),
                    "p90": round(delays[int(0.9 * (len(delays) - 1))], 2),
                    "max": round(delays[-1], 2),
                    "within_1_s": round(sum(delay <= 1 for delay in delays) / len(delays), 3),
                },
                "behind_s": [round(max(page.behind[url], default=0), 2) for url in cameras],
                "said_less_s": round(max(least), 2),
                "frames": [found[number]["done"] for number in jobs],
                "states": [found[number]["state"] for number in jobs],
            }
        )
    )


main()
