"""CasADi functions take no more instructions than hand-written ones from contact physics and `ca.solve`.

This holds for all families of layouts, with all parameters tunable and with none, for functions and their Jacobians.
Both give the same values.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from benchmarks.naive import LAYOUTS, Layout, counts, pairs
from tests.robots import of_gallery, of_text

NAMES = {layout.name: layout for layout in LAYOUTS}
EVERY = [
    (layout.name, tunable, name)
    for layout in LAYOUTS
    for tunable in (True, False)
    for name in ("ode", "inverse", "forward")
    if name != "inverse" or all(w.type != "steered" for w in layout.wheels)
]
# `forward` of everything tunable is a law of its own, see below; a bicycle's chooses by the steering angle between two
# sets of rows, where what is typed divides by zero.
FORWARD = [case for case in EVERY if case[2] == "forward" and case[1]]
CHOOSES = ("bicycle", "train")


def both(layout: Layout, tunable: bool, name: str) -> tuple[ca.Function, ca.Function]:
    return pairs(layout, of_text(layout.text(tunable)), tunable)[name]


@pytest.mark.parametrize(("layout", "tunable", "name"), EVERY)
def test_both_compute_the_same(layout: str, tunable: bool, name: str) -> None:
    """Functions equal contact physics, also for parameters that are not nominal."""
    ours, theirs = both(NAMES[layout], tunable, name)
    random = np.random.default_rng(7)
    for off in (0.0, 0.1, 0.1):
        p = {k: v * (1 + off * random.uniform(-1, 1)) for k, v in NAMES[layout].parameters.items()}
        values = [random.uniform(-0.9, 0.9, ours.size1_in(i)) for i in range(ours.n_in())]
        if name == "ode":
            values[2] = list(p.values()) if tunable else []
        else:
            values = [p.get(each, value) for each, value in zip(ours.name_in(), values, strict=True)]
        found, wanted = (
            np.concatenate([part.full().ravel() for part in f.call(values)]) for f in (ours, theirs)
        )
        assert found == pytest.approx(wanted, rel=1e-11, abs=1e-12)


@pytest.mark.parametrize(
    ("layout", "tunable", "name"),
    [c for c in EVERY if c not in FORWARD and (c[0] not in CHOOSES or c[2] != "forward")],
)
def test_no_more_instructions_than_what_is_typed(layout: str, tunable: bool, name: str) -> None:
    for most, own in zip(*map(counts, reversed(both(NAMES[layout], tunable, name))), strict=True):
        assert own <= most


@pytest.mark.parametrize("layout", [layout for layout, _, _ in FORWARD if layout not in CHOOSES])
def test_forward_with_everything_tunable_takes_no_more_either(layout: str) -> None:
    for most, own in zip(*map(counts, reversed(both(NAMES[layout], True, "forward"))), strict=True):
        assert own <= most


# ---- models of the gallery, as a specialist writes them by hand


def _tricycle(x: ca.SX, u: ca.SX) -> list[ca.SX]:
    v = 0.11 * u[0]
    ahead = v * ca.cos(x[3])
    return [ahead * ca.cos(x[2]), ahead * ca.sin(x[2]), v * ca.sin(x[3]) / 1.4, u[1]]


def _turned(x: ca.SX, vx: ca.SX, vy: ca.SX, omega: ca.SX) -> list[ca.SX]:
    c, s = ca.cos(x[2]), ca.sin(x[2])
    return [c * vx - s * vy, s * vx + c * vy, omega]


def _kiwi(x: ca.SX, u: ca.SX) -> list[ca.SX]:
    back = 0.05 / 3 * (u[0] + u[2] - 2 * u[1])
    return _turned(x, 0.05 / 3**0.5 * (u[2] - u[0]), back, 0.05 / (3 * 0.125) * (u[0] + u[1] + u[2]))


def _mecanum(x: ca.SX, u: ca.SX) -> list[ca.SX]:
    turn = 0.025 / (0.285 + 0.2104) * (u[1] - u[2])
    return _turned(x, 0.025 * (u[0] + u[1]), 0.025 * (u[2] - u[0]), turn)


def _swerve(x: ca.SX, u: ca.SX) -> list[ca.SX]:
    return [*_turned(x, u[0], u[1], u[2]), *ca.vertsplit(u[3:])]


def _train(x: ca.SX, u: ca.SX) -> list[ca.SX]:
    v, hitch = u[0], x[2] - x[4]
    return [
        v * ca.cos(x[2]), v * ca.sin(x[2]), v * ca.tan(x[3]) / 1.4, u[1],
        v * ca.sin(hitch) / 1.1, v * ca.cos(hitch) * ca.sin(x[4] - x[5]) / 0.9,
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("robot", "form", "typed"),
    [
        ("textbook_tricycle", None, _tricycle), ("lekiwi", None, _kiwi), ("clearpath_do100", None, _mecanum),
        ("wpilib_swervebot", None, _swerve), ("car_with_trailers", "trailer", _train),
    ],
)  # fmt: skip
def test_models_are_as_short_as_what_a_specialist_types(
    robot: str, form: str | None, typed: Callable[[ca.SX, ca.SX], list[ca.SX]]
) -> None:
    f = of_gallery(robot).state_space(form)
    x, u = ca.SX.sym("x", f.size1_in(0)), ca.SX.sym("u", f.size1_in(1))
    by_hand = ca.Function("by_hand", [x, u], [ca.vertcat(*typed(x, u))])
    ours = ca.Function("ours", [x, u], [f(x, u, [])])
    at = np.random.default_rng(1).uniform(-0.9, 0.9, 20)
    values = at[: x.numel()], at[x.numel() : x.numel() + u.numel()]
    assert ours(*values).full() == pytest.approx(by_hand(*values).full(), abs=1e-13)
    assert ours.n_instructions() <= by_hand.n_instructions()


def test_no_guard_of_geometry_is_in_a_model() -> None:
    """With tunable parameters: 35 instructions, of which 15 kept half_track off zero; and a sine of a sum stays one."""
    assert of_gallery("pioneer3dx").state_space().n_instructions() <= 20
    text = str(of_gallery("synchro_drive").state_space().str(True))
    assert text.count("sin(") == text.count("cos(") == 1
