"""Steering and turning circle of a car: Ackermann's rule, the radius (Tzafestas (2.49)-(2.51))."""

from __future__ import annotations

from wmrgen import notation
from wmrgen.backends.report.latex import latex
from wmrgen.backends.report.markdown import aligned, plain
from wmrgen.backends.report.texts import car
from wmrgen.constraints import symbolic_view
from wmrgen.layout.records import Robot


def circle(robot: Robot) -> list[str]:
    """The turning circle of a robot with a fixed axle through P and one or two wheels in front that steer."""
    steered = [w for w in robot.wheels if w.kind.steers]
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rollers]
    if (
        len(steered) not in (1, 2)
        or robot.couplings
        or not car(robot, wheels)
        or any(w.heading for w in steered)
    ):
        return []
    right, left = (
        min(steered, key=lambda w: float(w.nominal.y)),
        max(steered, key=lambda w: float(w.nominal.y)),
    )
    psi_r, psi_l = (notation.port(f"{w.name}.steer") for w in (right, left))
    base, track = left.nominal.x, left.nominal.y - right.nominal.y
    length = " = ".join(dict.fromkeys(["L", latex(symbolic_view(left).x), plain(base)]))
    radius = rf"&= \frac{{\omega\,L}}{{v_x}} = \frac{{L}}{{R}}, \qquad {length}"
    words = "P turns on a circle of radius R, to the left where R > 0, with v<sub>x</sub> = ω R"
    behind = ", and L is negative, for it steers behind P" if base.sign < 0 else ""
    if len(steered) == 1:
        return [f"{words}{behind}:", *aligned([rf"\tan{psi_l} {radius}"])]
    ratio = rf"\frac{{\mathrm{{track}}}}{{\mathrm{{wheelbase}}}} = {notation.decimal(float(track / base))}"
    return [
        f"{words}. The axles of both steered wheels pass through its centre (Ackermann), ψ is the angle of the virtual "
        f"wheel midway{behind}:",
        *aligned([rf"\tan\psi {radius}", rf"\cot{psi_r} - \cot{psi_l} &= {ratio}"]),
    ]
