"""How C99 writes operations in a scalar type."""

from __future__ import annotations

from functools import cache, partial

from wmrgen.backends.c99.text import literal
from wmrgen.backends.expression import Style
from wmrgen.ir.nodes import Op

LIBM = {
    Op.ABS: "fabs{}({{0}})", Op.SQRT: "sqrt{}({{0}})", Op.SIN: "sin{}({{0}})", Op.COS: "cos{}({{0}})",
    Op.ATAN: "atan{}({{0}})", Op.ATAN2: "atan2{}({{0}}, {{1}})", Op.FMA: "fma{}({{0}}, {{1}}, {{2}})",
}  # fmt: skip
# defined in templates/c99/bits.c.j2
BITS = {
    Op.NEGATE_IF_ODD: "wmrgen_negate_if_odd({0}, {1})", Op.WITH_SIGN_OF: "wmrgen_with_sign_of({0}, {1})",
    Op.CLAMP: "wmrgen_clamp({0}, {1})", Op.AT_LEAST: "wmrgen_at_least({0}, {1})",
}  # fmt: skip
# defined in templates/c99/integer.c.j2
INTEGER = {
    Op.ISIN: "wmrgen_sin({0})", Op.ICOS: "wmrgen_cos({0})", Op.IATAN: "wmrgen_atan({0})",
    Op.IMUL: "wmrgen_mul({0}, {1})", Op.IDIV: "wmrgen_div({0}, {1})", Op.ISQRT: "wmrgen_sqrt({0})",
}  # fmt: skip


@cache
def style(scalar: str) -> Style:
    """``scalar``: ``float`` (libm names end in f) or ``double``."""
    suffix = "f" if scalar == "float" else ""
    return Style(
        literal=partial(literal, scalar=scalar),
        calls={
            **{op: form.format(suffix) for op, form in LIBM.items()},
            **BITS,
            **INTEGER,
        },
        choices={
            # fminf would be a library call on most targets, and leaves the sign of zero open.
            Op.MIN: "({0} < {1}) ? {0} : {1}",
            Op.MAX: "({0} < {1}) ? {1} : {0}",
            Op.SELECT: "({0} < {1}) ? {2} : {3}",
        },
        declare="const {2} {0} = {1};",
        temporary="t{0}",
        grouped=True,
        scalar=scalar,
    )
