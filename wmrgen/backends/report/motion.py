"""Section 8: odometry and the posture model."""

from __future__ import annotations

from wmrgen.backends.report.markdown import aligned, code, math
from wmrgen.backends.report.subject import Subject
from wmrgen.backends.report.tex import broken, summands, terms_of
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.odometry import SWITCH, WORST_ERROR
from wmrgen.notation import TWIST, decimal, port


def motion(s: Subject) -> list[str]:
    """Section 8."""
    return ["## 8 Odometry and the posture model", *_odometry(), *_posture(s)]


def _odometry() -> list[str]:
    switch = rf"\frac{{{SWITCH.numerator}}}{{{SWITCH.denominator}}}"
    return [
        "A constant twist moves P along an arc. Its chord points along the heading half-way through, and is "
        "shorter than the arc by sin h / h. With h = ω Δt / 2 the pose after Δt is exactly",
        *aligned([
            r"x' &= x + \Delta t\,\mathrm{sinc}(h)\left(v_x\cos(\theta+h) - v_y\sin(\theta+h)\right)",
            r"y' &= y + \Delta t\,\mathrm{sinc}(h)\left(v_x\sin(\theta+h) + v_y\cos(\theta+h)\right)",
            r"\theta' &= \theta + \omega\,\Delta t",
        ]),
        "Near h = 0 the quotient is replaced by its series, which makes the step smooth through ω = 0:",
        *math(
            r"\mathrm{sinc}(h) = \begin{cases} 1 - \frac{h^2}{6} + \frac{h^4}{120} - \frac{h^6}{5040}",
            rf"& |h| < {switch} \\[4pt] \frac{{\sin h}}{{h}} & \mathrm{{else}} \end{{cases}}",
        ),
        "The first term left out is h⁸/9!, so the worst error is",
        *math(rf"\frac{{1}}{{9!}}\left({switch}\right)^8 = {decimal(float(f'{WORST_ERROR:.2e}'))},"),
        "half a unit in the last place of a double.",
    ]  # fmt: skip


def _posture(s: Subject) -> list[str]:
    columns = s.mobility.null_space
    if not columns:
        return ["Nothing can move without sliding, so the posture model is empty: all rates are 0."]
    etas = [Poly.gen("input", f"eta{k + 1}") for k in range(len(columns))]
    body = [sum((c[i] * e for c, e in zip(columns, etas, strict=True)), Poly({})) for i in range(3)]
    steering = s.mobility.basis_wheels
    blocks = [
        "The continuous model that a predictive controller integrates takes the coordinates η of the twist in the "
        "null space"
        + (" and the steering rates" if steering else "")
        + " as inputs:",
        *math(r"\frac{d}{dt}\begin{bmatrix} x \\ y \\ \theta \end{bmatrix} = R(\theta)^T N\,\eta"
              + (r", \qquad \frac{d}{dt}\psi_i = \dot{\psi}_i" if steering else "")),
        "Here, with the values of section 1 put in,",
        *aligned(f"{port(n)} &= {broken(summands(terms_of(p)))}" for n, p in zip(TWIST, body, strict=True)),
    ]  # fmt: skip
    if steering:
        blocks += [
            f"where the steering of {' and '.join(code(n) for n in steering)} is the state; any other steered "
            "wheel follows through `inverse`."
        ]
    return blocks
