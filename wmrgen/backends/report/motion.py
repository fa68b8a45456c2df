"""Section 8: odometry along an arc, and the posture model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.latex import broken
from wmrgen.backends.report.letters import in_wheel_speeds
from wmrgen.backends.report.markdown import aligned, code
from wmrgen.exact.poly import Poly
from wmrgen.ports import TWIST_NAMES

if TYPE_CHECKING:
    from wmrgen.robot import Derivation


def motion(d: Derivation) -> list[str]:
    """Section 8."""
    return [
        "## 8 Odometry and the posture model",
        "A constant twist moves P along an arc (`odometry`). Its chord points along the heading half-way through, and "
        "is shorter than the arc by the factor sinc σ, for which near σ = 0 the code has a series "
        "([numerics.md](numerics.md)). The pose after Δt is exactly",
        *aligned([
            r"x' &= x + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\cos(\theta+\sigma) - v_y\sin(\theta+\sigma)\right)",
            r"y' &= y + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\sin(\theta+\sigma) + v_y\cos(\theta+\sigma)\right)",
            r"\theta' &= \theta + \omega\,\Delta t, \qquad "
            r"\mathrm{sinc}(\sigma) = \frac{\sin\sigma}{\sigma}, \qquad \sigma = \frac{\omega\,\Delta t}{2}",
        ]),
        *_posture(d),
    ]  # fmt: skip


def _posture(d: Derivation) -> list[str]:
    columns = d.mobility.scaled
    if not columns:
        return ["Nothing can move without sliding, so the posture model is empty: all rates are 0."]
    etas = [Poly.gen("input", f"eta{k}") for k in range(1, len(columns) + 1)]
    rates = [Poly.sum(c[i] * eta for c, eta in zip(columns, etas, strict=True)) for i in range(3)]
    steering = " and ".join(code(n) for n in d.mobility.basis_wheels)
    rates_of = "dψ<sub>i</sub>/dt = ψ̇<sub>i</sub>"
    general = [
        "The continuous model that a predictive controller integrates (`dynamics`) is d(x, y, θ)/dt = R(θ)ᵀ N η"
        + (f" and {rates_of}" if steering else "")
        + ". Its inputs are the coordinates η of the twist in the null space"
        + (" and the steering rates." if steering else ".")
    ]
    in_eta = [
        "With the values of section 1, columns scaled as in `dynamics`, so that η are speeds, [m/s] or, of a rotation "
        "whose centre no angle moves, [rad/s]:",
        *aligned(f"{notation.port(n)} &= {broken(p)}" for n, p in zip(TWIST_NAMES, rates, strict=True)),
    ]
    states = (
        f"where the steering of {steering} is the state; any other steered wheel follows through `inverse`."
    )
    return [*general, *(in_wheel_speeds(d) or in_eta), *([states] if steering else [])]
