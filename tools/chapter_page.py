#!/usr/bin/env python3
"""Reproduces the tables and figures of a thesis chapter and writes docs/chapterN.md from them.

Usage: chapter_page.py CHAPTER PROGRAM [--data DIR] [--results DIR] [--docs DIR] [--frames N]
CHAPTER is 3 (matches and the cascade) or 5 (chapters 4 and 5: tracking, geolocation and the whole system).
Runs `PROGRAM experiment NAME` for each experiment without a NAME.json in the results folder, then writes the page and
copies its images to docs/images/chapterN. Run it from the repository's root. --frames is passed to the experiments to
shorten the flights.
"""

import argparse
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

MAX_IMAGE_BYTES = 150_000

# Experiment name, heading, introduction, images besides the plot.
Section = tuple[str, str, str, list[str]]

CHAPTER3_SECTIONS: list[Section] = [
    ("table3.2", "Table 3.2: the cascade at a ratio of 0.8",
     "The running example stands for the thesis's Humvee: a jeep in a noisy picture, seen from an azimuth of 150 and an "
     "off-nadir angle of 60 degrees, and the template of the nearest view.", []),
    ("figure3.10", "Figure 3.10: the same, drawn", "", ["figure3.10.png"]),
    ("table3.3", "Table 3.3: six ratios",
     "Looser ratios let more true matches in and many more false ones; the cascade is what makes them usable.", []),
    ("figure3.11", "Figure 3.11: the same, drawn", "", ["figure3.11.png"]),
    ("figure3.12", "Figure 3.12: ROC of the stages",
     "Each stage moves the points to the left, to fewer false alarms at the same share of detected keypoints.", []),
    ("table3.4", "Table 3.4: a second object", "A jet stands for the thesis's MiG.", []),
    ("figure3.13", "Figure 3.13: the same, drawn", "", ["figure3.13.png"]),
    ("table3.5", "Table 3.5: time",
     "More keypoints than the thesis's are matched here, so that absolute times are not of one task; how they grow is.", []),
    ("figure3.14", "Figure 3.14: which view is it", "", ["figure3.14.png"]),
    ("figure3.15", "Figure 3.15: the same as bars", "", ["figure3.15.png"]),
    ("figure3.16", "Figure 3.16: objects found", "", ["figure3.16.png"]),
    ("chapter3.filters", "Filters compared over every scene",
     "Not in the thesis: the cascade beside Video Google's voting by nearest neighbours (k = 15, m = 1), each stage "
     "alone, and robust fits without any cascade, in every scene file and movie at hand. Then what the thesis leaves open: "
     "R, whether support must be distinct, and thresholds learnt from simulated pictures.", []),
    ("chapter3.sweeps", "Filters under one difficulty at a time", "", []),
]

CHAPTER3_HEAD = """# Chapter 3: matches and the cascade

The thesis's tables and figures of sections 3.3 and 3.5, repeated on the project's own scenes, and what it does not show:
baselines, open choices and difficulties one at a time.
Written by `tools/chapter_page.py 3 build/victorious --data $VICTORIOUS_DATA` from what `victorious experiment NAME` measures.

Its setting is `--params thesis`: Lowe's keypoints without noise taken out first, table 3.1, R = 75 px.
Ours is the program's default: twice as many, fainter keypoints and salt-and-pepper noise taken out, by the same cascade.
Whether a match is true is known from the simulator alone: the template keypoint's place on the object, by the rendering's depth, goes
through the true pose into the picture. Within 3 px or the keypoint's scale of it and not hidden, it is true; beyond 10 px
false; between them near, which is neither. Of movies only the known objects' depth is known: what the town hides there counts as seen.
The thesis's own scenes are lost, so its counts are of other pictures.
"""

WHAT_IS_MISSED = """
What is missed is in small or noisy objects at loose ratios: a true match with few true neighbours among thousands of false
ones gets too low an approval, and the cascade asks for two votes. What is left false is mostly groups of matches that agree
with each other: a repeated pattern, or another vehicle.
At tight ratios, and wherever the object is large in the picture, MLESAC alone does as well as the cascade; with a ratio of 0.8
and more, small objects and hidden ones it takes the wrong group, and costs more.
"""


def cell(value) -> str:
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"
    return str(value)


