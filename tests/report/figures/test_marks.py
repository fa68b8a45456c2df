"""Marks of small robots: what each wheel bears, what the legend explains, dimensions and trailers."""

from __future__ import annotations

import math
import re

import pytest

from tests.report.figures.common import (
    CASTOR,
    FRONT,
    MECANUM,
    PAIR,
    SVG,
    THREE,
    numbers,
    of_class,
    page,
    panels,
    parsed,
    robot,
    words,
)  # fmt: skip
from wmrgen.derivation.facade import Derivation
from wmrgen.report.figures.marks import contact, extremes

# ---- marks


def test_marks_of_wheels() -> None:
    """A castor has an arm and the circle that it swivels over; a steered wheel without offset a pivot alone."""
    for wheels, arms, pivots, swivels in (
        (PAIR, 0, 0, 0),
        (PAIR + FRONT.format(0), 0, 1, 0),
        (PAIR + CASTOR.format(0.1), 1, 1, 1),
        (PAIR + FRONT.format(0).replace("r: 0.1", "r: 0.1, offset_y: 0.05"), 1, 1, 0),
        (THREE, 0, 3, 0),
    ):
        root = parsed(robot(wheels))
        groups = [g for g in root.iter(f"{SVG}g") if "data-wheel" in g.attrib]
        counts = [sum(len(of_class(g, name)) for g in groups) for name in ("arm", "pivot", "swivel")]
        assert counts == [arms, pivots, swivels], wheels
        assert len(of_class(root, "roll")) // 2 == len(groups) + 1, (
            "an arrow of each wheel, and in the legend"
        )


@pytest.mark.parametrize("heading", [0.0, 0.7, 2.0, -2.9])
def test_a_wheel_reaches_as_far_as_its_radius(heading: float) -> None:
    """Where it stands ahead and behind along its heading; a castor besides as far as its arm goes."""
    for w in robot(PAIR + CASTOR.format(0.1)).robot.wheels:
        x, y = contact(w, heading)
        *arm, ahead, behind = extremes(w, heading)
        rim = float(w.nominal.r) * math.cos(heading), float(w.nominal.r) * math.sin(heading)
        assert ahead == pytest.approx((x + rim[0], y + rim[1]))
        assert behind == pytest.approx((x - rim[0], y - rim[1]))
        for px, py in arm:
            assert abs(px - w.pivot.real) == pytest.approx(0.1 * w.kind.swivels)
            assert abs(py - w.pivot.imag) == pytest.approx(0.1 * w.kind.swivels)


def test_the_legend_explains_what_occurs_and_nothing_else() -> None:
    legends = {
        PAIR: ["fixed wheel, r = 0.1 m", "positive rolling"],
        PAIR + FRONT.format(0): ["fixed wheel, r = 0.1 m", "steered wheel, r = 0.1 m", "positive rolling", "pivot"],
        MECANUM: ["Swedish wheel, r = 0.05 m", "positive rolling", "roller axis at the ground"],
        "  - {name: ball, type: spherical, x: 0.3, y: 0, r: 0.02}\n" + PAIR.replace("r: 0.1", "r: 0.2", 1): [
            "fixed wheel, r = 0.1 m, 0.2 m", "spherical wheel, r = 0.02 m", "positive rolling",
        ],
    }  # fmt: skip
    for wheels, keys in legends.items():
        root = parsed(robot(wheels))
        assert sorted(e.text or "" for e in of_class(root, "key")) == sorted(keys)


def test_wheels_of_one_axle_share_a_line() -> None:
    three = PAIR + "  - {name: back, type: fixed, x: 0, y: -0.4, heading: pi, r: 0.1}\n"
    oblique = "".join(
        f"  - {{name: {n}, type: fixed, x: 0.1 - {k}*sin({h}), y: 0.3 + {k}*cos({h}), heading: {h}, r: 0.1}}\n"
        for n, k, h in (("a", 1, "pi/6"), ("b", 1, "7*pi/6"), ("c", 2, "-5*pi/6"))
    )
    for wheels, lines in ((three, 1), (oblique, 1), (PAIR + FRONT.format(0), 2)):
        assert len(of_class(parsed(robot(wheels), "motion.svg"), "axle")) == lines
    parallel = PAIR.replace("x: 0, y: -0.2", "x: 0.1, y: -0.2")
    assert len(of_class(parsed(robot(parallel), "motion.svg"), "axle")) == 2


# ---- dimensions and trailers


