"""Covariances of twist and pose: against Jacobians by differences, and against a hundred thousand noisy runs."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.functions.refusals import mistaken, refused
from tests.oracle import oracle, weighted
from tests.oracle.harness import robot_text
from tests.oracle.weighted import LAYOUTS
from tests.robots import of_text
from wmrgen.codegen.c.checked import safe
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code
from wmrgen.functions.registry import Reason
from wmrgen.geometry.ports import NO_SITE, POSE_COVARIANCE
from wmrgen.geometry.ports import POSE as PORTS
from wmrgen.ir.interpret import FLOAT32, evaluate_module

Array = NDArray[np.float64]
NOISE = {"spin": (0.02, 0.01), "steer": (0.0, 0.004), "steer_rate": (0.05, 0.02)}
NOISY = "noise:\n" + "".join(
    f"  {joint}: {{proportional: {p}, constant: {c}}}\n" for joint, (p, c) in NOISE.items()
)
TWIST, POSE = ("vx", "vy", "omega"), ("x", "y", "theta")
FUNCTIONS = ("forward", "odometry", "forward_covariance", "odometry_covariance")
SEEN = [name for name in LAYOUTS if name != "one castor"]


def derived(text: str) -> Derivation:
    return of_text(text, FUNCTIONS)


def matrix(values: dict[str, Any], names: tuple[str, ...]) -> Array:
    """The symmetric matrix of six named scalars."""
    pair = {frozenset((i, j)): a + b for i, a in enumerate(names) for j, b in enumerate(names) if j >= i}
    return np.array([[float(values[pair[frozenset((i, j))]]) for j in range(3)] for i in range(3)])


def upper(values: Array, names: tuple[str, ...]) -> dict[str, float]:
    return {names[i] + names[j]: float(values[i, j]) for i in range(3) for j in range(i, 3)}


def variance(name: str, value: float) -> float:
    share, least = NOISE[name.partition(".")[2]]
    return (share * value) ** 2 + least**2


def consistent(layout: dict[str, Any], rng: random.Random) -> tuple[Array, dict[str, float]]:
    """A twist that the fixed wheels allow, and joints that drive it without slip."""
    fixed = any(w["type"] == "fixed" for w in layout["wheels"])
    twist = np.array([rng.uniform(0.5, 2), 0.0 if fixed else rng.uniform(-1, 1), rng.uniform(-1, 1)])
    turning = [w["name"] for w in layout["wheels"] if w["type"] in oracle.STEERABLE]
    present = {f"{name}.steer": rng.uniform(-1, 1) for name in turning}
    joints = present | oracle.inverse(layout, twist, present)
    return twist, joints


def noise_of_rows(layout: dict[str, Any], sensed: dict[str, float], twist: Array) -> Array:
    """Covariance [n, n] of H xi - z at a given twist, by central differences."""
    total = np.zeros((len(weighted.rows(layout, sensed)[1]),) * 2)
    for name, value in sensed.items():
        sides = [weighted.rows(layout, sensed | {name: value + d}) for d in (1e-5, -1e-5)]
        moved = np.subtract(*((h @ twist - z) for h, z, _ in sides)) / 2e-5
        total += variance(name, value) * np.outer(moved, moved)
    return total


def sensed_of(d: Derivation, joints: dict[str, float]) -> dict[str, float]:
    return {p.name: joints.get(p.name, 0.0) for p in d.formula("forward").inputs}


@pytest.mark.parametrize("name", SEEN)
def test_propagation_through_the_least_squares(name: str) -> None:
    """Without slip the covariance is J S J^T, J the differences of numpy's lstsq."""
    layout, rng = LAYOUTS[name], random.Random(name)
    d = derived(robot_text(layout, extra=NOISY))
    inputs = [p.name for p in d.formula("forward_covariance").inputs]
    for _ in range(3):
        twist, joints = consistent(layout, rng)
        sensed = sensed_of(d, joints)
        wanted = np.zeros((3, 3))
        for joint, value in sensed.items():
            sides = [weighted.forward(layout, sensed | {joint: value + step})[0] for step in (1e-5, -1e-5)]
            wanted += variance(joint, value) * np.outer(*[(sides[0] - sides[1]) / 2e-5] * 2)
        values = sensed | dict(zip(TWIST, twist, strict=True)) | {"slip": 0.0}
        result = d.numpy().forward_covariance(**{n: values[n] for n in inputs})
        np.testing.assert_allclose(matrix(result, TWIST), wanted, atol=1e-6 * np.trace(wanted))


