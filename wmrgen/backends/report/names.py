"""Names as LaTeX: parameters in italics, joints as Greek letters with the wheel as index."""

from __future__ import annotations

import re

from wmrgen.symbolic import escape

_PLAIN = {
    "omega": r"\omega",
    "theta": r"\theta",
    "vx": "v_x",
    "vy": "v_y",
    "dt": r"\Delta t",
    "x": "x",
    "y": "y",
}
_JOINTS = {"spin": r"\dot{\varphi}", "steer": r"\psi", "steer_rate": r"\dot{\psi}"}
TWIST = ("vx", "vy", "omega")
DRIVEN = {f"{n}_driven": _PLAIN[n] + "^{*}" for n in TWIST}


def wheel(name: str) -> str:
    """A wheel's name as an index."""
    return rf"\mathrm{{{escape(name)}}}"


def parameter(name: str) -> str:
    """``r``, ``d_1``, ``h_x`` as they are written by hand; longer names in italics."""
    short = re.fullmatch(r"([a-z])_?([a-z0-9]|\d+)?", name)
    if short:
        return f"{short[1]}_{{{short[2]}}}" if short[2] else name
    return rf"\mathit{{{escape(name)}}}"


def port(name: str) -> str:
    """An input or output by its contract name."""
    if name in _PLAIN:
        return _PLAIN[name]
    if name in DRIVEN:
        return DRIVEN[name]
    if name.endswith("_rate") and not name.endswith(".steer_rate"):
        letter, bar, index = port(name.removesuffix("_rate")).partition("_")
        return rf"\dot{{{letter}}}{bar}{index}" if len(letter) < 8 else rf"\dot{{{letter}{bar}{index}}}"
    owner, _, joint = name.partition(".")
    if joint in _JOINTS:
        return f"{_JOINTS[joint]}_{{{wheel(owner)}}}"
    if joint in _PLAIN:
        return f"{_PLAIN[joint]}_{{{wheel(owner)}}}"
    numbered = re.fullmatch(r"eta(\d+)", name)
    return rf"\eta_{{{numbered[1]}}}" if numbered else rf"\mathrm{{{escape(name)}}}"
