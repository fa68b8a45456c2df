"""``make bench``: print the tables. ``python -m benchmarks [derive] [start] [check] [counts] [--runs N]``."""

from __future__ import annotations

import argparse
import platform
import sys

from benchmarks import counts, speed

SECTIONS = {
    "start": speed.start,
    "derive": speed.derive,
    "check": speed.check,
    "counts": lambda runs: counts.table(),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", help=f"{' '.join(SECTIONS)}; default: all")
    parser.add_argument("--runs", type=int, default=7, help="runs of each command (default 7)")
    chosen = parser.parse_args()
    unknown = [name for name in chosen.sections if name not in SECTIONS]
    if unknown:
        parser.error(f"no section {unknown[0]}; there are: {' '.join(SECTIONS)}")
    print(f"Python {platform.python_version()}, {platform.system()} {platform.machine()}\n")
    for name, section in SECTIONS.items():
        if not chosen.sections or name in chosen.sections:
            for line in section(chosen.runs):
                print(line)
                sys.stdout.flush()
            print()


if __name__ == "__main__":
    main()
