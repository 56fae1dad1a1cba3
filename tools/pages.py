"""What the generators of pages share: they write their files below docs/, or compare them with what is there."""

import sys
from pathlib import Path


def publish(files: dict[Path, str], check: bool, tool: str) -> int:
    """Writes the texts; with `check` only compares them. The exit status is 1 if a file is out of date."""
    for target, text in files.items():
        if not check:
            target.write_text(text, encoding="utf-8")
        elif not target.exists() or target.read_text(encoding="utf-8") != text:
            print(f"{target} is out of date: tools/{tool}", file=sys.stderr)
            return 1
    return 0
