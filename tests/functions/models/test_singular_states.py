"""State spaces where other models are singular: on the spot, sideways, with axles that meet on the robot or off it."""

from __future__ import annotations

import re
from math import cos, sin

import casadi
import numpy as np
import pytest
import sympy

from tests.functions.models.test_state_space import nominal
from tests.ir.defined import findings
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.report.sections.motion import regular


def test_a_swerve_is_regular_on_the_spot_and_sideways() -> None:
    """Where its posture model in driven speeds is not: rates stay those of the twist, derivatives finite."""
    derivation = of_gallery("wpilib_swervebot")
    f = derivation.state_space()
    assert derivation.model()["state_space"]["form"] == "twist"
    angles = [3 * np.pi / 4, np.pi / 4, -3 * np.pi / 4, -np.pi / 4]
    for steers, twist in ((angles, (0, 0, 2.0)), ([np.pi / 2] * 4, (0, 1.5, 0)), ([0.0] * 4, (-1.0, 0, 0))):
        x, u = [0.0, 0.0, 0.0, *steers], [*twist, 0, 0, 0, 0]
        assert np.array(f(x, u, [])).ravel()[:3] == pytest.approx(twist)
        assert np.array(derivation.rolling()(x, u, [])).ravel() == pytest.approx(np.zeros(4), abs=1e-12)
        assert np.isfinite(np.array(f.factory("j", ["x", "u", "p"], ["jac:xdot:x"])(x, u, []))).all()


def test_axles_that_meet_off_the_robot_leave_driven_speeds() -> None:
    """A degenerate robot whose wheels turn about one point has no twist that is commanded."""
    text = """\
wmrgen: 1
name: carousel
wheels:
  - {name: a, type: fixed, x: 1, y: 0, heading: 90 deg, r: 0.1}
  - {name: b, type: fixed, x: 0, y: 0.7, heading: 180 deg, r: 0.1}
"""
    derivation = of_text(text)
    assert derivation.model()["state_space"]["form"] == "posture"
    rates = derivation.state_space()([0, 0, 0.0], [3.0], []).full().ravel()
    assert rates == pytest.approx([0, 0, 0.3])


@pytest.mark.parametrize("name", ["wpilib_swervebot", "agilex_ranger", "kelly_4ws", "care_o_bot_4"])
def test_from_driving_sideways_to_turning_on_the_spot(name: str) -> None:
    """The whole motion, by steps of the model: no module slides, the pose is that of points which keep their distance,
    and the constraints stay regular (their Jacobian has full rank) where the chart of the posture model ends."""
    derivation = of_gallery(name)
    wheels = [w for w in derivation.robot.wheels if w.kind.steers]
    pivots = np.array([w.pivot for w in wheels])
    headings = np.array([w.zero_heading for w in wheels])
    g, step = derivation.rolling(), derivation.state_space("twist", "rk4", 0.005)
    jacobian = g.factory("jacobian", ["x", "u", "p"], ["jac:g:x", "jac:g:u"])

    def motion(s: float) -> tuple[complex, float]:
        """From sideways to on the spot, s from 0 to 1."""
        return 0.6j * (1 - s) * np.exp(-0.3j * s), 0.9 * s

    def angles(s: float) -> np.ndarray:
        v, omega = motion(s)
        return np.unwrap(np.angle((v + 1j * omega * pivots) / headings))

    body = np.array([0, 1, 1j])  # three points of the body, moved by their own velocities
    places = body.copy()
    steer = angles(0.0)
    x = np.array([0, 0, 0, *steer])
    count = 400
    for k in range(count):
        now, later = k / count, (k + 1) / count
        target = angles(later)
        target += 2 * np.pi * np.round((steer - target) / (2 * np.pi))
        v, omega = motion((now + later) / 2)
        u = np.array([v.real, v.imag, omega, *((target - steer) / 0.005)])
        here = g([*x[:3], *angles((now + later) / 2)], u, []).full()
        assert np.abs(here).max() < 1e-12
        by_x, by_u = (part.full() for part in jacobian(x, u, []))
        assert np.linalg.svd(np.hstack([by_x[:, 3:], by_u[:, :3]]))[1][-1] > 0.05
        turn = places[1] - places[0]
        middle = places + 0.0025 * turn * (v + 1j * omega * body)
        places = places + 0.005 * (middle[1] - middle[0]) * (v + 1j * omega * body)
        x, steer = step(x, u, [])[0].full().ravel(), target
    assert x[3:] == pytest.approx(steer, abs=1e-9)
    assert complex(x[0], x[1]) == pytest.approx(places[0], abs=1e-5)
    assert x[2] == pytest.approx(np.angle(places[1] - places[0]), abs=1e-5)
    twists = jacobian(x, u, [])[1].full()[:, :3]
    values = np.linalg.svd(twists)[1]
    assert values[1] > 0.1 and values[2] < 0.01  # one motion is left, turning on the spot


