"""Wheels, joints, limits and couplings."""

from __future__ import annotations

import pytest

from tests.robotfile.files import KEYS, one_wheel, read, robot, show, wheel
from wmrgen.errors import RobotFileError


@pytest.mark.parametrize("type_name", KEYS)
def test_every_type_is_read(type_name: str) -> None:
    assert one_wheel(wheel("a", type_name)).type == type_name


@pytest.mark.parametrize("type_name", KEYS)
def test_both_placements_and_orientations(type_name: str) -> None:
    polar = one_wheel(wheel("a", type_name, x="", y="", heading="", extra="l: 0.2, alpha: pi/2, beta: 0"))
    assert (show(polar.l.expr), show(polar.alpha.expr), show(polar.beta.expr)) == ("1/5", "(pi / 2)", "0")
    assert (polar.x, polar.y, polar.heading) == (None, None, None)


@pytest.mark.parametrize("letters", ["αβγ", "𝛼𝛽𝛾", "𝜶ϐ𝝲"])
def test_greek_keys_are_the_latin_ones(letters: str) -> None:
    a, b, g = letters
    greek = one_wheel(
        wheel("a", "swedish", x="", y="", heading="", extra=f"l: 1, {a}: 0, {b}: 0, {g}: 45 deg")
    )
    assert show(greek.gamma.expr) == "(1/4 * pi)"
    assert (show(greek.alpha.expr), show(greek.beta.expr)) == ("0", "0")


def test_marks_point_at_values() -> None:
    text = robot(wheel("a"))
    radius = read(text).wheels[0].r
    line = text.split("\n")[3]
    assert radius.mark.column == line.index("0.05") + 1
    assert radius.mark.text == line
    assert (radius.mark.file, radius.mark.line) == ("bot.yaml", 4)


@pytest.mark.parametrize(
    ("type_name", "actuated"),
    [
        ("fixed", ("spin",)),
        ("steered", ("spin", "steer")),
        ("castor", ()),
        ("swedish", ("spin",)),
        ("spherical", ()),
    ],
)
def test_defaults_of_actuated_and_sensed(type_name: str, actuated: tuple[str, ...]) -> None:
    found = one_wheel(wheel("a", type_name))
    assert (found.actuated, found.sensed) == (actuated, actuated)


def test_sensed_follows_actuated_unless_written() -> None:
    found = one_wheel(wheel("a", "steered", actuated="[steer]"))
    assert (found.actuated, found.sensed) == (("steer",), ("steer",))
    found = one_wheel(wheel("a", "castor", sensed="[steer, spin]"))
    assert (found.actuated, found.sensed) == ((), ("spin", "steer"))
    assert one_wheel(wheel("a", actuated="[]")).sensed == ()


def test_a_castor_and_a_ball_need_no_orientation_and_a_ball_no_radius() -> None:
    assert one_wheel(wheel("a", "castor")).heading is None
    assert one_wheel(wheel("a", "spherical")).r is None


