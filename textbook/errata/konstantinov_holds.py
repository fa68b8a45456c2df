"""Equations of Konstantinov that hold as printed."""

from __future__ import annotations

from functools import partial

import sympy

from textbook.errata import engine
from textbook.errata.claims import claim
from textbook.errata.forms import symbol
from textbook.errata.konstantinov import (
    E_I,
    LAMBDA,
    N_I,
    RATES,
    TEXT,
    M,
    a,
    angle,
    cos,
    phi,
    phi_i,
    phid,
    r,
    sin,
    sqrt,
    theta,
    w,
    wheel_row,
    x,
    xd,
    y,
    yd,
)  # fmt: skip
from textbook.errata.records import Record
from textbook.transforms import world_to_robot_rows
from wmrgen.symbolic import Expr

BODY = M.vstack(*(wheel_row(i) for i in (1, 2, 3))).xreplace({phi: sympy.S.Zero})
TWIST = world_to_robot_rows(phi).T * engine.inverse(BODY) * (r * M(w))  # world velocity from wheel speeds
PLACES = [M([x + a * cos(angle(i)), y + a * sin(angle(i))]) for i in (1, 2, 3)]
HUBS = [M([xd, yd]) + sympy.diff(p, phi) * phid for p in PLACES]
E = [M([[sin(angle(i)), -cos(angle(i))]]) for i in (1, 2, 3)]
N = [M([[cos(angle(i)), sin(angle(i))]]) for i in (1, 2, 3)]
U = [(E[k] * HUBS[k])[0] * E[k].T for k in range(3)]
W = [(N[k] * HUBS[k])[0] * N[k].T for k in range(3)]
V3 = M([xd, yd])
STEP = 2 * sympy.pi / 3
HUB_I = V3 + a * phid * M([-sin(phi_i), cos(phi_i)])
MU1 = TWIST[0] * cos(phi) + TWIST[1] * sin(phi)
TIME, W0, SPEED, PHI0, X0, Y0 = (symbol(n) for n in ("t", r"\omega_0", "v", r"\phi_0", "x_0", "y_0"))
PSI = [symbol(rf"\psi_{k}") for k in (1, 2, 3)]


def _drive(k: int) -> Expr:
    """lambda_k / r by wmrgen's rolling row."""
    return (wheel_row(k) * RATES)[0] / r


holds = partial(claim, TEXT)  # a claim of this text

HEADING = PHI0 - W0 * TIME  # with constant wheel speeds
CENTRE = (X0 + SPEED / W0 * sin(PHI0 + theta), Y0 - SPEED / W0 * cos(PHI0 + theta))
RADIUS = SPEED / W0
STRAIGHT = {w[2]: -w[0] - w[1]}

HOLDS: tuple[Record, ...] = (
    holds("(1)", "wheel 2 stands at distance a in direction φ + 120°: wmrgen's layout, turned by φ",
          ("x_2", x + a * cos(angle(2)), x + a * (cos(phi) * cos(STEP) - sin(phi) * sin(STEP))),
          ("y_2", y + a * sin(angle(2)), y + a * (sin(phi) * cos(STEP) + cos(phi) * sin(STEP)))),
    holds("vᵢ²", "square of the hub's velocity, (1) differentiated",
          ("v_i^2", xd**2 + yd**2 + a**2 * phid**2 - 2 * a * phid * (xd * sin(phi_i) - yd * cos(phi_i)),
           (HUB_I.T * HUB_I)[0]), remark="The next line, “vᵢ² = ẋ² + ẏ²”, is to be read as v² = ẋ² + ẏ²."),
    holds("(3)", "components of the hub's velocity along e and n",
          (r"\lambda_i", LAMBDA, (E_I * HUB_I)[0]), (r"\mu_i", xd * cos(phi_i) + yd * sin(phi_i), (N_I * HUB_I)[0])),
    holds("sums", "hub velocities and their components, added over the three wheels",
          ("v_1+v_2+v_3", 3 * V3, HUBS[0] + HUBS[1] + HUBS[2]),
          (r"\sum u_i", sympy.Rational(3, 2) * V3, U[0] + U[1] + U[2]),
          (r"\sum w_i", sympy.Rational(3, 2) * V3, W[0] + W[1] + W[2])),
    holds("(4)", "wmrgen's rolling rows; in detail for ω₂ and ω₃",
          *((rf"\omega_{i}", (xd * sin(angle(i)) - yd * cos(angle(i)) - a * phid) / r, _drive(i)) for i in (2, 3)),
          remark="“ω = ψ̇ᵢ” is to be read as ωᵢ = ψ̇ᵢ."),
    holds("(5)", "wmrgen's rolling rows, solved",
          (r"\dot{\phi}", -r / (3 * a) * sum(w), TWIST[2]),
          (r"\dot{x}", 2 * r / 3 * sum(w[k] * sin(angle(k + 1)) for k in range(3)), TWIST[0]),
          (r"\dot{y}", -2 * r / 3 * sum(w[k] * cos(angle(k + 1)) for k in range(3)), TWIST[1])),
    holds("(6)", "(5) integrated: the rate of the right-hand side along ψ̇ᵢ = ωᵢ is φ̇",
          (r"\dot{\phi}", sympy.Add(*(sympy.diff(PHI0 - r / (3 * a) * sum(PSI), p) * s
                                      for p, s in zip(PSI, w, strict=True))), TWIST[2]),
          remark="A holonomic relation between φ and the wheel angles."),
    holds("μᵢ", "component along n of the velocity solved from wmrgen's rows",
          (r"\mu_1", r / sqrt(3) * (w[1] - w[2]), MU1)),
    holds("constant wheel speeds, φ", "rate of φ₀ − ω₀ t with ω₀ = r Ω/(3a), against (5)",
          (r"\dot{\phi}", sympy.diff(HEADING, TIME).xreplace({W0: r * sum(w) / (3 * a)}), TWIST[2])),
    holds("case Ω = 0", "v² at ω₁ + ω₂ + ω₃ = 0 from wmrgen's rows",
          ("v^2", 4 * r**2 * (w[0] ** 2 + w[0] * w[1] + w[1] ** 2) / 3,
           (TWIST[0] ** 2 + TWIST[1] ** 2).xreplace(STRAIGHT))),
    holds("x_C, y_C", "centre of the circle: the start, v/ω₀ to the right of the velocity at φ₀ + θ (turning at −ω₀)",
          ("x_C", CENTRE[0], X0 + RADIUS * cos(PHI0 + theta - sympy.pi / 2)),
          ("y_C", CENTRE[1], Y0 + RADIUS * sin(PHI0 + theta - sympy.pi / 2))),
)  # fmt: skip
