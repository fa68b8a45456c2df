"""The generated C of many robots in one program, compared with the float32 interpreter and C's libm.

All robots go into one translation unit (their names are prefixed), so a compiler starts once per flag set.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tests.codegen.backends.samples import samples
from tests.depth import everyday
from tests.robots import ROBOTS, of_gallery
from wmrgen.codegen.c.driver import Call, answer, calls, driver, request
from wmrgen.codegen.c.emit import printed, unit
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.codegen.unit import Unit
from wmrgen.ir.interpret import FLOAT32, FLOAT64, Arithmetic, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ir.nodes import Module, Op

WARNINGS = (
    "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wfloat-conversion", "-Wshadow",
    "-Wcast-qual", "-Wstrict-prototypes", "-Wmissing-prototypes", "-Werror",
)  # fmt: skip
STRICT = ("-std=c99", "-ffp-contract=off", *WARNINGS)
COMPILERS = tuple(name for name in ("gcc", "clang") if shutil.which(name))
EACH = everyday(COMPILERS, COMPILERS[:1])  # cases of a test: the everyday tests use the first

_LIBM = ctypes.CDLL(ctypes.util.find_library("m"))


@dataclass(frozen=True)
class Libm:
    """An arithmetic with C's sine, cosine and arctangent; ``seen`` collects their arguments."""

    arithmetic: Arithmetic
    seen: set[tuple[Op, tuple[float, ...]]]


def libm(scalar: str) -> Libm:
    """Return the float32 or float64 arithmetic of the interpreter with the system's libm."""
    base, suffix, kind = (
        (FLOAT32, "f", ctypes.c_float) if scalar == "float" else (FLOAT64, "", ctypes.c_double)
    )
    seen: set[tuple[Op, tuple[float, ...]]] = set()

    def call(op: Op, arity: int) -> Callable[..., float]:
        function = getattr(_LIBM, op.name + suffix)
        function.restype, function.argtypes = kind, [kind] * arity

        def through(*args: float) -> float:
            seen.add((op, args))
            return float(function(*args))

        return through

    own = {Op.SIN: call(Op.SIN, 1), Op.COS: call(Op.COS, 1), Op.ATAN: call(Op.ATAN, 1)}
    own[Op.ATAN2] = call(Op.ATAN2, 2)
    return Libm(Arithmetic(base.enter, lambda op: own.get(op) or base.of(op)), seen)


def ulps32(op: Op, args: tuple[float, ...], value: float) -> float:
    """Return the distance of ``value`` from the float64 result in units in the last place of float32."""
    functions: dict[Op, Callable[..., float]] = {
        Op.SIN: math.sin, Op.COS: math.cos, Op.ATAN: math.atan, Op.ATAN2: math.atan2,
    }  # fmt: skip
    exact = functions[op](*args)
    unit_ = math.ldexp(1.0, max(math.frexp(exact)[1] - 24, -149))
    return abs(value - exact) / unit_


@dataclass(frozen=True)
class Program:
    """Every function of every module, the cases for it and the answers expected."""

    modules: tuple[Module, ...]
    scalar: str
    count: int
    math: str = DEFAULT.math
    target: str = DEFAULT.target

    @property
    def choice(self) -> Choice:
        return Choice(self.scalar, self.math, self.target)

    @cached_property
    def libm(self) -> Libm:
        return libm(self.scalar)

    @cached_property
    def units(self) -> tuple[Unit, ...]:
        return tuple(unit(module, self.choice) for module in self.modules)

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        return tuple(call for each in self.units for call in calls(each))

    @cached_property
    def cases(self) -> list[tuple[int, dict[str, float], dict[str, float]]]:
        """(index of the call, inputs, expected outputs)."""
        modules = {module.name: module for module in self.modules}
        computed = {
            module.name: expand(module, self.scalar, self.math, self.target) for module in self.modules
        }
        result = []
        for index, call in enumerate(self.calls):
            module = modules[call.robot]
            name = call.function.removeprefix(f"{call.robot}_")
            for case in samples(module, module.function(name), self.count):
                expected = evaluate_module(computed[call.robot], name, case, self.libm.arithmetic)
                result.append((index, case, expected))
        return result

    @cached_property
    def files(self) -> dict[str, str]:
        """File name -> text: a header and a source per robot, and the driver."""
        result = {}
        for each in self.units:
            result[f"{each.robot}.h"], result[f"{each.robot}.c"], _ = printed(each)
        result["wmrgen-driver.c"] = driver(self.calls)
        return result

    def write(self, folder: Path) -> None:
        for name, text in self.files.items():
            (folder / name).write_text(text)
        every = [f'#include "{name}"\n' for name in self.files if name.endswith(".c")]
        (folder / "wmrgen-all.c").write_text("".join(every))

    def mismatches(
        self, folder: Path, compiler: str, flags: Sequence[str], env: dict[str, str] | None = None
    ) -> list[str]:
        """Compile in ``folder``, run all cases, and return a line for each output with unexpected bits."""
        program = compile_program(folder, ["wmrgen-all.c"], compiler, flags)
        lines = [request(index, self.calls[index], case) for index, case, _ in self.cases]
        answers = run_program(program, "\n".join(lines) + "\n", env).splitlines()
        assert len(answers) == len(self.cases)
        wrong = []
        for (index, case, expected), line in zip(self.cases, answers, strict=True):
            got = answer(self.calls[index], line)
            wrong += [
                f"{self.calls[index].function}({case}).{key}: {got[key].hex()}, expected {value.hex()}"
                for key, value in expected.items()
                if got[key].hex() != value.hex()
            ]
        return wrong


def gallery() -> tuple[Module, ...]:
    """The C modules of every robot file of the gallery."""
    return tuple(of_gallery(name).c_module for name in ROBOTS)
