"""The chained form on a sheet of paper: equations have the values of the functions, domains end where they say."""

from __future__ import annotations

import random

import pytest
import sympy

from tests.functions.models.robots import (
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_REAR,
    UNICYCLE,
    VIRTUAL_REAR,
    call,
    derived,
    on_axle,
)
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.sheet import Sheet
from wmrgen.functions.trailers import chained_sheet as module
from wmrgen.functions.trailers.chained_sheet import (
    MANY_TRAILERS,
    MOST_TERMS,
    POINTS,
    Verification,
    chained_sheet,
    verify,
)
from wmrgen.geometry.exact.number import Exact

TRAINS = {
    "differential": (DIFFERENTIAL, ""),
    "turned": (UNICYCLE.replace("x: 0, y: 0, heading: 0", "x: 0.2, y: 0.1, heading: pi/6"), ""),
    "car": (CAR_REAR, ""),
    "four wheels": (FOUR_REAR, VIRTUAL_REAR),
    "differential and 1": (DIFFERENTIAL, on_axle(1)),
    "unicycle and 2": (UNICYCLE, on_axle(2)),
    "car and 1": (CAR_REAR, on_axle(1)),
    "car and 2": (CAR_REAR, on_axle(2)),
    "car and 3": (CAR_REAR, on_axle(3)),
}


def sheet(d: Derivation) -> Sheet:
    return chained_sheet(d.robot, d.mobility)


def symbol(name: str) -> str:
    return name.replace(".", "_")


def values(page: Sheet, seed: int) -> dict[str, float]:
    chance = random.Random(seed)
    names = [p.name for p in (*page.state, *page.inputs)]
    return {name: chance.uniform(-0.6, 0.6) for name in names}


def written(page: Sheet, at: dict[str, float]) -> dict[str, float | None]:
    """The value of every equation; None where it refers to a derivative that is not written out."""
    here = {symbol(name): value for name, value in at.items()}
    here |= {symbol(p.name): float(p.default or 0) for p in page.parameters}
    result: dict[str, float | None] = {}
    for equation in (*page.where, *page.equations):
        symbols = equation.right.free_symbols
        if any(s.name not in here for s in symbols):
            result[equation.left] = None
            continue
        result[equation.left] = here[symbol(equation.left)] = float(
            sympy.N(equation.right.xreplace({s: here[s.name] for s in symbols}))
        )
    return result


@pytest.mark.parametrize("name", TRAINS)
def test_the_equations_are_the_functions(name: str) -> None:
    d = derived(*TRAINS[name])
    page = sheet(d)
    for seed in range(2):
        at = values(page, seed)
        state = {p.name: at[p.name] for p in page.state}
        wanted = call(d, "chained", state) | call(d, "chained_input", at)
        for left, value in written(page, at).items():
            if left != "kappa" and value is not None:
                assert value == pytest.approx(wanted[left], rel=1e-9, abs=1e-12), left


@pytest.mark.parametrize("name", TRAINS)
def test_every_derivative_of_a_short_train_is_written_out(name: str) -> None:
    page = sheet(derived(*TRAINS[name]))
    size = len(page.state)
    assert [e.left for e in page.equations][:size] == [f"z{k}" for k in range(1, size + 1)]
    assert len(page.equations) == size + 2
    missing = [left for left, value in written(page, values(page, 0)).items() if value is None]
    assert missing == ([f"{page.equations[-1].left}"] if name == "car and 3" else [])


def test_of_a_long_train_the_first_derivatives_are() -> None:
    page = sheet(derived(CAR_REAR, "trailers: [" + ", ".join("{length: 0.8}" for _ in range(4)) + "]"))
    none = {left for left, value in written(page, values(page, 0)).items() if value is None}
    size = len(page.state)
    assert none and "z1" not in none and f"z{size - 1}" not in none
    lowest = min(k for k in range(2, size + 1) if f"z{k}" not in none)
    assert none >= {f"z{k}" for k in range(2, lowest)}
    for e in page.equations:
        if e.left in none and e.left.startswith("z"):
            assert e.right == module.local(f"dz{int(e.left[1:]) + 1}/dz1")
    assert MOST_TERMS == 40


def test_the_domain_has_a_condition_for_each_place_that_is_lost() -> None:
    d = derived(CAR_REAR, on_axle(2))
    page = sheet(d)
    texts = [c.text for c in page.domain]
    named = [[n for n in ("`front`", "`trailer1`", "`trailer2`") if n in text] for text in texts]
    assert named == [[], ["`front`"], ["`trailer2`"], ["`trailer1`"]]
    at = {symbol(p.name): 0.0 for p in page.state} | {
        symbol(p.name): float(p.default or 0) for p in page.parameters
    }
    for condition, changed in zip(
        page.domain,
        (
            {"trailer2_theta": 1, "trailer1_theta": 1, "theta": 1},
            {"front_steer": 1},
            {"trailer1_theta": 1, "theta": 1},
            {"theta": 1},
        ),
        strict=True,
    ):
        for other in page.domain:
            here = at | {name: float(sympy.pi / 2) for name in changed}
            size = abs(
                float(
                    sympy.N(
                        other.expression.xreplace({s: here[s.name] for s in other.expression.free_symbols})
                    )
                )
            )
            assert (size < 1e-12) == (other is condition)


def test_how_far_it_is_verified() -> None:
    d = derived(CAR_REAR)
    checked = verify(d.robot, d.mobility)
    assert checked.holds and checked.points == 3 and checked.text in sheet(d).text
    assert (POINTS, MANY_TRAILERS) == (3, 8)
    assert Verification(1, (Exact(0), Exact(0))).holds
    wrong = Verification(2, (Exact(0), Exact(1)))
    assert not wrong.holds and "at 2 " in wrong.text and wrong.text != Verification(2, (Exact(0),)).text


def test_fewer_points_for_many_trailers(monkeypatch: pytest.MonkeyPatch) -> None:
    points: list[int] = []

    def noted(robot: object, mobility: object, count: int) -> Verification:
        points.append(count)
        return Verification(count, ())

    monkeypatch.setattr(module, "verify", noted)
    for count in (8, 9):
        sheet(derived(UNICYCLE, "trailers: [" + ", ".join("{length: 1}" for _ in range(count)) + "]"))
    assert points == [3, 1]