@pytest.mark.parametrize("name", ["wpilib_swervebot", "agilex_ranger", "textbook_two_steer"])
def test_eta_moves_nothing_on_its_singular_set_alone(name: str) -> None:
    """Its condition is zero where both axles are one line, there G of eta1 is, and nowhere around."""
    derivation = of_gallery(name)
    system = derivation.system("eta")
    (domain,) = system.domain
    a, b = (derivation.robot.wheel(w) for w in derivation.mobility.basis_wheels)
    across = 1j * (b.pivot - a.pivot)
    on_line = {f"{w.name}_steer": np.angle(across / w.zero_heading) for w in (a, b)}
    column = sympy.Matrix(system.fields[[port.name for port in system.inputs].index("eta1")])
    for off in (0.0, 0.3):
        names = {s.name: s for s in (*domain.expression.free_symbols, *column.free_symbols)}
        values = {
            s: 0.4 if n == "theta" else on_line[n] + off * (n == f"{a.name}_steer") for n, s in names.items()
        }
        assert (abs(float(domain.expression.subs(values))) < 1e-20) == (off == 0)
        assert (float(column.subs(values).norm()) < 1e-12) == (off == 0)


SETS = {  # pivots of steered wheels that turn together; for each case steering angles by set, twist
    "synchro": ([[0.5 + 0.3j, 0.5 - 0.3j, -0.5], [0]], "", {(0.4, 0.4): (cos(0.4), sin(0.4), 0), (0, 0): (1, 0, 0)}),
    "two pairs": (
        [[0.6 + 0.4j, 0.6 - 0.4j], [-0.6 + 0.4j, -0.6 - 0.4j]], "", {(0, 0): (1, 0, 0), (1, 1): (cos(1), sin(1), 0)}
    ),
    "diagonal": (
        [[0.6 + 0.4j, -0.6 - 0.4j], [0.6 - 0.4j, -0.6 + 0.4j]], "",
        {(0, 0): (1, 0, 0), (np.arctan2(0.6, -0.4), np.arctan2(0.6, 0.4)): (0, 0, 1)},
    ),
    "diagonal beside an axle": (
        [[0.5 + 0.3j, -0.5 - 0.3j], [0.5 - 0.3j, -0.5 + 0.3j]],
        "{name: c, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}",
        {(0, 0): (1, 0, 0), (np.arctan2(0.5, -0.3), np.arctan2(0.5, 0.3)): (0, 0, 1)},
    ),
    "one pair": (
        [[0.5 + 0.1j, -0.5 + 0.1j, 0.9 + 0.1j]], "",
        {(0.3,): (cos(0.3), sin(0.3), 0), (np.pi / 2,): (0.1, 1, 1), (-np.pi / 2,): (0, 1, 0)},
    ),
    "parallel fronts": ([[0.5 + 0.3j, 0.5 - 0.3j]], "{name: c, type: fixed, x: -0.5, y: 0, heading: 0, r: 0.1}",
        {(0,): (1, 0, 0)}),
    "rear steered": ([[0.5 + 0.3j, 0.5 - 0.3j], [-0.5]], "", {
        (0, 0): (1, 0, 0), (0.3, 0.3): (cos(0.3), sin(0.3), 0), (0, np.arctan2(-1, 1)): (1, -0.5, 1)}),
}  # fmt: skip


