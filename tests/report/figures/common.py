"""Figures read back: elements by class, panels, and the boxes of words by an estimate of their widths."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache

from tests.robots import of_gallery, of_text
from wmrgen.derivation.facade import Derivation

SVG = "{http://www.w3.org/2000/svg}"
FILES = ("layout.svg", "symbols.svg", "contact.svg", "motion.svg", "singular.svg", "reach.svg", "wiring.svg")
Box = tuple[float, float, float, float]
Point = tuple[float, float]

PAIR = """\
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""
FRONT = "  - {{name: front, type: steered, x: 0.5, y: 0, heading: {}, r: 0.1}}\n"
THREE = "".join(
    f"  - {{name: s{k}, type: steered, x: {x}, y: {y}, heading: {h}, r: 0.05}}\n"
    for k, (x, y, h) in enumerate(((0.3, 0.0, 0), (-0.2, 0.25, 1), (-0.2, -0.25, -2)))
)
CASTOR = "  - {{name: castor, type: castor, x: -0.3, y: 0, heading: 0, d: {}, r: 0.05}}\n"


def mecanum(ahead: str = "0", left: str = "0") -> str:
    """Rollers in an X at the ground, about a point of the robot: they cannot turn it."""
    corners = ((0.2, 0.2, "pi/4"), (0.2, -0.2, "-pi/4"), (-0.2, 0.2, "-pi/4"), (-0.2, -0.2, "pi/4"))
    return "".join(
        f"  - {{name: m{k}, type: swedish, x: {x} + {ahead}, y: {y} + {left}, heading: 0, gamma: {g}, r: 0.05}}\n"
        for k, (x, y, g) in enumerate(corners)
    )


MECANUM = mecanum()


def many(count: int, name: str = "w{}", r: float = 0.05) -> str:
    return "".join(
        f"  - {{name: {name.format(k)}, type: steered, l: 2, alpha: 2*pi*{k}/{count}, beta: 0, r: {r}}}\n"
        for k in range(count)
    )


ODD = {
    "64 wheels": many(64),
    "64 long names": many(64, "a_wheel_of_a_long_name_{}"),
    "8 long names": many(8, "a_wheel_of_a_very_long_name_{}_x"),
    "millimetre": PAIR.replace("0.2", "0.0005").replace("r: 0.1", "r: 0.0001"),
    "ten kilometres": PAIR.replace("0.2", "5000") + FRONT.format(0).replace("0.5", "10000"),
    "huge wheels": PAIR.replace("r: 0.1", "r: 30"),
    "one place": "".join(
        f"  - {{name: w{k}, type: steered, x: 0, y: 0, heading: 0, r: 0.1}}\n" for k in range(5)
    ),
    "one place off P": "".join(
        f"  - {{name: w{k}, type: fixed, x: 3, y: 1, heading: 0, r: 0.1}}\n" for k in range(3)
    ),
    "far from P": "".join(
        f"  - {{name: w{k}, type: fixed, x: 3000, y: {k}, heading: 0, r: 0.1}}\n" for k in range(2)
    ),
    "cannot move": PAIR
    + "  - {name: across, type: fixed, x: 0.5, y: 0.1, heading: 1, r: 0.1}\n" * 1
    + "  - {name: more, type: fixed, x: -0.7, y: 0.3, heading: 2, r: 0.1}\n",
    "mecanum X": MECANUM,
    "balls without radius": "".join(
        f"  - {{name: ball{k}, type: spherical, x: {x}, y: 0.1}}\n" for k, x in enumerate((0.1, -0.2, 0.3))
    ),
    "one ball": "  - {name: ball, type: spherical, x: 0, y: 0}\n",
    "castor": PAIR + CASTOR.format(0.1),
    "three": THREE,
}


def robot(wheels: str, more: str = "") -> Derivation:
    return of_text(f"wmrgen: 1\nname: sample\n{more}wheels:\n{wheels}")


def parsed(d: Derivation, file: str = "layout.svg") -> ET.Element:
    return ET.fromstring(d.figures[file][1])


@cache
def page(name: str, file: str = "layout.svg") -> ET.Element:
    return parsed(of_gallery(name), file)


def of_class(root: ET.Element, name: str) -> list[ET.Element]:
    return [e for e in root.iter() if name in e.attrib.get("class", "").split()]


def numbers(e: ET.Element, *keys: str) -> list[float]:
    return [float(e.attrib[key]) for key in keys]


def points(e: ET.Element) -> list[Point]:
    return [tuple(map(float, p.split(","))) for p in e.attrib["points"].split()]  # type: ignore[misc]


def panels(root: ET.Element) -> list[tuple[ET.Element, float, Point]]:
    """Groups that show the plane: scale [px/m] and the origin of its frame on paper."""
    shown = []
    for g in root.iter(f"{SVG}g"):
        if "data-scale" in g.attrib:
            x, y = map(float, g.attrib["data-origin"].split(","))
            shown.append((g, float(g.attrib["data-scale"]), (x, y)))
    return shown


def words(root: ET.Element) -> Iterator[tuple[str, Box]]:
    """Every text with its box, as wide as in DejaVu Sans, the widest of the usual fonts."""
    for e in root.iter(f"{SVG}text"):
        classes, text = e.attrib["class"].split(), e.text or ""
        size = 14.0 if "letter" in classes else 12.0
        wide = size * sum(0.33 if c in " iljft.,:;|!'()" else 0.84 if c in "mwMWω=+−" else 0.62 for c in text)
        x, y = numbers(e, "x", "y")
        left = x - (wide / 2 if "middle" in classes else wide if "end" in classes else 0.0)
        yield text, (left, y - 0.75 * size, left + wide, y + 0.2 * size)


def apart(a: Box, b: Box) -> bool:
    return a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