@pytest.mark.parametrize("name", ["load wheel", "swerve", "mecanum", "wide castors", "mixed"])
def test_slip_beyond_the_noise_raises_it(name: str) -> None:
    """What slip**2 has beyond its mean under noise, per redundant row, times (H^T W H)^-1; nothing below."""
    layout, rng = LAYOUTS[name], random.Random(name)
    d = derived(robot_text(layout, extra=NOISY))
    inputs = [p.name for p in d.formula("forward_covariance").inputs]
    twist, joints = consistent(layout, rng)
    sensed = sensed_of(d, joints)
    h, _, w = weighted.rows(layout, sensed)
    normal = np.linalg.inv(h.T @ np.diag(w) @ h)
    rest = np.eye(len(w)) - h @ normal @ h.T @ np.diag(w)
    noise = noise_of_rows(layout, sensed, twist)
    mean = float(np.trace(rest.T @ np.diag(w) @ rest @ noise))
    sampled = rng_normal(name).multivariate_normal(np.zeros(len(w)), noise, 100_000) @ rest.T
    assert np.mean(sampled**2 @ w) == pytest.approx(mean, rel=0.02)

    def at(slip: float) -> Array:
        values = sensed | dict(zip(TWIST, twist, strict=True)) | {"slip": slip}
        return matrix(d.numpy().forward_covariance(**{n: values[n] for n in inputs}), TWIST)

    least = at(0.0)
    np.testing.assert_array_equal(at(0.999 * mean**0.5), least)
    for slip in (1.001 * mean**0.5, 0.3):
        raised = (slip**2 - mean) / (len(w) - 3) * normal
        np.testing.assert_allclose(
            at(slip) - least, raised, atol=2e-6 * np.trace(raised) + 1e-9 * np.trace(least)
        )


def rng_normal(name: str) -> np.random.Generator:
    return np.random.default_rng(list(name.encode()))


def _exponential(pose: Array, twist: Array, dt: float) -> Array:
    """Poses [n, 3] after driving twists [n, 3] for dt along arcs, by the centre of rotation."""
    vx, vy, turn = twist[:, 0] * dt, twist[:, 1] * dt, twist[:, 2] * dt
    small = np.abs(turn) < 1e-9
    safe = np.where(small, 1.0, turn)
    a = np.where(small, 1.0, np.sin(safe) / safe)
    b = np.where(small, turn / 2, (1 - np.cos(safe)) / safe)
    dx, dy = a * vx - b * vy, b * vx + a * vy
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    return pose + np.stack([c * dx - s * dy, s * dx + c * dy, turn], axis=1)


def _measured_twists(layout: dict[str, Any], joints: dict[str, Array]) -> Array:
    """Weighted least squares of n noisy samples of joints at a time; every wheel measures a contact velocity."""
    some = next(iter(joints.values()))
    normal, moment = np.zeros((len(some), 3, 3)), np.zeros((len(some), 3))
    for w in layout["wheels"]:
        spin, steer = joints[f"{w['name']}.spin"], joints.get(f"{w['name']}.steer", np.zeros_like(some))
        rate = joints.get(f"{w['name']}.steer_rate", np.zeros_like(some))
        c, s = np.cos(w["heading"] + steer), np.sin(w["heading"] + steer)
        d, o = w.get("d", 0.0), w.get("o", 0.0)
        bx, by = w["x"] + d * c - o * s, w["y"] + d * s + o * c
        along, across = w["r"] * spin + o * rate, -d * rate
        one, none = np.ones_like(c), np.zeros_like(c)
        for row, value in (
            ((one, none, -by), along * c - across * s),
            ((none, one, bx), along * s + across * c),
        ):
            h = np.stack(row, axis=1)
            normal += w["weight"] * h[:, :, None] * h[:, None, :]
            moment += w["weight"] * h * value[:, None]
    return np.asarray(np.linalg.solve(normal, moment[:, :, None])[:, :, 0])


