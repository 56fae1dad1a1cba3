#!/usr/bin/env python3
"""Measures whether the scores of objects can be believed, over several indexes with truth.

Usage: object_scores.py INDEX=TRUTH... [--program build/victorious] [--rejected] [--fit]

INDEX is an index of one video, TRUTH its truth.jsonl, or "none" for a video that shows none of the models: then every
object is wrong. --rejected counts rejected objects, too: without them wrong objects are few.

Prints one row per index (right and wrong objects, mean score of each), then over all: the reliability by score, the
calibration error (ten bins of equal width), the Brier score, and the separation (area under the ROC), as
`victorious evaluate --scores` defines them; the wrong objects with the highest scores and the right ones with the lowest,
with what speaks against each. --fit prints the weights of place/associate/object_score.cc that logistic regression gives for
these objects, and their calibration error when each index is left out in turn. Wrong objects are few, and right and
wrong ones nearly separable, so each weight has a normal prior (PRIOR): the a contrario test alone would give the
strength a weight of 1, and patterns that look like the model in every frame make it less; a size 10 % off, or a third
of the headings, should weigh about as much as three units of strength.
"""

import argparse
import json
import math
import tempfile
from pathlib import Path

from movies import Program

MAX_STRENGTH, USUAL_SIZE, MAX_SIZE, MIN_COUNTED = 20, 0.05, 0.5, 3  # as in place/associate/object_score.cc


def fraction(part: int, whole: int) -> float:
    return part / whole if whole >= MIN_COUNTED else 0


def inputs(evidence: dict) -> list[float]:
    """1 and the x_k of place/associate/object_score.cc."""
    size = min(abs(math.log(evidence["size_ratio"] or 1)), MAX_SIZE)
    return [
        1,
        min(evidence["strength"], MAX_STRENGTH),
        max(0, size - USUAL_SIZE),
        fraction(evidence["missing_lines"], evidence["lines"]),
        fraction(evidence["contradicting_headings"], evidence["headings"]),
        min(evidence["place_weight"], 0),
        fraction(evidence["view_jumps"], evidence["view_steps"]),
    ]


# Mean and standard deviation of each weight before the objects are seen.
PRIOR = {
    "kBias": (-2.0, 1.0),
    "kStrengthWeight": (0.6, 0.15),
    "kSizeWeight": (-20.0, 5.0),
    "kMissingWeight": (-2.0, 1.0),
    "kHeadingWeight": (-5.0, 1.5),
    "kPlaceWeight": (1.0, 0.3),
    "kJumpWeight": (-5.0, 1.5),
}


def probability(weights: list[float], x: list[float]) -> float:
    return 1 / (1 + math.exp(-max(-60.0, min(60.0, sum(w * v for w, v in zip(weights, x, strict=True))))))


