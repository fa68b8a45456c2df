"""Mechanical couplings: how the left null space of the joint-rate columns reduces the robot's mobility."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from tests.laws.common import derived, law
from tests.laws.layouts import lengths, offsets, radii
from tests.laws.test_constraints import check_null_space, check_ranks
from tests.oracle import oracle
from tests.oracle.freedom import freedom
from tests.oracle.harness import named, twist_of
from tests.robots import of_text
from wmrgen.errors import NotDerivableError
from wmrgen.ir.interpret import EXACT, evaluate_module

Layout = dict[str, Any]


def wheel(name: str, kind: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "type": kind, "x": x, "y": y, "heading": 0.0, "r": 0.1} | more


AXLE = [wheel("a", "fixed", 0.0, 0.2), wheel("b", "fixed", 0.0, -0.2)]
STEERED = [
    wheel("a", "steered", 0.3, 0.0),
    wheel("b", "steered", -0.2, 0.25),
    wheel("c", "steered", -0.2, -0.25),
]
CASTORS = [
    wheel("a", "castor", 0.3, 0.2, d=-0.04, actuated=["spin", "steer"]),
    wheel("b", "castor", 0.3, -0.2, d=-0.04, actuated=["spin", "steer"]),
    wheel("c", "castor", -0.3, 0.0, d=-0.04),
]
# (mobility, steerability, dof): worked out by hand
KNOWN = {
    "differential drive": (AXLE, [], (2, 0, 3)),
    "locked axle: no turning": (AXLE, [("spin", ["a", "b"])], (1, 0, 1)),
    "three free steered wheels": (STEERED, [], (1, 2, 3)),
    "synchro drive": (STEERED, [("steer", ["a", "b", "c"]), ("spin", ["a", "b", "c"])], (1, 1, 2)),
    "belt for steering only": (STEERED, [("steer", ["a", "b", "c"])], (1, 1, 2)),
    "free castors": (CASTORS, [], (3, 0, 3)),
}


@pytest.mark.parametrize("case", KNOWN)
def test_known(case: str) -> None:
    wheels, couplings, (mobility, steerability, dof) = KNOWN[case]
    layout = {"wheels": wheels, "couplings": couplings}
    model = derived(layout)
    m = model.derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability, m.dof) == (mobility, steerability, dof)
    check_ranks(model, layout)
    check_null_space(model, layout)


def test_two_castors_on_one_steering_motor() -> None:
    """One relation between twist and the common steering rate is left over: it constrains the twist."""
    layout = {"wheels": CASTORS, "couplings": [("steer", ["a", "b"])]}
    assert (
        derived(layout).derivation.mobility.degree_of_mobility
        == oracle.mobility(layout)["degree_of_mobility"]
        == 2
    )


def test_castors_on_one_steering_motor_count_once() -> None:
    free, belt = (derived({"wheels": CASTORS, "couplings": c}) for c in ([], [("steer", ["a", "b"])]))
    assert str(free.derivation.mobility.actuation[0]).startswith(
        "driving: 4 actuated joints for 3 degrees of freedom"
    )
    assert str(belt.derivation.mobility.actuation[0]).startswith(
        "driving: 3 actuated joints for 2 degrees of freedom"
    )


@law(15)
@given(st.lists(st.tuples(lengths, radii), min_size=2, max_size=4, unique=True), lengths)
def test_fixed_wheels_that_turn_alike(wheels: list[tuple[float, float]], x: float) -> None:
    """Equal spins on one axle line leave a circle about one centre, a straight line, or nothing."""
    fixed = [wheel(f"w{i}", "fixed", x, y, r=r) for i, (y, r) in enumerate(wheels)]
    layout = {"wheels": fixed, "couplings": [("spin", [w["name"] for w in fixed])]}
    model = derived(layout)
    check_ranks(model, layout)
    null = oracle.null(oracle.constraint(layout, {}))
    for twist in null.T:
        joints = model.call("inverse", named(twist))
        assert joints["slip"] == pytest.approx(0.0, abs=1e-9)
        assert len({round(joints[f"{w['name']}.spin"], 9) for w in fixed}) == 1
        spins = {k: v for k, v in joints.items() if k.endswith(".spin")}
        back = model.call("forward", spins)
        assert back["slip"] == pytest.approx(0.0, abs=1e-8)
        if oracle.forward(layout, spins)[2] == 3:
            np.testing.assert_allclose(twist_of(back), twist, atol=1e-6)


@law(15)
@given(st.lists(st.tuples(lengths, lengths), min_size=2, max_size=5, unique=True), radii, offsets)
def test_belt_driven_wheels_only_translate(places: list[tuple[float, float]], r: float, vy: float) -> None:
    """Any belt-steered, belt-driven robot of three wheels or more: type (1, 1), and it keeps its heading."""
    wheels = [wheel(f"w{i}", "steered", x, y, r=r) for i, (x, y) in enumerate(places)]
    names = [w["name"] for w in wheels]
    layout = {"wheels": wheels, "couplings": [("steer", names), ("spin", names)]}
    model = derived(layout)
    found = model.call("inverse", named([0.5, vy, 0.0]))
    speed = np.hypot(0.5, vy)
    assert [found[f"{n}.spin"] for n in names] == pytest.approx([speed / r] * len(names))
    assert [found[f"{n}.steer"] for n in names] == pytest.approx([np.arctan2(vy, 0.5)] * len(names))
    back = model.call("forward", {k: v for k, v in found.items() if k != "slip"})
    np.testing.assert_allclose(twist_of(back), [0.5, vy, 0.0], atol=1e-9)
    m = model.derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability, m.dof) == (1, 1, 2)


CHAINED = [wheel("rear", "fixed", 0.0, 0.0), wheel("front", "steered", 0.6, 0.0)]
TRICYCLE = [*AXLE, wheel("front", "steered", 0.5, 0.0)]
PI = {"heading": np.pi, "text": {"heading": "pi"}}
THIRD = {"heading": np.pi / 3, "text": {"heading": "pi/3"}}
MIRRORED = [
    wheel("a", "steered", 0.3, 0.2),
    wheel("b", "steered", -0.3, 0.2) | PI,
]
LOCKED = [*AXLE, wheel("c", "fixed", 0.5, 0.0, heading=0.5), wheel("d", "steered", 0.4, 0.4)]
TWO = [
    wheel("a", "fixed", 0.0, 0.3), wheel("b", "steered", 0.0, 0.1),
    wheel("c", "fixed", 0.0, -0.3), wheel("d", "steered", 0.0, -0.3),
]  # fmt: skip
TWO_CHAINS = [("steer", ["b", "d"]), ("spin", ["a", "b"]), ("spin", ["c", "d"])]
GEARED = {
    "bicycle on one chain": (CHAINED, [("spin", ["rear", "front"])], (1, 0, 1)),
    "tricycle, all wheels geared": (TRICYCLE, [("spin", ["a", "b", "front"])], (1, 0, 1)),
    "one belt and one chain, a wheel the other way round": (
        MIRRORED, [("steer", ["a", "b"]), ("spin", ["a", "b"])], (1, 0, 1)),
    "locked by its fixed wheels": (LOCKED, [("spin", ["a", "b", "d"])], (0, 0, 0)),
    "locked, and two steered wheels on a belt": (
        [*LOCKED, wheel("e", "steered", -0.4, 0.4)], [("steer", ["d", "e"])], (0, 0, 0)),
    # One belt turns b and d, each on a chain. Straight ahead one would roll against its chain; about (0, 0.2) neither.
    "two chains and a belt": (
        [TWO[0], TWO[1], TWO[2] | PI, TWO[3]], TWO_CHAINS, (1, 0, 1)),
    "two chains and a belt, the other way round": (
        [TWO[2], TWO[0] | PI, TWO[1], TWO[3]], TWO_CHAINS, (1, 0, 1)),
    # r cos gamma of the swedish wheel is the radius of the steered one: at one speed both roll along pi/3.
    "a swedish and a steered wheel on one pivot": (
        [wheel("a", "swedish", 0.0, 0.0, r=0.2, gamma=np.pi / 3), wheel("b", "steered", 0.0, 0.0),
         wheel("c", "fixed", 0.0, 0.0) | THIRD], [("spin", ["a", "b"])], (2, 0, 3)),
}  # fmt: skip


@pytest.mark.parametrize("case", GEARED)
def test_geared(case: str) -> None:
    wheels, couplings, wanted = GEARED[case]
    layout = {"wheels": wheels, "couplings": couplings}
    model = derived(layout)
    m = model.derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability, m.dof) == wanted
    seen = freedom(layout)
    assert (seen.mobility, seen.steerability, seen.dof) == wanted
    assert m.degree_of_mobility == len(m.null_space) == model.derivation.null_space.cols
    assert {n for n in model.ports("dynamics")[0] if n.startswith("eta")} == {
        f"eta{k + 1}" for k in range(m.degree_of_mobility)
    }


def test_wheels_that_would_roll_against_their_chain() -> None:
    wheels, couplings, _ = GEARED["two chains and a belt"]
    vx, vy, omega = derived({"wheels": wheels, "couplings": couplings}).derivation.mobility.admissible.sample
    assert (vx / omega, vy) == pytest.approx((0.2, 0.0))


@pytest.mark.parametrize("order", ["abgcf", "gfcab", "gbacf"])
def test_chains_and_belts_in_any_order(order: str) -> None:
    """g goes ahead, f backwards; a belt turns a and c, chains tie a to b and c to f: all but g turn about."""
    wheels = {
        "a": wheel("a", "steered", 0.3, 0.1), "b": wheel("b", "steered", -0.4, 0.2),
        "c": wheel("c", "steered", 0.2, -0.3), "f": wheel("f", "fixed", 0.0, 0.2) | PI,
        "g": wheel("g", "fixed", 0.0, -0.5),
    }  # fmt: skip
    couplings = [("steer", ["a", "c"]), ("spin", ["a", "b"]), ("spin", ["c", "f"])]
    sets = [(joint, sorted(names, key=order.index)) for joint, names in couplings]
    m = derived({"wheels": [wheels[n] for n in order], "couplings": sets}).derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability, m.dof) == (1, 0, 1)


def test_a_row_of_equal_spins_turns_with_its_steered_wheel() -> None:
    """Two steered wheels on one pivot give one sliding row; the chain to one of them gives the second row."""
    wheels = [
        wheel("a", "swedish", -0.3, 0.1),
        wheel("b", "steered", 0.3, 0.0),
        wheel("c", "steered", 0.3, 0.0),
    ]
    m = derived({"wheels": wheels, "couplings": [("spin", ["a", "c"])]}).derivation.mobility
    angles = {g.name for row in m.basis_rows for p in row for g in p.generators}
    assert m.degree_of_mobility == 1
    assert angles == set(m.basis_wheels) == {"b", "c"}


@pytest.mark.parametrize("case", ["bicycle on one chain", "tricycle, all wheels geared"])
def test_a_chain_tells_what_slides(case: str) -> None:
    """Straight ahead nothing slides; in a bend wheels at one speed cannot all roll."""
    wheels, couplings, _ = GEARED[case]
    model = derived({"wheels": wheels, "couplings": couplings})
    assert model.call("inverse", {"vx": 0.7})["slip"] == pytest.approx(0.0, abs=1e-12)
    assert model.call("inverse", {"vx": 0.7, "omega": 0.9})["slip"] > 0.01


def test_a_chained_wheel_turns_about_rather_than_backwards() -> None:
    """At 100 degrees the nearer heading would roll against the chain."""
    model = derived({"wheels": CHAINED, "couplings": [("spin", ["rear", "front"])]})
    found = model.call("inverse", {"vx": 1.0, "front.steer": 1.75})
    assert found["front.steer"] == pytest.approx(0.0, abs=1e-12)
    assert found["front.spin"] == found["rear.spin"] == pytest.approx(10.0)
    assert found["slip"] == pytest.approx(0.0, abs=1e-12)


MIXED = [
    wheel("s", "steered", 0.4, 0.0),
    wheel("t", "castor", -0.4, 0.0, d=-0.05),
    wheel("f", "fixed", 0.0, 0.2),
]
OFFSET = [wheel("s", "steered", 0.4, 0.0, o=0.03), wheel("f", "fixed", 0.0, 0.2)]


@pytest.mark.parametrize(
    ("wheels", "coupling", "named"),
    [
        (MIXED, ("steer", ["t", "s"]), {"t.steer", "s.steer", "castor"}),
        (MIXED, ("spin", ["s", "t"]), {"t.spin", "s.spin", "castor"}),
        (OFFSET, ("spin", ["f", "s"]), {"s.spin", "offset_y"}),
    ],
)
def test_couplings_without_a_model_are_refused(wheels: Any, coupling: Any, named: set[str]) -> None:
    with pytest.raises(NotDerivableError) as caught:
        derived({"wheels": wheels, "couplings": [coupling]})
    assert caught.value.code == "WMR113" and named <= {*re.findall(r"[\w.]*\w", caught.value.what)}
    assert caught.value.mark is not None and "equal: [" in caught.value.mark.text


@pytest.mark.parametrize("joint", ["steer", "spin"])
def test_dynamics_of_coupled_castors(joint: str) -> None:
    """Their angles are states that the motion turns; CasADi, NumPy and exact arithmetic agree."""
    model = derived({"wheels": [*CASTORS, wheel("f", "fixed", 0.0, 0.0)], "couplings": [(joint, ["a", "b"])]})
    case = {n: 0.1 * (k + 1) for k, n in enumerate(model.ports("dynamics")[0])}
    exact = evaluate_module(model.derivation.raw_module, "dynamics", case, EXACT)
    found = model.call("dynamics", case)
    assert found == pytest.approx({k: float(v) for k, v in exact.items()}, rel=1e-12, abs=1e-12)


def test_axles_of_coupled_castors_are_refused() -> None:
    layout = {
        "wheels": [
            wheel("f", "fixed", 0.25, -0.8, heading=1.57),
            wheel("g", "fixed", 0.3, 0.3),
            wheel("a", "castor", 0.7, -0.4, d=0.04),
            wheel("b", "castor", 0.2, 0.4, d=0.02),
        ],
        "couplings": [("steer", ["a", "b"])],
    }
    with pytest.raises(NotDerivableError) as caught:
        derived(layout).derivation.formula("axles")
    assert caught.value.code == "WMR113" and "castors" in caught.value.what


def test_the_centroid_of_belt_steered_wheels_keeps_its_velocity() -> None:
    """Rotation is taken away about the wheels' centroid, here (0.4, 0.5): v + omega z x c, by hand."""
    shifted: list[Any] = [w | {"x": w["x"] + 13 / 30, "y": w["y"] + 0.5} for w in STEERED]
    texts = [{"x": f"{w['x']} + 13/30", "y": f"{w['y']} + 1/2"} for w in STEERED]
    wheels = [w | {"text": t} for w, t in zip(shifted, texts, strict=True)]
    model = derived({"wheels": wheels, "couplings": [("steer", ["a", "b", "c"])]})
    found = model.call("inverse", named([0.3, -0.2, 0.7]))
    v = complex(0.3 - 0.7 * 0.5, -0.2 + 0.7 * 0.4)
    for n in "abc":
        along = (
            found[f"{n}.spin"] * 0.1 * complex(math.cos(found[f"{n}.steer"]), math.sin(found[f"{n}.steer"]))
        )
        assert abs(along - v) < 1e-12
    places = [complex(w["x"] - 0.4, w["y"] - 0.5) for w in shifted]
    assert found["slip"] == pytest.approx(0.7 * math.sqrt(sum(abs(p) ** 2 for p in places)))


