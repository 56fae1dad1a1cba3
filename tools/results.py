#!/usr/bin/env python3
"""Measures the figures of bench/results/rows with the program at hand, and writes docs/results.md.

Usage: results.py [PATTERN...] [--list] [--count] [--again] [--reread] [--limit SECONDS] [--dry-run] [--root DIR]
Runs, cheapest first, the commands of the rows that are stale: whose sources differ from the commit at which they were
measured. PATTERN (as of a shell, of the names of runs and rows) selects; --again measures fresh ones as well; --limit
starts no run that would exceed so many seconds in all, by the table. Each figure is stored (bench/results/measured.json)
as soon as it is measured, so that the next call goes on where this one ended. What a command printed stays in
$OUT/outputs; --reread reads it again, if it is of the same sources, instead of running the command: after a change to the
table. What lacks its data or its program is SKIPPED, by name. In commands, $DATA is the folder of external data ($VICTORIOUS_DATA, default ../shared/data), $OUT
that of flights and indexes ($OUT, default build/results), $MODELS the library of all CAD models of $DATA ($MODELS,
default $OUT/models), $OWN_MODELS that of assets/models. --list prints each row with its state, --count how many are stale.
"""

import argparse
import datetime
import fnmatch
import json
import os
import platform
import re
import string
import subprocess
import sys
from pathlib import Path

import intervals
import results_page
from results_table import (Figure, Row, Run, differing, digest_of, field, has_history, is_met, is_stale, read_measured,
                           read_table, write_measured)  # fmt: skip

LIBRARIES = {"$MODELS": "$DATA/models", "$OWN_MODELS": "assets/models"}  # and the folder of their CAD files


def folders(root: Path) -> dict[str, str]:
    """What the variables in commands stand for."""
    data = os.environ.get("DATA") or os.environ.get("VICTORIOUS_DATA") or str(root / "../shared/data")
    out = os.environ.get("OUT") or str(root / "build/results")
    models = os.environ.get("MODELS") or f"{out}/models"
    return {"DATA": data, "OUT": out, "MODELS": models, "OWN_MODELS": f"{out}/own_models"}


def expanded(text: str, where: dict[str, str]) -> str:
    return re.sub(r"\$([A-Z_]+)", lambda name: where.get(name[1], name[0]), text)


def missing(run: Run, root: Path, where: dict[str, str]) -> str | None:
    """What the run needs and is not there: data, or a program below build/."""
    programs = re.findall(r"build[\w-]*/[\w-]+", run.command)
    libraries = [cad for library, cad in LIBRARIES.items() if library in run.command]
    for need in [*run.needs, *programs, *libraries]:
        if not (root / expanded(need, where)).exists():
            return need
    return None


def make_libraries(run: Run, root: Path, where: dict[str, str]) -> None:
    """Makes the models that the run searches for, unless their folder exists."""
    for library, cad in LIBRARIES.items():
        folder = root / expanded(library, where)
        if library not in run.command or folder.exists():
            continue
        made = folder.with_name(folder.name + ".part")
        for file in sorted((root / expanded(cad, where)).glob("*.glb")):
            print(f"adding {file.stem} to {folder}", file=sys.stderr, flush=True)
            subprocess.run([root / "build/victorious", "model", "add", file.stem, file, "--models", made], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        made.rename(folder)


def parsed(run: Run, text: str) -> dict:
    """The output of a run as paths address it. Raises ValueError if it is not as the table says."""
    if run.output == "json":
        output = json.loads(text, object_pairs_hook=lambda pairs: {key.replace(".", "_"): value for key, value in pairs})
        return output if isinstance(output, dict) else {"all": output}
    match = re.search(run.output, text, re.MULTILINE | re.DOTALL)
    if not match:
        raise ValueError(f"the output does not match {run.output}")
    return match.groupdict()


def percent(low: float, high: float) -> str:
    return f"{100 * low:.1f} to {100 * high:.1f} %"


def uncertainty(row: Row, output: dict) -> tuple[int, str]:
    """The number of cases and the 95 % interval, if the row says of what."""
    if row.rate:
        count, cases = (round(float(field(path, output))) for path in row.rate)
        return cases, percent(*intervals.wilson(count, cases)) if cases else ""
    if row.sample:
        numbers = [number for number in field(row.sample, output) if number is not None]
        between = intervals.median_of(numbers)
        return len(numbers), f"median {between[0]:.3g} to {between[1]:.3g}" if between else ""
    return 0, ""


class FigureFormat(string.Formatter):
    """Lists are written with commas, what there is not as a dash."""

    def format_field(self, value: object, form: str) -> str:
        if isinstance(value, list):
            return ", ".join(self.format_field(one, form) for one in value)
        return "-" if value is None else super().format_field(value, form)


def figure_of(row: Row, output: dict, origin: dict[str, str]) -> Figure:
    value = FigureFormat().vformat(row.value, (), output)
    cases, interval = uncertainty(row, output)
    return Figure(re.sub(r"(?<=\d)%", " %", value), cases=cases, interval=interval, missed=not is_met(row, output),
                  note=row.note, **origin)  # fmt: skip


def machine() -> str:
    """Its processor, as Linux names it, the number of cores, and the work on it in the last five minutes."""
    try:
        name = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    except OSError:
        name = None
    return f"{name[1] if name else platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[1]:.0f}"


def commit_of(root: Path, run: Run) -> str:
    """HEAD; with "+" if sources of the run are not committed."""
    head = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], cwd=root, capture_output=True, text=True, check=True)
    commit = head.stdout.strip()
    changed = any(path.startswith(run.sources) for path in differing(root, commit) or ())
    return commit + ("+" if changed else "")


