"""Live sources on this machine: a transport stream that is sent as a camera would, evenly within some seconds."""

import contextlib
import ctypes
import select
import socket
import ssl
import struct
import threading
from pathlib import Path

PACKET = 7 * 188  # bytes of a transport stream in a datagram


class Source:
    """As a context manager: the address to watch."""

    def __init__(self, stream: Path, seconds: float):
        content = stream.read_bytes()
        self.packets = [content[at : at + PACKET] for at in range(0, len(content), PACKET)]
        self.seconds, self.is_ending = seconds, threading.Event()
        self.thread = threading.Thread(target=self.run)

    def __enter__(self) -> str:
        self.thread.start()
        return self.url

    def __exit__(self, *_):
        self.is_ending.set()
        self.thread.join()

    def in_time(self):
        """The packets with their numbers, each when it is due."""
        for number, packet in enumerate(self.packets):
            yield number, packet
            if self.is_ending.wait(self.seconds / len(self.packets)):
                return


class Udp(Source):
    """Sends to a free port once somebody listens there."""

    def __init__(self, stream: Path, seconds: float):
        super().__init__(stream, seconds)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.url = f"udp://127.0.0.1:{self.port}"

    def run(self):
        heard = f":{self.port:04X} "
        while not any(heard in Path("/proc/net", name).read_text() for name in ("udp", "udp6")):
            if self.is_ending.wait(0.05):
                return
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _, packet in self.in_time():
                with contextlib.suppress(ConnectionRefusedError):  # whoever listened has gone
                    sender.sendto(packet, ("127.0.0.1", self.port))


class Rtsp(Source):
    """A server (RFC 2326) for one viewer, whose connection it sends the stream over (RTP, RFC 2250)."""

    SDP = "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=flight\r\nc=IN IP4 127.0.0.1\r\nt=0 0\r\nm=video 0 RTP/AVP 33\r\na=control:track1\r\n"
    ANSWERS = {
        "OPTIONS": ["Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN"],
        "DESCRIBE": ["Content-Type: application/sdp", f"Content-Length: {len(SDP)}"],
        "SETUP": ["Transport: RTP/AVP/TCP;unicast;interleaved=0-1", "Session: 1"],
        "PLAY": ["Session: 1"],
    }

    def __init__(self, stream: Path, seconds: float):
        super().__init__(stream, seconds)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"rtsp://127.0.0.1:{self.listener.getsockname()[1]}/camera"
        self.requests = []  # each as its lines

    def accept(self) -> socket.socket:
        return self.listener.accept()[0]

    def __exit__(self, *_):
        self.listener.shutdown(socket.SHUT_RDWR)  # ends accept()
        super().__exit__()
        self.listener.close()

    def run(self):
        with contextlib.suppress(OSError):  # the viewer has gone
            viewer = self.accept()
            with viewer, viewer.makefile("rb") as lines:
                while request := self.read_request(lines):
                    self.requests.append(request)
                    if self.answer(viewer, request) == "PLAY":
                        return self.send(viewer)

    def read_request(self, lines) -> list[str]:
        head = []
        while (line := lines.readline().decode().strip()) != "":
            head.append(line)
        return head

    def answer(self, viewer: socket.socket, request: list[str]) -> str:
        method = request[0].split()[0]
        number = next(line for line in request if line.lower().startswith("cseq"))
        head = ["RTSP/1.0 200 OK", number, *self.ANSWERS.get(method, [])]
        viewer.sendall("\r\n".join([*head, "", self.SDP if method == "DESCRIBE" else ""]).encode())
        return method

    def send(self, viewer: socket.socket):
        for number, packet in self.in_time():
            stamp = int(90_000 * self.seconds * number / len(self.packets))
            rtp = struct.pack(">BBHII", 0x80, 33, number & 0xFFFF, stamp, 1) + packet
            viewer.sendall(struct.pack(">cBH", b"$", 0, len(rtp)) + rtp)


class Rtsps(Rtsp):
    """The same by TLS, for a viewer with a name and a password."""

    def __init__(self, stream: Path, seconds: float, certificate: Path, key: Path):
        super().__init__(stream, seconds)
        self.url = self.url.replace("rtsp://", "rtsps://ann:secret@")
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.context.load_cert_chain(certificate, key)

    def accept(self) -> socket.socket:
        return self.context.wrap_socket(super().accept(), server_side=True)

    def answer(self, viewer: socket.socket, request: list[str]) -> str:
        if any(line.lower().startswith("authorization") for line in request):
            return super().answer(viewer, request)
        number = next(line for line in request if line.lower().startswith("cseq"))
        viewer.sendall("\r\n".join(["RTSP/1.0 401 Unauthorized", number, 'WWW-Authenticate: Basic realm="camera"', "", ""]).encode())
        return ""


class Srt(Source):
    """A listener (draft-sharabayko-srt) for one viewer, by the library that FFmpeg reads SRT with."""

    LIBRARY = "libsrt-gnutls.so.1.5"

    def __init__(self, stream: Path, seconds: float):
        super().__init__(stream, seconds)
        self.srt = ctypes.CDLL(self.LIBRARY)
        self.srt.srt_startup()
        self.listener = self.srt.srt_create_socket()
        address = struct.pack("=H", socket.AF_INET) + struct.pack("!H", 0) + socket.inet_aton("127.0.0.1") + bytes(8)
        self.check(self.srt.srt_bind(self.listener, address, len(address)))
        self.check(self.srt.srt_listen(self.listener, 1))
        size = ctypes.c_int(len(address))
        bound = ctypes.create_string_buffer(len(address))
        self.check(self.srt.srt_getsockname(self.listener, bound, ctypes.byref(size)))
        self.url = f"srt://127.0.0.1:{struct.unpack_from('!H', bound.raw, 2)[0]}"

    def check(self, result: int):
        if result < 0:
            self.srt.srt_getlasterror_str.restype = ctypes.c_char_p
            raise OSError(self.srt.srt_getlasterror_str().decode())

    def __exit__(self, *_):
        self.srt.srt_close(self.listener)  # ends srt_accept()
        super().__exit__()
        self.srt.srt_cleanup()

    def run(self):
        viewer = self.srt.srt_accept(self.listener, None, None)
        if viewer < 0:
            return
        for _, packet in self.in_time():
            if self.srt.srt_send(viewer, packet, len(packet)) < 0:
                break  # the viewer has gone
        self.srt.srt_close(viewer)


class Broadcast(Source):
    """A TCP server that sends to whoever is connected, from where the stream is at that moment; it begins with the first."""

    def __init__(self, stream: Path, seconds: float):
        super().__init__(stream, seconds)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.setblocking(False)
        self.url = f"tcp://127.0.0.1:{self.listener.getsockname()[1]}"

    def __exit__(self, *_):
        super().__exit__()
        self.listener.close()

    def run(self):
        while not select.select([self.listener], [], [], 0.05)[0]:
            if self.is_ending.is_set():
                return
        viewers = []
        for _, packet in self.in_time():
            with contextlib.suppress(BlockingIOError):
                viewers.append(self.listener.accept()[0])
            for viewer in list(viewers):
                try:
                    viewer.sendall(packet)
                except OSError:  # it has gone
                    viewers.remove(viewer)
                    viewer.close()
        for viewer in viewers:
            viewer.close()
