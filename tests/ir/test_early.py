"""Partial sums that are known earlier than the rest of their sum share terms with earlier rows."""

from __future__ import annotations

from tests.ir.common import build, verify_function
from wmrgen.ir import linear_forms as forms
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op


def additions(function: Function) -> int:
    return sum(node.op in (Op.ADD, Op.SUB) for node in function.nodes)


def two_sums() -> Function:
    """s = a + b + c + d and (a - c + b - d) + s t."""

    def body(b: Builder, x: dict[str, int]) -> dict[str, int]:
        total = b.sum(x[k] for k in "abcd")
        difference = b.sub(b.add(b.sub(x["a"], x["c"]), x["b"]), x["d"])
        return {"s": total, "m": b.add(difference, b.mul(total, x["t"]))}

    return build("abcdt", body)


def test_part_of_a_sum_shares() -> None:
    """Both use a + b and c + d: five additions instead of seven. Without parts that are known early there are more."""
    function = two_sums()
    shared = forms.share_linear_forms(function)
    verify_function(function, shared, "early parts")
    assert (additions(function), additions(shared)) == (7, 5)