def solve(matrix: list[list[float]], right: list[float]) -> list[float]:
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    n = len(rows)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(n):
            if i != k:
                factor = rows[i][k] / rows[k][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    return [rows[k][n] / rows[k][k] for k in range(n)]


def fit(objects: list[dict]) -> list[float]:
    """The most probable weights (logistic regression with the prior), by Newton's method."""
    means = [mean for mean, _ in PRIOR.values()]
    precisions = [sigma**-2 for _, sigma in PRIOR.values()]
    weights = list(means)
    for _ in range(50):
        gradient = [-p * (w - m) for p, w, m in zip(precisions, weights, means, strict=True)]
        hessian = [[precisions[i] * (i == j) for j in range(len(weights))] for i in range(len(weights))]
        for one in objects:
            p = probability(weights, one["x"])
            for i, a in enumerate(one["x"]):
                gradient[i] += (one["right"] - p) * a
                for j, b in enumerate(one["x"]):
                    hessian[i][j] += p * (1 - p) * a * b
        weights = [w + s for w, s in zip(weights, solve(hessian, gradient), strict=True)]
    return weights


def mean(values: list[float]) -> str:
    return f"{sum(values) / len(values):.3f}" if values else "-"


def bins_of(objects: list[dict]) -> dict[int, list[dict]]:
    bins: dict[int, list[dict]] = {}
    for one in objects:
        bins.setdefault(min(int(one["score"] * 10), 9), []).append(one)
    return dict(sorted(bins.items()))


def calibration_error(objects: list[dict]) -> float:
    return sum(abs(sum(one["score"] - one["right"] for one in part)) for part in bins_of(objects).values()) / len(objects)


def separation(objects: list[dict]) -> float | None:
    right = [one["score"] for one in objects if one["right"]]
    wrong = [one["score"] for one in objects if not one["right"]]
    if not right or not wrong:
        return None
    return sum((a > b) + (a == b) / 2 for a in right for b in wrong) / (len(right) * len(wrong))


def read(program: Program, index: str, truth: str, rejected: bool, scratch: Path) -> list[dict]:
    if truth == "none":
        empty = scratch / "empty.jsonl"
        empty.write_text("")
        truth = str(empty)
    flags = ["--rejected"] if rejected else []
    judged = json.loads(program("evaluate", "--db", index, "--truth", truth, "--scores", "--json", *flags))["reliability"]
    listed = {
        row["object_id"]: row
        for row in map(json.loads, program("search", "--db", index, "--json", *flags).splitlines())
    }
    objects = []
    for one in judged["objects"]:
        row = listed[one["object_id"]]
        if row["evidence"] is None:
            raise SystemExit(f"{index}: made by an older version: run `index` on its video again")
        objects.append({**one, "x": inputs(row["evidence"]), "against": row["against"], "index": Path(index).stem,
                        "rejected": row.get("rejected", "")})  # fmt: skip
    return objects


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("indexes", nargs="+", metavar="INDEX=TRUTH")
    parser.add_argument("--program", default="build/victorious")
    parser.add_argument("--rejected", action="store_true")
    parser.add_argument("--fit", action="store_true")
    arguments = parser.parse_args()
    program = Program(arguments.program)
    objects: list[dict] = []
    print(f"{'index':<20}{'right':>6}{'wrong':>6}{'score of right':>16}{'of wrong':>10}")
    with tempfile.TemporaryDirectory() as scratch:
        for pair in arguments.indexes:
            index, _, truth = pair.partition("=")
            own = read(program, index, truth or "none", arguments.rejected, Path(scratch))
            objects += own
            right = [one["score"] for one in own if one["right"]]
            wrong = [one["score"] for one in own if not one["right"]]
            print(f"{Path(index).stem:<20}{len(right):>6}{len(wrong):>6}{mean(right):>16}{mean(wrong):>10}", flush=True)
    if not objects:
        raise SystemExit("no objects")
    print(f"\n{'score':<12}{'objects':>8}{'mean score':>12}{'right':>8}")
    for number, part in bins_of(objects).items():
        print(f"{number / 10:.1f} to {(number + 1) / 10:.1f}  {len(part):>8}{mean([one['score'] for one in part]):>12}"
              f"{mean([float(one['right']) for one in part]):>8}")  # fmt: skip
    brier = sum((one["score"] - one["right"]) ** 2 for one in objects) / len(objects)
    apart = separation(objects)
    print(f"\n{len(objects)} objects: calibration error {calibration_error(objects):.3f}, Brier score {brier:.3f}, "
          f"separation {'-' if apart is None else f'{apart:.3f}'}")  # fmt: skip
    for title, is_right in (("wrong, highest scores", False), ("right, lowest scores", True)):
        print(f"\n{title}:")
        extreme = sorted((one for one in objects if one["right"] == is_right), key=lambda one: one["score"], reverse=not is_right)
        for one in extreme[:8]:
            print(f"  {one['score']:.3f} {one['index']} {one['model']}: {'; '.join(one['against']) or '-'}"
                  f"{' (rejected)' if one['rejected'] else ''}")  # fmt: skip
    if arguments.fit:
        weights = fit(objects)
        print("\n" + "\n".join(f"{name} = {weight:.2f}" for name, weight in zip(PRIOR, weights, strict=True)))
        left_out = []
        for index in sorted({one["index"] for one in objects}):
            rest = fit([one for one in objects if one["index"] != index])
            left_out += [{**one, "score": probability(rest, one["x"])} for one in objects if one["index"] == index]
        print(f"each index left out in turn: calibration error {calibration_error(left_out):.3f}, "
              f"separation {separation(left_out) or 0:.3f}")  # fmt: skip


if __name__ == "__main__":
    main()
