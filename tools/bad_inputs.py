#!/usr/bin/env python3
"""Some 400 wrong and hostile inputs over all commands: each must end by itself, with exit status 2 (or 1 for what is
not the input's fault), one line that says what is wrong, and nothing lost.

Usage: bad_inputs.py [PROGRAM] [DEMO] [--limit SECONDS]

PROGRAM (build/victorious) is tried on the files that `make demo` leaves in DEMO (demo): a video, a model, an index.
Works in a scratch folder. Prints each case that ends otherwise, and those that end well although something is wrong
with their input, to be judged by eye; exits with 1 if any crashed, hung, said more or less than one line, or changed a
file of the demo.
"""

import argparse
import hashlib
import os
import random
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
PROGRESS = re.compile(r"^.+: \d+( of \d+)? \w+, [\d.]+ a second(, [\d:]+ left)?$")
TELEMETRY_HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
TOO_LONG = "x" * 5000  # for a file name of any system
LINES_HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,azimuth_deg,elevation_deg\n"


def write(name: str, content: bytes | str) -> None:
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def flipped(content: bytes, start: int, count: int, draws: random.Random) -> bytes:
    damaged = bytearray(content)
    for _ in range(count):
        damaged[draws.randrange(start, len(damaged))] ^= 1 << draws.randrange(8)
    return bytes(damaged)