STEPS, DT, RUNS = 25, 0.05, 100_000
DRIVEN = ("differential", "swerve", "wide castors")


@pytest.mark.parametrize(
    ("name", "runs"),
    [
        *((name, RUNS // 10) for name in DRIVEN),
        *(pytest.param(n, RUNS, marks=pytest.mark.slow) for n in DRIVEN),
    ],
)
def test_noisy_runs(name: str, runs: int) -> None:
    """The spread of poses after a second of driving is the covariance that is carried along."""
    layout, rng, noise = LAYOUTS[name], random.Random(name), rng_normal(name)
    d = derived(robot_text(layout, extra=NOISY))
    inputs = [p.name for p in d.formula("forward_covariance").inputs]
    start = np.array([0.4, -0.2, 0.7])
    poses, pose = np.tile(start, (runs, 1)), dict(zip(POSE, start, strict=True))
    carried = upper(np.zeros((3, 3)), POSE)
    for _ in range(STEPS):
        twist, joints = consistent(layout, rng)
        sensed = sensed_of(d, joints)
        noisy = {n: v + np.sqrt(variance(n, v)) * noise.standard_normal(runs) for n, v in sensed.items()}
        poses = _exponential(poses, _measured_twists(layout, noisy), DT)
        values = sensed | dict(zip(TWIST, twist, strict=True)) | {"slip": 0.0}
        spread = d.numpy().forward_covariance(**{n: values[n] for n in inputs})
        after = d.numpy().odometry_covariance(
            **pose, **carried, **dict(zip(TWIST, twist, strict=True)), **spread, dt=DT
        )
        pose, carried = {n: after[n] for n in POSE}, {n: after[n] for n in carried}
    wanted, sampled = matrix(carried, POSE), np.cov(poses.T)
    sizes = np.sqrt(np.diag(wanted))
    np.testing.assert_allclose(
        sampled / np.outer(sizes, sizes), wanted / np.outer(sizes, sizes), atol=0.01 + 4 * np.sqrt(2 / runs)
    )


@pytest.mark.parametrize("turn", [0.0, 0.02, 0.6])
def test_a_step_is_the_jacobian_of_the_exponential(turn: float) -> None:
    d = derived(robot_text(LAYOUTS["differential"], extra=NOISY))
    dt, rng = 0.2, np.random.default_rng(5)
    values = np.array([0.3, -0.4, 0.9, 1.2, -0.7, turn / dt])

    def end(at: Array) -> Array:
        return oracle.step(at[:3], at[3:], dt)

    jacobian = np.stack([(end(values + e) - end(values - e)) / 2e-6 for e in 1e-6 * np.eye(6)], axis=1)
    roots = rng.normal(size=(2, 3, 3))
    before, spread = (r @ r.T for r in roots)
    full = np.block([[before, np.zeros((3, 3))], [np.zeros((3, 3)), spread]])
    inputs = dict(zip((*POSE, *TWIST), values, strict=True)) | upper(before, POSE) | upper(spread, TWIST)
    after = d.numpy().odometry_covariance(**inputs, dt=dt)
    # By the yaw rate, what turns the chord is taken, and not what shortens it.
    h, way = turn / 2, end(values)[:2] - values[:2]
    shortened = dt / 2 * (1 / h - 1 / np.tan(h)) * way if h else 0 * way
    jacobian[:2, 5] += shortened
    wanted = jacobian @ full @ jacobian.T
    np.testing.assert_allclose(matrix(after, POSE), wanted, atol=1e-7)
    assert np.linalg.norm(shortened) <= turn / 6 * 1.02 * dt / 2 * np.linalg.norm(way)
    plain = d.numpy().odometry(**{n: inputs[n] for n in (*POSE, *TWIST)}, dt=dt)
    assert {n: after[n] for n in POSE} == plain


@pytest.mark.parametrize("name", ["differential", "swerve", "wide castors", "mixed"])
def test_positive_semidefinite_in_float(name: str) -> None:
    """No eigenvalue lies further below 0 than rounding: 1e-6 of the trace; over 300 steps."""
    layout, rng = LAYOUTS[name], random.Random(name)
    module = derived(robot_text(layout, extra=NOISY)).c_module
    carried, pose = upper(np.zeros((3, 3)), POSE), dict.fromkeys(POSE, 0.0)
    inputs = {f: [p.name for p in module.function(f).inputs] for f in FUNCTIONS[2:]}
    for _ in range(300):
        values = {n: rng.uniform(-3, 3) * rng.choice((0.0, -0.0, 1.0)) for n in inputs["forward_covariance"]}
        spread = evaluate_module(module, "forward_covariance", values, FLOAT32)
        after = evaluate_module(
            module, "odometry_covariance",
            dict.fromkeys(("dt",), 0.01) | {n: rng.uniform(-3, 3) for n in TWIST} | pose | carried | spread, FLOAT32,
        )  # fmt: skip
        pose, carried = {n: after[n] for n in POSE}, {n: after[n] for n in carried}
        for covariance in (matrix(spread, TWIST), matrix(carried, POSE)):
            assert np.linalg.eigvalsh(covariance)[0] >= -1e-6 * np.trace(covariance)


def test_a_refused_step_keeps_the_covariance() -> None:
    """0 would say that the pose is known exactly."""
    module = derived(robot_text(LAYOUTS["differential"], extra=NOISY)).c_module
    outputs = safe(module.function("odometry_covariance"), "float", NO_SITE)
    assert [output.port.name for output in outputs if output.held] == [
        p.name for p in (*PORTS, *POSE_COVARIANCE)
    ]


def test_a_wheel_has_its_own_noise() -> None:
    """Before that of the robot; a joint without any is exact."""
    text = robot_text(LAYOUTS["differential"]).replace("weight: 0.25", "noise: {spin: {constant: 1 rad/s}}")
    assert "noise" in text
    alone = derived(text).numpy().forward_covariance(**{"w0.spin": 5.0, "w1.spin": 7.0})
    assert alone["vxvx"] == pytest.approx((0.05 * 0.15 / 0.35) ** 2)
    assert alone["omegaomega"] == pytest.approx((0.05 / 0.35) ** 2)
    both = derived(text + "noise: {spin: {proportional: 0.1}}\n").numpy()
    assert both.forward_covariance(**{"w0.spin": 5.0, "w1.spin": 0.0}) == pytest.approx(alone)
    result = both.forward_covariance(**{"w0.spin": 5.0, "w1.spin": 7.0})
    assert result["vxvx"] == pytest.approx((0.05 * 0.15 / 0.35) ** 2 + (0.05 * 0.7 * 0.2 / 0.35) ** 2)


def test_who_has_no_covariance() -> None:
    for layout, extra, reason in (
        (LAYOUTS["swerve"], "", Reason.NO_NOISE),
        (LAYOUTS["one castor"], NOISY, Reason.UNOBSERVABLE),
        (weighted.layout(LAYOUTS["differential"]["wheels"][0]), NOISY, Reason.UNOBSERVABLE),
    ):
        with refused(reason, "forward_covariance"):
            derived(robot_text(layout, extra=extra)).formula("forward_covariance")


@pytest.mark.parametrize(
    ("noise", "code", "place", "names"),
    [("{spin: 0.1}", Code.FORM, "0.1}", ("spin",)),
     ("{spin: {constant: -1}}", Code.VALUE, "-1}", ("constant", "-1")),
     ("{spin: {constant: 1 deg}}", Code.FORM, "1 deg}", ("constant", "1 deg")),
     ("{spin: {proportional: 2 m}}", Code.FORM, "2 m}", ("proportional", "2 m")),
     ("{spin: {sigma: 1}}", Code.UNKNOWN_KEY, "sigma: 1}", ("sigma",)),
     ("{vx: {constant: 1}}", Code.UNKNOWN_KEY, "vx: {", ("vx",))],
)  # fmt: skip
def test_noise_that_makes_no_sense(noise: str, code: Code, place: str, names: tuple[str, ...]) -> None:
    with mistaken(code, place, *names):
        derived(robot_text(LAYOUTS["differential"], extra=f"noise: {noise}\n"))
