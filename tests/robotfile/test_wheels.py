"""Wheels, joints, limits and couplings."""

from __future__ import annotations

import pytest

from tests.robotfile.files import KEYS, one_wheel, places, read, refused, robot, show, wheel


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
    ("inside", "where", "hint"),
    [
        (wheel("a", extra="l: 1, alpha: 0"), "WMR106 4:63", "Keep l and alpha, or x and y"),
        (wheel("a", extra="l: 1"), "WMR106 4:63", "Keep"),
        (wheel("a", x="", y=""), "WMR103 4:5", "l: and alpha"),
        (wheel("a", y=""), "WMR103 4:5", "left of the origin"),
        (wheel("a", x="", y="", extra="l: 1"), "WMR103 4:5", "direction"),
        (wheel("a", heading=""), "WMR103 4:5", "heading: 0"),
        (wheel("a", "steered", heading=""), "WMR103 4:5", "heading: 0"),
        (wheel("a", beta="0"), "WMR106 4:63", "Keep one"),
        (wheel("a", r=""), "WMR103 4:5", "r: 50 mm"),
        (wheel("a", "castor", d=""), "WMR103 4:5", "type: steered"),
        (wheel("", x="0"), "WMR103 4:5", "front_left"),
        ("x: 0, y: 0", "WMR103 4:5, WMR103 4:5", "front_left"),
        ("name: a, x: 0, y: 0", "WMR103 4:5", "swedish"),
        (wheel("a", type="mecanum"), "WMR104 4:21", "swedish"),
        (wheel("a", type="omni"), "WMR104 4:21", "gamma: 0"),
        (wheel("a", type="caster"), "WMR104 4:21", "castor"),
        (wheel("a", type="fixd"), "WMR104 4:21", "fixed"),
        (wheel("a", type="Steered"), "WMR104 4:21", "steered"),
        (wheel("a", type="xyzzy"), "WMR104 4:21", "spherical"),
        (wheel("a", gamma="0"), "WMR106 4:63", "type: swedish"),
        (wheel("a", d="0.1"), "WMR106 4:63", "x, y"),
        (wheel("a", "steered", d="0.1"), "WMR106 4:65", "type: castor"),
        (wheel("a", "swedish", offset_y="0.1"), "WMR106 4:65", "x, y"),
        (wheel("a", "castor", r_sw="0.1"), "WMR106 4:61", "swedish"),
        (wheel("a", radius="0.1"), "WMR102 4:63", "r?"),
        (wheel("a", diameter="0.1"), "WMR102 4:63", "half the diameter"),
        (wheel("a", gama="0.1"), "WMR102 4:63", "gamma"),
        (wheel("a", trail="0.1"), "WMR102 4:63", "d?"),
        (wheel("a", extra="x:1"), "WMR104 4:63", "x: 1"),
        (wheel("a", x="atan2(1, 2)"), "WMR104 4:40", "in quotes"),
        (wheel("a", x="1,5"), "WMR104 4:33", "decimal point"),
        (wheel("a", extra="<<: {x: 1}"), "WMR104 4:63", "Write the keys out"),
        (wheel("a", extra="α: 0, alpha: 0"), "WMR106 4:63, WMR106 4:69", "Delete"),
        (wheel("a", extra="x: 1"), "WMR106 4:63", "Delete"),
        (wheel("a", actuated="[steer]"), "WMR104 4:74", "spin"),
        (wheel("a", actuated="spin"), "WMR104 4:73", "[spin]"),
        (wheel("a", actuated="[spin, spin]"), "WMR106 4:80", "Delete"),
        (wheel("a", "spherical", sensed="[spin]"), "WMR104 4:55", "sensed: []"),
        (wheel("a", limits="{steer: 1}"), "WMR102 4:72", "spin"),
        (wheel("a", limits="{spin: [1]}"), "WMR104 4:78", "[low, high]"),
        (wheel("a", limits="{spin: 1 m/s}"), "WMR104 4:78", "rpm"),
        (wheel("a", limits="{vx_rate: 1}"), "WMR102 4:72", "spin"),
        (wheel("a", limits="3"), "WMR104 4:71", "omega"),
        ("- a", "WMR104 4:5", "name: left"),
    ],
)
def test_refused_wheels(inside: str, where: str, hint: str) -> None:
    """``hint``: a word that the message offers."""
    error = refused(robot(inside) if not inside.startswith("-") else robot().split("  -")[0] + "  - a\n")
    assert places(error) == where
    assert hint in str(error)


