"""What may not depend on the frame, the side, the order of the wheels or the unit of length."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.laws.common import NAMES, admissible, coupled, derived, gallery, law, sensed
from tests.laws.layouts import decimals, layouts, twists
from tests.laws.test_kinematics import gentle, near, present_of, within_limits
from tests.oracle import oracle
from tests.oracle.harness import Model, named, turn, twist_of

Layout = dict[str, Any]
Change = Callable[[Layout], Layout]
NUMBERS = st.lists(st.integers(-300, 300), min_size=24, max_size=24)


def moved(layout: Layout, dx: float, dy: float, quarter: int) -> Layout:
    """The same robot described in a frame whose origin is at (dx, dy), turned by ``quarter`` right angles."""
    return changed(layout, lambda w: _in_frame(w, dx, dy, quarter))


def changed(layout: Layout, each: Callable[[dict[str, Any]], dict[str, Any]]) -> Layout:
    return layout | {"wheels": [each(dict(w)) for w in layout["wheels"]]}


def _in_frame(w: dict[str, Any], dx: float, dy: float, quarter: int) -> dict[str, Any]:
    text = w.get("text", {})
    x, y = f"({text.get('x', repr(w['x']))}) - ({dx})", f"({text.get('y', repr(w['y']))}) - ({dy})"
    c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter % 4]
    new = {
        "x": f"{c}*({x}) + {s}*({y})", "y": f"{c}*({y}) - {s}*({x})",
        "heading": f"({text.get('heading', repr(w['heading']))}) - {quarter % 4}*pi/2",
    }  # fmt: skip
    px, py = w["x"] - dx, w["y"] - dy
    return w | {
        "x": c * px + s * py,
        "y": c * py - s * px,
        "heading": w["heading"] - quarter % 4 * math.pi / 2,
        "text": new,
    }


def mirrored(layout: Layout) -> Layout:
    """Left and right exchanged."""
    return changed(layout, _mirror)


def _mirror(w: dict[str, Any]) -> dict[str, Any]:
    text = w.get("text", {})
    new = {k: f"-({text.get(k, repr(w[k]))})" for k in ("y", "heading")} | {"x": text.get("x", repr(w["x"]))}
    flipped = {k: -w[k] for k in ("y", "heading", "gamma", "o") if k in w}
    return w | flipped | {"text": new}


def scaled(layout: Layout, k: float) -> Layout:
    """Every length times k."""
    return changed(layout, lambda w: _scale(w, k))


def _scale(w: dict[str, Any], k: float) -> dict[str, Any]:
    text = w.get("text", {})
    lengths = {n: f"{k}*({text.get(n, repr(w[n]))})" for n in ("x", "y")}
    return w | {n: k * w[n] for n in ("x", "y", "r", "d", "o") if n in w} | {"text": text | lengths}


def same_mobility(a: Model, b: Model) -> None:
    p, q = a.derivation.mobility, b.derivation.mobility
    for key in (
        "degree_of_mobility",
        "degree_of_steerability",
        "dof",
        "robot_type",
        "holonomic",
        "growth_vector",
    ):
        assert getattr(p, key) == getattr(q, key), key
    assert (p.rank_C1f.value, p.rank_C1.value) == (q.rank_C1f.value, q.rank_C1.value)


def compare(
    layout: Layout, other: Layout, twist: Any, twist_other: Any, sign: float, numbers: list[int],
    back: Callable[[Any], Any],
) -> None:  # fmt: skip
    """Mobility, inverse and forward of two descriptions of one robot. ``sign`` -1 turns steering angles round.

    ``back`` takes a twist of the other description to this one. Spins agree, as one wheel's steering may lie
    a half turn off with the drive reversed only where both branches are equally near.
    """
    check_same(derived(layout), layout, other, twist, twist_other, sign, numbers, back)


def check_same(
    a: Model, layout: Layout, other: Layout, twist: Any, twist_other: Any, sign: float, numbers: list[int],
    back: Callable[[Any], Any],
) -> None:  # fmt: skip
    """`compare`, with the model of the first description at hand."""
    b = derived(other)
    same_mobility(a, b)
    present = within_limits(a, coupled(layout, present_of(layout, 0.31)))
    p = a.call("inverse", named(twist) | present)
    q = b.call("inverse", named(twist_other) | {k: sign * v for k, v in present.items()})
    assert p.keys() == q.keys()
    radius = {w["name"]: w["r"] for w in layout["wheels"]}
    for key in p.keys() - {"slip"}:
        wheel, joint = key.split(".")
        factor = 1.0 if joint == "spin" else sign
        near(q[key], factor * p[key], scale=1 / radius[wheel], tol=1e-7)
    rates = {k: n / 100 for k, n in zip(sensed(a, {}), numbers, strict=False)}
    turned = {k: v if k.endswith(".spin") else sign * v for k, v in rates.items()}
    f, g = a.call("forward", rates), b.call("forward", turned)
    if well_posed(layout, rates) and well_posed(other, turned):
        near(back(twist_of(g)), twist_of(f), scale=float(np.abs(twist_of(f)).max()), tol=1e-6)


def well_posed(layout: Layout, rates: dict[str, float]) -> bool:
    """All of the twist is seen, and not only just: a lever of a micrometre counts as none."""
    found = oracle.measured_rows(layout, rates)[0]
    singular = np.linalg.svd(found, compute_uv=False) if len(found) >= 3 else np.zeros(3)
    return bool(singular[-1] > 1e-4 * singular[0])


@law(12)
@given(layouts(), twists, decimals(-0.8, 0.8), decimals(-0.8, 0.8), st.integers(0, 3), NUMBERS)
def test_frame(layout: Layout, weights: Any, dx: float, dy: float, quarter: int, numbers: list[int]) -> None:
    twist = admissible(layout, np.array(weights))
    at = np.array([twist[0] - twist[2] * dy, twist[1] + twist[2] * dx, twist[2]])
    rotation = turn(-quarter * math.pi / 2)

    def back(t: Any) -> Any:
        v = rotation.T @ t
        return np.array([v[0] + v[2] * dy, v[1] - v[2] * dx, v[2]])

    compare(layout, moved(layout, dx, dy, quarter), twist, rotation @ at, 1.0, numbers, back)


@law(12)
@given(layouts(), twists, NUMBERS)
def test_mirror(layout: Layout, weights: Any, numbers: list[int]) -> None:
    flip = np.array([1.0, -1.0, -1.0])
    twist = admissible(layout, np.array(weights))
    compare(layout, mirrored(layout), twist, flip * twist, -1.0, numbers, lambda t: flip * t)


@law(12)
@given(layouts(), twists, NUMBERS, st.randoms(use_true_random=False))
def test_wheel_order(layout: Layout, weights: Any, numbers: list[int], random: Any) -> None:
    wheels = list(layout["wheels"])
    random.shuffle(wheels)
    twist = admissible(layout, np.array(weights))
    compare(layout, layout | {"wheels": wheels}, twist, twist, 1.0, numbers, lambda t: t)


@law(12)
@given(layouts(), twists, NUMBERS, st.sampled_from([0.001, 0.0254, 1000.0]))
def test_unit_of_length(layout: Layout, weights: Any, numbers: list[int], k: float) -> None:
    twist = admissible(layout, np.array(weights))
    units = np.array([k, k, 1.0])
    compare(layout, scaled(layout, k), twist, units * twist, 1.0, numbers, lambda t: t / units)


def described(name: str) -> tuple[Model, Layout, Any]:
    """A gallery robot, its layout with the joints that have motors or encoders, and a twist for it."""
    model, layout = gallery(name)
    joints = {w.name: {"actuated": list(w.actuated), "sensed": list(w.sensed)} for w in model.robot.wheels}
    layout = changed(layout, lambda w: w | joints[w["name"]])
    return model, layout, admissible(layout, np.asarray(gentle(model, layout, (0.7, 0.2, -0.3)), float))


RATES = [37 * k % 211 - 100 for k in range(1, 25)]


@pytest.mark.parametrize("name", NAMES)
def test_gallery_frame(name: str) -> None:
    model, layout, twist = described(name)
    dx, dy, rotation = 0.25, -0.5, turn(-math.pi / 2)
    at = rotation @ [twist[0] - twist[2] * dy, twist[1] + twist[2] * dx, twist[2]]

    def back(t: Any) -> Any:
        v = rotation.T @ t
        return np.array([v[0] + v[2] * dy, v[1] - v[2] * dx, v[2]])

    check_same(model, layout, moved(layout, dx, dy, 1), twist, at, 1.0, RATES, back)


@pytest.mark.parametrize("name", NAMES)
def test_gallery_mirrored(name: str) -> None:
    model, layout, twist = described(name)
    flip = np.array([1.0, -1.0, -1.0])
    check_same(model, layout, mirrored(layout), twist, flip * twist, -1.0, RATES, lambda t: flip * t)


@pytest.mark.parametrize("name", NAMES)
def test_gallery_wheel_order(name: str) -> None:
    model, layout, twist = described(name)
    other = layout | {"wheels": layout["wheels"][1::2] + layout["wheels"][::2]}
    check_same(model, layout, other, twist, twist, 1.0, RATES, lambda t: t)


@pytest.mark.parametrize("name", NAMES)
def test_gallery_unit_of_length(name: str) -> None:
    model, layout, twist = described(name)
    units = np.array([0.0254, 0.0254, 1.0])
    check_same(model, layout, scaled(layout, 0.0254), twist, units * twist, 1.0, RATES, lambda t: t / units)


@law(12)
@given(layouts(), twists)
def test_polar_and_cartesian(layout: Layout, twist: Any) -> None:
    """(l, alpha, beta) and (x, y, heading) of one robot give the same commands."""
    p = derived(layout).call("inverse", named(twist))
    q = derived(layout, polar=True).call("inverse", named(twist))
    for key in p:
        radius = (
            1.0 if key == "slip" else next(w["r"] for w in layout["wheels"] if w["name"] == key.split(".")[0])
        )
        near(q[key], p[key], scale=1 / radius, tol=1e-7)