def sizes(d: Derivation) -> list[str]:
    return [text for text, _ in words(parsed(d)) if re.fullmatch(r"(track |l = )?[\d.]+ [mk]?m", text)]


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("0.001", ["0.5 mm", "track 0.4 mm"]), ("0.02", ["0.01 m", "track 8 mm"]), ("1", ["0.5 m", "track 0.4 m"]),
        ("45", ["22.5 m", "track 18 m"]), ("20000", ["10 km", "track 8000 m"]),
    ],
)  # fmt: skip
def test_dimensions_are_drawn_as_long_as_they_say(unit: str, said: list[str]) -> None:
    scaled = (PAIR + FRONT.format(0)).replace("0.2", f"0.2*{unit}").replace("0.5", f"0.5*{unit}")
    d = robot(scaled.replace("r: 0.1", f"r: 0.1*{unit}"))
    k = float(unit)
    assert sorted(sizes(d)) == sorted(said)
    root = parsed(d)
    ((_, scale, _),) = panels(root)
    ticks = [numbers(e, "x1", "y1", "x2", "y2") for e in of_class(root, "size") if e.tag == f"{SVG}line"]
    across = [t[0] for t in ticks if t[0] == t[2] and abs(t[3] - t[1]) == 8]
    upright = [t[1] for t in ticks if t[1] == t[3] and abs(t[2] - t[0]) == 8]
    assert max(across) - min(across) == pytest.approx(0.4 * k * scale, abs=0.03)
    assert max(upright) - min(upright) == pytest.approx(0.5 * k * scale, abs=0.03)


def test_wheels_on_a_circle_have_one_dimension() -> None:
    omni = "".join(
        f"  - {{name: w{k}, type: swedish, l: 0.25, alpha: 2*pi*{k}/3 + 0.3, beta: 0, r: 0.05}}\n"
        for k in range(3)
    )
    assert sizes(robot(omni)) == ["l = 0.25 m"]
    assert sorted(sizes(robot(MECANUM))) == ["0.4 m", "track 0.4 m"]


def test_a_track_is_that_of_wheels_side_by_side_that_roll_forward() -> None:
    """Whatever stands between them."""
    across = FRONT.format("pi/2")
    assert sorted(sizes(robot(PAIR + across))) == ["0.5 m", "track 0.4 m"]
    assert sorted(sizes(robot(PAIR.replace("y: 0.2, heading: 0", "y: 0.2, heading: 1") + across))) == [
        "0.4 m",
        "0.5 m",
    ]


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("axles", "said"),
    [
        ((-0.2, 0.5), ["0.2 m", "0.5 m"]), ((-0.3, 0.3), ["0.6 m"]), ((-0.3, 0.1, 0.3), ["0.2 m", "0.4 m"]),
        ((-0.1, 0.2, 0.6, 0.9), ["0.3 m", "0.3 m", "0.4 m"]), ((-0.4, -0.2, 0.0, 0.2, 0.4), ["0.8 m"]),
    ],
)  # fmt: skip
def test_each_distance_of_axles_is_told_once(axles: tuple[float, ...], said: list[str], way: int) -> None:
    """However many wheels stand on one; and that of P from both of two axles, where it lies nearer to one."""
    wheels = "".join(
        PAIR.replace("type: fixed, x: 0,", f"type: steered, x: {way * x},").replace("name: ", f"name: w{k}")
        for k, x in enumerate(axles)
    )
    assert sorted(sizes(robot(wheels))) == [*said, "track 0.4 m"]


def test_trailers_stand_behind_each_other() -> None:
    """Axles at 1.1 m and 2 m behind the rear axle of the car, which P stands on."""
    root = page("car_with_trailers")
    ((_, scale, (px, py)),) = panels(root)
    wheels = [
        numbers(e, "x", "y", "width", "height") for e in of_class(root, "trailer") if e.tag == f"{SVG}rect"
    ][:4]
    axles = sorted({round((y + h / 2 - py) / scale, 2) for _, y, _, h in wheels})
    assert axles == pytest.approx([1.1, 2.0], abs=0.02)
    assert sum(x + w / 2 - px for x, _, w, _ in wheels) == pytest.approx(0, abs=0.1)
    assert {"trailer1, 1.1 m", "trailer2, 0.9 m"} <= {text for text, _ in words(root)}
    cart = page("tractor_off_axle")
    ((_, scale, (_, py)),) = panels(cart)
    ys = [numbers(e, "y", "height") for e in of_class(cart, "trailer") if e.tag == f"{SVG}rect"][:2]
    assert [(y + h / 2 - py) / scale for y, h in ys] == pytest.approx([1.05, 1.05], abs=0.01)
