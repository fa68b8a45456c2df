"""Random robots of extreme values: derived, or refused in words. `make fuzz` looks further."""

from __future__ import annotations

import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import wmrgen
from tests.depth import examples
from tests.hostile.fuzz import derive
from tests.robotfile.files import HEAD, read, robot, wheel
from wmrgen.errors import RobotFileError

LENGTHS = st.sampled_from(
    "0 -0.0 1 -1 0.1 1/3 1e-30 1e30 -1e30 sqrt(2) p p/q (p-q)**4 1/(p-p) pi sin(p) 10mm 0.3333333333333333".split()
)
ANGLES = st.sampled_from(
    "0 -0.0 pi/2 -pi pi/4 1.5707 1e30 p 'atan2(p,q)' 'atan2(0,p-p)' 45deg 0.7 100*pi p*pi".split()
)
SIZES = st.sampled_from("0.1 0.1 p 1e-30 1e30 sqrt(2) 1/3 10mm p/q 0".split())
JOINTS = st.sampled_from(
    ["", ", actuated: []", ", actuated: [spin]", ", actuated: [spin, steer]", ", sensed: []"]
)
LIMITS = st.sampled_from(["", ", limits: {spin: 1e-30}", ", limits: {spin: 40}"])
MORE = {"swedish": ("gamma", "r_sw"), "castor": ("d", "offset_y"), "steered": ("offset_y",)}
TOP = (
    "", "snap: false\n", "limits: {vx: 1, omega: 1e30}\n", "couplings: [{equal: [w0.spin, w1.spin]}]\n",
    "couplings: [{equal: [w0.steer, w1.steer]}]\n", "trailers: [{name: t, length: p, hitch: q}]\n",
    "cg: {x: 0, y: p, z: 1}\n", "functions: [posture, motion]\n",
)  # fmt: skip


@st.composite
def robots(draw: st.DrawFn) -> str:
    """The text of a robot file: its form is right, its values are what they are."""
    tunable = draw(st.sampled_from(["0.5", "{value: 0.5, tunable: true}", "{value: 1e-30, tunable: true}"]))
    text = f"{HEAD}parameters: {{p: {tunable}, q: {draw(st.sampled_from(['0.25', '0.5', '-1e30']))}}}\n"
    text += "".join(draw(st.lists(st.sampled_from(TOP), max_size=2, unique_by=lambda t: t[:5]))) + "wheels:\n"
    for number in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(["fixed", "steered", "castor", "swedish", "spherical"]))
        place = draw(st.sampled_from([("x", "y"), ("l", "alpha")]))
        values = {key: draw(ANGLES if key == "alpha" else LENGTHS) for key in place}
        if kind != "spherical":
            values |= {draw(st.sampled_from(["heading", "beta"])): draw(ANGLES), "r": draw(SIZES)}
        for key in MORE.get(kind, ()):
            if key == "d" or draw(st.booleans()):
                values[key] = draw(ANGLES if key == "gamma" else SIZES)
        inside = ", ".join(f"{key}: {value}" for key, value in values.items())
        text += f"  - {{name: w{number}, type: {kind}, {inside}{draw(JOINTS)}{draw(LIMITS)}}}\n"
    return text


@settings(
    max_examples=examples(120, share=15),  # each is a process
    suppress_health_check=list(HealthCheck),
    derandomize=True,
    database=None,
)
@given(robots())
def test_random_robots(text: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # what numpy warns of would be on a user's stderr
        derive(text.encode())


def test_a_slip_that_needs_less_of_prepare_than_inverse_does() -> None:
    """The passive spin is left out of the C, and with it the values of `prepare` that it alone needs."""
    top = "parameters: {p: {value: 0.5, tunable: true}}\n"
    derive(robot(wheel("a", "fixed", heading="p*pi", actuated="[]"), top=top).encode())


def test_a_lone_wheel_whose_joint_does_not_tell_the_twist() -> None:
    """Its report solved for it, by a determinant of 0, in a recursion without end."""
    derive(
        robot("name: a, type: swedish, x: 0, y: p, heading: 0, r: 0.1", top="parameters: {p: 0.5}\n").encode()
    )


def test_a_lever_of_an_astronomic_length() -> None:
    """What the speeds of its wheels have in common was asked of rows of 1 and of 1e30."""
    derive(robot(wheel("a", "fixed", x="0", y="0"), wheel("b", "fixed", x="0", y="1e30")).encode())


def test_a_parameter_of_which_no_code_depends() -> None:
    """A passive castor has no joint in the C: its length is in the formulas alone. It was a crash."""
    top = "parameters: {p: {value: 0.5, tunable: true}}\n"
    derive(robot(wheel("a", "castor", d="p"), top=top).encode())


def test_a_parameter_on_which_nothing_depends() -> None:
    """It has its place in the vector of parameters. It was a crash."""
    derive(robot(wheel("a"), top="parameters: {p: {value: 0.5, tunable: true}}\n").encode())


def test_what_cannot_be_told_from_zero() -> None:
    """The sine of so small an angle is a rational with few digits. It was a crash."""
    inside = wheel("a", x="1e-30", y="sin(p)", heading="", beta="0")
    with pytest.raises(RobotFileError, match="too small to be distinguished from zero"):
        wmrgen.robot_of(read(robot(inside, top="parameters: {p: {value: 1e-30, tunable: true}}\n")))


@pytest.mark.parametrize("length", ["'atan2(1, 2)'", "tan(0.3)*sqrt(2)"])
def test_a_length_that_is_an_angle(length: str) -> None:
    """The report wrote the arctangent of a number in a recursion without end."""
    derive(robot(wheel("a", y=length)).encode())
