"""Instructions per call on an emulated processor: wmrgen, hand-written references and other generators."""

from __future__ import annotations

import random
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from statistics import mean

from benchmarks.emulator import gcc
from benchmarks.emulator.fleet import LAYOUTS, Fleet, write_sources
from benchmarks.emulator.image import Image
from benchmarks.emulator.machine import Run
from benchmarks.emulator.zig import M0, M4F
from benchmarks.jobs import JOBS, ODOMETRY, Job, derivations, outputs
from benchmarks.others import casadi_c, symforce_c, sympy_c
from wmrgen.codegen.c import sources
from wmrgen.codegen.unit import Step
from wmrgen.ir.calls import nominal
from wmrgen.ir.kernels.choice import MATHS, Choice

REFERENCE = Path(__file__).resolve().parent / "reference"
RUNS = 40
GENERATORS = {
    "sympy": sympy_c,
    "casadi": casadi_c,
    **({"symforce": symforce_c} if symforce_c.present() else {}),
}
_TITLES = {"sympy": "sympy", "casadi": "CasADi", "symforce": "SymForce"}


@dataclass(frozen=True)
class Count:
    """Instructions per call: mean over random inputs, least and most over those and special ones.

    ``cycles``: that a Cortex-M4F takes, mean over random inputs.
    """

    mean: float
    least: int
    most: int
    cycles: float

    def __str__(self) -> str:
        """Return mean and range, or ``=n`` if every input needs the same number."""
        return f"={self.most}" if self.least == self.most else f"{self.mean:.0f} ({self.least}–{self.most})"

    @property
    def beside(self) -> str:
        """Instructions and cycles."""
        return f"{self.mean:.0f} / {self.cycles:.0f}"


class Bench:
    """All functions of one choice of ``math``, compiled for one processor with the GNU toolchain and newlib."""

    def __init__(
        self,
        folder: Path,
        math: str,
        processor: str = "m4f",
        jobs: Sequence[Job] = JOBS,
        others: bool = False,
        small: bool = False,
    ) -> None:
        self.flat: dict[str, tuple[str, ...]] = {}
        self.jobs = jobs
        modules = [derivations()[name].c_module for name in dict.fromkeys(job.robot for job in jobs)]
        target = M0 if processor.startswith("m0") else M4F
        write_sources(folder, modules, lambda m: sources(m, Choice(math=math, target=target.name)))
        files = [f"{module.name}.c" for module in modules] + [LAYOUTS]
        files += references(folder, {module.name for module in modules})
        files += [name for job in jobs for name in self._others(folder, job)] if others else []
        flags = (
            *gcc.FLAGS,
            *(("-DREFERENCE_INLINE",) if math == "inline" else ()),
            *(gcc.SMALL if small else ()),
        )
        image = Image(gcc.build(folder, files, f"{math}.{processor}.elf", processor, flags))
        self.fleet = Fleet(tuple(modules), image, {}, target)

    def _others(self, folder: Path, job: Job) -> Iterator[str]:
        for generator in GENERATORS.values():
            code = generator.source(derivations()[job.robot], job.function, outputs(job))
            if code is not None:
                text, name, self.flat[name] = code[0], code[1], code[2]
                (folder / f"{name}.c").write_text(text)
                yield f"{name}.c"

    @cached_property
    def steps(self) -> dict[str, Step]:
        return {step.name: step for module in self.fleet.modules for step in self.fleet.steps(module.name)}

    def step(self, job: Job) -> Step:
        return self.steps[f"{job.robot}_{job.function}"]

    def call(self, job: Job, name: str, case: dict[str, float]) -> tuple[Run, dict[str, float]]:
        """Run wmrgen's function, or the one called ``name``, and return the run and its outputs."""
        wanted = outputs(job)
        if name in self.flat:
            run, values = self.fleet.call_flat(name, [case[n] for n in self.flat[name]], len(wanted))
            return run, dict(zip(wanted, values, strict=True))
        run, computed = self.fleet.call(self.step(job), case, name=name)
        return run, {n: computed[n] for n in wanted}

    def count(self, job: Job, name: str = "") -> Count:
        step = self.step(job)
        tunables = nominal(next(m for m in self.fleet.modules if m.name == job.robot))
        every = list(inputs(self.fleet.inputs(step), tunables, step.name))
        runs = [self.call(job, name, case)[0] for case in every]
        counts = [run.instructions for run in runs]
        return Count(mean(counts[:RUNS]), min(counts), max(counts), mean(run.cycles for run in runs[:RUNS]))

    def other(self, job: Job, generator: str) -> Count | None:
        name = f"{generator}_{job.robot}_{job.function}"
        return self.count(job, name) if name in self.flat else None


