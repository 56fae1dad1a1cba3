"""`serve`: what hostile or merely awkward videos and images cost: decoding has a queue of its own and processes of its own."""

import concurrent.futures
import contextlib
import os
import shutil
import socket
import sqlite3
import struct
import subprocess
import time
import urllib.parse
import zlib
from pathlib import Path

import program
import test_serve

FRAMES = 1500  # of the video with one key frame (draw_numbers.cc)
A_CLIENT = 24  # requests for frames that a client may have at once (apps/serve/work_queue.h)


def large_png(path: Path, side: int) -> Path:
    """A black image: many pixels in few bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer = zlib.compressobj(1)
    rows = b"".join(packer.compress(bytes(1 + side)) for _ in range(side)) + packer.flush()
    header = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))
    return path


def peak_bytes(process: int) -> int:
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) << 10
    raise AssertionError("no VmHWM")


def children(process: int) -> list[int]:
    lists = (task / "children" for task in Path(f"/proc/{process}/task").iterdir())
    return [int(child) for one in lists for child in one.read_text().split()]


class ServeDecodingTest(test_serve.ServerCase):
    def serve(self, video: Path) -> program.Server:
        """A server whose only video is this one."""
        db = self.scratch / "index.db"
        shutil.copy(test_serve.index_of_mp4(), db)
        with contextlib.closing(sqlite3.connect(db)) as connection, connection:
            connection.execute(
                "UPDATE videos SET name = ?, frame_count = NULL, content_id = 'another'", (str(video),)
            )
        return program.Server(db)

    def one_key_frame(self) -> Path:
        video = self.scratch / "long.one_key.mp4"
        subprocess.run([os.environ["VICTORIOUS_DRAW_NUMBERS"], video], check=True)
        return video

    def only_video(self, server) -> int:
        return self.get(server, "/api/v1/videos")["videos"][0]["id"]

    def test_frames_far_from_a_key_frame_hold_up_nothing_else(self):
        with self.serve(self.one_key_frame()) as server:
            video = self.only_video(server)
            first, _, _ = self.ask(server, f"/api/v1/videos/{video}/frames/0")
            self.assertEqual(first, 200)

            def frame(number: int):
                status, headers, body = self.ask(server, f"/api/v1/videos/{video}/frames/{number}")
                return status, headers, body, time.monotonic()

            asked = 40
            with concurrent.futures.ThreadPoolExecutor(asked) as pool:
                answers = [pool.submit(frame, FRAMES - 1 - number) for number in range(asked)]
                refused = []
                for answer in concurrent.futures.as_completed(answers):
                    if answer.result()[0] == 503:
                        refused.append(answer.result())
                    if len(refused) == asked - A_CLIENT - 2:
                        break
                # The queue is full now; what needs no decoder is answered at once.
                for path in ("/api/v1/session", "/api/v1/objects", "/"):
                    self.assertEqual(self.ask(server, path)[0], 200)
                session_s = time.monotonic()
                ended = [answer.result() for answer in answers]
            for _, headers, body, _ in refused:
                self.assertEqual(headers["Retry-After"], "3")
                self.assertEqual(self.described(body, "Error")["code"], "unavailable")
            shown = [answer for answer in ended if answer[0] == 200]
            self.assertEqual({answer[0] for answer in ended}, {200, 503})
            self.assertGreaterEqual(len(shown), A_CLIENT, "what was taken is shown")
            later = sum(answer[3] > session_s for answer in shown)
            self.assertGreater(later, A_CLIENT // 2, "the session did not wait for the frames")

    def test_frames_that_nobody_waits_for_are_not_decoded(self):
        with self.serve(self.one_key_frame()) as server:
            video = self.only_video(server)
            port = urllib.parse.urlsplit(server.url).port
            self.assertEqual(self.ask(server, f"/api/v1/videos/{video}/frames/0")[0], 200)
            for number in range(A_CLIENT):
                with socket.create_connection(("127.0.0.1", port)) as client:
                    target = f"/api/v1/videos/{video}/frames/{FRAMES - 1 - number}"
                    client.sendall(f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            # They left: their places in the queue are free before they would have been decoded.
            deadline = time.monotonic() + program.TIMEOUT_S
            while self.ask(server, f"/api/v1/videos/{video}/frames/{FRAMES // 2}")[0] != 200:
                self.assertLess(time.monotonic(), deadline)
            self.assertLess(len(children(server.process.pid)), 8)

    def test_image_of_many_pixels_is_refused(self):
        image = large_png(self.scratch / "large.png", 16384)
        self.assertLess(image.stat().st_size, 3_000_000)
        with self.serve(image) as server:
            video = self.only_video(server)
            before = peak_bytes(server.process.pid)
            self.get(server, f"/api/v1/videos/{video}/camera")  # its tags are looked for, and none are there
            for path in (f"/api/v1/videos/{video}/frames/0", f"/api/v1/videos/{video}/times", "/api/v1/objects/1/thumbnail"):
                status, _, body = self.ask(server, path)
                self.assertEqual(status, 422, body[:200])
                self.assertIn("16384 x 16384 pixels, more than the 67108864", self.described(body, "Error")["message"])
            self.assertLess(peak_bytes(server.process.pid) - before, 50_000_000)

    def test_decoders_have_no_sockets_and_files_of_the_server(self):
        video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", video)
        with self.serve(video) as server:
            port = urllib.parse.urlsplit(server.url).port
            with socket.create_connection(("127.0.0.1", port)):  # a client who waits
                number = self.only_video(server)
                self.assertEqual(self.ask(server, f"/api/v1/videos/{number}/frames/3")[0], 200)
                seen = 0
                for child in children(server.process.pid):
                    with contextlib.suppress(PermissionError):  # of a process that is confined
                        open_files = {int(one.name): os.readlink(one) for one in Path(f"/proc/{child}/fd").iterdir()}
                        seen += 1
                        self.assertTrue(open_files[3].startswith("socket:"))
                        ours = {name: file for name, file in open_files.items() if file not in ("/dev/null", str(video))}
                        self.assertEqual(list(ours), [3], open_files)
                self.assertGreater(seen, 0, "at least the process that waits for a video")


if __name__ == "__main__":
    program.main()
