"""Where growth vectors are others, against Lie brackets that sympy forms and NumPy ranks.

The oracle takes the vector fields of a model and nothing of its brackets: it differentiates by sympy, forms every
bracket of an input with every field of the order before, and counts singular values at a point.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

import wmrgen
from tests.functions.models.robots import CAR_FRONT, CAR_REAR, DIFFERENTIAL, UNICYCLE, derived, p, s
from tests.report.sections.common import FACTS, page_of
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.exceptional import exceptional
from wmrgen.functions.models.growth import growing, growth
from wmrgen.functions.system import System
from wmrgen.report import sections as report

ROBOTS = Path(__file__).parents[3] / "robots"


def of_gallery(name: str) -> Derivation:
    return wmrgen.derive(wmrgen.load(ROBOTS / f"{name}.yaml"))


@cache
def bracketed(system: System, orders: int) -> list[Any]:
    """By order: a function of the state whose rows are the fields and their brackets up to that order, by sympy."""
    symbols = [s(port.name) for port in system.state]
    values = {
        p(port.name): sympy.Float(float(port.default)) for port in system.geometry if port.default is not None
    }
    inputs = [sympy.Matrix([sympy.sympify(e).xreplace(values) for e in f]) for f in system.fields]
    reached, newest, functions = [*inputs], [*inputs], []
    for order in range(1, orders + 1):
        if order > 1:
            newest = [b.jacobian(symbols) * a - a.jacobian(symbols) * b for b in newest for a in inputs]
            reached += newest
        functions.append(sympy.lambdify([symbols], [list(f) for f in reached], "numpy"))
    return functions


def vector_at(system: System, point: dict[str, float], orders: int) -> tuple[int, ...]:
    """Dimensions by order at a point, by NumPy."""
    state = [point[str(s(port.name).name)] for port in system.state]
    dims: list[int] = []
    for fields in bracketed(system, orders):
        rows = np.array(fields(state), float)
        sizes = np.linalg.norm(rows, axis=1, keepdims=True)
        rows = rows / np.where(sizes > 1e-9, sizes, np.inf)
        dims.append(int(np.linalg.matrix_rank(rows, tol=1e-9)))
    while len(dims) > 1 and dims[-1] == dims[-2]:
        dims.pop()
    return tuple(dims)


def drawn(system: System, seed: int) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    return {str(s(port.name).name): float(rng.uniform(-1.2, 1.2)) for port in system.state}


QUARTERS = (0.0, np.pi / 2, -np.pi / 2, np.pi)


def model(d: Derivation, form: str | None = None) -> System:
    return growing(d.robot, d.mobility) if form is None else d.system(form, symbolic=True)


@pytest.mark.parametrize(
    "name", ["pioneer3dx", "synchro_drive", "tractor_off_axle", "locked_bicycle", "bicycle"]
)
def test_a_vector_that_holds_everywhere_does(name: str) -> None:
    """At random states and at quarter turns; the trailer of the tractor stands square to it, too."""
    system = model(of_gallery(name))
    found = growth(system)
    assert exceptional(system, found) == ()
    for seed in range(3):
        assert vector_at(system, drawn(system, seed), len(found.vector)) == found.vector
    for turn in QUARTERS:
        for other in QUARTERS:
            point = dict.fromkeys(drawn(system, 0), turn) | {str(s(system.state[-1].name).name): other}
            if not any(abs(np.cos(v)) < 1e-9 for n, v in point.items() if n.endswith("_steer")):
                assert vector_at(system, point, len(found.vector)) == found.vector


@pytest.mark.parametrize(
    ("d", "form", "condition", "wanted"),
    [
        pytest.param(
            of_gallery("car_with_trailers"),
            None,
            sympy.cos(s("theta") - s("trailer1.theta")),
            (2, 3, 4, 5, 5, 6),
            marks=pytest.mark.slow,
        ),
        (of_gallery("bicycle"), "configuration", sympy.sin(s("front.steer")), (2, 3, 5, 5, 6)),
        (of_gallery("textbook_two_steer"), None, sympy.cos(s("front.steer")), (3, 4, 5)),
        (derived(CAR_FRONT, "trailers: [{length: 0.7}]"), None, sympy.cos(s("front.steer")), (2, 3, 4, 4, 5)),
    ],
    ids=["car with trailers", "bicycle", "two steer", "front drive"],
)
def test_exceptional_vectors(
    d: Derivation, form: str | None, condition: Any, wanted: tuple[int, ...]
) -> None:
    system = model(d, form)
    found = growth(system)
    sets = {str(one.condition): one.vector for one in exceptional(system, found) or ()}
    assert sets[str(condition)] == wanted
    point = drawn(system, 1)
    assert vector_at(system, point, len(found.vector)) == found.vector
    turned = sorted(condition.free_symbols, key=str)[0]
    (at,) = sympy.solve(condition, turned)[:1]
    point[str(turned.name)] = float(
        at.subs({q: point[str(q.name)] for q in condition.free_symbols - {turned}})
    )
    assert vector_at(system, point, len(wanted)) == wanted


def test_a_minor_is_given_by_its_factors() -> None:
    """The axle of either deciding module through the pivot of the other: there one rate moves no centre of rotation."""
    system = model(of_gallery("wpilib_swervebot"))
    found = growth(system)
    sets = exceptional(system, found) or ()
    assert {str(one.condition) for one in sets} == {
        f"sin({w}_steer) + cos({w}_steer)" for w in ("front_left", "back_right")
    }
    assert all(not one.vector for one in sets)
    point = drawn(system, 4)
    assert vector_at(system, point, 2) == found.vector == (3, 5)
    assert vector_at(system, point | {"front_left_steer": -np.pi / 4}, 3) == (3, 4, 5)


def test_a_long_hitch_has_a_set_of_its_own() -> None:
    """The minor of these brackets has a zero only if the hitch is longer than the bar."""
    for hitch, everywhere in (("0.25", True), ("1.5", False)):
        d = derived(DIFFERENTIAL, f"trailers: [{{name: cart, length: 0.8, hitch: {hitch}}}]", b="0.3")
        system = model(d)
        assert (exceptional(system, growth(system)) == ()) == everywhere


@pytest.mark.parametrize("wheels", [UNICYCLE, CAR_REAR], ids=["unicycle", "rear"])
def test_the_first_trailer_behind_a_driven_axle_is_never_exceptional(wheels: str) -> None:
    d = derived(wheels, "trailers: [{length: 0.7}]")
    system = model(d)
    found = growth(system)
    assert exceptional(system, found) == ()
    point = drawn(system, 3)
    point["trailer1_theta"] = point["theta"] + np.pi / 2
    assert vector_at(system, point, len(found.vector)) == found.vector


def test_the_rolling_disk_reaches_all_four() -> None:
    d = of_gallery("unicycle")
    system = model(d, "configuration")
    found = growth(system)
    assert [p.name for p in system.state][:3] == ["x", "y", "theta"] and len(system.state) == 4
    assert found.vector == (2, 3, 4) and found.controllable and exceptional(system, found) == ()
    assert vector_at(system, drawn(system, 0), 3) == (2, 3, 4)


@pytest.mark.parametrize(
    "name",
    ["pioneer3dx", "textbook_omnidirectional", "unicycle", "locked_bicycle", "turtlebot3_burger", "andino"],
)
def test_what_wheel_angles_reach_is_what_no_integral_forbids(name: str) -> None:
    """Robots that do not steer: states less the relations that the constraints integrate to."""
    d = of_gallery(name)
    found = growth(model(d, "configuration"))
    assert found.vector[-1] == len(found.state) - len(d.integrability.integrals)


def test_no_page_says_that_nothing_is_singular_where_trailers_are() -> None:
    page = page_of("tractor_off_axle")
    assert "No configuration is singular" not in page and "`cart` is jack-knifed" in page
    assert "No configuration is singular" in page_of("pioneer3dx")


CASTORS = """{name: e, type: castor, x: 0.35, y: -0.2, heading: 0, d: 0.25, r: 0.1}
{name: c, type: castor, x: -0.4, y: 0.15, heading: 0, d: 0.2, r: 0.1}"""


def test_castors_on_one_shaft_lose_an_input_where_they_are_parallel() -> None:
    """At equal angles the field of eta1 is zero, though the rolling rows of both leave that motion free."""
    d = derived(CASTORS, "couplings: [{equal: [e.spin, c.spin]}]")
    system = d.system("eta", symbolic=True)
    (lost,) = system.domain
    a, c = s("e.steer"), s("c.steer")
    assert sympy.simplify(lost.expression.subs(a, c)) == 0
    assert sympy.simplify(sympy.Matrix(system.fields[0]).subs(a, c)) == sympy.zeros(5, 1)
    assert "No configuration is singular" not in report.emit(d, FACTS)[report.FILE].decode()
