"""Shared by the end-to-end tests: the program as a child process, a synthetic flight, and checks of error output."""

import atexit
import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import NamedTuple

TIMEOUT_S = 600  # of one command: far more than a busy machine needs
SKIPPED = 77  # exit status of a file whose tests were all skipped
FRAMES = 40  # of the synthetic flight, 10 a second
SEARCHED_FRAMES = 20  # of these, as a whole: one each 0.2 s
PROGRESS = re.compile(r"^.+: \d+( of \d+)? \w+, [\d.]+ a second(, [\d:]+ left|, up to [\d.]+ s behind)?$")
REPOSITORY = Path(__file__).resolve().parents[2]


os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp(prefix="victorious-e2e-cache-")
atexit.register(shutil.rmtree, os.environ["XDG_CACHE_HOME"], ignore_errors=True)


def built(name: str, variable: str) -> Path:
    """The program that the variable names (ctest sets it), else that of the release build."""
    path = Path(os.environ.get(variable, REPOSITORY / "build" / name)).resolve()
    if not path.exists():
        sys.exit(f"{path} is not there: build it (make build), or set {variable} to the built program")
    return path


PROGRAM = built("victorious", "VICTORIOUS_PROGRAM")
DRAW_FLIGHT = built("draw_flight", "VICTORIOUS_DRAW_FLIGHT")
# Where ctest's e2e/inputs (make_inputs.py) keeps what most of these files read; without it each file makes its own.
INPUTS = Path(os.environ["VICTORIOUS_E2E_INPUTS"]) if "VICTORIOUS_E2E_INPUTS" in os.environ else None


class Outcome(NamedTuple):
    status: int
    out: str
    err: str

    def messages(self) -> list[str]:
        """The lines on stderr except progress."""
        return [line for line in self.err.splitlines() if not PROGRESS.match(line)]

    def rows(self) -> list[dict]:
        """Standard output as JSON Lines."""
        return [json.loads(line) for line in self.out.splitlines()]


class Server:
    """`victorious serve` on a free port, as a context manager. `url` ends without a slash.

    Without `db`, on the index of the folder `cwd`."""

    def __init__(self, db: Path | None, *flags, listen="127.0.0.1:0", cwd: Path | None = None):
        index = [] if db is None else ["--db", db]
        command = [PROGRAM, "serve", *index, "--listen", listen, *flags]
        self.process = subprocess.Popen(
            list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd
        )
        self.url = self.process.stdout.readline().strip().rstrip("/")

    def __enter__(self) -> "Server":
        assert self.url.startswith("http"), self.process.communicate()[1]
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.err = self.process.communicate(timeout=TIMEOUT_S)[1]


