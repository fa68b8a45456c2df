"""Singularities in symbols: the conditions vanish in singular states and nowhere else."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import wmrgen
from tests.analysis.mobility.test_couplings import AXLE, STEERED, wheel
from tests.laws.common import derived, law
from wmrgen.analysis.mobility.basis import primitive
from wmrgen.analysis.mobility.records import Singularity
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly
from wmrgen.geometry.symbolic import expression, parameter, signal

FRONT = wheel("f", "steered", 0.5, -0.2, heading=0.3)


def of(wheels: list[dict[str, Any]], kind: str, *coupled: str, joint: str = "steer") -> list[Singularity]:
    couplings = [(joint, [*coupled])] if coupled else []
    model = derived({"wheels": wheels, "couplings": couplings})
    return [s for s in model.derivation.mobility.singularities if s.kind == kind]


def at(poly: Poly, **steer: float) -> float:
    """A condition at steering angles by wheel name."""
    return float(expression(poly).xreplace({signal(f"{name}.steer"): angle for name, angle in steer.items()}))


def test_the_icr_on_a_pivot_is_a_turn_about_it() -> None:
    (pivot,) = of([*AXLE, FRONT], "icr_on_pivot")
    assert pivot.wheels == ("f",)
    for vx, vy, omega, there in ((-0.2, -0.5, 1.0, True), (-0.2, -0.5, 1.5, False), (0.4, 1.0, -2.0, True)):
        values = [
            sum(at(p) * v for p, v in zip(row, (vx, vy, omega), strict=True)) for row in pivot.conditions
        ]
        assert (max(map(abs, values)) < 1e-12) == there, values


def test_two_steered_axles_on_one_line() -> None:
    """Headings square to the line between the pivots; another wheel decides then, unless it stands on it too."""
    a, b, _ = STEERED
    (shared,) = of(STEERED, "shared_axle")
    assert shared.wheels == ("a", "b") and "C1" not in shared.meaning
    across = math.atan2(b["y"] - a["y"], b["x"] - a["x"]) + math.pi / 2
    for i, (first, second, there) in enumerate(
        ((across, across, True), (across, across + math.pi, True), (across, 0.3, False), (0.3, across, False))
    ):
        values = [at(p, a=first, b=second) for p in shared.conditions]
        assert (max(map(abs, values)) < 1e-12) == there, i
    in_line = [wheel(name, "steered", x, 0.1) for name, x in (("a", 0.3), ("b", -0.2), ("c", -0.5))]
    for wheels in (STEERED[:2], in_line):
        (shared,) = of(wheels, "shared_axle")
        assert re.findall(r"\bC1\b|\b\d\b", shared.meaning) == ["C1", "2", "1"]


def test_axles_that_one_angle_turns_are_not_one_line() -> None:
    """Aslant they never are: C1 has rank 2 at each angle."""
    aslant = [
        wheel("a", "steered", 0.04, -0.49, heading=0.08),
        wheel("b", "steered", 0.63, -0.63, heading=-1.56),
    ]
    assert len(of(aslant, "shared_axle")) == 1 and of(aslant, "shared_axle", "a", "b") == []
    in_line = [
        wheel("a", "steered", 0.5, 0.1),
        wheel("b", "steered", 0.0, 0.1),
        wheel("c", "steered", -0.5, 0.1, heading=0.3),
    ]
    (shared,) = of(in_line, "shared_axle", "b", "c")
    assert "a" in shared.wheels and "C1" not in shared.meaning


def test_coupled_spins_decide_where_steered_axles_are_one_line() -> None:
    """Wheels of unlike radius, so that the robot turns: about the points of a circle, of which the line has two."""
    a, b = wheel("a", "steered", 0.3, 0.1, r=0.1), wheel("b", "steered", -0.3, 0.1, r=0.2)
    for wheels in ([a, b], [a, b, wheel("c", "castor", -0.4, 0.3, d=0.1)]):
        (shared,) = of(wheels, "shared_axle", "a", "b", joint="spin")
        assert shared.wheels == ("a", "b") and "coupled" in shared.meaning


def test_a_fixed_axle_is_shared_with_no_steered_wheel() -> None:
    """A wheel in front crosses it in one point; one on its line can always follow."""
    for wheels in ([*AXLE, FRONT], AXLE, [*AXLE, wheel("f", "steered", 0.0, 0.6, heading=0.3)]):
        assert of(wheels, "shared_axle") == []


STEERS = wheel("f", "steered", 0.5, 0.0, actuated=["steer"])


def test_a_driven_wheel_on_the_icr_drives_nothing() -> None:
    """The rear wheel of a bicycle whose front wheel stands square; two rear wheels do not stand still together."""
    rear = wheel("r", "fixed", 0.0, 0.0)
    (still,) = of([rear, STEERS], "drive")
    assert still.wheels == ("r",) and "`r`" in still.meaning
    (condition,) = still.conditions
    assert isinstance(condition, Poly)
    assert at(condition, f=math.pi / 2) == pytest.approx(0, abs=1e-12) and abs(at(condition, f=1.5)) > 0.01
    for wheels in (
        [*AXLE, STEERS],
        [rear, STEERS | {"actuated": ["steer", "spin"]}],
        [rear | {"actuated": []}, STEERS],
    ):
        assert of(wheels, "drive") == []


def test_driven_wheels_of_one_condition_stand_still_together() -> None:
    """Two wheels of unlike size in the same place: one condition, once."""
    rear = wheel("r", "fixed", 0.0, 0.0)
    twin = wheel("t", "fixed", 0.0, 0.0, r=0.2)
    (still,) = of([rear, twin, STEERS], "drive")
    assert still.wheels == ("r", "t") and len(still.conditions) == 1
    (still,) = of([rear, twin, wheel("u", "fixed", 0.0, 0.0, r=0.3), STEERS], "drive")
    assert still.wheels == ("r", "t", "u") and not still.everywhere  # at one steering angle alone


def test_rollers_of_an_x(tmp_path: Path) -> None:
    """The minors of the rolling rows: they vanish where the half-lengths are equal, and do not where they are not."""
    path = tmp_path / "x.yaml"
    path.write_text(
        "wmrgen: 1\nname: x\nparameters: {a: 0.25, b: 0.25}\nwheels:\n"
        + "".join(
            f"  - {{name: w{k}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {g}*pi/4, r: 0.1}}\n"
            for k, (x, y, g) in enumerate(
                (("a", "b", "1"), ("a", "-b", "-1"), ("-a", "b", "-1"), ("-a", "-b", "1"))
            )
        ),
        encoding="utf-8",
    )
    mobility = wmrgen.derive(wmrgen.load(path)).mobility
    (lost,) = (s for s in mobility.singularities if s.kind == "rolling_rank")
    assert lost.wheels == ("w0", "w1", "w2", "w3") and lost.everywhere
    conditions = [expression(p) for c in lost.conditions for p in (c if isinstance(c, tuple) else (c,))]
    assert conditions and len(set(conditions)) == len(conditions)
    for a, b in ((0.25, 0.25), (0.4, 0.4), (0.4, 0.25)):
        values = [float(c.xreplace({parameter("a"): a, parameter("b"): b})) for c in conditions]
        assert (max(map(abs, values)) < 1e-12) == (a == b)


GENERATORS = [
    Gen("param", "a"),
    Gen("param", "b"),
    Gen("cos", "f"),
    Gen("sqrt", "", (Poly.gen("param", "c") + 1,)),
]
monomials = st.dictionaries(st.sampled_from(GENERATORS[:3]), st.integers(-3, 3), max_size=3)


def monomial(powers: dict[Gen, int], factor: int = 1) -> Poly:
    return Poly({tuple(sorted((g, e) for g, e in powers.items() if e)): Exact(factor)})


@given(
    st.lists(st.lists(st.tuples(monomials, st.integers(1, 9)), max_size=3), min_size=3, max_size=3), monomials
)
@law(60)
def test_a_primitive_row_has_no_common_factor(
    rows: list[list[tuple[dict[Gen, int], int]]], by: dict[Gen, int]
) -> None:
    """Every generator is missing in a term, none is below the line, a coefficient is 1; and of a multiple of the row
    it is the same but for a number."""
    row = tuple(Poly.sum(monomial(*term) for term in entry) for entry in rows)
    own = primitive(row)
    other = primitive(tuple(p * monomial(by, 7) for p in row))
    ratios = {own[i].terms[m] / c for i in range(3) for m, c in other[i].terms.items()}
    assert len(ratios) <= 1 and [p.terms.keys() for p in own] == [p.terms.keys() for p in other]
    terms = [dict(m) for p in own for m in p.terms]
    for g in GENERATORS:
        powers = [t.get(g, 0) for t in terms]
        assert not terms or min(powers) == 0
    assert not terms or any(c == 1 for p in own for c in p.terms.values())
