#!/usr/bin/env python3
"""Measures how vehicles of one colour are found: each in one of four colours, whatever its file shows.

Usage: plain_vehicles.py --files DIR --models LIBRARY [--sizes 40 90] [--noise 0] [--textured] [--seed 1]
                         [--program build/victorious] [--params FILE] [--keep DIR] [--json]

DIR contains CAD files (*.glb) of vehicles among others, LIBRARY their models and further ones. A flight at each size and noise
passes ten vehicles of 4 to 14 m, drawn from DIR, in a drawn town with parked cars of other makes; SIZE is the length of a
vehicle of 5.5 m in the frame, px, NOISE a fraction of salt and pepper. Draws follow from the seed, the size and the noise.
With --textured the vehicles look as in their files. Prints a row per flight:

  found      objects found, of those findable, and false objects (as `victorious evaluate` counts)
  recall     of sightings, of clear truth rows; precision of sightings
  CEP        median horizontal error of the places, m

With --json an object instead: by size and noise (`px40_0`), by size (`px40`) and `all`, with the sums.
"""

import argparse
import json
import random
import struct
import sys
import tempfile
from pathlib import Path

from movies import Movie, Program
from movies_by_default import measure, total

REPOSITORY = Path(__file__).resolve().parents[2]
VEHICLES = 10
SIDE_M = 24  # of a town's square
LENGTHS_M = (4.2, 14)  # diagonals of the bounding boxes
COLOURS = {"grey": (0.35, 0.35, 0.34), "white": (0.8, 0.8, 0.78), "black": (0.02, 0.02, 0.022), "green": (0.09, 0.13, 0.07)}
TILES = ("apron", "court", "yard", "parking")


def read_glb(file: Path) -> tuple[dict, bytes]:
    """The JSON of a binary glTF file, and what follows it."""
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def diagonal_m(file: Path) -> float:
    gltf, _ = read_glb(file)
    corners = [gltf["accessors"][part["attributes"]["POSITION"]] for mesh in gltf["meshes"] for part in mesh["primitives"]]
    sizes = [max(one["max"][i] for one in corners) - min(one["min"][i] for one in corners) for i in range(3)]
    return sum(size * size for size in sizes) ** 0.5


