"""``make bench``: print the tables. ``python -m benchmarks [SECTION…] [--runs N] [--update]``."""

from __future__ import annotations

import argparse
import platform
import sys

from benchmarks import (
    accuracy,
    batches,
    budgets,
    calibration,
    counts,
    figures,
    kernels,
    mutants,
    naive,
    solvers,
    speed,
)

SECTIONS = {
    "start": lambda chosen: speed.start(chosen.runs),
    "derive": lambda chosen: speed.derive(chosen.runs),
    "formats": lambda chosen: speed.formats(min(chosen.runs, 3)),
    "check": lambda chosen: speed.check(chosen.runs),
    "counts": lambda chosen: counts.table(),
    "casadi": lambda chosen: naive.table(),
    "kernels": lambda chosen: kernels.table(),
    "accuracy": lambda chosen: accuracy.table(),
    "budgets": lambda chosen: budgets.run(chosen.update),
    "processor": lambda chosen: figures.run(chosen.update),
}
# These take long: only where they are named.
ASKED = {
    "mutants": lambda chosen: mutants.run(chosen.count, chosen.seed),
    "coverage": lambda chosen: calibration.table(chosen.count),
    "batches": lambda chosen: batches.table(chosen.runs),
    "solvers": lambda chosen: solvers.table(chosen.runs),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", help=f"{' '.join(SECTIONS)}; default: all")
    parser.add_argument("--runs", type=int, default=7, help="runs of each command (default 7)")
    parser.add_argument("--update", action="store_true", help="budgets, processor: write what is measured")
    parser.add_argument(
        "--count",
        type=int,
        default=mutants.COUNT,
        help="mutants: how many faults are planted; coverage: how many runs of each layout",
    )
    parser.add_argument("--seed", type=int, default=mutants.SEED, help="mutants: which faults are drawn")
    chosen = parser.parse_args()
    every = SECTIONS | ASKED
    unknown = [name for name in chosen.sections if name not in every]
    if unknown:
        parser.error(f"no section {unknown[0]}; there are: {' '.join(every)}")
    print(f"Python {platform.python_version()}, {platform.system()} {platform.machine()}\n")
    for name, section in every.items():
        if name in (chosen.sections or SECTIONS):
            for line in section(chosen):
                print(line)
                sys.stdout.flush()
            print()


if __name__ == "__main__":
    main()