def make_files(demo: Path) -> None:
    """Into the current folder."""
    draws = random.Random(5)
    video = (demo / "flight/video.mp4").read_bytes()
    index = (demo / "index.db").read_bytes()
    model = (demo / "models/jeep.vmodel").read_bytes()
    cad = (REPOSITORY / "assets/models/jeep.glb").read_bytes()
    for folder in ("empty", "dir"):
        Path(folder).mkdir()
    write("lib/jeep.vmodel", model)
    write("badlib/x.vmodel", flipped(model, 0, 50, draws))
    write("cutlib/jeep.vmodel", model[:4000])
    write("txtlib/jeep.vmodel", "no model")
    write("empty.bin", "")
    write("nul.bin", bytes(4096))
    write("rand.bin", draws.randbytes(8192))
    write("text.txt", "hello\n" * 50)
    write("existing.txt", "keep me")
    write("cut.mp4", video[: len(video) // 3])
    write("headless.mp4", video[2000:90000])
    write("cut.db", index[:20000])
    write("flip.db", flipped(index, 4096, 400, draws))
    write("cut.glb", cad[:3000])
    write("length.glb", cad[:12] + struct.pack("<I", 0xFFFFFFFF) + cad[16:])
    write("index.obj", "v 1 2\nf 1 2 99999999\n")
    write("nan.obj", "v nan inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    write("flat.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n")
    write("huge.obj", "v 1e308 0 0\nv 0 1e308 0\nv 0 0 1e308\nf 1 2 3\n")
    write("outside.gltf", '{"asset":{"version":"2.0"},"buffers":[{"uri":"file:///etc/passwd","byteLength":10}]}')
    header = struct.pack(">IIBBBBB", 100000, 100000, 8, 6, 0, 0, 0)
    write("bomb.png", b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + header + bytes(4))
    write("t_columns.csv", "a,b\n1,2\n")
    write("t_nan.csv", TELEMETRY_HEADER + "0,nan,inf,1e400,0,0,0,0\n")
    write("t_back.csv", TELEMETRY_HEADER + "5,50,10,100,0,-45,0,30\n1,50,10,100,0,-45,0,30\n")
    write("t_latitude.csv", TELEMETRY_HEADER + "0,950,10,100,0,-45,0,30\n")
    write("t_short.csv", "time_s,latitude_deg\n0\n1,2,3,4\n")
    write("t_semicolon.csv", "\ufefftime_s;latitude_deg\n0;1\n")
    write("t_commas.csv", TELEMETRY_HEADER + "0,5,50,1,10,2,100,0,0,0,-45,5,0,0,30,0\n")
    write("t_utf16.csv", "\ufefftime_s;latitude_deg\n0;1\n".encode("utf-16-le"))
    write("t_zero.csv", TELEMETRY_HEADER + "0,0,0,0,0,0,0,0\n")
    write("cut.srt", "1\n00:00:00,000 --> 00:00:01,000\n[latitude: 47.37] [longitude: 8.")
    write("autel.srt", "1\n00:00:00,000 --> 00:00:01,000\nGPS(W: 71.09, N: , 86)\n\n")
    write("empty.ass", "[Script Info]\n[Events]\nDialogue: 0,0:00:01.0,GPS(W:\n")
    write("cut.klv", bytes.fromhex("060e2b34020b01010e01030101000000") + b"\x40\x0d\x04")
    write("bad.srt", "1\n00:00:00,000 --> xx\nGPS(abc)\n\n")
    for name, text in (("cut", '{"a":'), ("array", "[1,2]"), ("deep", "[" * 100000), ("twice", '{"every":1,"every":2}'),
                       ("unknown", '{"no.such":1}'), ("type", '{"every":"x"}'), ("range", '{"detect.min_score":-5}'),
                       ("nan", '{"detect.min_score":NaN}'), ("scene", '{"video":{}}')):  # fmt: skip
        write(f"{name}.json", text)
    write("truth_keys.jsonl", '{"frame":1}\n')
    write("truth_text.jsonl", "hello\n")
    write("list.csv", "image,category\nnone.png,a\n")
    write("list_columns.csv", "x\n")
    write("l_nan.csv", LINES_HEADER + "0,nan,0,0,0,0\n1,0,0,0,0,0\n")
    write("l_latitude.csv", LINES_HEADER + "0,91,0,0,0,0\n")
    write("l_none.csv", LINES_HEADER)
    write("l_one.csv", LINES_HEADER + "0,50,10,100,0,-45\n")
    os.symlink("loop", "loop")
    os.symlink("/nonexistent", "dangling")


# One a line, as in a shell; VIDEO, INDEX, TRUTH, CAD and SCENE stand for files of the demo, LONG for a name too long.
COMMANDS = r"""
model add ../x CAD --models ml
model add '' CAD --models ml
model add a/b CAD --models ml
model add x CAD --models text.txt
model add x CAD --models ml --length -1
model add x CAD --models ml --length nan
model add x CAD --models ml --step 0
model add x CAD --models ml --step 1e9
model add x CAD CAD --models ml
model add x --models ml
model remove none --models lib
model remove ../lib/jeep --models lib
model frobnicate
track VIDEO --box 1,1,50,50 --at 0 --out VIDEO
track VIDEO --at 0 --out t
track VIDEO --box 1,1,9,9 --out t
track VIDEO --box 10,10,50,50 --at 0 --out /nonexistent/x
track VIDEO --box 10,10,50,50 --at 0 --out dir
track VIDEO --box 10,10,50,50 --at 0 --out existing.txt
locate l_one.csv --motion x
locate l_one.csv --method x
export --db INDEX --format gpkg
export --db INDEX --format kml --out INDEX
export --db INDEX --format kml --out existing.txt
export --db INDEX --format mot --video none
export --db INDEX --format video --out /nonexistent/a.mp4
search --db INDEX --from 5 --to 1
search --db INDEX --from x
search --db INDEX --model none
search --db INDEX --model a --category b
search --db INDEX --image none.png
search --db INDEX --image rand.bin
search --db INDEX --image bomb.png
search --db INDEX --box 1,1,1,1
search --db INDEX --most -1
search
simulate SCENE --out existing.txt
simulate SCENE --out ''
features bomb.png --out bomb.png
features VIDEO --engine x --out f
match a
match a b --ratio 2
match a b --ratio x
category train --images dir --list list.csv --out c
category train --images none --list list.csv --out c
category train --images dir --list list_columns.csv --out c
category train --images dir --list rand.bin --out c
category classify --model rand.bin --images dir --list list.csv
category classify --model none --images dir --list list.csv
category x
navigate VIDEO --landmarks none --models lib --out n.csv
navigate none --landmarks INDEX --models lib --out n.csv
navigate VIDEO --landmarks INDEX --models none --out n.csv
navigate VIDEO --landmarks rand.bin --models lib --out n.csv
navigate VIDEO --landmarks INDEX --models lib --out VIDEO
navigate VIDEO --landmarks INDEX --models lib --out n.csv --hfov 0
navigate VIDEO --landmarks INDEX --models lib --out n.csv --hfov nan
serve --db none
serve --db rand.bin
serve --db INDEX --listen x
serve --db INDEX --listen 127.0.0.1:99999
serve --db INDEX --listen 256.1.1.1:80
serve --db INDEX --models none
serve --db dir
work --db x
work --db postgresql://127.0.0.1:9/x
submit VIDEO --models lib --db x
submit none --models lib --db postgresql://127.0.0.1:9/x
cluster status --db x
cluster
copy none x
copy INDEX INDEX
user list --db none
user add x --db none

x
--x
index
index --help x
params none
params
manual x
bench none
experiment none --out e
--json
-V x
--events 99 index
--events x index
index VIDEO --models lib --db dir
index VIDEO --models lib --db /nonexistent/a.db
index VIDEO --models lib --db text.txt
index VIDEO --models lib --db VIDEO
index VIDEO --models lib --db o6.db --from 9 --to 1
index VIDEO --models lib --db o6.db --from -1
index VIDEO --models lib --db o6.db --quality x
index VIDEO --models lib --db o6.db --hfov 0
index VIDEO --models lib --db o6.db --threads -1
index VIDEO --models lib --db o6.db --threads x
index VIDEO --db o6.db
index VIDEO --models lib --db o6.db --categories rand.bin
index VIDEO --models lib --db o6.db --camera x
index VIDEO --models lib --db o6.db --ground rand.bin
index VIDEO --models lib --db o6.db --draw x.txt
index VIDEO --models lib --db o6.db --draw VIDEO
frame VIDEO --at 1e9 --out f.png
frame VIDEO --at 0 --out VIDEO
frame VIDEO --at 0 --out f.xyz
sheet --db INDEX --out existing.txt
sheet --db INDEX --out /nonexistent/a.png
export --db INDEX --format kml --out LONG
sheet --db INDEX --out LONG.png
search --db INDEX --image LONG
simulate SCENE --out LONG
model add LONG CAD --models ml
model remove LONG --models lib
frame VIDEO --at 0 --out LONG.png
category train --images LONG --list list.csv --out c
category classify --model LONG --images dir --list list.csv
navigate VIDEO --landmarks LONG --models lib --out n.csv
serve --db INDEX --models LONG
serve --db INDEX --tiles LONG
serve --db INDEX --categories LONG
serve --db INDEX --web LONG
copy INDEX LONG
index VIDEO --models lib --db o6.db --ground LONG
index VIDEO --models lib --db o6.db --draw LONG.mp4
index VIDEO --models lib --db o6.db --categories LONG
"""


def make_cases(demo: Path) -> list[list[str]]:
    video, index, truth = (str(demo / name) for name in ("flight/video.mp4", "index.db", "flight/truth.jsonl"))
    cad, scene = str(REPOSITORY / "assets/models/jeep.glb"), str(REPOSITORY / "scenes/demo.json")
    cases = []
    sources = [
        "none.mp4", "empty.bin", "nul.bin", "rand.bin", "text.txt", "cut.mp4", "headless.mp4", "dir", "loop",
        "dangling", "/dev/null", "http://127.0.0.1:9/x", "bomb.png", "lib/jeep.vmodel", "", "-", "https://",
        "file:///etc/passwd", "concat:/etc/passwd|/etc/hosts", TOO_LONG, TOO_LONG + ".mp4",
    ]  # fmt: skip
    for v in sources:
        cases.append(["index", v, "--models", "lib", "--db", "o1.db"])
        cases.append(["doctor", v or "none"])
        cases.append(["track", v, "--box", "10,10,50,50", "--at", "0", "--out", "o.jsonl"])
        cases.append(["telemetry", v])
        cases.append(["frame", v, "--at", "0", "--out", "o.png"])
    for m in [
        "none", "empty", "badlib", "cutlib", "txtlib", "text.txt", "", "/dev/null", "lib/jeep.vmodel", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["index", video, "--models", m, "--db", "o2.db"])
        cases.append(["model", "list", "--models", m])
        cases.append(["model", "show", "jeep", "--models", m])
    for d in [
        "none.db", "empty.bin", "nul.bin", "rand.bin", "text.txt", "cut.db", "flip.db", "dir", "",
        "postgresql://127.0.0.1:9/x", "postgres://", "loop", "/dev/null", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["search", "--db", d])
        cases.append(["export", "--db", d, "--format", "objects"])
        cases.append(["evaluate", "--db", d, "--truth", truth])
        cases.append(["sheet", "--db", d, "--out", "s.png"])
        cases.append(["doctor", "--check", d])
    for c in [
        "none.glb", "empty.bin", "cut.glb", "length.glb", "index.obj", "nan.obj", "flat.obj", "huge.obj",
        "outside.gltf", "rand.bin", "bomb.png", "text.txt", "dir", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["model", "add", "x", c, "--models", "ml"])
    for t in [
        "none", "empty.bin", "rand.bin", "t_columns.csv", "t_nan.csv", "t_back.csv", "t_latitude.csv",
        "t_short.csv", "t_semicolon.csv", "bad.srt", "t_commas.csv", "t_utf16.csv", "t_zero.csv", "cut.srt",
        "autel.srt", "empty.ass", "cut.klv", "dir", "bomb.png", video, TOO_LONG,
    ]:  # fmt: skip
        cases.append(["telemetry", t])
        cases.append(["index", video, "--telemetry", t, "--models", "empty", "--db", "o3.db"])
    for p in [
        "none", "empty.bin", "cut.json", "array.json", "deep.json", "twice.json", "unknown.json", "type.json",
        "range.json", "nan.json", "rand.bin", "dir", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["index", video, "--models", "lib", "--db", "o4.db", "--params", p])
    for e in [
        "0", "-1", "x", "1e9", "2.5", "", "99999999999999999999",
    ]:  # fmt: skip
        cases.append(["index", video, "--models", "lib", "--db", "o5.db", "--every", e])
    for b in [
        "1,2,3", "a,b,c,d", "0,0,0,0", "-5,-5,3,3", "nan,0,1,1", "1e9,1e9,5,5", "10,10,5000,5000,9", "",
    ]:  # fmt: skip
        cases.append(["track", video, "--box", b, "--at", "0", "--out", "t.jsonl"])
    for a in [
        "-1", "nan", "1e9", "x", "",
    ]:  # fmt: skip
        cases.append(["track", video, "--box", "10,10,50,50", "--at", a, "--out", "t.jsonl"])
    for l in [
        "none", "empty.bin", "rand.bin", "l_nan.csv", "l_latitude.csv", "l_none.csv", "t_columns.csv",
        "l_one.csv", "dir", "bomb.png", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["locate", l])
    for f in [
        "x", "", "objects,mot",
    ]:  # fmt: skip
        cases.append(["export", "--db", index, "--format", f])
    for n in [
        "x", "1,2", "91,0,5", "0,0,-5", "nan,nan,nan", "0,0,1e999", "1,2,3,4",
    ]:  # fmt: skip
        cases.append(["search", "--db", index, "--near", n])
    for t in [
        "none", "empty.bin", "truth_cut.jsonl", "truth_text.jsonl", "rand.bin", "dir", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["evaluate", "--db", index, "--truth", t])
    for s in [
        "none", "empty.bin", "cut.json", "array.json", "deep.json", "scene_cut.json", "rand.bin", "dir", TOO_LONG,
    ]:  # fmt: skip
        cases.append(["simulate", s, "--out", "sim"])
    for i in [
        "none", "empty.bin", "rand.bin", "bomb.png", "text.txt", "dir", video, TOO_LONG,
    ]:  # fmt: skip
        cases.append(["features", i, "--out", "f.txt"])
        cases.append(["match", i, i])
    files = {"VIDEO": video, "INDEX": index, "TRUTH": truth, "CAD": cad, "SCENE": scene, "LONG": TOO_LONG}
    lines = COMMANDS.strip("\n").split("\n")
    return cases + [[files.get(word, word) for word in shlex.split(line)] for line in lines]


def digest(demo: Path) -> list[str]:
    return [hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(demo.rglob("*")) if path.is_file()]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default=REPOSITORY / "build/victorious", type=Path)
    parser.add_argument("demo", nargs="?", default=REPOSITORY / "demo", type=Path)
    parser.add_argument("--limit", type=float, default=120)
    arguments = parser.parse_args()
    program, demo = arguments.program.resolve(), arguments.demo.resolve()
    before = digest(demo)
    wrong = judged = 0
    scratch = Path(tempfile.mkdtemp(prefix="bad-inputs-"))
    os.chdir(scratch)
    make_files(demo)
    cases = make_cases(demo)
    for case in cases:
        try:
            done = subprocess.run(
                [program, *case], capture_output=True, timeout=arguments.limit, stdin=subprocess.DEVNULL, check=False
            )
        except subprocess.TimeoutExpired:
            print("HANGS:", *case, flush=True)
            wrong += 1
            continue
        said = [line for line in done.stderr.decode(errors="replace").splitlines() if not PROGRESS.match(line)]
        errors = [line for line in said if not line.startswith(("warning: ", "info: "))]
        if done.returncode == 0:
            judged += 1
            print("well?", *case, "|", " // ".join(said)[:300], flush=True)
        elif done.returncode not in (1, 2) or len(errors) != 1:
            wrong += 1
            print(f"WRONG: status {done.returncode}, {len(errors)} lines:", *case, "|", " // ".join(said)[:300],
                  flush=True)  # fmt: skip
        elif done.returncode == 1:
            judged += 1
            print("status 1?", *case, "|", errors[0][:300], flush=True)
    if Path("existing.txt").read_text() != "keep me" or digest(demo) != before:
        wrong += 1
        print("WRONG: a file was changed")
    os.chdir(REPOSITORY)
    shutil.rmtree(scratch)
    print(f"{len(cases)} cases: {wrong} wrong, {judged} to be judged")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
