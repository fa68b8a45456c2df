"""How names, numbers and lists of names look in sentences and in LaTeX.

Names in LaTeX follow textbooks: single letters where textbooks have them, Greek letters for joints, and the name of a
wheel as an index. This module does not import sympy; `printing` writes whole expressions with the names from here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from fractions import Fraction
from typing import Literal

from wmrgen.geometry.exact.number import Exact

_GREEK = frozenset(
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu xi rho sigma tau phi psi omega".split()
)
# Letters that the reports do not use themselves, except d, l and r of wheels.
_LETTERS = frozenset("abdfghjlrs")
_INDEXED = frozenset("v_x v_y c1 c2 c_1 c_2".split())  # indexed letters that the reports use themselves
_JOINTS = {
    "spin": r"\dot{\varphi}", "spin_rate": r"\ddot{\varphi}",
    "steer": r"\psi", "steer_rate": r"\dot{\psi}", "steer_acceleration": r"\ddot{\psi}",
}  # fmt: skip
# How the numbers of a sum are written; "": no preference.
Style = Literal["", "exact", "decimals", "fractions"]
_COMPONENT = re.compile(r"([a-z])([xyz])")  # vx
_ROOTS = ("", r"\sqrt{2}", r"\sqrt{3}", r"\sqrt{6}")  # the basis of the number field, as in `Exact.num`
_COVARIANCE = re.compile(r"(vx|vy|omega|x|y|theta)(vx|vy|omega|x|y|theta)")
# The symbols of parameters that the robot file gives, by name of the parameter.
_symbols: ContextVar[Mapping[str, str]] = ContextVar("symbols", default={})  # noqa: B039 (it is never changed)
_NUMBERED = re.compile(r"([a-z]+)(\d+)")  # eta1, m12


def listed(parts: Sequence[str], word: str = "and") -> str:
    """Return "a, b and c", or the list with another ``word`` before its last part."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} {word} {parts[-1]}"


def in_backticks(names: Iterable[str]) -> str:
    """Return "`a`, `b` and `c`": names from a robot file, in backticks, for a sentence about the robot."""
    return listed([f"`{name}`" for name in names])


def plain(text: str) -> str:
    """Return a sentence without its backticks, for terminals and for data."""
    return text.replace("`", "")


def turning(ratios: Sequence[object]) -> str:
    """Return the verb phrase for wheels whose spins are coupled: in these ratios, or equal if ``ratios`` is empty."""
    return f"turn in the ratio {' : '.join(map(str, ratios))}" if ratios else "turn at one speed"


def steering(ratios: Sequence[object]) -> str:
    """Return the verb phrase for wheels whose steering is coupled: in these ratios, or equal if ``ratios`` is empty."""
    return f"steer in the ratio {' : '.join(map(str, ratios))}" if ratios else "share one steering angle"


def escape(name: str) -> str:
    """Return an identifier with its underscores escaped for LaTeX."""
    return name.replace("_", r"\_")


def decimal(value: float) -> str:
    """Return a number with six significant digits in LaTeX."""
    digits, e, exponent = f"{value + 0.0:.6g}".partition("e")
    return rf"{digits}\cdot 10^{{{int(exponent)}}}" if e else digits


def magnitude(value: Exact, style: Style = "") -> tuple[str, str, bool]:
    """Return the LaTeX of |value| as a fraction.

    Args:
        value: The number.
        style: "decimals" or "fractions" to prefer one where both are possible.

    Returns:
        The numerator, the denominator ("" if there is none), and whether the numerator is a sum. A numerator of 1 is
        "" if there is no denominator.
    """
    short = _short(value, style) if value.is_rational or style != "decimals" else None
    if short:
        return short
    shown = decimal(abs(float(value)))
    return "" if shown == "1" else shown, "", False


def style_of(numbers: Sequence[Exact]) -> Style:
    """Return one style for all numbers of a sum, so that fractions and decimals are not mixed.

    Halves of roots are fractions too. They become decimals if another number of the sum has to be rounded.
    """
    shown = [magnitude(n) for n in numbers]
    if not (any("." in above for above, _, _ in shown) and any(below for _, below, _ in shown)):
        return ""
    if all("." not in magnitude(n, "fractions")[0] for n in numbers):
        return "fractions"
    rounded = not all(_short(n) for n in numbers)
    return "decimals" if rounded or all(n.is_rational for n in numbers) else "exact"


def _short(value: Exact, style: Style = "") -> tuple[str, str, bool] | None:
    """Return the `magnitude` of a number whose exact form is short, else None."""
    value = abs(value)
    parts = [(n, root) for n, root in zip(value.num, _ROOTS, strict=True) if n]
    if len(parts) == 1:
        n, root = parts[0]
        fraction = _fraction(Fraction(abs(n), value.den), bool(root), style)
        if fraction is None:
            return None
        above, below = fraction
        return ("" if above == "1" else above) + root, below, False
    if value.den >= 1000 or max(abs(n) for n in value.num) >= 1000:
        return None
    signed = []
    for n, root in parts:
        sign = "-" if n < 0 else "+"
        digits = "" if abs(n) == 1 and root else str(abs(n))
        signed.append(sign + digits + root)
    signed.sort(key=lambda part: part.startswith("-"))
    return "".join(signed).removeprefix("+"), "" if value.den == 1 else str(value.den), True


