"""Expressions for readers: long numbers are rounded, short ones are not, and it is said where they were."""

from __future__ import annotations

import pytest
import sympy

from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.printing import DIGITS, Latex, Reader, Text, by_hand, exact, readable, size, symbol_names
from wmrgen.geometry.symbolic import Local, nearest, parameter, signal

LONG = sympy.Rational(10**DIGITS + 1, 10**DIGITS + 39)
X, A = signal("left.spin"), parameter("a")


@pytest.mark.parametrize(
    "number",
    [
        sympy.Rational(10**DIGITS - 1, 7),
        sympy.Rational(3, 10**DIGITS - 1),
        sympy.Integer(-(10**DIGITS) + 1),
        sympy.pi,
    ],
)
def test_numbers_of_twelve_digits_stay(number: sympy.Expr) -> None:
    assert readable(number) is number
    expr = X * number + A
    assert readable(expr) is expr


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        (sympy.Integer(10**DIGITS), "1e+12"),
        (sympy.Integer(-(10**DIGITS)), "-1e+12"),
        (sympy.Rational(1, 10**DIGITS), "1e-12"),
        (sympy.Rational(2 * 10**DIGITS + 1, 3 * 10**DIGITS), "0.666666666667"),
    ],
)
def test_longer_ones_are_rounded_to_twelve(number: sympy.Expr, shown: str) -> None:
    assert exact(readable(number)) == shown
    assert exact(readable(X + number)).replace(" ", "") in (
        f"left_spin{shown}",
        f"left_spin+{shown}",
        f"{shown}+left_spin",
    )


def test_a_reader_says_where_it_rounded() -> None:
    reader = Reader()
    assert reader(X + A) == exact(X + A) and reader.note == ""
    assert "0.999999999962" in reader(X * LONG)
    assert reader.note == "Numbers of 12 digits are rounded for reading; --json gives the exact ones."
    port = Port("left.spin", Role.STATE, "rad/s")
    assert Reader(Text((port,)).doprint)(X * LONG) in ("0.999999999962*left.spin", "left.spin*0.999999999962")


def test_sizes_count_every_node_as_written_out() -> None:
    assert [size(e) for e in (X, X + A, X * A + X, sympy.sin(X * A) + sympy.cos(X * A))] == [1, 3, 5, 9]
    twice = sympy.sin(X + A, evaluate=False)
    assert size(sympy.Add(twice, sympy.cos(twice), evaluate=False)) == 1 + 4 + 5


def test_names_of_symbols() -> None:
    ports = [Port(n, Role.STATE, "") for n in ("left.spin", "vx", "front_left.steer_rate")]
    assert symbol_names(ports) == {
        "left_spin": "left.spin", "vx": "vx", "front_left_steer_rate": "front_left.steer_rate",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("expr", "shown"),
    [
        (sympy.Rational(3, 7), r"\frac{3}{7}"),
        (sympy.Rational(123456789, 1000), r"\frac{123456789}{1000}"),
        (sympy.Rational(1, 999999), r"\frac{1}{999999}"),
        (sympy.Rational(1, 10**6), "10^{-6}"),
        (sympy.Rational(1, 10**9), "10^{-9}"),
        (sympy.Rational(3, 10**6), r"3\cdot 10^{-6}"),
        (sympy.Rational(1234567890123, 1000), r"1.23457\cdot 10^{9}"),
        (sympy.pi, r"\pi"),
        (nearest(signal("vx")), r"\mathrm{rint}\left(v_x\right)"),
        (sympy.atan2(signal("vy"), signal("vx"), evaluate=False) ** 2, r"\mathrm{atan2}\left(v_y,\, v_x\right)^{2}"),
        (sympy.sign(signal("vx")), r"\mathrm{sign}\left(v_x\right)"),
    ],
)  # fmt: skip
def test_numbers_and_functions_in_latex(expr: sympy.Expr, shown: str) -> None:
    ports = [Port(n, Role.STATE, "") for n in ("vx", "vy")]
    assert Latex(ports).doprint(expr) == shown


def test_a_choice_in_latex() -> None:
    choice = sympy.Piecewise((A, X < 1), (sympy.Integer(2), True))
    shown = Latex([Port("left.spin", Role.STATE, "")]).doprint(choice)
    assert shown == (r"\begin{cases} a & \dot{\varphi}_{\mathrm{left}} < 1 \\ 2 & \mathrm{else} \end{cases}")


def test_names_and_numbers_by_hand() -> None:
    """Names of intermediate results in words, long fractions as decimals, powers of ten as they are."""
    step = Local("half_turn")
    names = by_hand([step], [step * LONG - A / 10**9, X * -LONG])
    shown = {str(old): new for old, new in names.items()}
    assert Latex().doprint(shown["half_turn"]) == r"\mathrm{half\;turn}"
    assert Latex().doprint(names[LONG]) == "1" and Latex().doprint(names[-LONG]) == "- 1"
    assert set(names) == {step, LONG, -LONG}
