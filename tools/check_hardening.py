#!/usr/bin/env python3
"""Checks how programs are hardened, by readelf: a position-independent executable, relocations that are read-only once the
program runs (full RELRO), no executable stack; with --compiled also stack protectors and FORTIFY (CMake's option
VICTORIOUS_HARDEN).

    tools/check_hardening.py [--compiled] PROGRAM...
"""

import re
import subprocess
import sys


def read(program: str, *what: str) -> str:
    return subprocess.run(["readelf", "--wide", *what, program], check=True, capture_output=True, text=True).stdout


def faults_of(header: str, segments: str, dynamic: str, symbols: str, is_compiled: bool) -> list[str]:
    """What is wrong with a program, by what readelf prints of it."""
    faults = []
    if not re.search(r"Type:\s+DYN", header) or not re.search(r"FLAGS_1.*\bPIE\b", dynamic):
        faults.append("not a position-independent executable")
    if "GNU_RELRO" not in segments:
        faults.append("relocations stay writable: no RELRO")
    if not re.search(r"BIND_NOW|FLAGS_1.*\bNOW\b", dynamic):
        faults.append("functions are bound while it runs: no full RELRO")
    stack = re.search(r"GNU_STACK\s+(?:0x\S+\s+){5}(\S+)", segments)
    if not stack or "E" in stack[1]:
        faults.append("the stack is executable")
    if is_compiled and "__stack_chk_fail" not in symbols:
        faults.append("no stack protector")
    # Static parts of libraries bring a call or two of their own.
    if is_compiled and len(set(re.findall(r"__\w+_chk\b", symbols)) - {"__stack_chk_fail"}) < 5:
        faults.append("no FORTIFY")
    return faults


def main() -> int:
    programs = [argument for argument in sys.argv[1:] if argument != "--compiled"]
    if not programs:
        print(__doc__)
        return 2
    status = 0
    for program in programs:
        parts = (read(program, option) for option in ("--file-header", "--program-headers", "--dynamic", "--dyn-syms"))
        for fault in faults_of(*parts, "--compiled" in sys.argv):
            print(f"{program}: {fault}")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
