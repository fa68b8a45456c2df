"""Can the sliding equations be integrated? The test of Frobenius, written out."""

from __future__ import annotations

from wmrgen.backends.report.markdown import aligned, listed
from wmrgen.backends.report.subject import CAP, Subject
from wmrgen.exact.number import Exact
from wmrgen.layout.records import Wheel


def integrability(s: Subject) -> list[str]:
    """c . curl c of the sliding rows in world coordinates, and what all rows do together."""
    wheels = [w for w in s.robot.wheels if w.kind.constrains]
    if not wheels:
        return []
    who = listed([w.name for w in wheels[:CAP]]) + (" and others" if len(wheels) > CAP else "")
    held = ", the steering angle held" if any(w.kind.steers for w in wheels) else ""
    values = {curl_product(w) for w in wheels}
    value = " or ".join(f"{float(v):g}" for v in sorted(values, key=float))
    return [
        "Integrability:",
        "",
        f"The sliding row of {who} is c(q) q̇ = 0 in the coordinates q = (x, y, θ) of the world{held}, with h the "
        "wheel's heading and k the third entry of its row. Frobenius asks for c · curl c:",
        *aligned([
            r"c &= \begin{bmatrix} -\sin(\theta+h) & \cos(\theta+h) & k \end{bmatrix}",
            r"\mathrm{curl}\,c &= \begin{bmatrix} \sin(\theta+h) & -\cos(\theta+h) & 0 \end{bmatrix}",
            rf"c\cdot\mathrm{{curl}}\,c &= -\sin^2(\theta+h) - \cos^2(\theta+h) = {value}",
        ]),
        "It is not zero, so none of these equations alone is the derivative of a condition on the pose (Tzafestas "
        "(2.25)). " + _together(s),
        "",
    ]  # fmt: skip


def curl_product(w: Wheel) -> Exact:
    """c . curl c of a wheel's sliding row, exact: c = R(theta)^T (-sin h, cos h) and its third entry is constant."""
    g = w.nominal
    return -(g.ch * g.ch + g.sh * g.sh)


def _together(s: Subject) -> str:
    m = s.mobility
    if m.ddof == 0:
        return "Together they forbid all motion."
    if m.holonomic:
        return (
            "Together they can be integrated all the same: the brackets of the motions left over give nothing "
            f"new, DOF = DDOF = {m.dof}."
        )
    return f"Nor can they together: brackets of the motions left over reach {m.dof} dimensions, DDOF is {m.ddof}."
