"""Small functions for controls: correct ones, and ones that must raise an alarm."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from wmrgen.ir.bounds.analysis import boxed
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE, Library
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Module, Op, Port, Role

ONE_INPUT = (Port("vx", Role.COMMAND, "m/s", "an input"),)
OUT = (Port("y", Role.COMMAND, "1", "an output"),)


def function(make: Callable[[Builder, int], int]) -> Function:
    """vx -> y, computed by ``make``."""
    builder = Builder()
    return builder.function("control", ONE_INPUT, OUT, [make(builder, builder.input("vx"))])


def module(made: Function) -> Module:
    return Module("bad", (made,))


def reciprocal(b: Builder, x: int) -> int:
    """1/x, which is not defined at 0."""
    return b.div(b.const(1), x)


def guarded(b: Builder, x: int) -> int:
    """1/x; 1 or -1 if x is small."""
    return b.div(b.const(1), b.apply(Op.AT_LEAST, (x, b.const(1))))


def power(b: Builder, x: int) -> int:
    """x**8, which overflows for x = 1e6."""
    return b.power(x, 8)


def root(b: Builder, x: int) -> int:
    """The root of a number that may be negative."""
    return b.sqrt(b.add(x, b.const(1)))


def walked(function: Function, ranges: Mapping[str, tuple[float, float]], library: Library = LIBM) -> Walk:
    """Analyse a function over one box."""
    return Walk(function, boxed(ranges, [], 1), SINGLE, library).run()


# What is wrong -> the function, a range of vx without and one with this fault.
BAD = {
    "division by zero": (reciprocal, (0.5, 2.0), (-1.0, 1.0)),
    "overflow": (power, (-10.0, 10.0), (-1e6, 1e6)),
    "root of a negative number": (root, (-0.5, 1.0), (-3.0, 1.0)),
}