def references(folder: Path, robots: set[str]) -> Iterator[str]:
    """Copy the hand-written code, and return the C files whose robot is among ``robots``."""
    for path in sorted(REFERENCE.iterdir()):
        text = path.read_text()
        (folder / path.name).write_text(text)
        if path.suffix == ".c" and any(f'#include "{robot}.h"' in text for robot in robots):
            yield path.name


def inputs(names: Sequence[str], tunables: dict[str, float], seed: str) -> Iterator[dict[str, float]]:
    """Yield `RUNS` random inputs (speeds in [-1, 1], angles in [-pi, pi]), then standstill and single motions."""
    source = random.Random(seed)
    angles = {name for name in names if name.endswith(".steer")}
    for _ in range(RUNS):
        yield {
            n: tunables.get(n, source.uniform(-1.0, 1.0) * (3.1415926 if n in angles else 1.0)) for n in names
        }
    moving = [name for name in names if name not in angles and name not in tunables]
    for angle, one in product((0.0, 1e-8, 1.5707963, -3.1415927, 2.3), (None, *moving)):
        yield {n: tunables.get(n, angle if n in angles else float(n == one)) for n in names}


def tables() -> Iterator[str]:
    """Yield the tables of a Cortex-M4F and a Cortex-M0, in Markdown."""
    if not gcc.present():
        yield "Instructions per call: needs arm-none-eabi-gcc with newlib."
        return
    yield from _m4f()
    yield ""
    yield from _m0()


def _m4f() -> Iterator[str]:
    compiler = gcc.PROCESSORS["m4f"].version
    yield f"Instructions per call on an emulated Cortex-M4F, {compiler} `{' '.join(gcc.FLAGS[:3])}`, newlib."
    yield f"Mean of {RUNS} random inputs. Brackets: least and most, special inputs included. =: equal for every input."
    yield "Hand: `benchmarks/reference`, with fused multiply-add. Simpler: steering without nearest branch or limits."
    yield ""
    heads = [f"{who}, {math}" for math in MATHS for who in ("hand", "wmrgen")]
    yield from _heading("layout", "function", *heads, *(_TITLES[name] for name in GENERATORS))
    with tempfile.TemporaryDirectory() as folder:
        benches = {}
        for math in MATHS:
            place = Path(folder) / math
            place.mkdir()
            benches[math] = Bench(place, math, others=math == "libm")
        for job in JOBS:
            cells = [job.layout, job.function]
            for bench in benches.values():
                simple = f"; simpler {bench.count(job, job.simpler)}" if job.simpler else ""
                cells += [f"{bench.count(job, job.reference)}{simple}", str(bench.count(job))]
            cells += [str(benches["libm"].other(job, name) or "–") for name in GENERATORS]
            yield f"| {' | '.join(cells)} |"
        yield ""
        yield from _cycles(benches)


def _cycles(benches: Mapping[str, Bench]) -> Iterator[str]:
    """Yield instructions and cycles of hand-written code and of wmrgen's; odometry has no hand-written code."""
    yield "Instructions / modelled cycles per call, means of the same inputs. Cycles are those of Arm's manual of the"
    yield "Cortex-M4 without waits: 14 for a division or root, 3 for a fused multiply-add or a branch, 2 for a load or"
    yield "store, 1 for the rest."
    yield ""
    yield from _heading(
        "layout", "function", "hand, inline", *(f"wmrgen, {math}" for math in reversed(list(benches)))
    )
    for job in (*JOBS, ODOMETRY):
        cells = [benches["inline"].count(job, job.reference).beside if job.reference else "–"]
        cells += [bench.count(job).beside for bench in reversed(list(benches.values()))]
        yield f"| {job.layout} | {job.function} | {' | '.join(cells)} |"


def _m0() -> Iterator[str]:
    yield "The same on an emulated Cortex-M0, all arithmetic in software."
    yield ""
    yield from _heading("layout", "function", "hand, libm", *(f"wmrgen, {math}" for math in MATHS))
    with tempfile.TemporaryDirectory() as folder:
        benches = []
        for math in MATHS:
            place = Path(folder) / math
            place.mkdir()
            benches.append(Bench(place, math, "m0"))
        for job in JOBS:
            cells = [str(benches[0].count(job, job.reference)), *(str(bench.count(job)) for bench in benches)]
            yield f"| {job.layout} | {job.function} | {' | '.join(cells)} |"


def _heading(*words: str) -> Iterator[str]:
    yield f"| {' | '.join(words)} |"
    yield f"|{'|'.join(['---', '---', *['---:'] * (len(words) - 2)])}|"
