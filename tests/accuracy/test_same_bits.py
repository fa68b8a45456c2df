"""The same bits on x86, on a Cortex-M4F and on a Cortex-M0: 50,000 inputs of the kernels and of a robot."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from benchmarks.emulator.fleet import Fleet
from benchmarks.emulator.zig import FLAGS as ZIG
from benchmarks.emulator.zig import M0, M4F
from benchmarks.kernels import verify
from tests.robots import of_gallery
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.ir.kernels.choice import TARGETS, Choice
from wmrgen.ir.rounding import nearest_float32

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
TOTAL = 50_000


def largest(function: str, name: str) -> float:
    if function == "arctangent":
        return 1.0
    return 100.0 if name == "x" or name.endswith(".steer") else 4.0


def mismatches(folder: Path, target: str, count: int) -> tuple[int, list[str]]:
    """Inputs tried of the C for ``target`` here and on both processors, and outputs of those that differ."""
    modules = (verify.module(), of_gallery("kelly_4ws").c_module)
    tried, wrong = 0, []
    fleets = []
    for processor in (M4F, M0):
        place = folder / processor.name
        place.mkdir()
        fleet = Fleet.build(
            place,
            modules,
            {"sqrtf": _root},
            lambda m: sources(m, Choice(target=target)),
            processor,
            (*ZIG, "-DWMRGEN_SLOW_FMA"),
            counts=False,
        )
        fleets.append(fleet)
    for module in modules:
        requests = []
        for function in (f for f in module.functions if f.outputs):
            source = random.Random(f"{target} {function.name}")
            bounds = {p.name: largest(function.name, p.name) for p in function.inputs}
            for _ in range(count):
                case = {n: nearest_float32(source.uniform(-b, b)) for n, b in bounds.items()}
                requests.append((function.name, case))
        tried += len(requests)
        here = evaluate_c(module, requests, Choice(target=target), None, FLAGS)
        for fleet in fleets:
            steps = {step.name: step for step in fleet.steps(module.name)}
            for (name, case), expected in zip(requests, here, strict=True):
                _, got = fleet.call(steps[f"{module.name}_{name}"], case)
                if {k: v.hex() for k, v in got.items()} != {k: v.hex() for k, v in expected.items()}:
                    wrong.append(f"{fleet.target.name} {name} {case}: {got}, x86 {expected}")
    return tried, wrong


def _root(x: float) -> float:
    return nearest_float32(x**0.5) if x >= 0 else float("nan")


@pytest.mark.slow
def test_the_same_bits(tmp_path: Path) -> None:
    tried = 0
    for target in TARGETS:
        if target == "avr":
            continue
        (tmp_path / target).mkdir()
        more, wrong = mismatches(tmp_path / target, target, TOTAL // (3 * 8) + 1)
        assert wrong == []
        tried += more
    assert tried >= TOTAL
