"""What the checks of this folder share: a finding, and the program about a check."""

import tomllib
from pathlib import Path
from typing import Callable, Iterable, NamedTuple


class Finding(NamedTuple):
    path: Path
    line: int  # from 1
    message: str

    def __str__(self) -> str:
        return f"{self.path.as_posix()}:{self.line}: {self.message}"


def read_levels(root: Path) -> dict[str, int]:
    """The folders of layers.toml, relative to src/victorious, with their levels."""
    return tomllib.loads((root / "layers.toml").read_text(encoding="utf-8"))["levels"]


def library_of(path: str, folders: Iterable[str]) -> str | None:
    """The folder of layers.toml that a path belongs to, both relative to src/victorious: the longest that holds it."""
    return max((folder for folder in folders if path.startswith(f"{folder}/")), key=len, default=None)


def run(check: Callable[[Path], Iterable[Finding]], arguments: list[str]) -> int:
    """Prints the findings in the tree at arguments[0], by default this repository; the exit status is 1 if there is any."""
    findings = list(check(Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent))
    for finding in findings:
        print(finding)
    return 1 if findings else 0
