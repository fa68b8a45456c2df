"""References of the objects of generated C: a float build never calls a routine for double."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from benchmarks.emulator.fleet import EVERY, write_sources
from benchmarks.emulator.image import Image
from benchmarks.emulator.zig import M0, M4F, Target, compile_objects
from tests.codegen.processor.conftest import Built
from tests.robots import of_gallery
from wmrgen.codegen.c import sources
from wmrgen.ir.kernels.choice import DEFAULT, MATHS, Choice
from wmrgen.ir.nodes import Module

TARGETS = pytest.mark.parametrize("target", [M4F, M0], ids=["m4f", "m0"])
KINDS = ("lekiwi", "wpilib_swervebot", "nomad_xr4000", "bicycle", "andino")
LIBM = r"(sin|cos|atan2?)f"
# Without an FPU the compiler calls routines for float, for integers and between the two.
SOFT = (
    r"sqrtf|fmaf|__aeabi_(f(add|sub|rsub|mul|div|cmp\w+|2u?iz)|u?i2f|l(mul|lsl|lsr|asr)|u?idiv(mod)?|mem\w+)"
)
DOUBLE = r"__aeabi_([cd]d?\w*|\w+2d|d\w+)|__\w+df\w*|(sin|cos|atan2?|sqrt|fabs|fma)"


def undefined(
    folder: Path, modules: Sequence[Module], target: Target, scalar: str = "float"
) -> frozenset[str]:
    """Return the symbols that the object of ``modules`` references."""
    write_sources(
        folder,
        modules,
        lambda module: sources(module, Choice(scalar, target=target.name)),
    )
    (made,) = compile_objects(folder, (EVERY,), target)
    return Image(made).undefined


def check(found: frozenset[str], target: Target, math: str) -> None:
    """An allow-list finds unexpected routines, too."""
    allowed = "|".join([*([LIBM] if math == "libm" else []), *([] if target.fpu else [SOFT])])
    assert ("sinf" in found) == (math == "libm")
    assert {name for name in found if not re.fullmatch(allowed, name)} == set()
    assert not any(re.fullmatch(DOUBLE, name) for name in found)


def test_no_double_routine_on_cortex_m4f(built: Built) -> None:
    """For the whole gallery. With an FPU and inline kernels, nothing is called."""
    check(Image(built(M4F, DEFAULT.math).objects[EVERY]).undefined, M4F, DEFAULT.math)


@pytest.mark.slow
def test_no_double_routine_on_cortex_m0(tmp_path: Path) -> None:
    """Robots of each kind; the whole gallery below."""
    check(undefined(tmp_path, [of_gallery(name).c_module for name in KINDS], M0), M0, DEFAULT.math)


@pytest.mark.slow
@TARGETS
@pytest.mark.parametrize("math", MATHS)
def test_no_double_routine(target: Target, math: str, built: Built) -> None:
    """The whole gallery on both, with each choice of mathematics."""
    check(Image(built(target, math).objects[EVERY]).undefined, target, math)


@TARGETS
def test_the_double_build_would_be_found(target: Target, tmp_path: Path) -> None:
    found = undefined(tmp_path, [of_gallery("ackermann_car").c_module], target, "double")
    assert {"__aeabi_dmul", "__aeabi_dadd", "sin"} <= found
    assert {name for name in found if re.fullmatch(DOUBLE, name)} == found - {"__aeabi_memcpy"}
