"""Names and numbers as LaTeX: single letters where texts have them, Greek for joints, bodies as an index."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Literal

from wmrgen.geometry.exact.number import Exact

_GREEK = frozenset(
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu xi rho sigma tau phi psi omega".split()
)
_LETTERS = frozenset("abdfgjlrs")  # those that mean nothing on pages, but for d, l, r of wheels
_INDEXED = frozenset("v_x v_y c1 c2 c_1 c_2".split())
_JOINTS = {
    "spin": r"\dot{\varphi}", "spin_rate": r"\ddot{\varphi}",
    "steer": r"\psi", "steer_rate": r"\dot{\psi}", "steer_acceleration": r"\ddot{\psi}",
}  # fmt: skip
Style = Literal["", "exact", "decimals", "fractions"]
_COMPONENT = re.compile(r"([a-z])([xyz])")  # vx
_ROOTS = ("", r"\sqrt{2}", r"\sqrt{3}", r"\sqrt{6}")
_COVARIANCE = re.compile(r"(vx|vy|omega|x|y|theta)(vx|vy|omega|x|y|theta)")
_NUMBERED = re.compile(r"([a-z]+)(\d+)")  # eta1, m12


def listed(parts: Sequence[str], word: str = "and") -> str:
    """a, b and c, or with another word before the last"""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} {word} {parts[-1]}"


def in_code(names: Iterable[str]) -> str:
    """`a`, `b` and `c`: names of a robot file as they stand in sentences about it."""
    return listed([f"`{name}`" for name in names])


def plain(text: str) -> str:
    """Such a sentence for a terminal and for data: without backticks."""
    return text.replace("`", "")


def turning(ratios: Sequence[object]) -> str:
    """What coupled wheels do whose spins are in these ratios; none are given of equal ones."""
    return f"turn in the ratio {' : '.join(map(str, ratios))}" if ratios else "turn at one speed"


def steering(ratios: Sequence[object]) -> str:
    """What coupled wheels do whose steering angles are in these ratios; none are given of equal ones."""
    return f"steer in the ratio {' : '.join(map(str, ratios))}" if ratios else "share one steering angle"


def escape(name: str) -> str:
    """An identifier inside LaTeX braces."""
    return name.replace("_", r"\_")


def decimal(value: float) -> str:
    """Six significant digits in LaTeX."""
    digits, e, exponent = f"{value + 0.0:.6g}".partition("e")
    return rf"{digits}\cdot 10^{{{int(exponent)}}}" if e else digits


def magnitude(value: Exact, style: Style = "") -> tuple[str, str, bool]:
    """|value| above and below the line, 1 as nothing; and whether a sum stands above.

    ``style``: decimals or fractions in place of the other, where both would do; exact is what is short.
    """
    short = _short(value, style) if value.is_rational or style != "decimals" else None
    if short:
        return short
    shown = decimal(abs(float(value)))
    return "" if shown == "1" else shown, "", False


def style_of(numbers: Sequence[Exact]) -> Style:
    """One style for the numbers of a sum: no halves beside decimals. Roots, which are halved, too, are decimals beside
    a number that is rounded."""
    shown = [magnitude(n) for n in numbers]
    if not (any("." in above for above, _, _ in shown) and any(below for _, below, _ in shown)):
        return ""
    if all("." not in magnitude(n, "fractions")[0] for n in numbers):
        return "fractions"
    rounded = not all(_short(n) for n in numbers)
    return "decimals" if rounded or all(n.is_rational for n in numbers) else "exact"


def _short(value: Exact, style: Style = "") -> tuple[str, str, bool] | None:
    """`magnitude` of what is exact and short, None of other numbers."""
    value = abs(value)
    parts = [(n, root) for n, root in zip(value.num, _ROOTS, strict=True) if n]
    if len(parts) == 1:
        n, root = parts[0]
        if not (fraction := _fraction(Fraction(abs(n), value.den), bool(root), style)):
            return None
        above, below = fraction
        return ("" if above == "1" else above) + root, below, False
    if value.den >= 1000 or max(abs(n) for n in value.num) >= 1000:
        return None
    signed = [f"{n:+}{root}" if abs(n) != 1 or not root else f"{n:+}"[0] + root for n, root in parts]
    signed.sort(key=lambda part: part.startswith("-"))
    return "".join(signed).removeprefix("+"), "" if value.den == 1 else str(value.den), True


def _fraction(f: Fraction, root: bool, style: Style) -> tuple[str, str] | None:
    """Numerator and denominator, or an exact decimal and "", or None when neither is short."""
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
    """``0.165`` when at most eight decimals say all, else None."""
    scaled = f * 10**8
    if scaled.denominator != 1 or len(str(scaled.numerator).rstrip("0")) > 7:
        return None
    whole, rest = divmod(scaled.numerator, 10**8)
    return f"{whole}.{rest:08d}".rstrip("0").rstrip(".")


def wheel(name: str) -> str:
    """A wheel's name as an index."""
    return rf"\mathrm{{{escape(name)}}}"


def parameter(name: str) -> str:
    """``r``, ``d_1``, ``h_x`` as they are written by hand, other words in italics; in typewriter what would look like
    a symbol of the pages themselves: ``h``, which is a heading there, ``L``, ``gamma``, ``v_x``."""
    if name in _LETTERS:
        return name
    if len(name) == 1 or name in _GREEK or name in _INDEXED:
        return rf"\mathtt{{{escape(name)}}}"
    indexed = re.fullmatch(r"([a-z])_?([a-z0-9]|\d+)", name)
    return f"{indexed[1]}_{{{indexed[2]}}}" if indexed else rf"\mathit{{{escape(name)}}}"


def port(name: str) -> str:
    """An input or output by its contract name: ``omega``, ``left.spin``, ``point.vx``, ``x_rate``, ``v_m.x``."""
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
    """A port by the name of its symbol, ``left_spin``, in which the wheel's own name may have low lines."""
    joints = (joint for joint in sorted(_JOINTS, key=len, reverse=True) if name.endswith(f"_{joint}"))
    joint = next(joints, "")
    return port(f"{name.removesuffix('_' + joint)}.{joint}" if joint else name)


def _is_letter(head: str) -> bool:
    numbered = _NUMBERED.fullmatch(head)
    return len(head) == 1 or (numbered[1] if numbered else head) in _GREEK


def _quantity(name: str, indices: list[str]) -> str:
    """``x_rate`` with a dot, ``vx``, ``eta1``, ``k_rho`` and ``goal_x`` with an index of their own before others."""
    if pair := _COVARIANCE.fullmatch(name):
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
    text = rf"\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{_spaced(head)}}}"
    text = rf"\{'d' * dots}ot{{{text}}}" if dots else text
    shown = ",".join([*own, *indices])
    return f"{text}_{shown}" if re.fullmatch("[a-z]", shown) else rf"{text}_{{{shown}}}" if shown else text


def _word(index: str) -> str:
    if re.fullmatch(r"\d+|[a-z]", index):
        return index
    return rf"\{index}" if index in _GREEK else rf"\mathrm{{{_spaced(index)}}}"


def _spaced(words: str) -> str:
    return words.replace("_", r"\;")
