"""Names of intermediate results, as the report writes them: what comments of generated code call its temporaries."""

from __future__ import annotations

import re

# The quantities of sections 6 to 8 of the report. A wheel's name may stand in front.
_OF_A_WHEEL = {
    "x": "a", "y": "b", "along": "u", "across": "w", "turn": "Delta",
    "size": "sqrt(a^2 + b^2)", "speed": "speed", "heading": "heading", "slope": "tan(heading / 2)",
    "p": "p", "q": "q", "tangent": "t", "rx": "row of H, vx", "ry": "row of H, vy", "rw": "row of H, omega",
    "nearest": "nearer angle", "target": "angle inside the limits",
    "bx": "contact point, x", "by": "contact point, y", "wx": "its velocity, x", "wy": "its velocity, y",
    "bx0": "contact point from the mean, x", "by0": "contact point from the mean, y",
}  # fmt: skip
_ALONE = {
    "half_turn": "h", "half_turn_squared": "h^2", "sinc_series": "series of sinc(h)", "half_turn_size": "|h|",
    "half_turn_safe": "|h| or 1/20",
    "chord": "dt sinc(h)", "middle": "theta + h", "vx_fit": "vx", "vy_fit": "vy", "omega_fit": "omega",
    "det": "det(HtH)",
}  # fmt: skip
_ROW = {"b": "Htz", "p": "(adj(HtH) Htz)", "error_": "residual"}
_ENTRY = {"n": "HtH", "adj": "adj(HtH)"}


def quantity(name: str) -> str:
    """``front_left_along`` is u of front_left, ``half_turn`` is h; others are called what the program calls them."""
    if name in _ALONE:
        return _ALONE[name]
    entry = re.fullmatch(r"(n|adj)([0-2])([0-2])", name)
    if entry:
        return f"{_ENTRY[entry[1]]}[{entry[2]}][{entry[3]}]"
    row = re.fullmatch(r"(b|p|error_)(\d+)", name)
    if row:
        return f"{_ROW[row[1]]} {row[2]}" if row[1] == "error_" else f"{_ROW[row[1]]}[{row[2]}]"
    wheel, _, last = name.rpartition("_")
    if wheel and last in _OF_A_WHEEL:
        return f"{wheel}: {_OF_A_WHEEL[last]}"
    return name.replace("_", " ")
