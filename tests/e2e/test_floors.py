"""Floors of the search for CAD models, on a flight made here: recall, precision, places, false objects. A constant that is
wrong by much falls through one of them.

The flight shows ten objects of eight of the project's models, one of them painted in one grey: no keypoints, the search by
shape alone finds it. Searched for are also fifteen models that it does not show: the other six, and nine of these in the
paint of another. Few views and a short flight keep it under a minute on two cores."""

import json
import struct
from pathlib import Path

import program

ASSETS = program.REPOSITORY / "assets"
SHOWN = ("fire_engine", "helicopter", "jeep", "jet", "pickup", "police_car", "tank", "tanker")
ABSENT = ("ambulance", "boat_trailer", "bus", "container_truck", "excavator", "propeller_plane")
PAINTS = (1, 2)  # of the models after it in ABSENT, of the first four and a half
VIEWS = ("--step", 15, "--max-off-nadir", 60)
GREY = "tanker"
# How the flight is rendered and compressed depends on the processor: on some at most one object is false, on an AMD EPYC
# without AVX-512 three are, ambulances for parked vans, with scores of 0.50, 0.60 and 0.69.
MAX_FALSE = 3
MAX_FALSE_SCORE = 0.75
SCENE = {
    "assets": str(ASSETS),
    "seed": 3,
    "video": {"frames": 48, "fps": 6, "width": 640, "height": 480, "hfov_deg": 18, "grain": 2},
    "origin": {"latitude_deg": 48.137, "longitude_deg": 11.575, "altitude_m": 565, "heading_deg": 17},
    "sun": {"azimuth_deg": 112, "elevation_deg": 52, "strength": 0.5, "sky": 0.58, "ground": 0.3},
    "camera": {
        "path": "linear", "aim_m": [[-58, 22], [58, 22]], "from_deg": [186, 174], "off_nadir_deg": 35, "range_m": 130,
        "roll_deg": 2,
    },
    "objects": [
        {"id": "jet-1", "model": "jet", "x_m": -55, "y_m": 26, "heading_deg": 112},
        {"id": "jeep-1", "model": "jeep", "x_m": -39, "y_m": 17, "heading_deg": 28},
        {"id": "police_car-1", "model": "police_car", "x_m": -31, "y_m": 27, "heading_deg": 200},
        {"id": "fire_engine-1", "model": "fire_engine", "x_m": -20, "y_m": 20, "heading_deg": 75},
        {"id": "pickup-1", "model": "pickup", "x_m": -6, "y_m": 27, "heading_deg": 330},
        {"id": "tanker-1", "model": "tanker", "x_m": 3, "y_m": 18, "heading_deg": 140},
        {"id": "helicopter-1", "model": "helicopter", "x_m": 19, "y_m": 24, "heading_deg": 250},
        {"id": "jeep-2", "model": "jeep", "x_m": 32, "y_m": 17, "heading_deg": 160},
        {"id": "tanker-2", "model": "tanker", "x_m": 42, "y_m": 27, "heading_deg": 60},
        {"id": "tank-1", "model": "tank", "x_m": 55, "y_m": 20, "heading_deg": 120},
    ],
    "town": {
        "seed": 11,
        "density": 0.6,
        "tiles": [
            {"tile": tile, "column": column, "row": 1}
            for column, tile in zip(range(-2, 3), ("apron", "parking", "yard", "helipad", "court"))
        ],
    },
}  # fmt: skip


class Glb:
    """A GLB file of one mesh, one material, one image."""

    def __init__(self, name: str):
        content = (ASSETS / "models" / f"{name}.glb").read_bytes()
        length = struct.unpack_from("<I", content, 12)[0]
        self.json = json.loads(content[20 : 20 + length])
        self.binary = content[28 + length :]

    def image(self) -> bytes:
        view = self.json["bufferViews"][self.json["images"][0]["bufferView"]]
        return self.binary[view.get("byteOffset", 0) :][: view["byteLength"]]

    def paint_grey(self):
        for material in self.json["materials"]:
            surface = material["pbrMetallicRoughness"]
            surface.pop("baseColorTexture")
            surface["baseColorFactor"] = [0.4, 0.4, 0.4, 1]

    def paint_as(self, other: "Glb"):
        """The other's image, on its own surface."""
        image = other.image()
        view = self.json["bufferViews"][self.json["images"][0]["bufferView"]]
        self.binary += bytes(-len(self.binary) % 4)
        view["byteOffset"], view["byteLength"] = len(self.binary), len(image)
        self.binary += image

    def write(self, path: Path):
        self.binary += bytes(-len(self.binary) % 4)
        self.json["buffers"][0]["byteLength"] = len(self.binary)
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.binary)
        path.write_bytes(
            b"glTF" + struct.pack("<II", 2, size) + struct.pack("<I", len(text)) + b"JSON" + text
            + struct.pack("<I", len(self.binary)) + b"BIN\0" + self.binary
        )  # fmt: skip


class FloorsTest(program.ProgramTest):
    def make_flight(self) -> Path:
        grey = Glb(GREY)
        grey.paint_grey()
        grey.write(self.scratch / "grey.glb")
        scene = json.loads(json.dumps(SCENE))
        next(one for one in scene["objects"] if one["id"] == f"{GREY}-2")["file"] = str(self.scratch / "grey.glb")
        folder = self.scratch / "flight"
        self.succeeds("simulate", self.write("scene.json", json.dumps(scene)), "--out", folder)
        return folder

    def make_models(self) -> Path:
        folder = self.scratch / "models"
        for name in SHOWN + ABSENT:
            self.succeeds("model", "add", name, ASSETS / "models" / f"{name}.glb", "--models", folder, *VIEWS)
        repainted = [(name, paint) for paint in PAINTS for name in ABSENT][:9]
        for name, paint in repainted:
            other = ABSENT[(ABSENT.index(name) + paint) % len(ABSENT)]
            model = Glb(name)
            model.paint_as(Glb(other))
            path = self.scratch / f"{name}_{other}.glb"
            model.write(path)
            self.succeeds("model", "add", path.stem, path, "--models", folder, *VIEWS)
        self.assertEqual(len(list(folder.glob("*.vmodel"))), len(SHOWN) + 15)
        return folder

    def test_recall_precision_places_and_false_objects(self):
        flight = self.make_flight()
        db = self.scratch / "index.db"
        self.succeeds(
            "index", flight / "video.mp4", "--telemetry", flight / "telemetry.csv", "--models", self.make_models(), "--db", db
        )
        score = json.loads(self.succeeds("evaluate", "--db", db, "--truth", flight / "truth.jsonl", "--json").out)
        listed = self.succeeds("search", "--db", db, "--rejected").out
        self.assertGreaterEqual(score["findable"], 9)
        self.assertEqual(score["found"], score["findable"], listed)
        self.assertGreaterEqual(score["sighting_recall"], 0.9, listed)
        self.assertGreaterEqual(score["sighting_precision"], 0.9, listed)
        self.assertLessEqual(score["false_objects"], MAX_FALSE, listed)
        self.assertLessEqual(score["cep75_m"], 0.3, listed)
        self.assertGreaterEqual(score["inside_ce90"], 0.75, listed)
        self.assertLessEqual(score["heading_error_p50_deg"], 1, listed)
        weak = [one for one in self.succeeds("search", "--db", db, "--json").rows() if one["model"] not in SHOWN]
        self.assertTrue(all(one["score"] < MAX_FALSE_SCORE for one in weak), listed)


if __name__ == "__main__":
    program.main()
