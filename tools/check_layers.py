#!/usr/bin/env python3
"""Checks project rules that the compiler does not: the include layers (layers.toml), the places where third-party
headers may be included, the one way to run in parallel (oneTBB), the length of files, and the absence of markers of
unfinished work.

Usage: check_layers.py [ROOT]
Prints one line per finding, "path:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from pathlib import Path
from typing import Iterator, NamedTuple

import findings
from findings import Finding, library_of, read_levels

SOURCES = Path("src/victorious")
PUBLIC_HEADERS = Path("include/victorious")
LIBRARY = SOURCES / "apps/library"
CODE_FOLDERS = ("include", "src", "experiments", "assets/make", "testing", "tests", "bench", "examples")
CODE_ENDINGS = (".h", ".cc", ".cu")
LONGEST_FILE = 600  # lines

PUBLIC_HEADER = re.compile(r"victorious/[a-z_]+\.h$")
STANDARD_HEADER = re.compile(r"[a-z_]+$")
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"(?P<quoted>[^"]+)"|<(?P<angled>[^>]+)>)')
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX)\b|\bnot (?:yet )?implemented\b", re.IGNORECASE)
# Threads of one's own, and other libraries' parallel loops. std::thread::hardware_concurrency() starts none.
OTHER_PARALLEL = re.compile(
    r"\bcv::parallel_for_|\bcv::ParallelLoopBody|\bstd::(?:jthread\b|thread\b(?!::hardware_concurrency)|async\b)"
    r"|\bstd::execution::par|\bpthread_create\b|#\s*pragma\s+omp\b"
)
PARALLEL_FOLDERS = (SOURCES.as_posix(), "experiments", "assets/make", "bench", "examples")
# Files of these folders with a thread of their own, each with the reason.
MAY_START_THREADS = (
    "bench/bench_queue.cc",  # workers that wait for the database, many more than cores
    "src/victorious/base/isolated_test_program.cc",  # shows that the sandbox lets a decoder start one
    "src/victorious/apps/cli/cmd_record.cc",  # enters files while the database may not answer, and packets come
    "src/victorious/apps/cluster/worker.cc",  # renews a lease while the database may not answer
    "src/victorious/apps/serve/job_runner.h",  # waits for child processes, which live as long as the thread that started them
    "src/victorious/apps/serve/live_service.h",  # watches the index while no request comes
    "src/victorious/apps/serve/live_service.cc",
)
PROJECT_ROOTS = ("victorious/", "experiments/", "assets/make/", "testing/", "tests/", "bench/", "hwy/")


class ThirdParty(NamedTuple):
    header: re.Pattern  # of the included path
    place: re.Pattern  # of the paths, relative to src/victorious, that may include it
    right: str  # the rule, for the message
    everywhere: bool = False  # also outside src/victorious, where no file may include it


CLI11_SOURCES = r"apps/cli/(argument_parser|describe_commands|output_files)\.cc$"
CLI11_RULE = "CLI11 stays in argument_parser.cc and two sources of cli/: others include victorious/apps/cli/argument_parser.h"

THIRD_PARTY = (
    ThirdParty(re.compile(r"lib(av|sw)[a-z]+/"), re.compile(r"input/video/"), "FFmpeg stays inside video/"),
    ThirdParty(re.compile(r"assimp/"), re.compile(r"object/mesh/"), "assimp stays inside mesh/"),
    ThirdParty(re.compile(r"(EGL|GL|GLES\d?)/"), re.compile(r"object/render/"), "OpenGL and EGL stay inside render/"),
    ThirdParty(re.compile(r"sqlite3(ext)?\.h$"), re.compile(r"store/sqlite/"), "SQLite stays inside store/sqlite/"),
    ThirdParty(re.compile(r"libpq-fe\.h$"), re.compile(r"store/postgres/"), "libpq stays inside store/postgres/"),
    ThirdParty(re.compile(r"libexif/"), re.compile(r"input/telemetry/photo(_test)?\.cc$"), "libexif stays inside input/telemetry/photo.cc"),
    ThirdParty(re.compile(r"opencv2/dnn"), re.compile(r"category/network/network_runner\.cc$"), "OpenCV's dnn stays inside category/network/network_runner.cc"),
    ThirdParty(re.compile(r"hwy/"), re.compile(r"kernels/"), "Highway stays inside kernels/"),
    ThirdParty(re.compile(r"GeographicLib/"), re.compile(r"geometry/.*\.cc$"), "GeographicLib stays inside geometry/"),
    ThirdParty(re.compile(r"(gdal|ogr|cpl|osr)\w*\.h$"), re.compile(r"(input/terrain|show/export)/.*\.cc$"), "GDAL stays inside terrain/ and export/"),
    ThirdParty(re.compile(r"ceres/"), re.compile(r"place/geolocate/.*\.cc$"), "Ceres stays inside geolocate/"),
    ThirdParty(re.compile(r"boost/"), re.compile(r"apps/serve/(.*\.cc|(client_stream|beast_message)\.h)$"), "Boost stays inside serve/"),
    ThirdParty(re.compile(r"openssl/"), re.compile(r"apps/serve/.*\.cc$"), "OpenSSL stays inside serve/"),
    ThirdParty(re.compile(r"sodium(/|\.h$)"), re.compile(r"apps/serve/.*\.cc$"), "libsodium stays inside serve/"),
    ThirdParty(re.compile(r"CLI/"), re.compile(CLI11_SOURCES), CLI11_RULE, everywhere=True),
    ThirdParty(re.compile(r"nlohmann/json\.hpp$"), re.compile(r".*\.cc$"), "headers include nlohmann/json_fwd.hpp"),
    ThirdParty(re.compile(r"(experiments|assets/make|bench)/"), re.compile(r"$^"), "the product includes no research and no tool"),
    ThirdParty(re.compile(r"testing/"), re.compile(r".*_test\.(cc|h)$"), "only tests may include testing/"),
)


class Include(NamedTuple):
    line: int
    path: str
    quoted: bool


def includes_of(text: str) -> Iterator[Include]:
    for number, line in enumerate(text.splitlines(), start=1):
        if match := INCLUDE.match(line):
            yield Include(number, match["quoted"] or match["angled"], match["quoted"] is not None)


def check_folders(root: Path, levels: dict[str, int]) -> Iterator[Finding]:
    """Every library is listed, and every listed folder is one. The last parts of their paths, which name them, differ."""
    lists = (root / SOURCES).rglob("CMakeLists.txt")
    present = {path.parent.relative_to(root / SOURCES).as_posix() for path in lists} - {"."}
    for name in sorted(present - levels.keys()):
        yield Finding(SOURCES / name, 1, f"folder {name} is not listed in layers.toml: give it a level")
    last_parts = [name.split("/")[-1] for name in levels]
    for name in levels:
        if last_parts.count(name.split("/")[-1]) > 1:
            yield Finding(Path("layers.toml"), 1, f"lists {name}, whose last part names another folder, too: rename one")
    for name in sorted(levels.keys() - present):
        yield Finding(Path("layers.toml"), 1, f"lists {name}, which is no folder of {SOURCES}: take it out")


def check_level(path: Path, include: Include, levels: dict[str, int]) -> Iterator[Finding]:
    """A folder may include itself and folders of a lower level.

    A test may also include folders of its own level: it feeds one stage with the output of another.
    """
    folder = library_of(path.relative_to(SOURCES).as_posix(), levels)
    target = library_of(include.path.removeprefix("victorious/"), levels)
    if target is None:
        yield Finding(path, include.line, f"includes {include.path}: layers.toml lists no folder of it")
    elif folder and target != folder and levels[target] >= levels[folder] + path.name.endswith("_test.cc"):
        yield Finding(
            path,
            include.line,
            f"includes {include.path} (level {levels[target]}) from {folder} (level {levels[folder]}): "
            "only lower levels may be included",
        )


def check_public_include(path: Path, include: Include) -> Iterator[Finding]:
    """A public header includes the standard library and other public headers; of the tree, library/ alone includes it."""
    if not path.is_relative_to(PUBLIC_HEADERS):
        if path.is_relative_to(SOURCES) and not path.is_relative_to(LIBRARY):
            yield Finding(path, include.line, f"includes {include.path}: the public headers are for callers of the library")
    elif include.quoted or not (PUBLIC_HEADER.match(include.path) or STANDARD_HEADER.match(include.path)):
        yield Finding(
            path, include.line, f"includes {include.path}: a public header includes <victorious/….h> and the standard library"
        )


def check_includes(path: Path, text: str, levels: dict[str, int]) -> Iterator[Finding]:
    in_sources = path.is_relative_to(SOURCES)
    for include in includes_of(text):
        if path.is_relative_to(PUBLIC_HEADERS) or PUBLIC_HEADER.match(include.path):
            yield from check_public_include(path, include)
            continue
        if in_sources and include.path.startswith("victorious/"):
            yield from check_level(path, include, levels)
        if include.quoted and not include.path.startswith(PROJECT_ROOTS):
            yield Finding(
                path, include.line, f'includes "{include.path}": name it from the root, as "victorious/folder/file.h"'
            )
        if include.path == "opencv2/opencv.hpp":
            yield Finding(path, include.line, f"includes {include.path}: include the modules that are used")
        place = path.relative_to(SOURCES if in_sources else Path()).as_posix()
        for rule in THIRD_PARTY:
            here = in_sources and rule.place.match(place)
            if (in_sources or rule.everywhere) and rule.header.match(include.path) and not here:
                yield Finding(path, include.line, f"includes {include.path}: {rule.right}")


def check_text(path: Path, text: str) -> Iterator[Finding]:
    lines = text.splitlines()
    if len(lines) > LONGEST_FILE:
        yield Finding(path, len(lines), f"{len(lines)} lines, more than {LONGEST_FILE}: split it by subject")
    for number, line in enumerate(lines, start=1):
        if match := UNFINISHED.search(line):
            yield Finding(path, number, f'says "{match[0]}": finish it, or open an issue and say what holds today')


def check_parallel(path: Path, text: str) -> Iterator[Finding]:
    """Parallel work runs on oneTBB's workers, so that nested loops share the cores. Tests may start threads."""
    if path.name.endswith("_test.cc") or path.as_posix() in MAY_START_THREADS:
        return
    if not any(path.is_relative_to(folder) for folder in PARALLEL_FOLDERS):
        return
    for number, line in enumerate(text.splitlines(), start=1):
        if match := OTHER_PARALLEL.search(line.split("//")[0]):
            yield Finding(path, number, f"uses {match[0]}: run in parallel by oneTBB, or list the file in MAY_START_THREADS")


def code_files(root: Path) -> Iterator[Path]:
    for folder in CODE_FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in CODE_ENDINGS and path.is_file():
                yield path.relative_to(root)


def check(root: Path) -> list[Finding]:
    levels = read_levels(root)
    findings = list(check_folders(root, levels))
    for path in code_files(root):
        text = (root / path).read_text(encoding="utf-8", errors="replace")
        findings += check_includes(path, text, levels)
        findings += check_parallel(path, text)
        findings += check_text(path, text)
    return findings


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