def table(rows: list[dict], columns: list[str] | None = None) -> str:
    columns = columns or list(rows[0])
    lines = ["| " + " | ".join(columns) + " |", "|" + " --- |" * len(columns)]
    lines += ["| " + " | ".join(cell(row[column]) for column in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def pivot(rows: list[dict], keys: list[str], name: str, show, names: list[str]) -> list[dict]:
    """One row per value of the keys, one column per name; each cell is show(row)."""
    pivoted: dict[tuple, dict] = {}
    for row in rows:
        if row[name] in names:
            key = tuple(row[k] for k in keys)
            pivoted.setdefault(key, {k: row[k] for k in keys})[row[name]] = show(row)
    return list(pivoted.values())


def filters_text(rows: list[dict]) -> str:
    text = "Share of the true matches kept, and of false ones among what is left:\n\n"
    everything = [row for row in rows if row["trials"].startswith("all")]
    ratios = sorted({row["ratio"] for row in everything})

    def shares(row):
        return f"{row['true kept %']:.1f} / {row['false % of kept matches']:.2f}"

    for setting in ("thesis", "ours"):
        mine = [row for row in everything if row["setting"] == setting]
        full = [row["filter"] for row in mine if row["ratio"] == ratios[0]]
        text += f"Setting: {setting}, {mine[0]['trials']} trials.\n\n"
        text += table([{"filter": f} | {str(row["ratio"]): shares(row) for row in mine if row["filter"] == f}
                       for f in full])
        loose = [row for row in mine if row["ratio"] == ratios[-1]]
        text += "\nThe same at a ratio of 0.95, and what is open:\n\n"
        text += table(loose, ["filter", "true before", "true kept %", "false before", "false after", "near after",
                              "false % of kept matches", "false before / after", "ms per trial"]) + "\n"
        unseen = [row for row in rows if row["setting"] == setting and row["trials"].startswith("unseen")]
        text += "Thresholds learnt on every second flight, measured on the others:\n\n"
        text += table(pivot(unseen, ["ratio"], "filter", shares,
                            ["cascade, table 3.1", "cascade, learnt thresholds",
                             "cascade, learnt, all measures in each stage"])) + "\n"
    return text


def sweeps_text(rows: list[dict]) -> str:
    names = ["neighbours (Video Google)", "first stage alone", "cascade", "cascade, R from scale", "cascade, then MLESAC",
             "MLESAC alone", "OpenCV's homography alone"]
    text = "Share of the true matches kept, and the number of false ones left:\n\n"
    for setting in ("thesis", "ours"):
        mine = [row for row in rows if row["setting"] == setting]
        text += f"Setting: {setting}.\n\n"
        text += table(pivot(mine, ["difficulty", "value", "true before", "false before"], "filter",
                            lambda row: f"{row['true kept %']:.0f} % / {row['false after']:.0f}", names)) + "\n"
    return text


def body(name: str, rows: list[dict]) -> str:
    if name == "chapter3.filters":
        return filters_text(rows)
    if name == "chapter3.sweeps":
        return sweeps_text(rows)
    return table(rows)


def example_line(name: str, rows: list[dict], before: str, after: str, key: str, thesis: str) -> str:
    """A line on one running example: true matches kept and false matches left, summed over all ratios."""
    counts = []
    for setting in ("thesis setting reproduced", "ours"):
        kept, whole, wrong = (sum(row[f"{setting}: {which}"] for row in rows if row[key] == when)
                              for which, when in (("true", after), ("true", before), ("false", after)))
        counts.append(f"{setting} {kept:.0f} of {whole:.0f} kept, {wrong:.0f} false left")
    return f"- {name}, all ratios together: {'; '.join(counts)} (thesis: {thesis}).\n"


def match_fractions(rows: list[dict]) -> str:
    """Of all matches of the rows: true matches kept, false ones among the rest, reduction factor of false ones."""
    before = sum(row["true before"] for row in rows)
    kept = sum(row["true before"] * row["true kept %"] / 100 for row in rows)
    false_after = sum(row["false after"] for row in rows)
    left = kept + false_after + sum(row["near after"] for row in rows)
    false_before = sum(row["false before"] for row in rows)
    fewer = f"{false_before / false_after:.0f}" if false_after else f"> {false_before:.0f}"
    return f"{100 * kept / before:.2f} %, {100 * false_after / left:.2f} %, {fewer}"


def cascade_targets(reports: dict[str, dict]) -> str:
    """Targets and results of the cascade."""
    text = example_line("The running example", reports["table3.3"]["rows"], "none", "third", "filtering",
                         "55 of 55, none false")
    text += example_line("The second object", reports["table3.4"]["rows"], "before", "after", "when",
                         "25 of 26, none false")
    text += ("- Over every scene tried, as shares: true kept (98 % asked), false among what is left (0.5 % asked), and "
             "how many times fewer false ones there are (100 asked; > N: none of N is left). Learnt thresholds, those "
             "of half the flights, are measured on the other half; `--params learnt` is near them.\n\n")
    rows = reports["chapter3.filters"]["rows"]
    wanted = {("all", "cascade"): "table 3.1", ("unseen", "cascade, table 3.1"): "table 3.1, unseen half",
              ("unseen", "cascade, learnt, all measures in each stage"): "learnt, unseen half"}
    cells: dict[tuple, dict[str, list[dict]]] = {}
    for setting in ("thesis", "ours"):
        for ratio in sorted({row["ratio"] for row in rows}) + ["together"]:
            for row in rows:
                column = wanted.get((row["trials"].split()[0], row["filter"]))
                if column and row["setting"] == setting and ratio in (row["ratio"], "together"):
                    cells.setdefault((setting, ratio), {}).setdefault(column, []).append(row)
    return text + table([{"setting": setting, "ratio": ratio} | {name: match_fractions(some[name]) for name in wanted.values()}
                         for (setting, ratio), some in cells.items() if len(some) == len(wanted)
                         ]) + WHAT_IS_MISSED


CHAPTER5_SECTIONS: list[Section] = [
    ("figure4.1", "Figure 4.1: what a tracker saves the recogniser", "", ["figure4.1.png"]),
    ("figure4.2", "Figure 4.2: a steady lock", "", ["figure4.2.png"]),
    ("figure4.3", "Figure 4.3: the conic frustum of one sighting", "", []),
    ("figure4.4", "Figure 4.4: what is common to many", "", []),
    ("figure4.5", "Figure 4.5: the architecture at work",
     "The thesis draws the parts; here is what they do: the list of objects over time.", []),
    ("figure5.2", "Figure 5.2: recall and precision of objects", "", []),
    ("figure5.3", "Figure 5.3: frame detection density", "", []),
    ("figure5.4", "Figure 5.4: errors of place by kind", "", []),
    ("figure5.5", "Figure 5.5: the helicopter and all others",
     "The helicopter stands for the thesis's Apache, the jeep for its Humvee, the tank for its Abrams, the jet for its "
     "MiG.", []),
]

CHAPTER5_HEAD = """# Chapters 4 and 5: tracking, places, the whole system

The thesis's figures of tracking, geolocation and the whole system, repeated on flights over the project's own town.
Written by `tools/chapter_page.py 5 build/victorious --data $VICTORIOUS_DATA{more}` from what `victorious experiment NAME`
measures. Flights, models and indexes are made once and kept in the results' folder, so that figures 5.2 to 5.5 are of
the same runs.
"""

# Targets: density quartiles (25, 50, 75 %), and position errors, m, at 50, 75 and 90 %.
TARGET_DENSITIES = (0.90, 0.97, 1.0)
TARGET_ERRORS_M = (0.3, 0.5, 1.0)


def format_three(row: dict, keys: tuple[str, str, str], digits: int) -> str:
    return " / ".join(f"{row[key]:.{digits}f}" for key in keys)


def system_targets(reports: dict[str, dict]) -> str:
    """Targets and results of the whole system."""
    settings = reports["figure5.2"]["rows"]
    whole = sum(row["recall"] == 1 for row in settings)
    clean = sum(row["precision"] == 1 for row in settings)
    perfect = sum(row["recall"] == 1 and row["precision"] == 1 for row in settings)
    max_ids = max(row["ids per object"] for row in settings)
    densities = reports["figure5.3"]["rows"][0]
    in_view = ("in view, 25 %", "in view, 50 %", "in view, 75 %")
    between = ("first to last, 25 %", "first to last, 50 %", "first to last, 75 %")
    percents = ("CEP 50 %, m", "75 %, m", "90 %, m")
    rows = [
        {"what": f"settings with a recall of 1, of {len(settings)}", "asked for": ">= 27", "thesis": "26",
         "here": f"{whole}"},
        {"what": f"settings with a precision of 1, of {len(settings)}", "asked for": ">= 26", "thesis": "-",
         "here": f"{clean}"},
        {"what": "settings with both", "asked for": "-", "thesis": "8", "here": f"{perfect}"},
        {"what": "ids per object, most of a setting", "asked for": "1.00", "thesis": "-",
         "here": f"{max_ids:.2f}"},
        {"what": "density of the frames in view, quartiles",
         "asked for": " / ".join(f">= {asked:.2f}" for asked in TARGET_DENSITIES), "thesis": "0.452 / 0.634 / 0.896",
         "here": format_three(densities, in_view, 3)},
        {"what": "density from the first to the last report, quartiles", "asked for": "-",
         "thesis": "-", "here": format_three(densities, between, 3)},
    ]
    others = [row for row in reports["figure5.5"]["rows"] if row["objects"] == "all others"]
    for row in reports["figure5.4"]["rows"] + others:
        rows.append({"what": f"place error of {row['objects']}, 50 / 75 / 90 %, m",
                     "asked for": " / ".join(f"<= {asked}" for asked in TARGET_ERRORS_M),
                     "thesis": row["thesis: 50 / 75 / 90 %, m"], "here": format_three(row, percents, 3)})
    return table(rows)


@dataclass
class Chapter:
    """A page: its head, its summary of targets, and one section per experiment."""

    head: str
    targets: Callable[[dict[str, dict]], str]
    sections: list[Section]


CHAPTERS = {
    "3": Chapter(CHAPTER3_HEAD, cascade_targets, CHAPTER3_SECTIONS),
    "5": Chapter(CHAPTER5_HEAD, system_targets, CHAPTER5_SECTIONS),
}


def read_reports(arguments: argparse.Namespace, sections: list[Section]) -> dict[str, dict]:
    """The report of each experiment by name; runs the experiments that have none."""
    reports = {}
    for name, *_ in sections:
        file = arguments.results / f"{name}.json"
        if not file.exists():
            command = [arguments.program, "experiment", name, "--out", arguments.results, "--data", arguments.data]
            if arguments.frames:
                command += ["--frames", str(arguments.frames)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        reports[name] = json.loads(file.read_text())
    return reports


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("chapter", choices=list(CHAPTERS))
    parser.add_argument("program", type=Path)
    parser.add_argument("--data", type=Path, default=Path("../shared/data"))
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--docs", type=Path, default=Path("docs"))
    parser.add_argument("--frames", type=int)
    arguments = parser.parse_args()
    chapter = CHAPTERS[arguments.chapter]
    folder = f"chapter{arguments.chapter}"
    pictures = arguments.docs / "images" / folder
    pictures.mkdir(parents=True, exist_ok=True)
    reports = read_reports(arguments, chapter.sections)

    more = f" --frames {arguments.frames}" if arguments.frames else ""
    page = chapter.head.replace("{more}", more) + "\n## In short\n\n" + chapter.targets(reports)
    for name, heading, words, drawn in chapter.sections:
        report = reports[name]
        page += f"\n## {heading}\n\n`victorious experiment {name}`: {report['title']}.\n"
        if words:
            page += words + "\n"
        page += "\n" + body(name, report["rows"]).rstrip() + "\n"
        for note in report["notes"]:
            page += f"\n{note}\n"
        plot = f"{name}.svg"
        for picture in drawn + ([plot] if (arguments.results / plot).exists() else []):
            size = (arguments.results / picture).stat().st_size
            if size > MAX_IMAGE_BYTES:
                print(f"{picture}: {size} bytes: must be at most {MAX_IMAGE_BYTES}", file=sys.stderr)
                return 1
            shutil.copy(arguments.results / picture, pictures / picture)
            page += f"\n![{heading}](images/{folder}/{picture})\n"
    (arguments.docs / f"{folder}.md").write_text(page)
    return 0


if __name__ == "__main__":
    sys.exit(main())
