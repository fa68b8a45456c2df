"""Numbers, units, expressions and degrees: what is read, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tests.robotfile.files import one_wheel, read, robot, show, wheel
from wmrgen.errors import RobotFileError
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
    with pytest.raises(RobotFileError, match="ambiguous"):
        one_wheel(wheel("a", x=text), DEG)
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
    ("text", "message"),
    [
        ("nan", "not a finite"), (".NaN", "not a finite"), (".inf", "not a finite"),
        ("-inf", "not a finite"), ("012", "begins with 0"), ("-00.5", "begins with 0"),
        ("half*012", "begins with 0"), ("1:30", "base 60"), ("1e999999", "exponent"),
        ("1e-999999999999999999999", "exponent"), ("2*1e31", "exponent"), ("0x10", "not decimal"),
        ("1_000", "underscores"), ("1" * 41, "digits"), ("'1,5'", "decimal comma"),
        ("45 deg", "is an angle"), ("1 m/s", "is a speed"), ("3 lightyears", "not a unit"),
        ("3 inch", "not a unit"), ("2pi", "operator is missing"), ("2 half", "operator is missing"),
        ("half mm", "stands after an expression"), ("2(3)", "operator is missing"),
        ("(2)(3)", "operator is missing"), ("half(3)", "a value, not a function"),
        ("pi(3)", "a value, not a function"), ("1 2", "operator is missing"),
        ("1.2.3", "operator is missing"), ("9**9**9", "exponent is not a whole number"),
        ("2**0.5", "exponent is not"), ("2**half", "exponent is not"), ("2**5", "exponent is not"),
        ("2**-5", "exponent is not"), ("2**--2", "exponent is not"), ("2^2", "cannot stand"),
        ("2//3", "cannot stand"), ("5 - % 3", "cannot stand"), ("half = 1", "cannot stand"),
        ("1 +", "not a complete"), ("(1", "not a complete"), ("1)", "not a complete"),
        ("()", "cannot stand"), ("1 < 2", "cannot stand"), ("unknown", "not a declared"),
        ("haff", "not a declared"), ("True", "is no number"), ("lambda", "not a declared"),
        ("half.real", "cannot stand"), ("half if half else half", "operator is missing"),
        ("__import__('os')", "not a function"), ("exec(half)", "not a function"),
        ("atan(1)", "not a function"), ("sqrt", "needs its argument"), ("'sqrt(1, 2)'", "takes 1 argument"),
        ("atan2(1)", "takes 2 arguments"), ("sin()", "takes 1 argument"), ("'(1, 2)'", "is 2 values"),
        ("sqrt(*half)", "cannot stand|not a complete"), ("−1", "cannot stand"), ("½", "cannot stand"),
        ("٣", "cannot stand"), ("ｘ", "cannot stand"), ("1 +" + "-" * 150 + "1", "more than 128"),
        ("1+" * 100 + "1", "characters"), ("1+\x00", "."), ('"1\\n+1"', "cannot stand"),
        ("[1]", "one value"), ("{a: 1}", "one value"), ("", "no value"), ("''", "no value"),
        ("~", "is no number"), ("((((9**4)**4)**4)**4)**4", "too large"),
        ("(((half+1)**4+half)**4+half)**4", "too large"),
    ],
)  # fmt: skip
def test_refused_values(text: str, message: str) -> None:
    head = "- name: a\n    type: fixed\n    y: 0.1\n    heading: 0\n    r: 0.05\n"
    with pytest.raises(RobotFileError, match=message) as caught:
        read(f"wmrgen: 1\nname: bot\n{TOP}wheels:\n  {head}    x: {text}\n")
    assert caught.value.mark is not None
    assert caught.value.mark.line == 10


def test_the_caret_stands_under_the_culprit() -> None:
    for quote in ("", "'", '"'):
        with pytest.raises(RobotFileError) as caught:
            one_wheel(wheel("a", x=f"{quote}half + haff{quote}"), TOP)
        shown = str(caught.value).split("\n")
        assert shown[2][shown[3].index("^") :].startswith("haff")
        assert "Did you mean half?" in shown[-1]


@pytest.mark.parametrize(
    "text", ["+".join(["half"] * 9), "4*half + 4*other_one + half", "3*(half + 2*other_one)"]
)
def test_angles_of_many_parameters_are_refused(text: str) -> None:
    with pytest.raises(RobotFileError, match="more than 8 others"):
        one_wheel(wheel("a", heading=text), TOP)
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
        ("text", "message"),
        [
            ("{a: a}", "refers to itself"), ("{a: b, b: c, c: a}", "circle: "),
            ("{a: nope}", "not a declared"), ("[a]", "must be a mapping"), ("{a: [1]}", "one value"),
            ("{a: }", "no value"), ("{a: {tunable: true}}", "no value"),
            ("{a: {value: 1, tunable: yes}}", "not known"),
            ("{a: {value: 1, tunabel: true}}", "unknown key"), ("{half-track: 1}", "not a valid"),
            ("{a: 1, A: 2}", "differ in case alone"), ("{PI: 1}", "reserved"),
            ("{pi: 1}", "reserved"), ("{sqrt: 1}", "reserved"), ("{vx: 1}", "reserved"),
            ("{eta1: 1}", "reserved"), ("{y: 1}", "reserved"), ("{lambda: 1}", "reserved"),
            ("{a__b: 1}", "reserved"), ("{a: 1, a: 2}", "duplicate key"),
            ("{a: 'sqrt(b'}", "not a declared"),
        ],
    )  # fmt: skip
    def test_refused(self, text: str, message: str) -> None:
        with pytest.raises(RobotFileError, match=message):
            read(robot(top=f"parameters: {text}\n"))

    def test_a_long_chain_needs_no_recursion(self) -> None:
        chain = ", ".join(f"p{i}: p{i + 1}" for i in range(200)) + ", p200: 1"
        assert len(read(robot(top=f"parameters: {{{chain}}}\n")).parameters) == 201

    def test_257_are_too_many(self) -> None:
        many = ", ".join(f"p{i}: 1" for i in range(257))
        with pytest.raises(RobotFileError, match="257 parameters"):
            read(robot(top=f"parameters: {{{many}}}\n"))

    @pytest.mark.parametrize(
        "step", ["p{0}*p{0}", "p{0} + p{0}", "cos(p{0}) + cos(p{0})", "p{0}**4", "1/p{0}/p{0}"]
    )
    def test_doubling_chains_are_stopped_early(self, step: str) -> None:
        chain = ", ".join(f"p{i + 1}: {step.format(i)}" for i in range(60))
        with pytest.raises(RobotFileError, match="too large"):
            read(robot(top=f"parameters: {{p0: 0.37, {chain}}}\n"))
