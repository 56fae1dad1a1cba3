"""Base maps for test_page.py: a tile server, and PMTiles files of one tile, which shows the whole world."""

import http.server
import json
import struct
import threading
import zlib

VECTOR, PNG = 1, 2


def png(red: int, green: int, blue: int) -> bytes:
    """256 x 256 pixels of one colour."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + bytes((red, green, blue)) * 256) * 256
    head = struct.pack(">IIBBBBB", 256, 256, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def varint(number: int) -> bytes:
    parts = bytearray()
    while number >= 0x80:
        parts.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes((*parts, number))


def field(number: int, content: bytes) -> bytes:
    """A field of a Protocol Buffer: bytes with their length."""
    return varint(number << 3 | 2) + varint(len(content)) + content


def square(layer: str) -> bytes:
    """A vector tile that one polygon of a layer covers."""

    def zigzag(number: int) -> int:
        return number << 1 ^ number >> 31

    path = [9, 0, 0, 26, zigzag(4096), 0, 0, zigzag(4096), zigzag(-4096), 0, 15]
    polygon = b"\x18\x03" + field(4, b"".join(map(varint, path)))
    return field(3, field(1, layer.encode()) + field(2, polygon) + b"\x28" + varint(4096) + b"\x78\x02")


def pmtiles(tile: bytes, kind: int, metadata: dict) -> bytes:
    """Version 3, nothing compressed: header, directory of one entry, metadata, tile 0/0/0."""
    # Number of entries; tile id, run length, length, offset + 1.
    directory = b"".join(map(varint, (1, 0, 1, len(tile), 1)))
    text = json.dumps(metadata).encode()
    at = 127
    parts = []
    for size in (len(directory), len(text), 0, len(tile)):
        parts += [at, size]
        at += size
    world = (-180, -85, 180, 85)
    header = b"PMTiles\x03" + struct.pack("<11Q", *parts, 1, 1, 1)
    header += struct.pack("<6B4iB2i", 1, 1, 1, kind, 0, 0, *(10_000_000 * one for one in world), 0, 0, 0)
    return header + directory + text + tile


class Server:
    """A tile server that gives one image for all tiles, to pages of any site. As a context manager: its address."""

    def __init__(self, image: bytes):
        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                self.send_response(200)
                self.send_header("Content-Type", "image/png")
                self.send_header("Content-Length", str(len(image)))
                self.send_header("Access-Control-Allow-Origin", "*")
                self.end_headers()
                self.wfile.write(image)

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)

    def __enter__(self) -> str:
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return f"http://127.0.0.1:{self.server.server_port}"

    def __exit__(self, *_):
        self.server.shutdown()
        self.server.server_close()
