"""Random layouts as robot files can say them: mixed wheels, unequal lengths, any origin.

Fixed wheels share one axle line, written as exact expressions, since fixed wheels anywhere leave no motion.
"""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

Layout = dict[str, Any]


def decimals(low: float, high: float, digits: int = 3) -> st.SearchStrategy[float]:
    """Numbers with a few decimals, as people write them."""
    scale = 10**digits
    return st.integers(round(low * scale), round(high * scale)).map(lambda k: k / scale)


lengths = decimals(-0.9, 0.9)
radii = decimals(0.02, 0.3)
offsets = st.one_of(decimals(0.01, 0.2), decimals(-0.2, -0.01))
angles = st.one_of(
    st.integers(-12, 12).map(lambda k: (f"{k}*pi/12", k * math.pi / 12)),
    decimals(-3.1, 3.1, 2)
    .filter(lambda a: abs(a * 12 / math.pi - round(a * 12 / math.pi)) > 0.01)
    .map(lambda a: (repr(a), a)),
)
gammas = st.sampled_from([0.0, math.pi / 4, -math.pi / 4, 0.6, -0.9])


@st.composite
def axle(draw: st.DrawFn, count: int) -> list[dict[str, Any]]:
    """``count`` fixed wheels on one axle line through (px, py) with a heading of k pi/12."""
    px, py, k = draw(lengths), draw(lengths), draw(st.integers(-12, 12))
    heading = k * math.pi / 12
    wheels = []
    for _ in range(count):
        t = draw(lengths)
        text = {
            "x": f"{px} - ({t})*sin({k}*pi/12)",
            "y": f"{py} + ({t})*cos({k}*pi/12)",
            "heading": f"{k}*pi/12",
        }
        flip = draw(st.booleans())
        if flip:
            text["heading"] = f"{k}*pi/12 + pi"
        wheels.append({
            "type": "fixed", "x": px - t * math.sin(heading), "y": py + t * math.cos(heading),
            "heading": heading + math.pi * flip, "r": draw(radii), "text": text,
        })  # fmt: skip
    return wheels


@st.composite
def wheel(draw: st.DrawFn, kind: str) -> dict[str, Any]:
    """One steered, castor, swedish or spherical wheel anywhere."""
    text, heading = draw(angles)
    w = {
        "type": kind,
        "x": draw(lengths),
        "y": draw(lengths),
        "heading": heading,
        "r": draw(radii),
        "text": {"heading": text},
    }
    if kind == "spherical" and draw(st.booleans()):
        w["driven"] = True
    if kind == "swedish":
        w["gamma"] = draw(gammas)
    if kind == "castor":
        w["d"] = draw(offsets)
        w["actuated"] = draw(st.sampled_from([[], ["spin", "steer"]]))
    if kind in ("steered", "castor"):
        w["o"] = draw(st.one_of(st.just(0.0), offsets))
    return w


@st.composite
def layouts(draw: st.DrawFn) -> Layout:
    """One to six wheels; at least one of them rolls."""
    count = draw(st.sampled_from([0, 0, 1, 2, 2, 3]))
    wheels = draw(axle(count))
    free = draw(st.lists(st.sampled_from(["steered", "steered", "castor", "swedish", "swedish", "spherical"]),
                         min_size=0 if count else 2, max_size=4))  # fmt: skip
    wheels += [draw(wheel(kind)) for kind in free]
    order = draw(st.permutations(range(len(wheels))))
    return {"wheels": [{"name": f"w{i}", **wheels[k]} for i, k in enumerate(order)], "couplings": []}


twists = st.tuples(decimals(-2, 2), decimals(-2, 2), decimals(-3, 3))
steers = decimals(-1.5, 1.5, 2)
