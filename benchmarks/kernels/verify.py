"""The worst error of each kernel over every float of its range, measured on the C that derive prints."""

from __future__ import annotations

import shutil
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

from wmrgen.analysis.kinematics.records import VECTOR_AT
from wmrgen.codegen.c import sources
from wmrgen.errors import EnvironmentFailure
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.build import Builder
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function, Module, Node, Op

DRIVER = Path(__file__).with_name("driver.c")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fno-math-errno")
HALF_PI, TURNS = 1.5707963, 100.0


@dataclass(frozen=True)
class Range:
    """All floats of [0, ``end``] (the kernels are odd or even). ``absolute``: in units of 2**-24."""

    function: str
    end: float
    absolute: bool
    start: float = 0.0


RANGES = (
    Range("sine", HALF_PI, False),
    Range("cosine", HALF_PI, True),
    Range("sine", TURNS, True, HALF_PI),
    Range("cosine", TURNS, True, HALF_PI),
    Range("arctangent", 1.0, False),
)


@dataclass(frozen=True)
class Found:
    """The worst error, where it is, and how many floats were tried."""

    worst: float
    where: float
    count: int


VECTOR = tuple(r for r in RANGES if r.function == "cosine")  # the cosine of a vector of a size and an angle


def module(vector: bool = False) -> Module:
    """A module of the kernels alone; ``vector``: the cosine is that of the vector of size 1 at this angle."""
    ops = {"sine": Op.SIN, "cosine": Op.COS, "arctangent": Op.ATAN}
    x, y = Port("x", Role.STATE, "", "argument"), Port("y", Role.COMMAND, "", "value")
    nodes = {name: (Node(Op.INPUT, name="x"), Node(op, (0,))) for name, op in ops.items()}
    kernels = {name: Function(name, (x,), n, (y,), (1,), name) for name, n in nodes.items()}
    if not vector:
        return Module("kernel", tuple(kernels.values()))
    functions = tuple((kernels | {"cosine": _vector()}).values())
    return Module("kernel", functions, kernels=(lower(VECTOR_AT),))


def _vector() -> Function:
    """Both parts of the vector of size 1 at the angle x; y is the one along."""
    b = Builder()
    x, one = b.input("x"), b.const(1)
    size = b.max(one, b.min(one, x))  # 1, and no constant
    called = b.call(VECTOR_AT.name, size, x)
    results = [b.result(called, number) for number in (0, 1)]
    ports = (Port("x", Role.STATE, "", "argument"),), tuple(Port(n, Role.COMMAND, "", n) for n in ("y", "z"))
    return b.function("cosine", ports[0], ports[1], results, "cosine")


def compiler() -> str:
    """Return a C compiler of this machine."""
    path = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if path is None:
        raise EnvironmentFailure("trying every float needs a C compiler")
    return path


def build(folder: Path, target: str, vector: bool = False) -> Path:
    """The driver for the kernels of ``target``; with the instructions of this machine where the compiler knows it, and
    kernels within its loops, which are called otherwise."""
    header, source = sources(module(vector), Choice(target=target))
    (folder / "kernel.h").write_text(header)
    (folder / "kernel.c").write_text(source)
    program = folder / f"kernels_{target}"
    words = ["-I", str(folder), str(DRIVER), "-o", str(program), "-lm"]
    for native in (("-march=native", "-fwhole-program"), ("-march=native",), ()):
        done = subprocess.run([compiler(), *FLAGS, *native, *words], capture_output=True, text=True)
        if done.returncode == 0:
            return program
    raise EnvironmentFailure(f"{compiler()} cannot build the kernels: {done.stderr[:2000]}")


def worst(program: Path, r: Range, step: int = 1) -> Found:
    """Return the worst error over every ``step``-th float of the range."""
    first, last = (struct.unpack("<I", struct.pack("<f", x))[0] for x in (r.start, r.end))
    words = [str(program), r.function, str(first), str(last), str(step), "a" if r.absolute else "r"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    error, where, count = done.stdout.split()
    return Found(float(error), float(where), int(count))
