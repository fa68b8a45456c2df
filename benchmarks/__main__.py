"""``make bench``: print the tables. ``python -m benchmarks [SECTION…] [--runs N] [--update]``."""

from __future__ import annotations

import argparse
import platform
import sys

from benchmarks import accuracy, budgets, counts, figures, kernels, speed

SECTIONS = {
    "start": lambda chosen: speed.start(chosen.runs),
    "derive": lambda chosen: speed.derive(chosen.runs),
    "check": lambda chosen: speed.check(chosen.runs),
    "counts": lambda chosen: counts.table(),
    "kernels": lambda chosen: kernels.table(),
    "accuracy": lambda chosen: accuracy.table(),
    "budgets": lambda chosen: budgets.run(chosen.update),
    "processor": lambda chosen: figures.run(chosen.update),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", help=f"{' '.join(SECTIONS)}; default: all")
    parser.add_argument("--runs", type=int, default=7, help="runs of each command (default 7)")
    parser.add_argument("--update", action="store_true", help="budgets, processor: write what is measured")
    chosen = parser.parse_args()
    unknown = [name for name in chosen.sections if name not in SECTIONS]
    if unknown:
        parser.error(f"no section {unknown[0]}; there are: {' '.join(SECTIONS)}")
    print(f"Python {platform.python_version()}, {platform.system()} {platform.machine()}\n")
    for name, section in SECTIONS.items():
        if not chosen.sections or name in chosen.sections:
            for line in section(chosen):
                print(line)
                sys.stdout.flush()
            print()


if __name__ == "__main__":
    main()