def _fraction(f: Fraction, root: bool, style: Style) -> tuple[str, str] | None:
    """Return numerator and denominator, or an exact decimal and "", or None if neither is short."""
    if f.denominator == 1:
        return (str(f.numerator), "") if f.numerator < 10**7 else None
    exact = terminating(f)
    if style == "decimals":
        return exact or decimal(float(f)), ""
    halved = f.denominator in (2, 4, 8) and f.numerator < (100 if root or style == "fractions" else 2)
    if exact is not None and not halved:
        return exact, ""
    return (str(f.numerator), str(f.denominator)) if max(f.numerator, f.denominator) < 10**4 else None


def terminating(f: Fraction) -> str | None:
    """Return the exact decimal, such as ``0.165``, if it has at most eight decimals and seven digits, else None."""
    scaled = f * 10**8
    if scaled.denominator != 1 or len(str(scaled.numerator).rstrip("0")) > 7:
        return None
    whole, rest = divmod(scaled.numerator, 10**8)
    return f"{whole}.{rest:08d}".rstrip("0").rstrip(".")


def wheel(name: str) -> str:
    """Return a wheel's name in upright LaTeX, for use as an index."""
    return rf"\mathrm{{{escape(name)}}}"


def parameter(name: str) -> str:
    """Return the LaTeX of a parameter's name.

    ``r``, ``d_1`` and ``h_x`` look as they are written by hand, and other words are in italics. Names that the reports
    use for their own symbols are in typewriter type: ``L``, ``gamma``, ``v_x``. Inside `with_symbols`, a parameter with
    a symbol is shown by it.
    """
    if own := _symbols.get().get(name):
        return letter(own)
    if name in _LETTERS:
        return name
    if len(name) == 1 or name in _GREEK or name in _INDEXED:
        return rf"\mathtt{{{escape(name)}}}"
    indexed = re.fullmatch(r"([a-z])_?([a-z0-9]|\d+)", name)
    return f"{indexed[1]}_{{{indexed[2]}}}" if indexed else rf"\mathit{{{escape(name)}}}"


def sort_key(name: str) -> str:
    """Return what sorts a parameter among others in a sum or a product: its symbol if it has one, or its name."""
    return _symbols.get().get(name, name)


def letter(symbol: str) -> str:
    """Return the LaTeX of a parameter's symbol in the robot file: ``h``, ``l_x``, ``lambda``, ``l_rear``."""
    head, _, index = symbol.partition("_")
    base = rf"\{head}" if head in _GREEK else head
    return f"{base}_{{{_word(index)}}}" if index else base


@contextmanager
def with_symbols(symbols: Mapping[str, str]) -> Iterator[None]:
    """Show parameters by their ``symbols``, by name of the parameter, in all LaTeX that is written in this context."""
    outside = _symbols.set(symbols)
    try:
        yield
    finally:
        _symbols.reset(outside)


def port(name: str) -> str:
    """Return the LaTeX of an input or output by its contract name.

    Such names are ``omega``, ``left.spin``, ``point.vx``, ``x_rate`` and ``v_m.x``.
    """
    if name == "dt":
        return r"\Delta t"
    if name.endswith("_driven"):
        return f"{port(name.removesuffix('_driven'))}^{{*}}"
    owner, _, word = name.rpartition(".")
    if owner and word == "speed":
        return f"v_{{{wheel(owner)}}}"
    if owner and word in _JOINTS:
        return f"{_JOINTS[word]}_{{{wheel(owner)}}}"
    if word in ("x", "y", "z") and _is_letter(owner.partition("_")[0]):
        return _quantity(owner, [word])
    return _quantity(word, [wheel(owner)] if owner else [])


def symbol(name: str) -> str:
    """Return the LaTeX of a port by the name of its symbol, ``left_spin``; the wheel's name may have underscores."""
    joints = (joint for joint in sorted(_JOINTS, key=len, reverse=True) if name.endswith(f"_{joint}"))
    joint = next(joints, "")
    return port(f"{name.removesuffix('_' + joint)}.{joint}" if joint else name)


def _is_letter(head: str) -> bool:
    numbered = _NUMBERED.fullmatch(head)
    return len(head) == 1 or (numbered[1] if numbered else head) in _GREEK


def _quantity(name: str, indices: list[str]) -> str:
    """Return the LaTeX of a quantity with ``indices``.

    ``x_rate`` gets a dot. ``vx``, ``eta1``, ``k_rho`` and ``goal_x`` have an index of their own, which comes first.
    """
    pair = _COVARIANCE.fullmatch(name)
    if pair:
        return rf"\sigma_{{{port(pair[1])}\,{port(pair[2])}}}"
    base, dots = name, 0
    while base.endswith("_rate"):
        base, dots = base.removesuffix("_rate"), dots + 1
    head, _, index = base.partition("_")
    split = _COMPONENT.fullmatch(head) or _NUMBERED.fullmatch(head)
    own = [*([split[2]] if split else []), *([_word(index)] if index else [])]
    head = split[1] if split else head
    if not _is_letter(head) and index and not re.fullmatch(r"\d+|[a-z]", index):
        head, own = base, []
    if head in _GREEK:
        text = rf"\{head}"
    elif len(head) == 1:
        text = head
    else:
        text = rf"\mathrm{{{_spaced(head)}}}"
    if dots:
        text = rf"\{'d' * dots}ot{{{text}}}"
    index = ",".join([*own, *indices])
    if not index:
        return text
    return f"{text}_{index}" if re.fullmatch("[a-z]", index) else rf"{text}_{{{index}}}"


def _word(index: str) -> str:
    if re.fullmatch(r"\d+|[a-z]", index):
        return index
    return rf"\{index}" if index in _GREEK else rf"\mathrm{{{_spaced(index)}}}"


def _spaced(words: str) -> str:
    return words.replace("_", r"\;")