@pytest.mark.parametrize("case", SETS)
def test_wheels_that_turn_together_say_nothing_twice(case: str) -> None:
    """Constraints of parallel wheels of one motor hold where no wheel slides, and there their Jacobian has full rank
    but where the model says that it has not; models of driven speeds name where they lack a motion."""
    sets, fixed, motions = SETS[case]
    names = [[f"w{i}{k}" for k in range(len(places))] for i, places in enumerate(sets)]
    wheels = [
        f"{{name: {name}, type: steered, x: {p.real}, y: {p.imag}, heading: {180 * (k % 2)} deg, r: 0.1}}"
        for places, row in zip(sets, names, strict=True)
        for k, (p, name) in enumerate(zip(map(complex, places), row, strict=True))
    ]
    pairs = [f"{{equal: [{row[0]}.steer, {name}.steer]}}" for row in names for name in row[1:]]
    text = f"couplings: [{', '.join(pairs)}]\nwheels: [{', '.join([*wheels, fixed] if fixed else wheels)}]"
    derivation = of_text(f"wmrgen: 1\nname: tied\n{text}\n")
    g, entries, system = derivation.rolling(), derivation.entries("twist"), derivation.system("twist")
    jacobian = g.factory("jacobian", ["x", "u", "p"], ["g", "jac:g:x", "jac:g:u"])
    told = {form: bool(derivation.system(form).domain) for form in ("posture", "eta")}
    assert set(told.values()) == {case in ("one pair", "rear steered")}
    assert "Section 9" not in "".join(regular(derivation))
    inputs = [entry["name"] for entry in entries["u"]]
    for angles, (vx, vy, omega) in motions.items():
        given = {"vx": vx, "vy": vy, "omega": omega}
        x, u = [0, 0, 0, *angles], [given.get(name, 0.0) for name in inputs]
        value, *parts = (part.full() for part in jacobian(x, u, []))
        assert np.abs(value).max() < 1e-12
        symbols = {f"{row[0]}_steer": a for row, a in zip(names, angles, strict=True)} | given
        conditions = [
            float(d.expression.subs({s: symbols[s.name] for s in d.expression.free_symbols}))
            for d in system.domain
        ]
        full = np.linalg.matrix_rank(np.hstack(parts), tol=1e-9) == len(entries["constraints"])
        assert full == all(abs(c) > 1e-12 for c in conditions)


SWINGING = """\
wmrgen: 1
name: swinging
parameters: {ahead: {value: 0.3, tunable: true}, trail: {value: -0.05, tunable: true},
             aside: {value: 0.02, tunable: true}, zero: {value: 0.4, tunable: true}}
limits: {spin: 20, steer_rate: 9, steer: 3}
%s
wheels:
  - {name: a, type: castor, x: ahead, y: 0.2, heading: zero, d: trail, offset_y: aside, r: 0.05,
     actuated: [spin, steer]}
  - {name: b, type: castor, x: -0.25, y: -0.1, heading: -0.7, d: 2*ahead, r: 0.07, actuated: [spin]}
  - {name: c, type: castor, x: 0.1, y: -0.3, heading: 2, d: 0.04, offset_y: -aside, r: 0.06, actuated: [steer]}
  - {name: idle, type: castor, x: 0, y: 0.3, heading: 0, d: 0.03, r: 0.02, actuated: []}
"""


