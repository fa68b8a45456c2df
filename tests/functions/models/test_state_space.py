"""`Derivation.state_space`: x' = f(x, u, p) for optimisers, against contact velocities and small steps."""

from __future__ import annotations

import copy
import importlib.util
import json
import pickle
from math import atan, cos, inf, nan, radians, sin, tan
from pathlib import Path
from types import ModuleType

import casadi
import numpy as np
import pytest

import wmrgen
from tests.conftest import GALLERY, ROOT
from tests.functions.refusals import missing_names
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.errors import Code, NotDerivableError, UsageError

STEERED = ("wpilib_swervebot", "agilex_ranger", "ackermann_car", "pr2", "synchro_drive")


def nominal(derivation: wmrgen.Derivation) -> list[float]:
    return [p["nominal"] for p in derivation.model()["state_space"]["p"]]


def point(function: casadi.Function, seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.uniform(-0.6, 0.6, function.size1_in(0)), random.uniform(-1, 1, function.size1_in(1))


def columns(
    f: casadi.Function, nominal: list[float], count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, a column each; parameters up to a tenth off."""
    random = np.random.default_rng(1)
    x, u, p = (random.uniform(-1, 1, (f.size1_in(i), count)) for i in range(3))
    x[:, 0], u[:, 0] = -0.0, -0.0
    return x, u, np.reshape(nominal, (-1, 1)) * (1 + 0.1 * p)


def imported(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"generated_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_the_file_is_the_model_of_model_json(path: Path) -> None:
    """Checked in beside it: names, sizes, bounds in order, and the values of `Derivation.state_space`."""
    folder = ROOT / "generated" / wmrgen.load(path).name
    model = json.loads((folder / "model.json").read_text(encoding="utf-8"))
    file = folder / f"{model['name']}_ode.casadi"
    assert file.exists() == ("state_space" in model)
    if not file.exists():
        with pytest.raises(NotDerivableError):
            wmrgen.derive(wmrgen.load(path)).state_space()
        return
    space = model["state_space"]
    f = casadi.Function.load(str(file))
    assert (f.name_in(), f.name_out()) == (["x", "u", "p"], ["xdot"])
    assert [f.size1_in(i) for i in range(3)] == [len(space[key]) for key in "xup"]
    assert [entry["name"] for entry in space["x"][:3]] == ["x", "y", "theta"]
    assert all((e["lower"] or -inf) <= (e["upper"] or inf) for key in "xu" for e in space[key])
    again = wmrgen.derive(wmrgen.load(path)).state_space()
    p = [entry["nominal"] for entry in space["p"]]
    x, u, p = columns(f, p, 20)
    assert np.array_equal(f.map(20)(x, u, p).full(), again.map(20)(x, u, p).full())
    assert (folder / f"{model['name']}_rolling.casadi").exists() == bool(space["constraints"])
    module = imported(folder / f"{model['name']}.py")
    assert [tuple(entry["name"] for entry in space[key]) for key in "xup"] == [
        module.STATE,
        module.INPUTS,
        module.PARAMETERS,
    ]
    bounds = [
        tuple((inf if sign > 0 else -inf) if e[end] is None else e[end] for e in space[key])
        for key in ("x", "u", "limits")
        for end, sign in (("lower", -1), ("upper", 1))
    ]
    assert [getattr(module, name) for name in ("LBX", "UBX", "LBU", "UBU", "LBH", "UBH")] == bounds
    assert [entry["nominal"] for entry in space["p"]] == list(module.NOMINAL)
    for name in (
        "ode",
        *(word for word, key in (("rolling", "constraints"), ("limits", "limits")) if space[key]),
    ):
        g = casadi.Function.load(str(folder / f"{model['name']}_{name}.casadi"))
        arrays = getattr(module, name)(x.T, u.T, p.T)
        assert arrays == pytest.approx(g.map(20)(x, u, p).full().T, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", STEERED)
def test_constraints_are_what_contacts_slide(name: str) -> None:
    """Velocity of each steered wheel's contact along its axle, from positions alone; of two wheels of one axle once, so
    that no constraint follows from others; of a synchro drive one, and the yaw rate."""
    derivation = of_gallery(name)
    g = derivation.rolling()
    names = [entry["name"] for entry in derivation.entries("twist")["constraints"]]
    jacobian = g.factory("jacobian", ["x", "u", "p"], ["jac:g:x", "jac:g:u"])
    f = derivation.state_space("twist")
    system = derivation.system("twist")
    for seed in range(5):
        x, u = point(g, seed)
        p = [float(port.default) for port in system.geometry if port.default is not None]
        values = dict(zip([port.name for port in (*system.state, *system.inputs)], [*x, *u], strict=True))
        rates = np.array(f(x, u, p)).ravel()
        c, s = cos(x[2]), sin(x[2])
        vx, vy, omega = c * rates[0] + s * rates[1], -s * rates[0] + c * rates[1], rates[2]
        slides = {"omega": omega} if name == "synchro_drive" else {}
        for w in derivation.robot.wheels:
            if w.kind.steers:
                leader = derivation.robot.wheels[derivation.robot.steer_group[w.index]]
                angle = w.heading + values[f"{leader.name}.steer"]
                normal = np.array([-sin(angle), cos(angle)])
                contact = np.array([float(w.nominal.x), float(w.nominal.y)]) + float(w.nominal.o) * normal
                velocity = np.array([vx - omega * contact[1], vy + omega * contact[0]])
                slides[f"{w.name}.slide"] = velocity @ normal
        constraints = g(x, u, p).full().ravel()
        assert constraints == pytest.approx([slides[entry] for entry in names], abs=1e-12)
        if name != "synchro_drive":
            assert all(np.abs(constraints - slide).min() < 1e-12 for slide in slides.values())
        assert np.linalg.matrix_rank(np.hstack([part.full() for part in jacobian(x, u, p)]), 1e-9) == len(
            names
        )


@pytest.mark.parametrize("heading", ["pi/6", "-pi/2", "2", "-2"])
def test_wheels_of_one_axle_are_one_constraint_whichever_way_they_point(heading: str) -> None:
    twin = f"x: 0.5, y: 0.2, r: 0.1, heading: {heading}"
    text = f"""\
wmrgen: 1
name: twins
couplings: [{{equal: [a.steer, b.steer]}}]
wheels:
  - {{name: a, type: steered, {twin}, offset_y: 0.05}}
  - {{name: b, type: steered, {twin} + pi, offset_y: 0.05}}
  - {{name: c, type: steered, x: -0.5, y: 0, heading: 0, r: 0.1}}
"""
    names = [entry["name"] for entry in of_text(text).entries()["constraints"]]
    assert names == ["a.slide", "c.slide"]


def test_a_skid_steer_turns() -> None:
    derivation = of_gallery("clearpath_a200")
    rates = np.array(derivation.state_space()([0, 0, 0.5], [0.4, 0.9], nominal(derivation))).ravel()
    assert rates == pytest.approx([0.4 * cos(0.5), 0.4 * sin(0.5), 0.9])


def test_an_axle_off_the_origin_moves_it_sideways() -> None:
    """Fixed wheels at x = 0.3: P, behind the axle, is at -0.3 omega sideways, so that contacts do not slide."""
    text = """\
wmrgen: 1
name: ahead
parameters:
  a: {value: 0.3, tunable: true}
wheels:
  - {name: left, type: fixed, x: a, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: a, y: -0.2, heading: 0, r: 0.1}
"""
    f = of_text(text).state_space("twist")
    assert np.array(f([0, 0, 0], [0.5, 2.0], [0.35])).ravel() == pytest.approx([0.5, -0.7, 2.0])


@pytest.mark.parametrize("name", ["pioneer3dx", "wpilib_swervebot", "lekiwi", "ackermann_car"])
@pytest.mark.parametrize("kind", ["rk4", "exact", "collocation"])
def test_a_step_is_many_small_ones(name: str, kind: str) -> None:
    """Its A, B, c are its derivatives; exact is refused where steering changes the twist."""
    derivation = of_gallery(name)
    if (name, kind) == ("ackermann_car", "exact"):
        with pytest.raises(UsageError, match="rk4"):
            derivation.state_space(discrete=kind, dt=0.1)
        return
    f, p = derivation.state_space(), nominal(derivation)
    step = derivation.state_space(discrete=kind, dt=0.1)
    x, u = point(f, 4)
    fine = x.copy()
    for _ in range(2000):  # the midpoint rule
        middle = fine + np.array(f(fine, u, p)).ravel() * 0.1 / 4000
        fine = fine + np.array(f(middle, u, p)).ravel() * 0.1 / 2000
    after, a, b, affine = (np.array(part) for part in step(x, u, p))
    assert after.ravel() == pytest.approx(fine, abs={"exact": 1e-9, "rk4": 1e-6, "collocation": 1e-6}[kind])
    assert (a @ x + b @ u + affine.ravel()) == pytest.approx(after.ravel(), abs=1e-12)
    for index in range(len(x)):
        offset = 1e-6 * np.eye(len(x))[index]
        high, low = (np.array(step(x + sign * offset, u, p)[0]).ravel() for sign in (1, -1))
        assert a[:, index] == pytest.approx((high - low) / 2e-6, abs=1e-7)
    for index in range(len(u)):
        offset = 1e-6 * np.eye(len(u))[index]
        high, low = (np.array(step(x, u + sign * offset, p)[0]).ravel() for sign in (1, -1))
        assert b[:, index] == pytest.approx((high - low) / 2e-6, abs=1e-7)


def test_a_trailer_has_no_exact_step() -> None:
    """Its angle follows the motion, though the inputs alone decide the twist; a wheel's angle does not."""
    text = """\
wmrgen: 1
name: pulled
trailers: [{length: 0.8, hitch: 0.3}]
wheels:
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
"""
    derivation = of_text(text)
    with pytest.raises(UsageError, match="rk4"):
        derivation.state_space("trailer", "exact", 0.1)
    after = derivation.state_space("configuration", "exact", 2.0)([0, 0, 0, 1, 2], [3, -4], [])[0]
    assert after.full().ravel()[3:] == pytest.approx([7, -6])


def test_rates_of_inputs_are_bounded_as_the_file_says() -> None:
    vx, *_, steer_rate = of_gallery("wpilib_swervebot").model()["state_space"]["u"]
    assert (vx["rate_lower"], vx["rate_upper"]) == (-9, 9) and "rate_lower" not in steer_rate


@pytest.mark.parametrize(
    "dt", [0.1, 0.0, -0.1, inf, nan, "soon", 2 * casadi.SX.sym("h"), casadi.SX.sym("h", 2)]
)
def test_what_is_no_step_is_refused(dt: float) -> None:
    kind, message = (
        ("euler", r"exact.*rk4.*collocation")
        if isinstance(dt, float) and dt == 0.1
        else ("rk4", "a step takes time")
    )
    with pytest.raises(UsageError, match=message):
        of_gallery("lekiwi").state_space(discrete=kind, dt=dt)


def test_a_form_or_a_step_that_there_is_not_is_refused() -> None:
    derivation = of_gallery("pioneer3dx")
    for ask in (derivation.state_space, derivation.entries, derivation.limits, derivation.system):
        with pytest.raises(UsageError) as caught:
            ask("postur")
        assert caught.value.code == Code.USAGE and missing_names(caught.value, ("postur", "posture")) == []
    with pytest.raises(UsageError, match=r"configuration.*eta.*posture.*trailer.*twist.*zeta"):
        derivation.state_space("chained")
    with pytest.raises(UsageError, match="rk4"):
        derivation.state_space(dt=0.1)


@pytest.mark.parametrize("kind", ["rk4", "exact", "collocation"])
def test_a_step_is_the_same_everywhere(kind: str) -> None:
    """In coordinates of a map, where a metre is the millionth part of x, and after many turns."""
    step = of_gallery("wpilib_swervebot").state_space(discrete=kind, dt=0.1)
    x, u = point(step, 4)
    after, a, *_ = (part.full() for part in step(x, u, []))
    away = np.array([5e5, 4.5e6, 200 * np.pi, 0, 0, 0, 0])
    there, same, *_ = (part.full() for part in step(x + away, u, []))
    assert there.ravel() - away == pytest.approx(after.ravel(), abs=2e-9)
    assert same == pytest.approx(a, abs=1e-9)


def test_parameters_that_are_not_given_are_nominal() -> None:
    """By name and by position, of rates, limits and steps, fixed and free; a copy and what is unpickled know them."""
    derivation = of_gallery("pioneer3dx")
    p = nominal(derivation)
    free = derivation.state_space(discrete="rk4")
    fixed = derivation.state_space(discrete="rk4", dt=0.1)
    for f in (derivation.state_space(), derivation.limits(), fixed, copy.copy(fixed), copy.deepcopy(fixed)):
        for function in (f, pickle.loads(pickle.dumps(f))):
            name = function.name_out(0)
            whole = function(x=[0, 0, 0], u=[1, 2], p=p)[name].full()
            assert np.abs(whole).max() > 0.01
            assert np.array_equal(function(x=[0, 0, 0], u=[1, 2])[name].full(), whole)
            assert np.array_equal(function.call([[0, 0, 0], [1, 2]])[0].full(), whole)
            other = function(x=[0, 0, 0], u=[1, 2], p=[0.2, 0.1])[name].full()
            assert not np.array_equal(other, whole)
    assert free(u=[1, 2], dt=0.1)["A"].full() == pytest.approx(fixed(u=[1, 2])["A"].full(), abs=1e-15)
    assert np.isnan(free(x=[0, 0, 0], u=[1, 2], p=p)["xnext"].full()).any()  # a step takes time
    swerve = of_gallery("wpilib_swervebot").state_space()
    assert np.isfinite(swerve(x=[0] * 7, u=[1] * 7)["xdot"].full()).all()


def test_a_file_knows_parameters_that_share_one_value(tmp_path: Path) -> None:
    """CasADi has one default for a vector: in files p is nominal if its entries are alike, else NaN, never 0."""
    text = """\
wmrgen: 1
name: alike
parameters: {a: {value: 0.1, tunable: true}, b: {value: B, tunable: true}}
wheels:
  - {name: left, type: fixed, x: 0, y: b, heading: 0, r: a}
  - {name: right, type: fixed, x: 0, y: -b, heading: 0, r: a}
"""
    for b in (0.1, 0.2):
        f = of_text(text.replace("B", str(b))).state_space()
        f.save(str(tmp_path / "f"))
        read = casadi.Function.load(str(tmp_path / "f"))
        rates = read(x=[0, 0, 0], u=[1, 2])["xdot"].full()
        if b == 0.1:
            assert np.array_equal(rates, f(x=[0, 0, 0], u=[1, 2])["xdot"].full())
        assert np.isnan(rates).any() == (b != 0.1)


@pytest.mark.parametrize(
    "name", ["pioneer3dx", "wpilib_swervebot", "lekiwi", "ackermann_car", "car_with_trailers"]
)
@pytest.mark.parametrize("kind", ["rk4", "exact", "collocation"])
def test_a_free_step_is_the_step_of_every_length(name: str, kind: str) -> None:
    """Its first four results are those of the fixed step; by_dt is the derivative by dt."""
    derivation = of_gallery(name)
    if kind == "exact" and name in ("ackermann_car", "car_with_trailers"):
        with pytest.raises(UsageError, match="rk4"):
            derivation.state_space(discrete=kind)
        return
    p = nominal(derivation)
    for symbol in (None, casadi.SX.sym("h"), casadi.MX.sym("h")):
        free = derivation.state_space(discrete=kind, dt=symbol)
        assert free.name_in() == ["x", "u", "p", "dt"]
        assert free.name_out() == ["xnext", "A", "B", "c", "by_dt"]
    x, u = point(free, 4)
    for dt in (1e-3, 0.1, 0.3):
        *parts, by_dt = free(x, u, p, dt)
        for part, same in zip(parts, derivation.state_space(discrete=kind, dt=dt)(x, u, p), strict=True):
            assert part.full() == pytest.approx(same.full(), abs=1e-13)
        high, low = (free(x, u, p, dt + h)[0].full() for h in (1e-6, -1e-6))
        assert by_dt.full() == pytest.approx((high - low) / 2e-6, abs=1e-7)
    zero = free(x, u, p, 0)
    assert zero[0].full().ravel() == pytest.approx(x, abs=1e-15)
    assert zero[4].full() == pytest.approx(derivation.state_space()(x, u, p).full(), abs=1e-9)


def test_a_free_exact_step_of_lags() -> None:
    """dt stands in the exponents of first-order lags, too."""
    text = ROBOTS["wpilib_swervebot"].read_text(encoding="utf-8") + "\nlag: {steer: 0.15}\n"
    derivation = of_text(text)
    free, x = derivation.state_space("twist", "exact"), [0, 0, 0, 0.1, 0.2, 0.3, 0.4]
    u = [1, 0.5, 0.2, 0.5, 0.4, 0.3, 0.2]
    for dt in (0.01, 0.4):
        after = free(x, u, [], dt)[0].full()
        assert after.ravel()[3] == pytest.approx(0.5 - 0.4 * np.exp(-dt / 0.15), abs=1e-14)
        assert np.array_equal(after, derivation.state_space("twist", "exact", dt)(x, u, [])[0].full())


def test_the_default_of_a_robot_with_trailers_has_them() -> None:
    """As states; in forms without them a line says so."""
    derivation = of_gallery("car_with_trailers")
    states = [e["name"] for e in derivation.entries()["x"]]
    assert derivation.entries()["form"] == "trailer" and states[-2:] == ["trailer1.theta", "trailer2.theta"]
    for form in ("posture", "twist", "eta"):
        entries = derivation.entries(form)
        assert all("trailer" not in e["name"] for e in entries["x"])
        assert "form trailer" in entries["text"].split("; ")[-1]


def test_a_plan_that_chooses_its_time() -> None:
    """Time-optimal: 1 m ahead at no more than 1.2 m/s."""
    derivation = of_gallery("pioneer3dx")
    step, limits = derivation.state_space(discrete="exact"), derivation.limits()
    robot, n = derivation.numpy(), 5
    problem = casadi.Opti()
    x, u, dt = problem.variable(3, n + 1), problem.variable(2, n), problem.variable()
    problem.subject_to(x[:, 0] == [0, 0, 0])
    problem.subject_to(x[:, n] == [1, 0, 0])
    problem.subject_to(dt >= 0)
    for k in range(n):
        problem.subject_to(x[:, k + 1] == step(x[:, k], u[:, k], robot.NOMINAL, dt)[0])
        problem.subject_to(problem.bounded(robot.LBH, limits(x[:, k], u[:, k]), robot.UBH))
    problem.minimize(n * dt)
    problem.set_initial(dt, 0.5)
    problem.set_initial(u, 5)
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    assert n * problem.solve().value(dt) == pytest.approx(1 / 1.2, rel=1e-6)


@pytest.mark.parametrize("kind", ["rk4", "exact", "collocation"])
def test_casadi_writes_c_of_a_step(kind: str) -> None:
    """Also of one that solves equations: of two of its Newton methods CasADi writes one in C."""
    generator = casadi.CodeGenerator("step.c")
    generator.add(of_gallery("pioneer3dx").state_space(discrete=kind, dt=0.1))
    text = generator.dump()
    assert "pioneer3dx_ode" in text and "#error Code generation not supported" not in text


def test_the_exact_step_is_exact_and_smooth_at_a_straight_line() -> None:
    """One step of ten seconds, through omega = 0 on both sides of the switch to the series."""
    derivation = of_gallery("lekiwi")
    f = derivation.state_space("twist", "exact", 10.0)
    for omega in (-0.7, -2.1e-5, -1.9e-5, 0.0, 1.9e-5, 2.1e-5, 0.7):
        x = np.array(f([1, 2, 0.4], [0.3, -0.1, omega], nominal(derivation))[0]).ravel()
        z = (
            complex(0.3, -0.1)
            * (10.0 if omega == 0 else (np.exp(10j * omega) - 1) / (1j * omega))
            * np.exp(0.4j)
        )
        assert x == pytest.approx([1 + z.real, 2 + z.imag, 0.4 + 10 * omega], abs=1e-9)
        jacobian = np.array(f([1, 2, 0.4], [0.3, -0.1, omega], nominal(derivation))[2])
        assert np.isfinite(jacobian).all()


def test_a_parameter_that_a_model_does_without_stays_in_its_vector() -> None:
    """A tunable toe moves inverse, and no term of a posture model: p has an entry for it all the same."""
    text = """\
wmrgen: 1
name: toed
parameters:
  a: {value: 0.05, tunable: true}
  unused: {value: 0.2, tunable: true}
wheels:
  - {name: left, type: swedish, x: 0.3, y: unused, heading: a/2, gamma: 0, r: 0.1}
  - {name: right, type: swedish, x: -0.2, y: -0.2, heading: 0, gamma: 0, r: 0.1}
  - {name: back, type: swedish, x: 0, y: 0.4, heading: pi/2, gamma: 0, r: 0.1}
"""
    f = of_text(text).state_space("twist")
    assert f.size1_in(2) == 2
    assert np.array(f([0, 0, 0], [0.5, 0.1, 2.0], [0.35, 0.1])).ravel() == pytest.approx([0.5, 0.1, 2.0])


def test_numpy_takes_vectors_along_the_last_axis() -> None:
    """The module without a file: shapes broadcast, wrong lengths and shapes are named; parameters are nominal."""
    module = of_gallery("pioneer3dx").numpy()
    assert (module.STATE, module.NOMINAL) == (("x", "y", "theta"), (0.1655, 0.0975))
    x, u = np.array([1.0, 2.0, 0.3]), np.array([[4.0, 6.0], [-1.0, 1.0], [0.0, -0.0]])
    rates = module.ode(np.broadcast_to(x, (5, 1, 3)), u)
    assert rates.shape == (5, 3, 3)
    speed, turn = 0.0975 * u.mean(axis=1), 0.0975 * (u[:, 1] - u[:, 0]) / (2 * 0.1655)
    assert rates[4] == pytest.approx(np.stack([speed * cos(0.3), speed * sin(0.3), turn], 1), abs=1e-15)
    assert module.ode(x, u[0], [0.331, 0.0975])[2] == pytest.approx(turn[0] / 2)
    with pytest.raises(ValueError, match=r"u has the shape \(3,\), not \(..., 2\)"):
        module.ode(x, [1, 2, 3])
    swerve = of_gallery("wpilib_swervebot")
    state, command = point(swerve.rolling(), 2)
    assert swerve.numpy().rolling(state, command) == pytest.approx(
        swerve.rolling()(state, command, []).full().ravel(), abs=1e-14
    )


@pytest.mark.parametrize("degrees", [40, 80, 200])
@pytest.mark.parametrize("lead", ["front", "front_left"])
def test_a_steering_coordinate_keeps_the_limits_of_those_that_follow(lead: str, degrees: int) -> None:
    """Cotangents of the angles of front wheels differ by distance over wheelbase (Ackermann): the inner one decides,
    beyond a right angle of the outer one, too. Wheels that may turn round bound nothing."""
    text = ROBOTS["car_with_trailers"].read_text(encoding="utf-8").replace("40 deg", f"{degrees} deg")
    if lead != "front":
        text = text[: text.index("virtual:")] + text[text.index("trailers:") :]
    derivation = of_text(text)
    entry = derivation.entries()["x"][3]
    left, right = (derivation.robot.wheel(f"front_{side}") for side in ("left", "right"))
    width = left.pivot.imag - right.pivot.imag
    base = left.pivot.real - derivation.robot.wheel("rear_left").pivot.real
    most, inner = radians(degrees), 1 / tan(radians(degrees))
    if degrees == 200:
        expected = {"front": (None, None), "front_left": (-most, most)}[lead]
    elif lead == "front":
        expected = (-atan(1 / (inner + width / 2 / base)), atan(1 / (inner + width / 2 / base)))
    else:
        expected = (-atan(1 / (inner + width / base)), most)
    assert (entry["lower"], entry["upper"]) == pytest.approx(expected)
