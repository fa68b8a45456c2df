"""Operation counts and how they read."""

from __future__ import annotations

from tests.ir.common import build
from wmrgen.ir.nodes import Cost, count


def test_counts_and_their_text() -> None:
    f = build(["x", "y"], lambda b, v: {
        "o": b.sqrt(b.add(b.square(v["x"]), b.square(v["y"]))), "p": b.neg(v["x"]),
    })  # fmt: skip
    cost = count(f)
    assert cost == Cost(additions=1, multiplications=2, roots=1, signs=1)
    assert str(cost) == "1 addition, 2 multiplications, 1 square root, 1 sign operation"
    assert cost.flops == 3
    assert str(Cost()) == "none"
