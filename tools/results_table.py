"""The table of measurements, what was measured, measured.json, and how old that is.

bench/results/table.toml has the topics, rows/TOPIC.toml the runs of each. A run is one command; its rows are the figures
that are read from its output. A figure is stale if a source that it depends on differs from what was measured: by the
digest of the sources, which outlives a rebase; a figure that has none, by its commit.
"""

import functools
import hashlib
import json
import operator
import re
import string
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

TABLE = Path("bench/results/table.toml")
ROWS = Path("bench/results/rows")  # TOPIC.toml
MEASURED = Path("bench/results/measured.json")
ROOMS = "src/victorious"
COMPARISONS = {"<=": operator.le, ">=": operator.ge, "==": operator.eq}
# What changes no figure.
NO_SOURCE = re.compile(r"(_test\.cc|_test\.py|\.md|CMakeLists\.txt)$")


@dataclass(frozen=True)
class Topic:
    name: str
    heading: str
    details: str = ""  # page in docs/results/
    rooms: tuple[str, ...] = ()  # folders of src/victorious, or names of groups, if a run names none


@dataclass(frozen=True)
class Row:
    """One figure. Paths are those of str.format, with _ for a point: `all[errors_m]`, `rows[0][CEP 50 %, m]`."""

    name: str
    what: str
    value: str  # format of the figure; its fields are paths into the output
    target: str = "-"
    limits: tuple[tuple[str, str], ...] = ()  # path, comparison: ("all[recall]", ">= 0.85")
    rate: tuple[str, ...] = ()  # paths of a count and of the number of cases
    sample: str = ""  # path of the numbers whose median is the figure
    note: str = ""


@dataclass(frozen=True)
class Run:
    name: str
    topic: Topic
    command: str
    rows: tuple[Row, ...]
    sources: tuple[str, ...]  # paths from the root
    output: str = "json"  # on standard output; or a regular expression with named groups, searched there
    needs: tuple[str, ...] = ()  # paths without which it is skipped
    seconds: float = 0  # of processor time, roughly
    judged: str = "-"  # "held out": no threshold was chosen on these data; "tuned on"


@dataclass(frozen=True)
class Figure:
    """What was measured for a row."""

    value: str
    commit: str  # with "+": from sources that were not committed
    date: str
    machine: str = ""
    cases: int = 0
    interval: str = ""  # 95 %
    missed: bool = False
    note: str = ""
    digest: str = ""  # of the sources that it depends on


def _strings(values: dict) -> dict:
    return {key: tuple(value) if isinstance(value, list) else value for key, value in values.items()}


def _row(entry: dict) -> Row:
    limits = tuple(entry.pop("limits", {}).items())
    for path, limit in limits:
        if limit.split()[0] not in COMPARISONS:
            raise ValueError(f"{entry['name']}: limit {path} {limit}: must begin with one of {', '.join(COMPARISONS)}")
    return Row(limits=limits, **_strings(entry))


def _run(entry: dict, topic: Topic, groups: dict[str, list[str]]) -> Run:
    rows = tuple(_row(row) for row in entry.pop("row"))
    named = entry.pop("rooms", topic.rooms)
    rooms = [room for name in named for room in groups.get(name, [name])]
    sources = [f"{ROOMS}/{room}/" for room in dict.fromkeys(rooms)] + entry.pop("sources", [])
    return Run(topic=topic, rows=rows, sources=tuple(sources), **_strings(entry))


def _runs_of(topic: Topic, root: Path, groups: dict[str, list[str]]) -> list[Run]:
    path = ROWS / f"{topic.name}.toml"
    try:
        return [_run(entry, topic, groups) for entry in tomllib.loads((root / path).read_text(encoding="utf-8"))["run"]]
    except (KeyError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from error


def read_table(root: Path) -> list[Run]:
    """In the order of the topics. Raises ValueError for what the table must not contain."""
    table = tomllib.loads((root / TABLE).read_text(encoding="utf-8"))
    topics = [Topic(name, **_strings(entry)) for name, entry in table["topic"].items()]
    strays = {file.stem for file in (root / ROWS).glob("*.toml")} - {topic.name for topic in topics}
    if strays:
        raise ValueError(f"{ROWS}: {', '.join(sorted(strays))}: no topic of {TABLE}")
    runs = [run for topic in topics for run in _runs_of(topic, root, table["group"])]
    names = [run.name for run in runs]
    rows = [row.name for run in runs for row in run.rows]
    for name in names + rows:
        if names.count(name) > 1 or rows.count(name) > 1:
            raise ValueError(f"{ROWS}: {name}: must be the name of one run and of one row")
    return runs


def read_measured(root: Path) -> dict[str, Figure]:
    """By the name of the row."""
    entries = json.loads((root / MEASURED).read_text(encoding="utf-8"))
    return {name: Figure(**entry) for name, entry in entries.items()}


def write_measured(root: Path, figures: dict[str, Figure]) -> None:
    def changed(figure: Figure) -> dict:
        return {key: value for key, value in vars(figure).items() if value}

    entries = {name: changed(figure) for name, figure in sorted(figures.items())}
    (root / MEASURED).write_text(json.dumps(entries, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def field(path: str, output: dict) -> object:
    return string.Formatter().get_field(path, (), output)[0]


def is_met(row: Row, output: dict) -> bool:
    for path, limit in row.limits:
        comparison, number = limit.split()
        if not COMPARISONS[comparison](float(field(path, output)), float(number)):
            return False
    return True


@functools.cache
def tracked(root: Path) -> tuple[tuple[str, str], ...]:
    """Path and hash of each source in git's index."""
    done = subprocess.run(["git", "ls-files", "-s"], cwd=root, capture_output=True, text=True, check=True)
    lines = (line.partition("\t") for line in done.stdout.splitlines())
    return tuple((path, entry.split()[1]) for entry, _, path in lines if not NO_SOURCE.search(path))


def digest_of(root: Path, run: Run) -> str:
    mine = "".join(f"{path} {blob}\n" for path, blob in tracked(root) if path.startswith(run.sources))
    return hashlib.sha256(mine.encode()).hexdigest()[:16]


@functools.cache
def differing(root: Path, commit: str) -> tuple[str, ...] | None:
    """The sources that differ from the commit; None if there is no such commit."""
    done = subprocess.run(["git", "diff", "--name-only", commit], cwd=root, capture_output=True, text=True)
    if done.returncode != 0:
        return None
    return tuple(path for path in done.stdout.splitlines() if not NO_SOURCE.search(path))


def is_stale(root: Path, run: Run, figure: Figure | None) -> bool:
    if figure is None or figure.commit.endswith("+"):
        return True
    if figure.digest:
        return figure.digest != digest_of(root, run)
    paths = differing(root, figure.commit)
    return paths is None or any(path.startswith(run.sources) for path in paths)


def has_history(root: Path) -> bool:
    return subprocess.run(["git", "rev-parse", "HEAD"], cwd=root, capture_output=True).returncode == 0
