"""CAD files as models: valid files, partly damaged files, and files rejected with a one-line error in bounded time."""

import json
import random
import resource
import struct
import time
import unittest
import zlib
from pathlib import Path

import program

FEW_VIEWS = ("--step", "90", "--max-off-nadir", "0")  # only the nadir view
OUTSIDE = program.REPOSITORY.parent / "shared/data/models"


def png(width: int, height: int, seed: int) -> bytes:
    """Random grey squares of 4 pixels."""
    draw = random.Random(seed)
    squares = [[draw.randrange(256) for _ in range(width // 4)] for _ in range(height // 4)]
    rows = b"".join(b"\0" + bytes(squares[y // 4][x // 4] for x in range(width)) for y in range(height))

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def roof_obj(size_x: float = 4, size_z: float = 2, extra: str = "") -> str:
    """A horizontal, textured rectangle at y = 0, visible from above."""
    x, z = size_x / 2, size_z / 2
    corners = ((-x, z), (x, z), (x, -z), (-x, -z))
    return (
        "mtllib roof.mtl\nusemtl roof\n"
        + "".join(f"v {a} 0 {b}\n" for a, b in corners)
        + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        + extra
        + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    )


MTL = "newmtl roof\nKd 1 1 1\nmap_Kd roof.png\n"


def glb(content: dict, binary: bytes = b"") -> bytes:
    return glb_of_text(json.dumps({"asset": {"version": "2.0"}, **content}), binary)


def glb_of_text(content: str, binary: bytes = b"") -> bytes:
    text = content.encode() + b" " * (-len(content) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def triangle(**changes) -> dict:
    """A glTF of one triangle; `changes` go into the accessor of its positions and the view of its buffer."""
    view = {"buffer": 0, "byteLength": 36} | {k: v for k, v in changes.items() if k in ("byteOffset", "byteLength")}
    accessor = {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 1]}
    accessor |= {key: value for key, value in changes.items() if key not in view}
    return {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [accessor],
        "bufferViews": [view],
        "buffers": [{"byteLength": 36}],
    }


POINTS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 0, 1)


class CadTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.models = self.scratch / "models"

    def write_roof(self, name: str = "roof.obj", **changes) -> Path:
        self.write("roof.mtl", MTL)
        self.write("roof.png", png(128, 64, 1))
        return self.write(name, roof_obj(**changes))

    def add(self, cad: Path, *flags):
        return self.succeeds("model", "add", "thing", cad, "--models", self.models, *FEW_VIEWS, *flags)

    def shown(self) -> dict:
        return json.loads(self.succeeds("model", "show", "thing", "--models", self.models, "--json").out)

    def refuses_cad(self, cad: Path, *words) -> None:
        began = time.monotonic()
        self.refuses(2, [cad, *words], "model", "add", "thing", cad, "--models", self.models, *FEW_VIEWS)
        self.assertLess(time.monotonic() - began, 60)
        self.assertFalse(self.models.exists())


class GoodTest(CadTest):
    def test_textured_roof(self):
        self.assertEqual(self.add(self.write_roof()).messages(), [])
        shown = self.shown()
        self.assertEqual([shown["kind"], shown["views"], shown["length_m"]], ["cad", 1, 4])
        self.assertGreater(shown["features"], 50)
        sheet = self.scratch / "views.png"
        self.succeeds("model", "show", "thing", "--models", self.models, "--views", sheet)
        self.assertTrue(sheet.read_bytes().startswith(b"\x89PNG"))
        show = ("model", "show", "thing", "--models", self.models)
        tried = self.scratch / "tried.png"
        flags = ("--findable", "--size-px", "120", "--directions", "3")
        findable = json.loads(self.succeeds(*show, *flags, "--draw", tried, "--json").out)["findable"]
        self.assertEqual([findable["directions"], len(findable["bands"])], [3, 1])
        self.assertGreater(findable["found"], 0.6)
        self.assertTrue(tried.read_bytes().startswith(b"\x89PNG"))
        self.refuses(2, "--size-px = 1", *show, "--findable", "--size-px", "1")
        self.refuses(2, "5 to 90", *show, "--findable", "--sun", "high")
        self.refuses(2, "--sun = 2.0: must be 5 to 90", *show, "--findable", "--sun", "2")
        self.refuses(2, "--findable", *show, "--noise", "0.1")

    def test_length_is_the_longest_side(self):
        self.add(self.write_roof(), "--length", "6")
        self.assertAlmostEqual(self.shown()["length_m"], 6, 4)

    def test_length_of_a_gltf_is_along_its_front(self):
        # 4 along x, 2 along z: length 4 as OBJ (longest side), 2 as glTF (along z).
        x, z = 2, 1
        positions = struct.pack("<12f", -x, 0, z, x, 0, z, x, 0, -z, -x, 0, -z)
        uvs = struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0)
        indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
        image = png(128, 64, 1)
        binary = positions + uvs + indices + image
        sizes = [len(positions), len(uvs), len(indices), len(image)]
        cad = self.write("roof.glb", glb({
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}],
            "images": [{"bufferView": 3, "mimeType": "image/png"}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "min": [-x, 0, -z], "max": [x, 0, z]},
                {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 4},
                {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 6},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": sum(sizes[:i]), "byteLength": size} for i, size in enumerate(sizes)
            ],
            "buffers": [{"byteLength": len(binary)}],
        }, binary))  # fmt: skip
        self.add(cad)
        self.assertAlmostEqual(self.shown()["length_m"], 2, 4)
        self.succeeds("model", "remove", "thing", "--models", self.models)
        self.add(cad, "--length", "5")
        self.assertAlmostEqual(self.shown()["length_m"], 5, 4)

    @unittest.skipUnless(OUTSIDE.is_dir(), "no outside models")
    def test_external_model_in_time(self):
        began = time.monotonic()
        self.succeeds("model", "add", "humvee", OUTSIDE / "humvee.glb", "--models", self.models)
        self.assertLess(time.monotonic() - began, 60)  # 30 s on two idle cores


class DamagedInPartTest(CadTest):
    def test_missing_texture(self):
        cad = self.write_roof(extra="usemtl gone\nv 3 0 1\nv 4 0 0\nv 3 0 -1\nf 5/1 6/2 7/3\nusemtl roof\n")
        self.write("roof.mtl", MTL + "newmtl gone\nKd 1 1 1\nmap_Kd gone.png\n")
        done = self.add(cad)
        self.assertEqual(len(done.messages()), 1)
        self.assertRegex(done.messages()[0], "^warning: .*gone.png: no such file")
        self.assertGreater(self.shown()["features"], 50)

    def test_non_finite_vertices(self):
        extra = "v nan 0 0\nv 0 nan 1\nv 1 inf 0\nf 5/1 6/2 7/3\nf 1/1 2/2 5/3\n"
        done = self.add(self.write_roof(extra=extra))
        self.assertGreater(self.shown()["features"], 50)
        self.assertTrue(all("warning" in line for line in done.messages()), done.err)


class BadTest(CadTest):
    def test_no_faces(self):
        self.refuses_cad(self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"))
        ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        self.refuses_cad(self.write("a.ply", ply + "end_header\n0 0 0\n1 0 0\n0 1 0\n"))
        self.refuses_cad(self.write("a.glb", glb({"scene": 0, "scenes": [{"nodes": []}]})))

    def test_only_non_finite_vertices(self):
        self.refuses_cad(self.write("a.obj", "v nan nan nan\nv nan 0 0\nv 0 nan 0\nf 1 2 3\n"))

    def test_formats_that_are_not_read(self):
        for name in ("a.wrl", "b.STEP", "c.fbx"):
            self.refuses_cad(self.write(name, "#VRML V2.0 utf8\n"), "a CAD file (.gltf")

    def test_no_texture(self):
        self.refuses_cad(self.write("a.obj", "v -1 0 1\nv 1 0 1\nv 0 0 -1\nf 1 2 3\n"), "texture")

    def test_ten_million_triangles(self):
        count = 10_000_000
        path = self.scratch / "huge.ply"
        with path.open("wb") as file:
            file.write(
                b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                b"property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n" % count
            )
            file.write(POINTS)
            face = struct.pack("<B3i", 3, 0, 1, 2) * 100_000
            for _ in range(count // 100_000):
                file.write(face)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.refuses_cad(path)
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.assertLess(after / 2**20, max(4, before / 2**20))  # GiB

    def test_malicious_gltf(self):
        cyclic = triangle() | {"nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]}
        chain = [{"children": [i + 1]} for i in range(200_000)] + [{"mesh": 0}]
        hostile = {
            "count beyond the buffer": glb(triangle(count=4_000_000_000), POINTS),
            "negative count": glb(triangle(count=-3), POINTS),
            "negative offset": glb(triangle(byteOffset=-36), POINTS),
            "offset beyond the buffer": glb(triangle(byteOffset=2**62), POINTS),
            "buffer beyond memory": glb(triangle() | {"buffers": [{"byteLength": 2**62}]}, POINTS),
            "cyclic nodes": glb(cyclic, POINTS),
            "a chain of nodes": glb(triangle() | {"nodes": chain}, POINTS),
            "nested deeply": glb_of_text('{"asset":{"version":"2.0"},"extras":' + "[" * 1_000_000),
            "a buffer of another machine": glb(triangle() | {"buffers": [{"byteLength": 36, "uri": "/etc/passwd"}]}),
        }
        for name, content in hostile.items():
            with self.subTest(name):
                self.refuses_cad(self.write("hostile.glb", content))


if __name__ == "__main__":
    program.main()
