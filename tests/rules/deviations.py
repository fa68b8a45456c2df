"""Accepted findings of the checkers in generated C, each with its reason.

docs/misra.md is generated from this table.
"""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Deviation:
    """``check`` of ``tool`` may be found in files that match ``where``; ``robot``: one that needs it."""

    tool: str
    check: str
    where: str
    what: str
    reason: str
    robot: str = "ackermann_car"


MISRA, TIDY = "cppcheck --addon=misra", "clang-tidy"
DEVIATIONS = (
    Deviation(
        MISRA, "misra-c2012-2.5", r"\w+\.[ch]",
        "`<ROBOT>_MODEL_HASH`, `<ROBOT>_PAIR_…` and `WMRGEN_NEGATE_IF_ODD` and its like are macros that no statement "
        "uses",
        "The pair is used by `#if defined` alone: it stops a header and a source that were not generated together. The "
        "hash is for the integrator's log.",
    ),
    Deviation(
        MISRA, "misra-c2012-19.2", r"\w+\.c",
        "`wmrgen_negate_if_odd()`, `wmrgen_with_sign_of()`, `wmrgen_at_least()` and `wmrgen_fused()` read the bits of "
        "floats through unions",
        "Turning a sign by the parity of a whole number or by another sign takes one exclusive or and no branch. C99 "
        "defines it for types of one size (6.5.2.3), and `memcpy` would be a call. `--target host` has no such "
        "function.",
    ),
    Deviation(
        MISRA, "misra-c2012-11.3", r"\w+\.c",
        "`<robot>_joint()` reads `<robot>_wheels` as an array of scalars",
        "All members are scalars of one type. A declaration below does not compile if the type has padding.",
    ),
    Deviation(
        MISRA, "misra-c2012-2.3", r"\w+\.c",
        "the type `<robot>_wheels_are_joints` is not used",
        "It asserts this layout, because C99 has no `_Static_assert`.",
    ),
    Deviation(
        MISRA, "misra-c2012-8.9", r"\w+_selftest\.c",
        "the tables of the self-test are at file scope and are read in one function",
        "A table inside the function would hide its ten lines behind two hundred. Not part of the product.",
    ),
    Deviation(
        MISRA, "misra-c2012-7.3", r"\w+\.c",
        "the names `fl` and `bl` of wheels of two robots",
        "A false alarm: the add-on reads them as hexadecimal numbers with a lower-case suffix l. Wheels have "
        "the names of the robot file.",
        "kuka_youbot",
    ),
    Deviation(
        TIDY, "bugprone-easily-swappable-parameters", r"\w+\.c",
        "`<robot>_is_within(x, low, high)`, `<robot>_between(x, low, high)`, `wmrgen_negate_if_odd(a, n)` "
        "and its like and kernels take floats side by side",
        "They are static, and every call of them is generated.",
    ),
    Deviation(
        TIDY, "misc-use-internal-linkage", r"\w+_selftest\.c",
        "`<robot>_selftest()` has external linkage and is called in its own file",
        "Firmware calls it from its own program. It has a `main` only if `<ROBOT>_SELFTEST_MAIN` is defined.",
    ),
)  # fmt: skip


def kept(tool: str, check: str, file: str) -> Deviation | None:
    """Return the deviation that allows a finding."""
    for deviation in DEVIATIONS:
        if (deviation.tool, deviation.check) == (tool, check) and re.fullmatch(deviation.where, file):
            return deviation
    return None


def table() -> str:
    """Return the rows of the table in docs/misra.md."""
    rows = ["| checker | finding | place | why it remains |", "| :-- | :-- | :-- | :-- |"]
    rows += [f"| {d.tool} | {d.check} | {d.what} | {d.reason} |" for d in DEVIATIONS]
    return "\n".join(rows)
