"""Self-tests on an emulated processor, where libm's functions are answered by the host's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.emulator.image import Image
from benchmarks.emulator.machine import Machine
from benchmarks.emulator.zig import DATA, FLAGS, Target, compile_objects, link
from tests.codegen.c.harness import libm
from tests.ir.selftest.every import EVERY, write
from wmrgen.ir.nodes import Op

STUBS = "stubs.c"


def _stub(name: str, arity: int) -> str:
    """A function that the emulator answers for: not a leaf that a compiler could look through."""
    head = f"float {name}({', '.join(f'float x{k}' for k in range(arity))})"
    return f"{head};\n{head} {{ {' '.join(f'(void)x{k};' for k in range(1, arity))} return x0; }}\n"


def on_target(
    target: Target, robots: Sequence[str], folder: Path, flags: Sequence[str] = FLAGS
) -> dict[str, int]:
    """What the self-test of each robot returns."""
    write(folder, robots, checks=True)
    of = libm("float").arithmetic.of
    traps = {f"{op}f": (op.arity, of(op)) for op in (Op.SIN, Op.COS, Op.ATAN, Op.ATAN2, Op.SQRT)}
    (folder / STUBS).write_text("".join(_stub(name, arity) for name, (arity, _) in traps.items()))
    objects = compile_objects(folder, (EVERY, STUBS), target, flags)
    machine = Machine(
        Image(link(folder, objects, f"every.{target.name}.elf", target)), traps, target.fpu, counts=False
    )
    results = {}
    for robot in robots:
        machine.call(f"check_{robot}", DATA)
        results[robot] = int.from_bytes(machine.read(DATA, 4), "little")
    return results