@pytest.mark.parametrize(
    ("inside", "message", "hint"),
    [
        (wheel("a", extra="l: 1, alpha: 0"), "placed twice", "Keep l and alpha, or x and y"),
        (wheel("a", extra="l: 1"), "placed twice", "Keep"),
        (wheel("a", x="", y=""), "no place", "l: and alpha"),
        (wheel("a", y=""), "has no y", "left of the origin"),
        (wheel("a", x="", y="", extra="l: 1"), "has no alpha", "direction"),
        (wheel("a", heading=""), "no beta or heading", "heading: 0"),
        (wheel("a", "steered", heading=""), "no beta or heading", "heading: 0"),
        (wheel("a", beta="0"), "beta and heading", "Keep one"),
        (wheel("a", r=""), "has no r", "r: 50 mm"),
        (wheel("a", "castor", d=""), "has no d", "type: steered"),
        (wheel("", x="0"), "has no name", "front_left"),
        ("x: 0, y: 0", "has no name", "front_left"),
        ("name: a, x: 0, y: 0", "has no type", "swedish"),
        (wheel("a", type="mecanum"), "unknown wheel type 'mecanum'", "swedish"),
        (wheel("a", type="omni"), "unknown wheel type", "gamma: 0"),
        (wheel("a", type="caster"), "unknown wheel type", "castor"),
        (wheel("a", type="fixd"), "unknown wheel type", "fixed"),
        (wheel("a", type="Steered"), "unknown wheel type", "steered"),
        (wheel("a", type="xyzzy"), "unknown wheel type", "spherical"),
        (wheel("a", gamma="0"), "has the key gamma", "type: swedish"),
        (wheel("a", d="0.1"), "has the key d", "x, y"),
        (wheel("a", "steered", d="0.1"), "has the key d", "type: castor"),
        (wheel("a", "swedish", offset_y="0.1"), "has the key offset_y", "x, y"),
        (wheel("a", "castor", r_sw="0.1"), "has the key r_sw", "swedish"),
        (wheel("a", radius="0.1"), "unknown key 'radius'", "r?"),
        (wheel("a", diameter="0.1"), "unknown key 'diameter'", "half the diameter"),
        (wheel("a", gama="0.1"), "unknown key 'gama'", "gamma"),
        (wheel("a", trail="0.1"), "unknown key 'trail'", "d?"),
        (wheel("a", extra="x:1"), "no space after the colon", "x: 1"),
        (wheel("a", x="atan2(1, 2)"), "stands where a key", "in quotes"),
        (wheel("a", x="1,5"), "stands where a key", "decimal point"),
        (wheel("a", extra="<<: {x: 1}"), "merges", "Write the keys out"),
        (wheel("a", extra="α: 0, alpha: 0"), "the same key", "Delete"),
        (wheel("a", extra="x: 1"), "duplicate key 'x'", "Delete"),
        (wheel("a", actuated="[steer]"), "no joint 'steer'", "spin"),
        (wheel("a", actuated="spin"), "must be a list", "[spin]"),
        (wheel("a", actuated="[spin, spin]"), "stands twice", "Delete"),
        (wheel("a", "spherical", sensed="[spin]"), "no joint 'spin'", "sensed: []"),
        (wheel("a", limits="{steer: 1}"), "unknown key 'steer'", "spin"),
        (wheel("a", limits="{spin: [1]}"), "has 1 value", "[low, high]"),
        (wheel("a", limits="{spin: 1 m/s}"), "angular rate", "rpm"),
        (wheel("a", limits="{vx_rate: 1}"), "unknown key 'vx_rate'", "spin"),
        (wheel("a", limits="3"), "must be a mapping", "omega"),
        ("- a", "must be a mapping", "name: left"),
    ],
)
def test_refused_wheels(inside: str, message: str, hint: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        read(robot(inside) if not inside.startswith("-") else robot().split("  -")[0] + "  - a\n")
    assert message in str(caught.value)
    assert hint in str(caught.value)
    assert caught.value.mark is not None
    assert caught.value.mark.line == 4


def test_wheel_names_are_distinct() -> None:
    with pytest.raises(RobotFileError, match="'a' is the name of a wheel already") as caught:
        read(robot(wheel("a"), wheel("b"), wheel("a")))
    assert caught.value.mark.line == 6
    assert "line 4" in str(caught.value)


def test_64_wheels_are_read_and_65_are_not() -> None:
    many = [wheel(f"w{i}") for i in range(65)]
    assert len(read(robot(*many[:64])).wheels) == 64
    with pytest.raises(RobotFileError, match="65 wheels") as caught:
        read(robot(*many))
    assert caught.value.mark.line == 4 + 64


def test_limits_of_acceleration_have_units_of_their_own() -> None:
    limits = "{vx_rate: [-3 m/s^2, 2 m/s2], vy_rate: 1.5 m/s², omega_rate: 90 deg/s^2}"
    spec = read(robot(top=f"limits: {limits}\n"))
    assert [(x.name, show(x.low.expr), show(x.high.expr)) for x in spec.limits] == [
        ("vx_rate", "-3", "2"),
        ("vy_rate", "-3/2", "3/2"),
        ("omega_rate", "-(1/2 * pi)", "(1/2 * pi)"),
    ]
    for wrong, message in (
        ("vx_rate: 1 m/s", "limit vx_rate is an acceleration, and '1 m/s' is a speed"),
        (
            "omega_rate: 1 m/s^2",
            "limit omega_rate is an angular acceleration, and '1 m/s^2' is an acceleration",
        ),
        ("vx: 1 m/s^2", "limit vx is a speed, and '1 m/s^2' is an acceleration"),
        ("vx: 1 m^2", "the unit 'm' stands after an expression"),
    ):
        with pytest.raises(RobotFileError) as caught:
            read(robot(top=f"limits: {{{wrong}}}\n"))
        assert message in str(caught.value)


@pytest.mark.parametrize(
    ("key", "hint"),
    [
        ("v", "Write vx: for the speed forward"),
        ("w", "Did you mean omega?"),
        ("a", "Valid here: vx vy omega"),
    ],
)
def test_a_limit_of_another_name(key: str, hint: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        read(robot(top=f"limits: {{{key}: 1}}\n"))
    assert hint in str(caught.value)


def test_a_negated_limit_reads_as_people_write_it() -> None:
    values = {
        "-1.2": "1.2",
        "1.2": "-1.2",
        "30 deg": "-30 deg",
        "a": "-a",
        "a + 1": "-(a + 1)",
        "-a - 1": "-(-a - 1)",
    }
    for value, text in values.items():
        (limit,) = read(robot(wheel("w"), top=f"parameters: {{a: 1}}\nlimits: {{steer: {value}}}\n")).limits
        assert limit.low.text == text


def test_limits() -> None:
    spec = read(robot(top="limits: {vx: 2.0, vy: [-1 m/s, 3.6 km/h], omega: 30 rpm, steer: 95 deg}\n"))
    assert [(x.name, show(x.low.expr), show(x.high.expr)) for x in spec.limits] == [
        ("vx", "-2", "2"),
        ("vy", "-1", "1"),
        ("omega", "-(1 * pi)", "(1 * pi)"),
        ("steer", "-(19/36 * pi)", "(19/36 * pi)"),
    ]


PAIR = (wheel("a", "steered"), wheel("b", "steered"), wheel("c"), wheel("s", "spherical"))


def test_couplings() -> None:
    spec = read(
        robot(*PAIR, top="couplings: [{equal: [a.steer, b.steer]}, {equal: [b.spin, a.spin, c.spin]}]\n")
    )
    assert [(c.joint, c.wheels) for c in spec.couplings] == [("steer", ("a", "b")), ("spin", ("b", "a", "c"))]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[{equal: [a.steer, x.steer]}]", "no wheel 'x'"),
        ("[{equal: [a.steer, c.steer]}]", "no joint 'steer'"),
        ("[{equal: [a.steer, b.spin]}]", "not a steer joint"),
        ("[{equal: [a.steer]}]", r"coupling of 1 joint\b"), ("[{equal: []}]", "coupling of 0 joints"),
        ("[{equal: [a.steer, a.steer]}]", "stands twice"), ("[{equal: [a, b]}]", "not a joint"),
        ("[{equal: [a.steer_rate, b.steer_rate]}]", "coupled rates"),
        ("[{equal: [a.spin, s.spin]}]", "no joint 'spin'"), ("[{eqal: [a.spin, b.spin]}]", "unknown key"),
        ("[{}]", "no equal"), ("[a.steer]", "must be a mapping"),
        ("{equal: [a.steer, b.steer]}", "must be a list"), ("[{equal: a.steer}]", "must be a list"),
        ("[{equal: [a.steer, b.steer]}, {equal: [b.steer, a.steer]}]", "already"),
        ("[{equal: [[a], b]}]", "one value"),
    ],
)  # fmt: skip
def test_refused_couplings(text: str, message: str) -> None:
    with pytest.raises(RobotFileError, match=message):
        read(robot(*PAIR, top=f"couplings: {text}\n"))
