"""Numbers, units, expressions and degrees: what is read, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tests.robotfile.files import one_wheel, places, read, refused, robot, show, wheel
from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.load import read_text
from wmrgen.robotfile.records import Num

TOP = "parameters: {half: 0.2, other_one: half/2, turn: 30 deg, bare: 30}\n"
DEG = "angles: deg\n" + TOP


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.165", "33/200"), ("2.0944", "1309/625"), ("1e-3", "1/1000"), (".5", "1/2"), ("5.", "5"),
        ("1E2", "100"), ("-0.22", "-11/50"), ("+3", "3"), ("0", "0"), ("0.0", "0"), ("1.5e+1", "15"),
        ("'0.1'", "1/10"), ('"0.1"', "1/10"), ("150 mm", "3/20"), ("150mm", "3/20"), ("-2 cm", "-1/50"),
        ("0.5 in", "127/10000"), ("1 ft", "381/1250"), ("3 um", "3/1000000"), ("3 µm", "3/1000000"),
        ("1e-3 km", "1"), ("2 m", "2"),
    ],
)  # fmt: skip
def test_a_number_is_exactly_what_is_written(text: str, value: str) -> None:
    assert one_wheel(wheel("a", x=text)).x.expr == Num(Fraction(value))


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("pi/2", "(pi / 2)"), ("π/2", "(pi / 2)"), ("-pi/4", "(-pi / 4)"), ("45 deg", "(1/4 * pi)"),
        ("45°", "(1/4 * pi)"), ("1.2 rad", "6/5"), ("half", "half"), ("-half*2", "(-half * 2)"),
        ("half**2", "(half ** 2)"), ("half**-2", "(half ** -2)"), ("-2**2", "-(2 ** 2)"),
        ("(-2)**2", "(-2 ** 2)"), ("1 - 2 - 3", "((1 - 2) - 3)"), ("1 + 2*3", "(1 + (2 * 3))"),
        ("sqrt(2)/2", "(sqrt(2) / 2)"), ("atan2(half, 0.1)", "atan2(half, 1/10)"),
        ("tan (pi/4)", "tan((pi / 4))"), ("2 ** 3 ** 1", None), ("1/0.1", "(1 / 1/10)"),
        ("cos(sin(0))", "cos(sin(0))"),
    ],
)  # fmt: skip
def test_an_expression_is_kept_as_a_tree(text: str, tree: str | None) -> None:
    inside = wheel("a", x="", y="", extra=f'l: 1, alpha: "{text}"')
    if tree is None:
        with pytest.raises(RobotFileError):
            one_wheel(inside, TOP)
    else:
        assert show(one_wheel(inside, TOP).alpha.expr) == tree


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("45", "(1/4 * pi)"), ("-45", "(-1/4 * pi)"), ("0", "(0 * pi)"), ("45 deg", "(1/4 * pi)"),
        ("1 rad", "1"), ("pi/4", "(pi / 4)"), ("bare", "((bare * 1/180) * pi)"), ("turn", "turn"),
        ("2*turn", "(2 * turn)"), ("90 - bare", "(((90 - bare) * 1/180) * pi)"),
        ("'atan2(half, 1)'", "atan2(half, 1)"),
    ],
)  # fmt: skip
def test_under_angles_deg_a_bare_angle_is_degrees(text: str, tree: str) -> None:
    for key in ("heading", "beta", "alpha"):
        place = (
            {"x": "", "y": "", "extra": "l: 1, alpha: 0"}
            if key != "alpha"
            else {"x": "", "y": "", "extra": "l: 1"}
        )
        values = {"heading": "" if key == "beta" else "0", key: text}
        if key == "alpha":
            values = {"alpha": text}
        assert show(getattr(one_wheel(wheel("a", **place, **values), DEG), key).expr) == tree


def test_degrees_reach_gamma_and_steer_limits_and_nothing_else() -> None:
    swedish = one_wheel(wheel("a", "swedish", gamma="45"), DEG)
    assert show(swedish.gamma.expr) == "(1/4 * pi)"
    steered = one_wheel(wheel("a", "steered", limits="{steer: 90, steer_rate: 3, spin: 60 rpm}"), DEG)
    shown = {limit.name: (show(limit.low.expr), show(limit.high.expr)) for limit in steered.limits}
    assert shown == {
        "steer": ("-(1/2 * pi)", "(1/2 * pi)"),
        "steer_rate": ("-3", "3"),
        "spin": ("-(2 * pi)", "(2 * pi)"),
    }
    assert show(steered.y.expr) == "1/10"


@pytest.mark.parametrize("text", ["cos(30)", "half*sin(bare)", "tan(1 + 2)"])
def test_under_angles_deg_trigonometry_of_bare_numbers_is_refused(text: str) -> None:
    column = len("  - {name: a, type: fixed, x: ") + 1
    assert places(refused(robot(wheel("a", x=text), top=DEG))) == f"WMR104 6:{column}"
    one_wheel(wheel("a", x=text), TOP)


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("cos(turn)", "cos(turn)"), ("cos(pi/6)", "cos((pi / 6))"), ("cos(0)", "cos(0)"),
        ("'cos(atan2(1, 2))'", "cos(atan2(1, 2))"),
    ],
)  # fmt: skip
def test_under_angles_deg_trigonometry_of_radians_is_read_as_written(text: str, tree: str) -> None:
    """Arguments stay radians: no factor pi/180 comes in."""
    assert show(one_wheel(wheel("a", x=text), DEG).x.expr) == tree


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("nan", "WMR104 10:8"), (".NaN", "WMR104 10:8"), (".inf", "WMR104 10:8"),
        ("-inf", "WMR104 10:8"), ("012", "WMR104 10:8"), ("-00.5", "WMR104 10:8"),
        ("half*012", "WMR104 10:13"), ("1:30", "WMR104 10:8"), ("1e999999", "WMR104 10:8"),
        ("1e-999999999999999999999", "WMR104 10:8"), ("2*1e31", "WMR104 10:10"), ("0x10", "WMR104 10:8"),
        ("1_000", "WMR104 10:8"), ("1" * 41, "WMR104 10:8"), ("'1,5'", "WMR104 10:8"),
        ("45 deg", "WMR104 10:8"), ("1 m/s", "WMR104 10:8"), ("3 lightyears", "WMR104 10:10"),
        ("3 inch", "WMR104 10:10"), ("2pi", "WMR104 10:9"), ("2 half", "WMR104 10:10"),
        ("half mm", "WMR104 10:13"), ("2(3)", "WMR104 10:9"),
        ("(2)(3)", "WMR104 10:11"), ("half(3)", "WMR104 10:8"),
        ("pi(3)", "WMR104 10:8"), ("1 2", "WMR104 10:10"),
        ("1.2.3", "WMR104 10:11"), ("9**9**9", "WMR104 10:11"),
        ("2**0.5", "WMR104 10:11"), ("2**half", "WMR104 10:11"), ("2**5", "WMR104 10:11"),
        ("2**-5", "WMR104 10:11"), ("2**--2", "WMR104 10:11"), ("2^2", "WMR104 10:9"),
        ("2//3", "WMR104 10:10"), ("5 - % 3", "WMR104 10:12"), ("half = 1", "WMR104 10:13"),
        ("1 +", "WMR104 10:8"), ("(1", "WMR104 10:8"), ("1)", "WMR104 10:9"),
        ("()", "WMR104 10:8"), ("1 < 2", "WMR104 10:10"), ("unknown", "WMR107 10:8"),
        ("haff", "WMR107 10:8"), ("True", "WMR104 10:8"), ("lambda", "WMR107 10:8"),
        ("half.real", "WMR104 10:8"), ("half if half else half", "WMR104 10:13"),
        ("__import__('os')", "WMR104 10:8"), ("exec(half)", "WMR104 10:8"),
        ("atan(1)", "WMR104 10:8"), ("sqrt", "WMR104 10:8"), ("'sqrt(1, 2)'", "WMR104 10:8"),
        ("atan2(1)", "WMR104 10:8"), ("sin()", "WMR104 10:8"), ("'(1, 2)'", "WMR104 10:8"),
        ("sqrt(*half)", "WMR104 10:13"), ("−1", "WMR104 10:8"), ("½", "WMR104 10:8"),
        ("٣", "WMR104 10:8"), ("ｘ", "WMR104 10:8"), ("1 +" + "-" * 150 + "1", "WMR104 10:8"),
        ("1+" * 100 + "1", "WMR104 10:8"), ("1+\x00", "WMR101 10:10"), ('"1\\n+1"', "WMR104 10:8"),
        ("[1]", "WMR104 10:8"), ("{a: 1}", "WMR104 10:8"), ("", "WMR104 10:7"), ("''", "WMR104 10:8"),
        ("~", "WMR104 10:8"), ("((((9**4)**4)**4)**4)**4", "WMR104 10:8"),
        ("(((half+1)**4+half)**4+half)**4", "WMR104 10:8"),
    ],
)  # fmt: skip
def test_refused_values(text: str, where: str) -> None:
    head = "- name: a\n    type: fixed\n    y: 0.1\n    heading: 0\n    r: 0.05\n"
    error = refused(f"wmrgen: 1\nname: bot\n{TOP}wheels:\n  {head}    x: {text}\n")
    assert places(error) == where


def test_the_caret_stands_under_the_culprit() -> None:
    for quote in ("", "'", '"'):
        with pytest.raises(RobotFileError) as caught:
            one_wheel(wheel("a", x=f"{quote}half + haff{quote}"), TOP)
        shown = str(caught.value).split("\n")
        assert shown[2][shown[3].index("^") :].startswith("haff")
        assert "half" in caught.value.instead


@pytest.mark.parametrize(
    "text", ["+".join(["half"] * 9), "4*half + 4*other_one + half", "3*(half + 2*other_one)"]
)
def test_angles_of_many_parameters_are_refused(text: str) -> None:
    error = refused(robot(wheel("a", heading=text), top=TOP))
    assert error.code == Code.FORM and "8" in error.what
    one_wheel(wheel("a", x=text), TOP)


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("pi/2 - half + 2*other_one", "(((pi / 2) - half) + (2 * other_one))"),
        ("12*3*pi/16", "(((12 * 3) * pi) / 16)"), ("half*180/pi", "((half * 180) / pi)"),
        ("1 + 2 + 3 + 4 + 5 + 6 + 7 + 8 + 9", "((((((((1 + 2) + 3) + 4) + 5) + 6) + 7) + 8) + 9)"),
    ],
)  # fmt: skip
def test_ordinary_angles_are_not(text: str, tree: str) -> None:
    read_wheel = one_wheel(wheel("a", heading=text, x=f"cos({text})"), TOP)
    assert show(read_wheel.heading.expr) == tree
    assert show(read_wheel.x.expr) == f"cos({tree})"


class TestParameters:
    def test_keep_the_order_of_the_file(self) -> None:
        spec = read(robot(wheel("w"), top="parameters: {b: 1, a: {value: b/2, tunable: true}, c: 3 mm}\n"))
        assert [(p.name, p.tunable, show(p.value.expr)) for p in spec.parameters] == [
            ("b", False, "1"),
            ("a", True, "(b / 2)"),
            ("c", False, "3/1000"),
        ]

    def test_stand_after_those_they_use(self) -> None:
        spec = read(robot(wheel("w"), top="parameters: {a: b + c, c: 2*b, b: 1}\n"))
        assert [p.name for p in spec.parameters] == ["b", "c", "a"]

    @pytest.mark.parametrize(
        ("text", "where"),
        [
            ("{a: a}", "WMR104 3:17, WMR106 5:12"), ("{a: b, b: c, c: a}", "WMR104 3:29, WMR106 5:12"),
            ("{a: nope}", "WMR107 3:17, WMR106 5:12"), ("[a]", "WMR104 3:13"), ("{a: [1]}", "WMR104 3:17, WMR106 5:12"),
            ("{a: }", "WMR104 3:16, WMR106 5:12"), ("{a: {tunable: true}}", "WMR103 3:17, WMR106 5:12"),
            ("{a: {value: 1, tunable: yes}}", "WMR104 3:37, WMR106 5:12"),
            ("{a: {value: 1, tunabel: true}}", "WMR102 3:28, WMR106 5:12"), ("{half-track: 1}", "WMR105 3:14"),
            ("{a: 1, A: 2}", "WMR106 3:20, WMR106 5:12"), ("{PI: 1}", "WMR105 3:14"),
            ("{pi: 1}", "WMR105 3:14"), ("{sqrt: 1}", "WMR105 3:14"), ("{vx: 1}", "WMR105 3:14"),
            ("{eta1: 1}", "WMR105 3:14"), ("{y: 1}", "WMR105 3:14"), ("{lambda: 1}", "WMR105 3:14"),
            ("{a__b: 1}", "WMR105 3:14"), ("{a: 1, a: 2}", "WMR106 3:20, WMR106 5:12"),
            ("{a: 'sqrt(b'}", "WMR107 3:23, WMR106 5:12"),
        ],
    )  # fmt: skip
    def test_refused(self, text: str, where: str) -> None:
        assert places(refused(robot(top=f"parameters: {text}\n"))) == where

    def test_a_long_chain_needs_no_recursion(self) -> None:
        chain = ", ".join(f"p{i}: p{i + 1}" for i in range(200)) + ", p200: 1"
        assert len(read(robot(top=f"parameters: {{{chain}}}\n")).parameters) == 201

    def test_257_are_too_many(self) -> None:
        many = ", ".join(f"p{i}: 1" for i in range(257))
        error = refused(robot(top=f"parameters: {{{many}}}\n"))
        assert places(error) == "WMR104 3:13" and "257" in error.what

    @pytest.mark.parametrize(
        "step", ["p{0}*p{0}", "p{0} + p{0}", "cos(p{0}) + cos(p{0})", "p{0}**4", "1/p{0}/p{0}"]
    )
    def test_doubling_chains_are_stopped_early(self, step: str) -> None:
        chain = ", ".join(f"p{i + 1}: {step.format(i)}" for i in range(60))
        assert refused(robot(top=f"parameters: {{p0: 0.37, {chain}}}\n")).code == Code.FORM


@pytest.mark.parametrize("word", ["forward", "Left", "backwards"])
def test_a_direction_is_an_angle_and_no_parameter(word: str) -> None:
    text = f"wmrgen: 1\nname: x\nwheels:\n  - {{name: a, type: fixed, x: 0, y: 0, heading: {word}, r: 1}}\n"
    with pytest.raises(RobotFileError) as caught:
        read_text(text, "x.yaml")
    (error,) = caught.value.parts
    assert error.code is Code.UNDECLARED and error.mark and error.mark.line == 4
    assert "left 90 deg" in error.instead and "parameters:" not in error.instead
