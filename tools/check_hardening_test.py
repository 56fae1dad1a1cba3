#!/usr/bin/env python3
"""Tests check_hardening.py on programs that are linked here with and without what it looks for."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parent / "check_hardening.py"
HARDENED = ("-fPIE", "-pie", "-Wl,-z,relro", "-Wl,-z,now", "-Wl,-z,noexecstack")
# A call to each of five functions of which FORTIFY has a version that knows the size of what is written to.
SOURCE = """
#include <stdio.h>
#include <string.h>
int main(int n, char** v) {
  char a[8], b[8], c[8], d[8];
  strcpy(a, v[n - 1]);
  memcpy(b, v[0], n);
  strncpy(c, v[0], n);
  snprintf(d, n, "%s", v[0]);
  printf("%s", strcat(a, b));
  return c[n] + d[n];
}
"""


class CheckHardening(unittest.TestCase):
    def faults(self, *flags, compiled=False) -> str:
        with tempfile.TemporaryDirectory() as folder:
            source, program = Path(folder) / "a.c", Path(folder) / "a"
            source.write_text(SOURCE)
            subprocess.run(["cc", "-w", *flags, source, "-o", program], check=True, capture_output=True)
            command = [sys.executable, CHECK, *(["--compiled"] if compiled else []), program]
            ended = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(ended.returncode, 1 if ended.stdout else 0, ended.stderr)
            return ended.stdout

    def test_hardened_program_has_no_fault(self):
        compiled = ("-O2", "-fstack-protector-strong", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2")
        self.assertEqual(self.faults(*HARDENED, *compiled, compiled=True), "")

    def test_what_is_missing_is_named(self):
        self.assertIn("position-independent", self.faults("-no-pie", *HARDENED[2:]))
        self.assertIn("no full RELRO", self.faults(*HARDENED[:3], "-Wl,-z,lazy"))
        self.assertIn("no RELRO", self.faults(*HARDENED[:2], "-Wl,-z,norelro"))
        self.assertIn("the stack is executable", self.faults(*HARDENED[:4], "-Wl,-z,execstack"))
        faults = self.faults(*HARDENED, "-O2", "-fno-stack-protector", "-U_FORTIFY_SOURCE", compiled=True)
        self.assertIn("no stack protector", faults)
        self.assertIn("no FORTIFY", faults)


if __name__ == "__main__":
    unittest.main()
