"""``generated/<robot>/budget.json``: the cost of each robot's C, and the check that it does not grow.

Instructions and bytes of code and stack are those of a Cortex-M4F and of the compiler in constraints.txt, so they are
the same on every machine. They exclude libm; ``calls`` counts how often it is called.
"""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import wmrgen
from benchmarks.emulator.fleet import Fleet, answers
from benchmarks.emulator.inputs import cases
from benchmarks.emulator.zig import FLAGS, M4F, version
from wmrgen.derivation.artifacts import write_file
from wmrgen.derivation.manifest import BUDGET
from wmrgen.ir.calls import inlined_calls, nominal
from wmrgen.ir.interpret import FLOAT32
from wmrgen.ir.nodes import Module, count

ROOT = Path(__file__).resolve().parent.parent
GENERATED = ROOT / "generated"
RUNS = 12
LIMITED = ("instructions", "text", "stack")
Budget = dict[str, Any]


def gallery() -> list[Module]:
    """Return the C modules of all robot files."""
    return [wmrgen.derive(wmrgen.load(path)).c_module for path in sorted((ROOT / "robots").glob("*.yaml"))]


def measure(modules: Sequence[Module]) -> dict[str, Budget]:
    """Return the content of budget.json for each robot, by name."""
    with tempfile.TemporaryDirectory(prefix="wmrgen-budget-") as folder:
        fleet = Fleet.build(Path(folder), modules, answers(FLOAT32), separate=True, stack=True)
        return {module.name: _robot(fleet, module) for module in modules}


def _robot(fleet: Fleet, module: Module) -> Budget:
    functions = {}
    for step in fleet.steps(module.name):
        name = step.name.removeprefix(f"{module.name}_")
        values = cases(fleet.inputs(step), nominal(module), step.name, RUNS)
        runs = [fleet.call(step, case)[0] for case in values]
        calls: Counter[str] = Counter()
        for run in runs:
            calls |= Counter(run.calls)
        operations = {
            kind: n for kind, n in count(inlined_calls(module).function(name))._asdict().items() if n
        }
        functions[name] = {
            "operations": operations,
            "instructions": max(run.instructions for run in runs),
            "calls": dict(sorted(calls.items())),
            "text": fleet.image.symbols[step.name].size,
            "stack": max(run.stack for run in runs),
        }
    return {
        "format": 1,
        "target": f"Cortex-M4F: zig cc -mcpu={M4F.cpu} {FLAGS[0]} {FLAGS[2]}",
        "compiler": version(),
        "text": fleet.text(module.name),
        "functions": functions,
    }


def growth(old: Budget, new: Budget) -> list[str]:
    """Return a sentence for each number that is larger in ``new`` or has no budget."""
    if old.get("format") != new["format"] or old.get("compiler") != new["compiler"]:
        return [f"measured with {old.get('compiler')}, here is {new['compiler']}"]
    grown = _grown("text", old.get("text", 0), new["text"])
    for name, now in new["functions"].items():
        was = old["functions"].get(name)
        if was is None:
            grown.append(f"{name} has no budget")
            continue
        for key in LIMITED:
            grown += _grown(f"{name}: {key}", was[key], now[key])
        for key in ("operations", "calls"):
            for kind in now[key]:
                grown += _grown(f"{name}: {kind}", was[key].get(kind, 0), now[key][kind])
    return grown


def _grown(what: str, was: int, now: int) -> list[str]:
    return [f"{what} {was} -> {now}"] if now > was else []


def read(path: Path) -> Budget | None:
    """Return the budget in a file, None if there is none."""
    try:
        budget: Budget = json.loads(path.read_bytes())
        return budget
    except (OSError, ValueError):
        return None


def text(budget: Budget) -> bytes:
    return (json.dumps(budget, indent=2) + "\n").encode()


def check(measured: Mapping[str, Budget], folder: Path = GENERATED) -> list[str]:
    """Return a line for each number that exceeds its budget."""
    excesses = []
    for robot, now in measured.items():
        was = read(folder / robot / BUDGET)
        why = ["no budget"] if was is None else growth(was, now)
        excesses += [f"{robot}: {line}" for line in why]
    return excesses


def update(measured: Mapping[str, Budget], folder: Path = GENERATED) -> int:
    """Write the measured budgets, and return how many files changed."""
    return sum(write_file(folder / robot / BUDGET, text(budget)) for robot, budget in measured.items())


def run(renew: bool) -> Iterator[str]:
    """Yield the lines to print. SystemExit(1) if a robot exceeds its budget and ``renew`` is False."""
    measured = measure(gallery())
    if renew:
        yield f"{update(measured)} of {len(measured)} budgets changed"
        return
    excesses = check(measured)
    yield from excesses
    if excesses:
        yield "To accept this: python -m benchmarks budgets --update"
        raise SystemExit(1)
    smaller = sum(read(GENERATED / robot / BUDGET) != now for robot, now in measured.items())
    yield f"{len(measured)} robots are within their budgets; {smaller} need less (budgets --update records it)"