@pytest.mark.parametrize("heading", [0.7, -0.7])
def test_of_motions_of_equal_freedom_the_straightest_is_taken(heading: float) -> None:
    """A fixed wheel and two that a belt steers, not parallel: two turns are left, and the wider one is driven."""
    wheels = [
        wheel("f", "fixed", 0.0, 0.2),
        wheel("a", "steered", 0.5, 0.3, heading=heading),
        wheel("b", "steered", -0.5, -0.3),
    ]
    m = derived({"wheels": wheels, "couplings": [("steer", ["a", "b"])]}).derivation.mobility
    vx, _, omega = m.admissible.sample
    assert m.degree_of_mobility == 1 and vx > abs(omega) > 0


def test_castors_of_one_motor_have_one_angle_in_the_null_space() -> None:
    """Two castors beside a fixed wheel leave motion straight ahead; by themselves they leave what their angle says."""
    castor = "{{name: {0}, type: castor, x: {1}, y: {2}, heading: 0, d: {3}, r: 0.05}}"
    a, b = castor.format("a", 0.2, 0.2, -0.03), castor.format("b", -0.2, -0.1, -0.04)
    fixed = ", {name: f, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}"
    text = "wmrgen: 1\nname: sample\ncouplings: [{equal: [a.steer, b.steer]}]\nwheels: "
    d = of_text(f"{text}[{a}, {castor.format('b', -0.2, 0.2, -0.03)}{fixed}]\n")
    assert d.null_space == sympy.Matrix([1, 0, 0])
    assert "no_sliding_constraint" not in [reason.key for reason in d.mobility.explanation]
    pair = of_text(f"{text}[{a}, {b}]\n").null_space
    psi = 0.7
    c, s = math.cos(psi), math.sin(psi)
    # Either sliding row over its own d, whose difference has no swivel rate.
    row = np.array([-s, c, 0.2 * c + 0.2 * s]) / -0.03 - np.array([-s, c, -0.2 * c - 0.1 * s]) / -0.04
    values = dict.fromkeys(pair.free_symbols, psi)
    assert {symbol.name for symbol in values} == {"a_steer"}
    assert row @ np.array(pair.subs(values), dtype=float) == pytest.approx([0, 0], abs=1e-12)
