"""Equations of AA274, lecture 1, that hold as printed."""

from __future__ import annotations

import sympy

from textbook.errata import engine
from textbook.errata.aa274 import TEXT, M, cos, sin, u1, xi
from textbook.errata.claims import book, claim
from textbook.errata.forms import symbol
from textbook.errata.records import Record
from textbook.transforms import world_to_robot_rows

ZERO, ONE = sympy.S.Zero, sympy.S.One
theta, xd, yd, thd, v, omega = (
    symbol(n) for n in (r"\theta", r"\dot{x}", r"\dot{y}", r"\dot{\theta}", "v", r"\omega")
)
TURN = world_to_robot_rows(theta)
SLIDE = engine.wheel(ZERO, ZERO, ZERO)[1]
UNICYCLE = book("unicycle", theta=theta, v=v, omega=omega)
REDUCED = book("car_reduction", u1=u1, xi=xi, wheelbase=ONE)
TRICYCLE = M([cos(xi) * cos(theta), cos(xi) * sin(theta), sin(xi)]) * u1

HOLDS: tuple[Record, ...] = (
    claim(TEXT, "no slip disk", "−1 times wmrgen's sliding row at P, in world coordinates",
          (r"[\dot{x}\;\dot{y}]\cdot(\sin\theta,-\cos\theta)", xd * sin(theta) - yd * cos(theta),
           -(SLIDE * TURN * M([xd, yd, thd]))[0])),
    claim(TEXT, "unicycle", "the library's unicycle, Tzafestas (2.28)",
          (r"\dot{x}", v * cos(theta), UNICYCLE["x_rate"]), (r"\dot{y}", v * sin(theta), UNICYCLE["y_rate"]),
          (r"\dot{\theta}", omega, UNICYCLE["theta_rate"])),
    claim(TEXT, "simple car", "the tricycle with v = u₁ cos ξ, ω = u₁ sin ξ is the unicycle",
          (r"\dot{q}", TRICYCLE,
           M([UNICYCLE[k] for k in ("x_rate", "y_rate", "theta_rate")]).xreplace(
               {v: REDUCED["v"], omega: u1 * sin(xi)}))),
)  # fmt: skip
