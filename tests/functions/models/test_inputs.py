"""Which driven joints are the inputs of a model, what is missing where they do not suffice, and their twists."""

from __future__ import annotations

import pytest

from tests.functions.models.robots import DIFFERENTIAL, OMNI, TWO_STEER, UNICYCLE, derived
from tests.functions.refusals import missing_names
from wmrgen.functions.models.inputs import UnderactuatedError, best_motion, posture_motion

Joints = tuple[str, ...]
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
    ("wheels", "missing"),
    [
        (
            UNICYCLE,
            (2, ("wheel.spin",), (), ()),
        ),
        (
            UNDRIVEN,
            (2, (), (), ("right.spin", "left.spin")),
        ),
        (
            ONE_DRIVEN,
            (2, ("left.spin",), (), ("right.spin",)),
        ),
        (
            UNICYCLE.replace("r: r}", "r: r, actuated: []}") + "\n" + WITH_CASTOR,
            (2, (), (), ("wheel.spin", "c.spin", "c.steer_rate")),
        ),
        (
            CASTORS,
            (3, ("k0.spin", "k1.steer_rate"), (), ("k1.spin", "k2.spin", "k0.steer_rate", "k2.steer_rate")),
        ),
        (
            "\n".join(UNICYCLE.replace("wheel", name) for name in ("one", "two")),
            (2, ("one.spin",), ("two.spin",), ()),
        ),
    ],
)  # fmt: skip
def test_what_is_missing_is_named(wheels: str, missing: tuple[int, Joints, Joints, Joints]) -> None:
    d = derived(wheels)
    with pytest.raises(UnderactuatedError) as refusal:
        posture_motion(d.robot, d.mobility)
    error, (freedoms, *joints) = refusal.value, missing
    assert [error.driven, error.dependent, error.free] == joints and d.mobility.degree_of_mobility == freedoms
    named = (f"{len(error.driven)} of {freedoms}", *(name for names in joints for name in names))
    assert missing_names(error, named) == []
    motion = best_motion(d.robot, d.mobility)
    assert error.what in motion.text
    etas = [p.name for p in motion.inputs]
    assert etas == [f"eta{k + 1}" for k in range(d.mobility.degree_of_mobility)]


@pytest.mark.parametrize(
    ("wheels", "extra", "inputs", "follows"),
    [
        (DIFFERENTIAL, "", ["right.spin", "left.spin"], ()),
        (OMNI, "", ["w1.spin", "w2.spin", "w3.spin"], ()),
        (TWO_STEER, "", ["front.spin", "front.steer_rate", "rear.steer_rate"], ("rear.spin",)),
        *(
            (DIAGONAL % place, "", ["rear.spin", "front.steer_rate", "rear.steer_rate"], ())
            for place in (
                (-0.3, 0.4),
                (0.3, -0.4),
                (-0.5, 1.2),
                (-0.8, 1.5),
                (0.7, -2.4),
            )  # sides of triangles
        ),
        (OMNI, "couplings: [{equal: [w1.spin, w2.spin]}]", ["w1.spin", "w3.spin"], ()),
    ],
)
def test_the_inputs_are_independent_joints_and_steering_rates(
    wheels: str, extra: str, inputs: list[str], follows: tuple[str, ...]
) -> None:
    d = derived(wheels, extra)
    motion = posture_motion(d.robot, d.mobility)
    assert [p.name for p in motion.inputs] == inputs
    assert motion.followers == follows and all(name in motion.text for name in (*inputs, *follows))
    assert len(motion.twists) == len(inputs) == len(motion.etas)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_joints_are_independent_whatever_the_size_of_the_robot(size: float) -> None:
    """Two wheels on one axle drive both freedoms, two wheels behind each other only one."""
    wheel = "{{name: {}, type: fixed, x: {!r}, y: {!r}, heading: 0, r: {!r}}}"
    side = [wheel.format(n, 0.0, y * size, 0.1 * size) for n, y in (("u", 0.3), ("v", -0.3))]
    d = derived("\n".join(side))
    assert [p.name for p in posture_motion(d.robot, d.mobility).inputs] == ["u.spin", "v.spin"]
    d = derived("\n".join(wheel.format(n, 0.0, 0.3 * size, 0.1 * size) for n in "uv"))
    with pytest.raises(UnderactuatedError) as refusal:
        posture_motion(d.robot, d.mobility)
    assert (refusal.value.driven, refusal.value.dependent) == (("u.spin",), ("v.spin",))


def test_a_joint_that_stands_still_drives_nothing() -> None:
    """The locked bicycle drives along its wheels; an omni wheel at a right angle to them does not turn."""
    wheels = (
        "{name: w, type: swedish, x: 2, y: 0, heading: pi/2, r: 0.1, gamma: 0}",
        "{name: u, type: fixed, x: 0, y: 0, heading: 0, r: 0.1, actuated: []}",
        "{name: v, type: fixed, x: 1, y: 0, heading: 0, r: 0.1, actuated: []}",
    )
    d = derived("\n".join(wheels))
    with pytest.raises(UnderactuatedError) as refusal:
        posture_motion(d.robot, d.mobility)
    assert (refusal.value.driven, refusal.value.dependent) == ((), ("w.spin",))
