"""Lie brackets and growth vectors (Siegwart 3.4.1; Tzafestas 2.2.3) against finite differences and against mobility."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

import wmrgen
from tests.functions.models.robots import (
    CAR_FRONT,
    CAR_REAR,
    DIFFERENTIAL,
    UNICYCLE,
    derived,
    on_axle,
    p,
    s,
    zero,
)
from tests.functions.refusals import refused
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.growth import growth
from wmrgen.functions.registry import Reason

ROBOTS = sorted((Path(__file__).parents[3] / "robots").glob("*.yaml"))
THETA, PSI = s("theta"), s("front.steer")


def train(wheels: str, count: int, hitch: str = "0") -> Derivation:
    trailers = ", ".join(f"{{length: {0.7 + 0.1 * k:.1f}, hitch: {hitch}}}" for k in range(count))
    return derived(wheels, f"trailers: [{trailers}]")


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_growth_vector_is_that_of_mobility(path: Path) -> None:
    """Two derivations: brackets of twists at a sample, brackets of the posture model's fields at a rational point."""
    d = wmrgen.derive(wmrgen.load(path))
    for seed in range(3):
        span = growth(d.system("eta", symbolic=True), seed)
        assert span.vector == d.mobility.growth_vector
        assert span.degree == d.mobility.degree_of_nonholonomy


def test_unicycle() -> None:
    span = derived(UNICYCLE).growth
    assert span.vector == (2, 3) and span.controllable
    assert [b.name for b in span.brackets] == ["g1", "g2", "[g1, g2]"]
    c, n = sympy.cos(THETA), sympy.sin(THETA)
    assert all(zero(a - b) for a, b in zip(span.brackets[2].field, (n, -c, 0), strict=True))


def test_car() -> None:
    """Tzafestas (2.55): steering, wriggle and slide are the brackets of a car."""
    span = growth(derived(CAR_REAR).system("posture", symbolic=True))
    assert span.vector == (2, 3, 4) and span.degree == 3
    assert [b.name for b in span.brackets] == ["g1", "g2", "[g1, g2]", "[g1, [g1, g2]]"]
    r, base, c = p("r"), p("base"), sympy.cos(PSI)
    wriggle, slide = span.brackets[2].field, span.brackets[3].field
    assert all(zero(a - b) for a, b in zip(wriggle, (0, 0, -r / (base * c**2), 0), strict=True))
    sideways = r**2 / (base * c**2)
    wanted = (-sideways * sympy.sin(THETA), sideways * sympy.cos(THETA), 0, 0)
    assert all(zero(a - b) for a, b in zip(slide, wanted, strict=True))
    assert span.controllable


@pytest.mark.parametrize("count", range(1, 5))
def test_trains_grow_by_one(count: int) -> None:
    """N trailers on the axle: (2, 3, ..., n), what a chained form has."""
    for wheels, states in ((UNICYCLE, 3), (CAR_REAR, 4)):
        d = train(wheels, count)
        span = growth(d.system("trailer", symbolic=True))
        assert span.vector == tuple(range(2, states + count + 1))
        assert span.controllable


def test_a_trailer_off_the_axle_grows_too() -> None:
    span = train(DIFFERENTIAL, 1, "0.2").growth
    assert span.controllable and span.vector[0] == 2 and span.vector[-1] == 4


@pytest.mark.parametrize("length", ["pi/9", "atan2(a, 0.7)", "1/(a + pi)", "sqrt(a*pi)"])
@pytest.mark.parametrize("a", ["0.3", "{value: 0.3, tunable: true}"])
def test_lengths_need_be_no_rationals(tmp_path: Path, length: str, a: str) -> None:
    """pi and angles of lengths are numbers as others are. They were a crash, of the report too."""
    path = tmp_path / "robot.yaml"
    path.write_text(
        f"wmrgen: 1\nname: odd\nparameters: {{a: {a}}}\nwheels:\n"
        f'  - {{name: left, type: fixed, x: 0, y: "{length}", heading: 0, r: 0.1}}\n'
        "  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
        f'trailers: [{{name: t, length: 0.8, hitch: "{length}"}}]\n',
        encoding="utf-8",
    )
    assert wmrgen.derive(wmrgen.load(path)).growth.vector == (2, 3, 4)


def test_what_is_not_reached_is_said() -> None:
    wheel = "{name: w%d, type: fixed, x: %s, y: 0, heading: 0, r: r}"
    span = derived("\n".join((wheel % (1, "0.6"), wheel % (2, "-0.6")))).growth
    assert span.vector == (1,) and not span.controllable
    assert len(span.state) == 3


@pytest.mark.parametrize(
    "d",
    [derived(CAR_REAR), derived(CAR_FRONT), derived(DIFFERENTIAL, on_axle(2), b="0.3")],
    ids=["rear", "front", "train"],
)
def test_brackets_by_finite_differences(d: Derivation) -> None:
    """[f, g] = Dg f - Df g with Jacobians by differences, and every later bracket from those before it."""
    system = d.system("trailer" if d.robot.trailers else "posture", symbolic=True)
    span = growth(system)
    values = {p(port.name): float(port.default) for port in system.geometry if port.default is not None}
    symbols = [s(port.name) for port in system.state]
    fields = {
        b.name: sympy.lambdify([symbols], [e.xreplace(values) for e in b.field], "numpy")
        for b in span.brackets
    }
    rng = random.Random(5)
    at = np.array([rng.uniform(-0.5, 0.5) for _ in symbols])
    h = 1e-6

    def jacobian(f: Any) -> Any:
        steps = np.eye(len(at)) * h
        return np.column_stack([(np.array(f(at + e)) - np.array(f(at - e))) / (2 * h) for e in steps])

    for b in span.brackets:
        if b.order == 1:
            continue
        left, right = b.name[1:-1].split(", ", 1)
        f, g = fields[left], fields[right]
        wanted = jacobian(g) @ np.array(f(at), float) - jacobian(f) @ np.array(g(at), float)
        assert np.array(fields[b.name](at), float) == pytest.approx(wanted, abs=1e-7)
    reached = np.array([fields[b.name](at) for b in span.brackets], float)
    assert np.linalg.matrix_rank(reached, tol=1e-9) == span.vector[-1]


def test_too_many_states_say_so() -> None:
    with refused(Reason.TOO_LONG, "chained"):
        _ = train(CAR_REAR, 8).growth
