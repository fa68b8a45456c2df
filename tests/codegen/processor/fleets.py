"""The gallery in emulated processors."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from benchmarks.emulator.fleet import Fleet, answers
from benchmarks.emulator.gcc import SMALL
from benchmarks.emulator.zig import FLAGS, Target
from tests.codegen.backends.modules import MODULES
from tests.codegen.backends.samples import input_names, samples
from tests.codegen.c.harness import Libm, gallery, libm
from wmrgen.codegen.c import sources
from wmrgen.ir.interpret import evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Function, Module

EDGES = (
    0.0, -0.0, 1e-45, -1e-40, 1.1754944e-38, 1e-20, -1e-8, 1e-3, 1.0, -1.0, 1.5707964, -3.1415927, 6.2831855, 100.0,
    -1e4, 1e9, -1e9, 3e38, float("inf"), float("-inf"), float("nan"),
)  # fmt: skip


@cache
def host() -> Libm:
    """Return the interpreter's float32 arithmetic, whose functions are also the emulator's libm."""
    return libm("float")


def every() -> tuple[Module, ...]:
    """Return the gallery and the modules of the backends' contract tests."""
    return (*MODULES, *gallery())


def inputs(module: Module, function: Function, count: int) -> Iterator[dict[str, float]]:
    """Yield standstill, ``count`` random inputs, and as many from `EDGES`, all as float32 values."""
    drawn = samples(module, function, count)
    for case in [drawn[0], *drawn[-count:]]:
        yield {name: rounded(value) for name, value in case.items()}
    source = random.Random(f"edges of {module.name}.{function.name}")
    names = input_names(module, function)
    for _ in range(count):
        yield {name: rounded(source.choice(EDGES)) for name in names}


def rounded(value: float) -> float:
    """``value`` as float32."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


def fleet(target: Target, folder: Path, modules: Sequence[Module], math: str, small: bool = False) -> Fleet:
    """Load ``modules`` into an emulated processor; the interpreter's functions are its libm."""
    known = answers(host().arithmetic)
    return Fleet.build(
        folder,
        modules,
        known,
        lambda m: sources(m, Choice(math=math, target=target.name)),
        target,
        (*FLAGS, *(SMALL if small else ())),
        counts=False,
    )


def mismatches(made: Fleet, math: str, count: int) -> tuple[int, list[str]]:
    """Return the number of calls of every function of every robot, and the outputs with other bits."""
    calls, wrong = 0, []
    for module in made.modules:
        computed = expand(module, "float", math, made.target.name)
        for step in made.steps(module.name):
            name = step.name.removeprefix(f"{module.name}_")
            for case in inputs(module, module.function(name), count):
                calls += 1
                _, got = made.call(step, case)
                for key, value in evaluate_module(computed, name, case, host().arithmetic).items():
                    if got[key].hex() != value.hex():
                        wrong.append(f"{step.name}({case}).{key}: {got[key].hex()}, expected {value.hex()}")
    return calls, wrong