def test_wheel_names_are_distinct() -> None:
    error = refused(robot(wheel("a"), wheel("b"), wheel("a")))
    assert places(error) == "WMR106 6:12"
    assert "line 4" in str(error)


def test_64_wheels_are_read_and_65_are_not() -> None:
    many = [wheel(f"w{i}") for i in range(65)]
    assert len(read(robot(*many[:64])).wheels) == 64
    error = refused(robot(*many))
    assert places(error) == f"WMR104 {4 + 64}:5" and "65" in error.what


def test_limits_of_acceleration_have_units_of_their_own() -> None:
    limits = "{vx_rate: [-3 m/s^2, 2 m/s2], vy_rate: 1.5 m/s², omega_rate: 90 deg/s^2}"
    spec = read(robot(top=f"limits: {limits}\n"))
    assert [(x.name, show(x.low.expr), show(x.high.expr)) for x in spec.limits] == [
        ("vx_rate", "-3", "2"),
        ("vy_rate", "-3/2", "3/2"),
        ("omega_rate", "-(1/2 * pi)", "(1/2 * pi)"),
    ]
    for wrong, where in (
        ("vx_rate: 1 m/s", "WMR104 3:19"),
        ("omega_rate: 1 m/s^2", "WMR104 3:22"),
        ("vx: 1 m/s^2", "WMR104 3:14"),
        ("vx: 1 m^2", "WMR104 3:16"),
    ):
        assert places(refused(robot(top=f"limits: {{{wrong}}}\n"))) == where


@pytest.mark.parametrize(
    ("key", "hint"),
    [
        ("v", "vx:"),
        ("w", "omega"),
        ("a", "vx vy omega"),
    ],
)
def test_a_limit_of_another_name(key: str, hint: str) -> None:
    error = refused(robot(top=f"limits: {{{key}: 1}}\n"))
    assert places(error) == "WMR102 3:10" and hint in error.instead


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
    ("text", "where"),
    [
        ("[{equal: [a.steer, x.steer]}]", "WMR107 3:31"),
        ("[{equal: [a.steer, c.steer]}]", "WMR104 3:31"),
        ("[{equal: [a.steer, b.spin]}]", "WMR104 3:31"),
        ("[{equal: [a.steer]}]", "WMR104 3:21"), ("[{equal: []}]", "WMR104 3:21"),
        ("[{equal: [a.steer, a.steer]}]", "WMR106 3:31"), ("[{equal: [a, b]}]", "WMR104 3:22, WMR104 3:25"),
        ("[{equal: [a.steer_rate, b.steer_rate]}]", "WMR104 3:22, WMR104 3:36"),
        ("[{equal: [a.spin, s.spin]}]", "WMR104 3:30"), ("[{eqal: [a.spin, b.spin]}]", "WMR102 3:14"),
        ("[{}]", "WMR103 3:13"), ("[a.steer]", "WMR104 3:13"),
        ("{equal: [a.steer, b.steer]}", "WMR104 3:12"), ("[{equal: a.steer}]", "WMR104 3:21"),
        ("[{equal: [a.steer, b.steer]}, {equal: [b.steer, a.steer]}]", "WMR106 3:42"),
        ("[{equal: [[a], b]}]", "WMR104 3:22"),
    ],
)  # fmt: skip
def test_refused_couplings(text: str, where: str) -> None:
    assert places(refused(robot(*PAIR, top=f"couplings: {text}\n"))) == where
