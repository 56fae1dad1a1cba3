"""The command lines in the documents use only commands and flags that the program has."""

import functools
import re
import shlex
import unittest
from pathlib import Path
from typing import Iterator

import program

DOCUMENTS = [program.REPOSITORY / "README.md", *sorted((program.REPOSITORY / "docs").rglob("*.md"))]
FENCED = re.compile(r"^```[a-z]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`(?:build/)?victorious ([^`]+)`")
COMMAND = re.compile(r"^(?:\$ )?(?:build/)?victorious ([^#|>&\n]+)", re.MULTILINE)
FLAG = re.compile(r"(?<![\w-])(--?[A-Za-z][\w-]*)")
# How a worker is started: by a shell, by systemd, or as the list of arguments of a container.
WORKER = re.compile(r"(?:^exec .*|^ExecStart=.*|args: \[)\bwork\b")


def command_lines(document: Path) -> Iterator[str]:
    """What follows the program's name on each command line of a document."""
    text = document.read_text(encoding="utf-8")
    for block in FENCED.findall(text):
        yield from COMMAND.findall(block.replace("\\\n", " "))
    yield from INLINE.findall(FENCED.sub("", text))


@functools.cache
def flags_of(*command: str) -> frozenset[str]:
    """The flags in the help of a command; none if there is no such command."""
    outcome = program.run(*command, "--help")
    return frozenset(FLAG.findall(outcome.out)) if outcome.status == 0 else frozenset()


class DocumentsTest(unittest.TestCase):
    def test_every_flag_exists(self):
        checked = 0
        for document in DOCUMENTS:
            for line in command_lines(document):
                words = shlex.split(line)
                if words[:1] == ["--events"]:  # before the command, as flags of the program are
                    self.assertIn("--events", flags_of())
                    words = words[2:]
                # `bench` and `experiment` are programs of their own, with names in place of commands.
                if not words or not words[0].islower() or words[0] in ("bench", "experiment"):
                    continue
                command = words[: 2 if words[0] in ("model", "category", "manual", "object", "user", "cluster") else 1]
                with self.subTest(document=document.name, line=line):
                    known = flags_of(*[word for word in command if not word.startswith("-")])
                    self.assertTrue(known, f"no command {command}")
                    for word in words:
                        if FLAG.fullmatch(word.split("=")[0]):
                            self.assertIn(word.split("=")[0], known)
                            checked += 1
        self.assertGreater(checked, 40)

    def test_every_flag_of_a_worker_exists(self):
        """In the files by which the schedulers of a cluster start workers."""
        for name in ("slurm/workers.sbatch", "systemd/victorious-worker@.service", "kubernetes/workers.yaml"):
            text = (program.REPOSITORY / "cluster" / name).read_text(encoding="utf-8")
            lines = [line for line in text.splitlines() if WORKER.search(line)]
            self.assertEqual(len(lines), 1, name)
            flags = FLAG.findall(WORKER.split(lines[0])[1])
            self.assertIn("--db", flags, name)
            self.assertLessEqual(set(flags), flags_of("work"), name)


if __name__ == "__main__":
    program.main()
