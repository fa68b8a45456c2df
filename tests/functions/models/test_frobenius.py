"""Integrability: Frobenius's test against finite differences, integrals against driven motions."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

import wmrgen
from tests.functions.models.robots import CAR_REAR, DIFFERENTIAL, OMNI, TWO_STEER, UNICYCLE, call, derived
from tests.functions.refusals import refused
from tests.robots import of_gallery
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.integrals import Integral
from wmrgen.functions.registry import Reason

ROBOTS = sorted((Path(__file__).parents[3] / "robots").glob("*.yaml"))
CASTOR = (
    UNICYCLE
    + "\n{name: tail, type: castor, x: -0.2, y: 0.1, heading: 20 deg, d: 0.04, offset_y: 0.03, r: 0.05}"
)
SPHERES = "{name: ball, type: spherical, x: 0, y: 0, r: 0.05}"
LOCKED = """{name: front, type: fixed, x: base, y: 0, heading: 0, r: r}
{name: rear, type: fixed, x: -base, y: 0, heading: pi, r: r}"""
BENT = """{name: front, type: fixed, x: 1.1, y: 0, heading: 0.4, r: r}
{name: rear, type: fixed, x: 0, y: 0, heading: 0, r: r}"""
SLIDES = """{name: w1, type: fixed, x: 0, y: a, heading: 0, r: r}
{name: w2, type: fixed, x: 0.3, y: -a, heading: 0, r: r}"""
MECANUM = """{name: w1, type: swedish, x: a, y: base, heading: 0, gamma: -45 deg, r: r}
{name: w2, type: swedish, x: a, y: -base, heading: 0, gamma: 45 deg, r: r}
{name: w3, type: swedish, x: -a, y: base, heading: 0, gamma: 45 deg, r: r}
{name: w4, type: swedish, x: -a, y: -base, heading: 0, gamma: -45 deg, r: r}"""


def test_tzafestas_2_25_not_integrable() -> None:
    row = derived(UNICYCLE).integrability.row("wheel")
    assert row.coordinates == ("x", "y", "theta")
    assert row.value == -1 and not row.integrable
    assert row.proof() == (
        "c = (-sin(theta), cos(theta), 0), curl c = (sin(theta), -cos(theta), 0), c . curl c = -1 != 0: not integrable"
    )
    assert r"\nabla \times c" in row.latex and r"= -1 \neq 0" in row.latex
    rolling = derived(UNICYCLE).integrability.row("wheel", "rolling")
    assert "c ^ dc = (-1) dx ^ dy ^ dtheta + ... != 0: not integrable" in rolling.proof()


def test_heading_of_a_synchro_drive_is_constant() -> None:
    d = of_gallery("synchro_drive")
    assert [i.coefficients for i in d.integrability.integrals] == [(("theta", 1.0),)]
    assert not d.integrability.holonomic  # theta integrates, the rest does not


def test_every_axle_row_has_the_same_curl() -> None:
    """c . curl c = -1 wherever the wheel stands and however it points: the arm of the row drops out."""
    d = derived("{name: w, type: fixed, x: a, y: base, heading: b, r: r}", b="0.3")
    assert d.integrability.row("w").value == -1


@pytest.mark.parametrize("wheels", [UNICYCLE, DIFFERENTIAL, CAR_REAR, CASTOR, OMNI, MECANUM, TWO_STEER])
def test_components_by_finite_differences(wheels: str) -> None:
    """c ^ dc of every row against differences of the Pfaffian matrix, which knows no forms."""
    d = derived(wheels)
    joints = list(d.pfaffian_rates[3:])
    numbers = {wmrgen.geometry.symbolic.parameter(p.name): float(p.nominal) for p in d.robot.parameters}
    matrix = sympy.lambdify(
        [wmrgen.geometry.symbolic.signal(f"{w.name}.steer") for w in d.robot.wheels if w.turns],
        d.pfaffian.xreplace(numbers), "numpy",
    )  # fmt: skip
    turning = [f"{w.name}.steer_rate" for w in d.robot.wheels if w.turns]
    coordinates = ["x", "y", "theta", *turning, *(j for j in joints if j.endswith(".spin"))]

    def forms(q: dict[str, float]) -> np.ndarray[Any, Any]:
        rows = np.array(matrix(*(q[t] for t in turning)), float)
        c, s = math.cos(q["theta"]), math.sin(q["theta"])
        world = np.column_stack(
            [rows[:, 0] * c - rows[:, 1] * s, rows[:, 0] * s + rows[:, 1] * c, rows[:, 2]]
        )
        rest = [rows[:, 3 + joints.index(n)] if n in joints else np.zeros(len(rows)) for n in coordinates[3:]]
        return np.column_stack([world, *rest])

    rng = random.Random(4)
    q = {n: rng.uniform(-1, 1) for n in coordinates}
    h = 1e-6
    here = forms(q)
    slope = np.array([(forms(q | {n: q[n] + h}) - forms(q | {n: q[n] - h})) / (2 * h) for n in coordinates])
    order = [*d.constraints.rolling, *d.constraints.sliding]
    values = {
        wmrgen.geometry.symbolic.signal(n.replace("_rate", "")): q[n] for n in ("theta", *turning)
    } | numbers
    for test in d.integrability.rows:
        k = next(i for i, r in enumerate(order) if (r.wheel.name, r.kind) == (test.wheel, test.kind))
        names = [n.replace(".steer", ".steer_rate").replace(".angle", ".spin") for n in test.coordinates]
        at = [coordinates.index(n) for n in names]
        for (a, b, c), component in test.components:
            i, j, m = (at[test.coordinates.index(n)] for n in (a, b, c))
            dc = slope[:, k, :] - slope[:, k, :].T
            numeric = here[k, i] * dc[j, m] - here[k, j] * dc[i, m] + here[k, m] * dc[i, j]
            assert float(sympy.N(component.xreplace(values))) == pytest.approx(numeric, abs=1e-7)


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_the_set_says_what_mobility_says(path: Path) -> None:
    d = wmrgen.derive(wmrgen.load(path))
    whole = d.integrability
    assert (whole.ddof, whole.dof, whole.holonomic) == (d.mobility.ddof, d.mobility.dof, d.mobility.holonomic)
    assert len(whole.rows) == len(d.constraints.sliding) + len(d.constraints.rolling)
    assert all(
        not row.integrable and row.value != 0 for row in whole.rows
    )  # a wheel by itself never integrates


def test_two_rows_integrate_that_do_not_by_themselves() -> None:
    """Siegwart 3.4.2: the locked bicycle. Neither wheel is integrable, both together are: y and theta constant."""
    whole = derived(LOCKED).integrability
    assert not whole.row("front").integrable and not whole.row("rear").integrable
    assert whole.holonomic and whole.ddof == whole.dof == 1
    heading, line, front, rear = (dict(i.coefficients) for i in whole.integrals)
    assert heading == {"theta": 1.0} and [*line] == ["y_body"]
    assert front == pytest.approx({"front.angle": -1.0, "x_body": 1 / 0.11})
    assert rear == pytest.approx({"rear.angle": -1.0, "x_body": -1 / 0.11})


# ---- integrals along driven motions


def along(d: Derivation, integral: Integral, seed: int) -> float:
    """How much the integral changes along a random admissible motion, in units of what moves."""
    rng = random.Random(seed)
    twists = np.array(
        [[float(sympy.N(e.xreplace({wmrgen.geometry.symbolic.parameter(p.name): sympy.Float(float(p.nominal))
          for p in d.robot.parameters}))) for e in d.null_space.col(k)] for k in range(d.null_space.cols)]
    )  # fmt: skip
    total = dict.fromkeys(("x_body", "y_body", "theta"), 0.0)
    for _ in range(20):
        vx, vy, omega = rng.uniform(-1, 1) * twists[0] + sum(rng.uniform(-1, 1) * t for t in twists[1:])
        dt = rng.uniform(0.1, 0.5)
        spins = call(d, "inverse", {"vx": vx, "vy": vy, "omega": omega}, "exact")
        for name, rate in (("x_body", vx), ("y_body", vy), ("theta", omega)):
            total[name] += rate * dt
        for name, rate in spins.items():
            if name.endswith(".spin"):
                key = name.replace(".spin", ".angle")
                total[key] = total.get(key, 0.0) + rate * dt
    return sum(c * total[name] for name, c in integral.coefficients)


@pytest.mark.parametrize(
    ("wheels", "count"), [(DIFFERENTIAL, 1), (OMNI, 1), (MECANUM, 2), (LOCKED, 4), (SLIDES, 4), (BENT, 3)]
)
def test_integrals_are_constant(wheels: str, count: int) -> None:
    d = derived(wheels, b="0.2")
    integrals_of_motion = d.integrability.integrals
    assert len(integrals_of_motion) == count
    for integral in integrals_of_motion:
        assert along(d, integral, 7) == pytest.approx(0, abs=1e-9), integral.text


def test_konstantinov_6_heading_of_three_omni_wheels() -> None:
    """phi = phi0 - (r/3a)(psi1 + psi2 + psi3)."""
    rolling_left = "\n".join(
        f"{{name: w{k + 1}, type: swedish, l: a, alpha: {2 * k}*pi/3, beta: 0, gamma: 0, r: r}}"
        for k in range(3)
    )
    (integral,) = derived(rolling_left).integrability.integrals
    r, a = 0.11, 0.27
    assert dict(integral.coefficients) == pytest.approx(
        {"theta": -1.0} | {f"w{k}.angle": -r / (3 * a) for k in (1, 2, 3)}
    )


def test_mecanum_has_a_relation_between_wheel_angles() -> None:
    """Four rates, three freedoms: one relation besides the heading (Tzafestas 2.4.2)."""
    relations = [dict(i.coefficients) for i in derived(MECANUM).integrability.integrals]
    assert len(relations) == 2
    names = [f"w{k}.angle" for k in (1, 2, 3, 4)]
    rows = np.array([[f.get(n, 0.0) for n in ("theta", *names)] for f in relations])
    compatibility = np.array([0.0, 1.0, 1.0, -1.0, -1.0])
    assert np.linalg.matrix_rank(np.vstack([rows, compatibility]), tol=1e-9) == 2


def test_wheel_angles_measure_the_way_along_the_heading() -> None:
    """Of the locked bicycle, at any constant heading; along x it is the case S-lockbike-phi of the texts."""
    way = {"x": 0.75 * math.cos(0.3), "y": 0.75 * math.sin(0.3), "theta": 0.3}
    angles = call(derived(LOCKED), "wheel_angles", way)
    assert angles == pytest.approx({"front.angle": 0.75 / 0.11, "rear.angle": -0.75 / 0.11})


def test_wheel_angles_on_a_circle() -> None:
    """The bent bicycle rolls about one point; its wheel angles are proportional to the angle turned."""
    d = derived(BENT)
    wheel_angles = call(d, "wheel_angles", {"theta": 0.5})
    radius = 1.1 / math.tan(0.4)  # of the rear wheel; the front one runs on the hypotenuse
    assert wheel_angles["rear.angle"] == pytest.approx(0.5 * radius / 0.11)
    assert wheel_angles["front.angle"] == pytest.approx(0.5 * math.hypot(radius, 1.1) / 0.11)


@pytest.mark.parametrize("wheels", [DIFFERENTIAL, OMNI, TWO_STEER, SPHERES])
def test_wheel_angles_need_a_holonomic_robot_that_does_not_turn(wheels: str) -> None:
    with refused(Reason.MOBILITY, "wheel_angles"):
        derived(wheels).formula("wheel_angles")


def test_no_constraint_at_all() -> None:
    whole = derived(SPHERES).integrability
    assert not whole.rows and whole.holonomic and whole.ddof == 3