def run(*arguments, timeout_s: float = TIMEOUT_S, **options) -> Outcome:
    done = subprocess.run(
        [PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=timeout_s, check=False, **options
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def folder_until_exit() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="victorious-e2e-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def self_signed(folder: Path, name: str, subject: str = "localhost", alternative: str | None = "IP:127.0.0.1") -> tuple[Path, Path]:
    """NAME.pem and NAME.key in the folder: a certificate that signs itself, and its key. Needs openssl."""
    files = (folder / f"{name}.pem", folder / f"{name}.key")
    new = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-noenc", "-days", "2", "-subj", f"/CN={subject}")
    names = ("-addext", f"subjectAltName={alternative}") if alternative else ()
    subprocess.run(["openssl", "req", "-x509", *new, *names, "-out", files[0], "-keyout", files[1]], check=True, capture_output=True)
    return files


@functools.cache
def flight(frames: int = FRAMES) -> Path:
    """A folder with flight.mkv, flight.mp4, flight.ts, truth.jsonl and photos (draw_flight.cc). Read-only."""
    return INPUTS / "flight" if INPUTS and frames == FRAMES else make_flight(folder_until_exit(), frames)


def make_flight(folder: Path, frames: int = FRAMES) -> Path:
    subprocess.run([DRAW_FLIGHT, folder, str(frames)], check=True)
    return folder


@functools.cache
def models() -> Path:
    """A model library with the crate and the truck. Read-only."""
    return INPUTS / "models" if INPUTS else make_models(flight(), folder_until_exit() / "models")


def make_models(flight_folder: Path, folder: Path) -> Path:
    for name in ("crate", "truck"):
        done = run("model", "add", name, flight_folder / f"{name}.png", "--models", folder)
        assert done.status == 0, done.err
    return folder


@functools.cache
def index() -> Path:
    """An index of flight.mkv. Read-only."""
    return INPUTS / "index.db" if INPUTS else make_index(flight(), models(), folder_until_exit() / "index.db")


def make_index(flight_folder: Path, library: Path, path: Path) -> Path:
    done = run("index", flight_folder / "flight.mkv", "--models", library, "--db", path)
    assert done.status == 0, done.err
    return path


# A jeep beside a road: a second of video.
PLACED_SCENE = {
    "assets": str(REPOSITORY / "assets"),
    "seed": 3,
    "video": {"frames": 12, "fps": 5, "width": 320, "height": 240, "hfov_deg": 20, "noise": 0.01, "blur_px": 0.4},
    "origin": {"latitude_deg": 48.1, "longitude_deg": 11.6, "altitude_m": 560, "heading_deg": 25},
    "camera": {"aim_m": [[22, 26], [26, 26]], "from_deg": [170, 190], "off_nadir_deg": 35, "range_m": 60},
    "objects": [{"id": "jeep-1", "model": "jeep", "x_m": 24, "y_m": 26, "heading_deg": 40}],
    "town": {"squares": [1, 1, 1, 1], "tiles": [{"tile": "apron", "column": 1, "row": 1}]},
}


def make_placed_flight(folder: Path) -> tuple[Path, Path]:
    """A rendered flight over a jeep with telemetry beside the video, and a folder with the model of the jeep."""
    scene = folder / "scene.json"
    scene.write_text(json.dumps(PLACED_SCENE))
    cad = REPOSITORY / "assets" / "models" / "jeep.glb"
    for command in (
        ("simulate", scene, "--out", folder / "flight"),
        ("model", "add", "jeep", cad, "--models", folder / "models", "--step", "20", "--max-off-nadir", "60"),
    ):
        done = run(*command)
        assert done.status == 0, done.err
    (folder / "flight" / "telemetry.csv").rename(folder / "flight" / "video.mp4.telemetry.csv")
    return folder / "flight" / "video.mp4", folder / "models"


def plain_image(path: Path, width: int = 160, height: int = 120) -> Path:
    """A uniform grey image, without features."""
    path.write_bytes(b"P6\n%d %d\n255\n" % (width, height) + b"\x80" * (3 * width * height))
    return path


class ProgramTest(unittest.TestCase):
    maxDiff = 4000

    def setUp(self):
        self.scratch = Path(tempfile.mkdtemp(prefix="victorious-e2e-"))
        self.addCleanup(shutil.rmtree, self.scratch, ignore_errors=True)

    def succeeds(self, *arguments, **options) -> Outcome:
        done = run(*arguments, **options)
        self.assertEqual(done.status, 0, done.err)
        return done

    def refuses(self, status: int, words, *arguments, **options) -> str:
        """Checks that the program exits with `status` and one line of error that contains all `words`, without any output."""
        done = run(*arguments, **options)
        said = f"{' '.join(map(str, arguments))}\n{done.err}"
        self.assertEqual(done.status, status, said)
        self.assertEqual(done.out, "", said)
        messages = done.messages()
        self.assertEqual(len(messages), 1, said)
        self.assertRegex(messages[0], r"^error: ", said)
        for word in [words] if isinstance(words, (str, Path)) else words:
            self.assertIn(str(word), messages[0], said)
        return messages[0]

    def files(self) -> dict[str, bytes]:
        """The contents of the files in the scratch folder, by name."""
        return {
            str(path.relative_to(self.scratch)): path.read_bytes() for path in self.scratch.rglob("*") if path.is_file()
        }

    def write(self, name: str, content) -> Path:
        path = self.scratch / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def export(self, db: Path, form: str, *flags) -> str:
        return self.succeeds("export", "--db", db, "--format", form, *flags).out


def main():
    result = unittest.main(module="__main__", exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if result.testsRun > 0 and len(result.skipped) == result.testsRun else 0)