def run_command(run: Run, root: Path, where: dict[str, str]) -> dict:
    """What the command printed, and its origin: commit, digest of the sources, date, machine. Raises ValueError if it fails."""
    make_libraries(run, root, where)
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", run.command], cwd=root, env=os.environ | where,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # fmt: skip
    if done.returncode != 0:
        raise ValueError(f"exit status {done.returncode}: {done.stderr.strip()[-500:]}")
    origin = {"commit": commit_of(root, run), "digest": digest_of(root, run), "date": datetime.date.today().isoformat(),
              "machine": machine()}  # fmt: skip
    return {"text": done.stdout, "origin": origin}


def kept_output(run: Run, where: dict[str, str]) -> Path:
    return Path(where["OUT"]) / "outputs" / f"{run.name}.json"


def measure(run: Run, root: Path, where: dict[str, str], reread: bool) -> dict[str, Figure]:
    """Raises ValueError if the command fails or its output is not as the table says."""
    kept = kept_output(run, where)
    kept.parent.mkdir(parents=True, exist_ok=True)
    if reread:
        printed = json.loads(kept.read_text(encoding="utf-8"))
    else:
        printed = run_command(run, root, where)
        kept.write_text(json.dumps(printed), encoding="utf-8")
    try:
        output = parsed(run, printed["text"])
        return {row.name: figure_of(row, output, printed["origin"]) for row in run.rows}
    except (KeyError, IndexError, TypeError) as error:
        raise ValueError(f"no such value in the output: {error!r}") from error


def can_reread(run: Run, root: Path, where: dict[str, str]) -> bool:
    """Whether an output is kept of the sources at hand."""
    kept = kept_output(run, where)
    return kept.exists() and json.loads(kept.read_text(encoding="utf-8"))["origin"]["digest"] == digest_of(root, run)


def selected(runs: list[Run], patterns: list[str]) -> list[Run]:
    def wanted(run: Run) -> bool:
        names = [run.name, run.topic.name, *(row.name for row in run.rows)]
        return not patterns or any(fnmatch.fnmatch(name, pattern) for name in names for pattern in patterns)

    return sorted(filter(wanted, runs), key=lambda run: run.seconds)


def state(root: Path, run: Run, row: Row, figures: dict[str, Figure]) -> str:
    return "stale" if is_stale(root, run, figures.get(row.name)) else "fresh"


def list_rows(root: Path, runs: list[Run], figures: dict[str, Figure]) -> None:
    for run in runs:
        for row in run.rows:
            value = figures[row.name].value if row.name in figures else "never measured"
            print(f"{state(root, run, row, figures):<6} {run.seconds:>6.0f} s {run.name} / {row.name}: {value}")


def count_rows(root: Path, runs: list[Run], figures: dict[str, Figure]) -> str:
    states = [state(root, run, row, figures) for run in runs for row in run.rows]
    return (f"results: {states.count('fresh')} of {len(states)} figures are of these sources, {states.count('stale')} are stale "
            "(tools/results.py --list)")  # fmt: skip


def is_wanted(run: Run, root: Path, figures: dict[str, Figure], arguments: argparse.Namespace) -> bool:
    if arguments.reread:
        return can_reread(run, root, folders(root))
    return arguments.again or any(state(root, run, row, figures) == "stale" for row in run.rows)


def run_all(root: Path, runs: list[Run], arguments: argparse.Namespace) -> bool:
    """Whether no run failed."""
    where, figures = folders(root), read_measured(root)
    spent, good = 0.0, True
    for run in runs:
        if not is_wanted(run, root, figures, arguments):
            continue
        if (lacking := missing(run, root, where)) is not None:
            print(f"SKIPPED: {run.name}: {lacking} is not there", flush=True)
            continue
        if spent + run.seconds > arguments.limit:
            print(f"{run.name}: {run.seconds:.0f} s: beyond --limit", flush=True)
            break
        spent += run.seconds
        print(f"{run.name}: {expanded(run.command, where)}", flush=True)
        if arguments.dry_run:
            continue
        try:
            measured = measure(run, root, where, arguments.reread)
        except ValueError as error:
            print(f"FAILED: {run.name}: {error}", flush=True)
            good = False
            continue
        figures = read_measured(root) | measured
        write_measured(root, figures)
        for name, figure in measured.items():
            print(f"  {name}: {figure.value}{' (missed)' if figure.missed else ''}", flush=True)
    return good


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("patterns", nargs="*", metavar="PATTERN")
    parser.add_argument("--list", action="store_true", help="print each row with its state")
    parser.add_argument("--count", action="store_true", help="print how many rows are stale")
    parser.add_argument("--again", action="store_true", help="measure fresh rows as well")
    parser.add_argument("--reread", action="store_true", help="read kept outputs again, run nothing")
    parser.add_argument("--limit", type=float, default=float("inf"), metavar="SECONDS")
    parser.add_argument("--dry-run", action="store_true", help="print the commands only")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    if not has_history(root):
        print("SKIPPED: results: not a git checkout")
        return 77
    runs = selected(read_table(root), arguments.patterns)
    if not runs:
        parser.error(f"{' '.join(arguments.patterns)}: names no run and no row: --list prints them")
    if arguments.list:
        list_rows(root, runs, read_measured(root))
        return 0
    if arguments.count:
        print(count_rows(root, runs, read_measured(root)))
        return 0
    good = run_all(root, runs, arguments)
    if not arguments.dry_run:
        results_page.write(root)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
