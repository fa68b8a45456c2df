"""Small functions for controls: what is right, and what must raise an alarm."""

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
    """1/x: not defined at 0."""
    return b.div(b.const(1), x)


def guarded(b: Builder, x: int) -> int:
    """1/x, 1 or -1 where x is small."""
    return b.div(b.const(1), b.apply(Op.AT_LEAST, (x, b.const(1))))


def power(b: Builder, x: int) -> int:
    """x**8: too large for a float where x is 1e6."""
    return b.power(x, 8)


def root(b: Builder, x: int) -> int:
    """A root of what may be negative."""
    return b.sqrt(b.add(x, b.const(1)))


def walked(function: Function, ranges: Mapping[str, tuple[float, float]], library: Library = LIBM) -> Walk:
    """The walk through a function over one box."""
    return Walk(function, boxed(ranges, [], 1), SINGLE, library).run()


# Control, a range of vx that is good, one that is bad, what is wrong there.
BAD = {
    "division by zero": (reciprocal, (0.5, 2.0), (-1.0, 1.0)),
    "overflow": (power, (-10.0, 10.0), (-1e6, 1e6)),
    "root of a negative number": (root, (-0.5, 1.0), (-3.0, 1.0)),
}