@pytest.mark.parametrize("name", ["tidybot2", "nomad_xr4000", "swinging", "together"])
def test_driven_castors_have_a_model_without_singular_angles(name: str) -> None:
    """Their angles are states, with the rates at which contacts do not slide; their speeds and rates are limits. Of
    castors that swing together the rate is the first one's, and `rolling` is what the others slide."""
    together = "couplings: [{equal: [a.steer, c.steer]}]" if name == "together" else ""
    limits = "limits: {spin: 20, steer_rate: 9, steer: 3}\n"
    if name in ROBOTS:
        text = ROBOTS[name].read_text(encoding="utf-8")
        derivation = of_text(re.sub("limits:.*\n", "", text) + limits)
    else:
        derivation = of_text(SWINGING % together)
    space = derivation.default_state_space
    assert space is not None and (space.form, space.singular, space.limited.absent) == ("twist", (), ())
    robot, entries = derivation.robot, derivation.entries()
    castors = [w for w in robot.wheels if w.actuated and (w.name, name) != ("c", "together")]
    assert [e["name"] for e in entries["x"][3:]] == [f"{w.name}.steer" for w in castors]
    for w, e in zip(castors, entries["x"][3:], strict=True):
        assert (e["lower"], e["upper"]) == ((-3, 3) if "steer" in w.actuated else (None, None))
    f, h, g, p = derivation.state_space(), derivation.limits(), derivation.rolling(), nominal(derivation)
    assert (g is None) == (name != "together")
    random = np.random.default_rng(5)
    for turn in (0, np.pi / 2, -np.pi, 0.3, None):
        angles = random.uniform(-3, 3, len(castors)) if turn is None else np.full(len(castors), turn)
        x, u = [0, 0, 0.5, *angles], random.uniform(-1, 1, 3)
        rates = f(x, u, p).full().ravel()
        v, omega = complex(*u[:2]), u[2]
        moved = v * np.exp(0.5j)
        assert rates[:3] == pytest.approx([moved.real, moved.imag, omega])
        limited = dict(zip([e["name"] for e in entries["limits"]], h(x, u, p).full().ravel(), strict=True))
        bounds = {e["name"]: (e["lower"], e["upper"]) for e in entries["limits"]}
        slides = {}
        for w in (w for w in robot.wheels if w.actuated):
            k = [c.name for c in castors].index("a" if (w.name, name) == ("c", "together") else w.name)
            e = w.zero_heading * np.exp(1j * angles[k])
            arm = float(w.nominal.d) * e + float(w.nominal.o) * 1j * e
            contact = (v + 1j * omega * w.pivot + 1j * (omega + rates[3 + k]) * arm) / e
            slides[f"{w.name}.slide"] = contact.imag
            if "spin" in w.actuated:
                assert limited[f"{w.name}.spin"] == pytest.approx(contact.real / float(w.nominal.r))
                assert bounds[f"{w.name}.spin"] == (-20, 20)
            if "steer" in w.actuated and w in castors:
                assert limited[f"{w.name}.steer_rate"] == pytest.approx(rates[3 + k])
                assert bounds[f"{w.name}.steer_rate"] == (-9, 9)
        follows = slides.pop("c.slide") if name == "together" else 0.0
        assert list(slides.values()) == pytest.approx([0] * len(slides), abs=1e-12)
        if g is not None:
            assert [e["name"] for e in entries["constraints"]] == ["c.slide"]
            assert g(x, u, p).full().ravel() == pytest.approx([follows], abs=1e-12)


@pytest.mark.slow
def test_a_swerve_is_planned_from_rest_to_rest() -> None:
    """As docs/mpc.md says: with rolling to a millimetre a second, where the equality has no regular point."""
    derivation = of_gallery("wpilib_swervebot")
    step, g = derivation.state_space(discrete="rk4", dt=0.1), derivation.rolling()
    problem = casadi.Opti()
    x, u = problem.variable(7, 21), problem.variable(7, 20)
    problem.subject_to(x[:, 0] == [0, 0, 0, 0.1, 0.1, 0.1, 0.1])
    problem.subject_to(x[:3, 20] == [1.0, 0.5, 1.0])
    problem.subject_to(u[:3, 19] == 0)
    for k in range(20):
        problem.subject_to(x[:, k + 1] == step(x[:, k], u[:, k], [])[0])
        problem.subject_to(problem.bounded(-1e-3, g(x[:, k], u[:, k], []), 1e-3))
    problem.minimize(casadi.sumsqr(u))
    problem.set_initial(u, 0.1)
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    plan = problem.solve()
    assert plan.value(x)[:3, 20] == pytest.approx([1.0, 0.5, 1.0])


def test_a_wheel_that_follows_may_be_the_centre_of_rotation() -> None:
    """Its speed is the root of a sum that rounding took below 0: `configuration` gave NaN."""
    derivation = of_text(
        """\
wmrgen: 1
name: three
parameters: {a: {value: 0.3, tunable: true}, b: {value: 0.4, tunable: true}}
wheels:
  - {name: one, type: steered, x: a, y: b, heading: 0, r: 0.05}
  - {name: two, type: steered, x: a, y: -b, heading: pi/2, r: 0.05}
  - {name: follows, type: steered, x: -a, y: b, heading: pi/2, r: 0.05}
""",
        ["posture", "configuration"],
    )
    a, b = np.random.default_rng(3).uniform(0.1, 0.6, (2, 200))
    still = dict.fromkeys(("x", "y", "theta", "one_angle", "two_angle", "follows_angle"), 0.0)
    angles = {"one_steer": np.pi / 2, "two_steer": np.arctan2(a, b) - np.pi / 2}
    rates = {"one_spin": 1.0, "one_steer_rate": 0.3, "two_steer_rate": 0.2}
    result = derivation.numpy().configuration(**still, **angles, **rates, a=a, b=b)
    assert np.abs(result["follows.spin"]).max() < 1e-6
    for f in derivation.module.functions:
        assert not findings(f), f.name