def paint(file: Path, colour: tuple[float, float, float], out: Path) -> None:
    """The file with all its surfaces in one colour, linear."""
    gltf, rest = read_glb(file)
    for part in [part for mesh in gltf["meshes"] for part in mesh["primitives"]]:
        part["attributes"].pop("COLOR_0", None)
    for material in gltf.get("materials", []):
        material.pop("extensions", None)
        for key in ("normalTexture", "occlusionTexture", "emissiveTexture"):
            material.pop(key, None)
        rough = material.setdefault("pbrMetallicRoughness", {})
        rough.pop("baseColorTexture", None)
        rough.pop("metallicRoughnessTexture", None)
        rough["baseColorFactor"] = [*colour, 1]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    out.write_bytes(b"glTF" + struct.pack("<III4s", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest)


def scene_of(size_px: int, noise: float, files: list[Path], arguments: argparse.Namespace, folder: Path) -> dict:
    lot = random.Random(f"{arguments.seed} {size_px} {noise}")
    width, hfov_deg, fps = 640, 16, 5
    range_m = 5.5 * 2277 / size_px  # 2277: focal length in px
    squares = range(1, VEHICLES + 1)
    side = lot.choice((-1, 1))
    start, end = SIDE_M * 0.5, SIDE_M * (VEHICLES + 0.5)
    seen_m = range_m * width * 0.75 / 2277  # along the flight
    seconds = (end - start) / seen_m * 2.2  # each vehicle is seen for about 2.2 s
    camera_deg = lot.uniform(-25, 25) + (90 if side > 0 else 270)
    objects = []
    for row, file in zip(squares, lot.sample(files, VEHICLES)):
        shown = file
        if not arguments.textured:
            shown = folder / f"{file.stem}.glb"
            paint(file, COLOURS[lot.choice(list(COLOURS))], shown)
        objects.append({"id": f"{file.stem}-1", "model": file.stem, "file": str(shown.resolve()), "x_m": SIDE_M * side + lot.uniform(-4, 4),
                        "y_m": SIDE_M * row + lot.uniform(-4, 4), "heading_deg": lot.uniform(0, 360)})  # fmt: skip
    return {
        "assets": str(REPOSITORY / "assets"), "seed": lot.randrange(1000),
        "video": {"frames": round(seconds * fps), "fps": fps, "width": width, "height": 480, "hfov_deg": hfov_deg, "noise": noise,
                  "grain": lot.choice((0, 1.5, 3)), "blur_px": lot.choice((0, 0.5))},
        "origin": {"latitude_deg": 52.1, "longitude_deg": 5.3, "altitude_m": 12, "heading_deg": lot.uniform(0, 360)},
        "sun": {"azimuth_deg": lot.uniform(0, 360), "elevation_deg": lot.uniform(20, 60), "strength": lot.choice((0.4, 0.7)), "sky": 0.45, "ground": 0.25},
        "camera": {"path": "linear", "aim_m": [[SIDE_M * side, start], [SIDE_M * side, end]], "from_deg": camera_deg,
                   "off_nadir_deg": lot.uniform(20, 45), "range_m": range_m, "roll_deg": lot.uniform(-4, 4)},
        "objects": objects,
        "town": {"seed": lot.randrange(1000), "density": 0.7, "columns_per_street": 100, "rows_per_street": 100,
                 "squares": [-4, -3, 4, VEHICLES + 4],
                 "tiles": [{"tile": lot.choice(TILES), "column": side, "row": row} for row in squares]},
    }  # fmt: skip


def fly(program: Program, size_px: int, noise: float, files: list[Path], arguments: argparse.Namespace, scratch: Path) -> Movie:
    folder = scratch / f"{'textured' if arguments.textured else 'plain'}_{size_px}_{noise:g}_{arguments.seed}"
    if not (folder / "video.mp4").exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene = folder / "scene.json"
        scene.write_text(json.dumps(scene_of(size_px, noise, files, arguments, folder)))
        program("simulate", scene, "--out", folder)
    return Movie(folder)


def line_of(name: str, one: dict) -> str:
    place = "-" if one["cep50_m"] is None else f"{one['cep50_m']:.2f}"
    return (f"{name:<10} {one['found']:3} of {one['findable']:3} {one['false_objects']:6} {one['recall']:8.3f} {one['precision']:10.3f} {place:>8}"
            f" {one['processor_s']:8.1f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=Path, required=True, metavar="DIR")
    parser.add_argument("--models", type=Path, required=True)
    parser.add_argument("--sizes", type=int, nargs="+", default=[40, 90], metavar="SIZE")
    parser.add_argument("--noise", type=float, nargs="+", default=[0])
    parser.add_argument("--textured", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--params", type=Path)
    parser.add_argument("--keep", type=Path, help="flights stay here; what is there is not flown again")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    files = sorted(file for file in arguments.files.glob("*.glb") if LENGTHS_M[0] <= diagonal_m(file) <= LENGTHS_M[1])
    if len(files) < VEHICLES:
        sys.exit(f"{arguments.files}: {len(files)} files (*.glb) of {LENGTHS_M[0]} to {LENGTHS_M[1]} m; {VEHICLES} are needed")
    program = Program(arguments.program)
    shown = sys.stderr if arguments.json else sys.stdout
    print("flight       found     false   recall  precision      CEP  processor", file=shown)
    results: dict[str, list[dict]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for size_px in arguments.sizes:
            for noise in arguments.noise:
                movie = fly(program, size_px, noise, files, arguments, arguments.keep or Path(scratch))
                result = measure(program, movie, 0.0, arguments)
                for name in (f"px{size_px}_{noise:g}", f"px{size_px}", "all"):
                    results.setdefault(name, []).append(result)
                print(line_of(f"{size_px}_{noise:g}", total([result])), file=shown, flush=True)
    print(line_of("all", total(results["all"])), file=shown)
    if arguments.json:
        print(json.dumps({name: total(of_name) for name, of_name in results.items()}))


if __name__ == "__main__":
    main()
