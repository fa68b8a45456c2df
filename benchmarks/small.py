"""The bytes that ``-DWMRGEN_SMALL`` saves, and the instructions that it costs."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.emulator.gcc import PROCESSORS
from benchmarks.footprint import SHOWN, heading, measure, rows, total
from benchmarks.jobs import JOBS, derivations
from benchmarks.processor import Bench
from wmrgen.ir.kernels.choice import DEFAULT


def table() -> Iterator[str]:
    """Yield code size, stack and instructions of `JOBS` and of all functions of their robots, in Markdown."""
    there = [PROCESSORS[key] for key in SHOWN if PROCESSORS[key].present]
    if not PROCESSORS["m4f"].present:
        yield "The least flash: needs arm-none-eabi-gcc."
        return
    modules = [derivations()[name].c_module for name in dict.fromkeys(job.robot for job in JOBS)]
    usual, small = ([measure(modules, processor, small=way) for processor in there] for way in (False, True))
    yield "The same with `-DWMRGEN_SMALL`. Called functions are included, which all functions of a robot share."
    yield ""
    yield from rows(there, small)
    yield ""
    yield "Bytes of code of all functions of a robot together, without → with `-DWMRGEN_SMALL`."
    yield ""
    yield from heading("layout", "robot", there)
    for layout, robot in dict.fromkeys((job.layout, job.robot) for job in JOBS):
        pairs = zip(usual, small, strict=True)
        cells = [" → ".join(str(total(footprints, robot)) for footprints in pair) for pair in pairs]
        yield f"| {layout} | `{robot}` | {' | '.join(cells)} |"
    yield ""
    yield "Instructions per call on the emulated Cortex-M4F, inline."
    yield ""
    yield "| layout | function | as usual | with `-DWMRGEN_SMALL` |"
    yield "|---|---|---:|---:|"
    with tempfile.TemporaryDirectory() as name:
        benches = []
        for way in (False, True):
            folder = Path(name) / str(way)
            folder.mkdir()
            benches.append(Bench(folder, DEFAULT.math, small=way))
        for job in JOBS:
            yield f"| {job.layout} | {job.function} | {' | '.join(str(b.count(job)) for b in benches)} |"
