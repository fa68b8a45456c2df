"""Which driven joints are the inputs of a model, what is missing where they do not suffice, and their twists."""

from __future__ import annotations

import pytest

from tests.functions.models.robots import DIFFERENTIAL, OMNI, TWO_STEER, UNICYCLE, derived
from wmrgen.functions.models.inputs import UnderactuatedError, _independent, best_motion, posture_motion

UNDRIVEN = DIFFERENTIAL.replace("r: r}", "r: r, actuated: []}")
ONE_DRIVEN = DIFFERENTIAL.replace("r: r}", "r: r, actuated: []}", 1)
CASTORS = "\n".join(
    f"{{name: k{n}, type: castor, x: {x}, y: {y}, heading: 0, d: 0.1, r: r, actuated: [{joints}]}}"
    for n, (x, y, joints) in enumerate(((0.3, 0, "spin"), (-0.3, 0.2, "steer"), (-0.3, -0.2, "")))
)
DIAGONAL = """{name: front, type: steered, x: %g, y: %g, heading: 0, r: r, actuated: [steer]}
{name: rear, type: steered, x: 0, y: 0, heading: 0, r: r}"""
WITH_CASTOR = "{name: c, type: castor, x: -0.3, y: 0, heading: 0, d: 0.1, r: r}"


@pytest.mark.parametrize(
    ("wheels", "words"),
    [
        (
            UNICYCLE,
            "the driven joints move 1 of 2 freedoms (wheel.spin). "
            "Missing actuation: 1 more driven wheel would be needed",
        ),
        (
            UNDRIVEN,
            "the driven joints move 0 of 2 freedoms (nothing). "
            "Missing actuation: actuate 2 more of right.spin, left.spin",
        ),
        (
            ONE_DRIVEN,
            "the driven joints move 1 of 2 freedoms (left.spin). Missing actuation: actuate 1 more of right.spin",
        ),
        (
            UNICYCLE.replace("r: r}", "r: r, actuated: []}") + "\n" + WITH_CASTOR,
            "the driven joints move 0 of 2 freedoms (nothing). "
            "Missing actuation: actuate 2 more of wheel.spin, c.spin, c.steer_rate",
        ),
        (
            CASTORS,
            "the driven joints move 2 of 3 freedoms (k0.spin, k1.steer_rate). "
            "Missing actuation: actuate 1 more of k1.spin, k2.spin, k0.steer_rate, k2.steer_rate",
        ),
        (
            "\n".join(UNICYCLE.replace("wheel", name) for name in ("one", "two")),
            "the driven joints move 1 of 2 freedoms (one.spin; two.spin adds nothing that is independent). "
            "Missing actuation: 1 more driven wheel would be needed",
        ),
    ],
)  # fmt: skip
def test_what_is_missing_is_named(wheels: str, words: str) -> None:
    d = derived(wheels)
    with pytest.raises(UnderactuatedError) as refusal:
        posture_motion(d.robot, d.mobility)
    assert refusal.value.what == words
    motion = best_motion(d.robot, d.mobility)
    assert motion.text == f"posture model in null-space coordinates: {words}"
    etas = [p.name for p in motion.inputs]
    assert etas == [f"eta{k + 1}" for k in range(d.mobility.degree_of_mobility)]


@pytest.mark.parametrize(
    ("wheels", "extra", "inputs", "follows"),
    [
        (DIFFERENTIAL, "", ["right.spin", "left.spin"], ""),
        (OMNI, "", ["w1.spin", "w2.spin", "w3.spin"], ""),
        (TWO_STEER, "", ["front.spin", "front.steer_rate", "rear.steer_rate"], "; rear.spin must follow"),
        *(
            (DIAGONAL % place, "", ["rear.spin", "front.steer_rate", "rear.steer_rate"], "")
            for place in (
                (-0.3, 0.4),
                (0.3, -0.4),
                (-0.5, 1.2),
                (-0.8, 1.5),
                (0.7, -2.4),
            )  # sides of triangles
        ),
        (OMNI, "couplings: [{equal: [w1.spin, w2.spin]}]", ["w1.spin", "w3.spin"], ""),
    ],
)
def test_the_inputs_are_independent_joints_and_steering_rates(
    wheels: str, extra: str, inputs: list[str], follows: str
) -> None:
    d = derived(wheels, extra)
    motion = posture_motion(d.robot, d.mobility)
    assert [p.name for p in motion.inputs] == inputs
    assert motion.text == f"posture model in {', '.join(inputs)}{follows}"
    assert len(motion.twists) == len(inputs) == len(motion.etas)


def test_rows_are_independent_whatever_their_sizes() -> None:
    assert _independent([[1e-6, 0.0, 1e-6], [3e5, 2e5, 3e5]])
    assert not _independent([[1e-6, 2e-6, 0.0], [3e5, 6e5, 0.0]])
    assert not _independent([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), "a joint that stands still drives nothing"
