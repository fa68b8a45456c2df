"""What ``slip`` of ``inverse`` is made of: what wheels forbid, what limits and couplings leave to sliding."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from wmrgen.analysis.kinematics.least_squares import Projection
from wmrgen.analysis.kinematics.steer import NARROW, turning_points
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.evaluate import fix, sqrt_poly
from wmrgen.geometry.exact.poly import Gen, Poly, Row
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.sections.closed import moves_as_partners, turned_apart
from wmrgen.report.sections.latex import latex
from wmrgen.report.sections.letters import multiples, squares
from wmrgen.report.sections.markdown import aligned, code, listed, math
from wmrgen.report.sections.terms import width

_ROOT = 100  # glyphs under a root
_MANY = 12  # lines of sums that stand under one


def narrow_wheels(robot: Robot, wheels: list[Wheel], twist: Row) -> list[Wheel]:
    """Wheels whose limits leave one heading at most."""
    limits = [(w, robot.limit(w, "steer")) for w in wheels if moves_as_partners(robot, w, twist)]
    return [w for w, limit in limits if limit and limit.high - limit.low <= NARROW]


def _may_be_cut(robot: Robot, w: Wheel) -> bool:
    limits = robot.limit(w, "steer")
    return limits is not None and turning_points(limits) != limits


def left_by_couplings(robot: Robot, twist: Row) -> dict[str, str]:
    """Squares that add to slip², and what they are of: what common rates leave to sliding."""
    unlike = turned_apart(robot, twist)
    if not unlike:
        return {}
    castors = any(robot.wheel(n).kind.swivels for names in unlike for n in names)
    swivels = ", or between d ψ̇ and its sideways speed" * castors
    return {
        r"\sum \varepsilon^2": "ε, what a common rate leaves between r φ̇ and the rim speed "
        f"of a coupled wheel{swivels}, summed over {' and over '.join(map(listed, unlike))}"
    }


def left_by_steering(robot: Robot, twist: Row) -> dict[str, str]:
    """The same of steered wheels that limits or couplings keep from their heading."""
    steered = [w for w in robot.wheels if w.kind.steers]
    limited = [w for w in steered if _may_be_cut(robot, w)]
    shared = [w for w in steered if not moves_as_partners(robot, w, twist)]
    held = [w.name for w in steered if w in limited or w in shared]
    if not held:
        return {}
    cut = {w.name for w in narrow_wheels(robot, steered, twist)}
    ways = ((not cut.issuperset(held), "w cos Δ − u sin Δ with Δ = ψ⁺ − ψ"), (cut, "(q − p t) / √(1 + t²)"))
    speed = " or ".join(text for there, text in ways if there)
    why = " or ".join(text for there, text in ((limited, "a limit"), (shared, "a coupling")) if there)
    which = code(held[0]) if len(held) == 1 else "a steered wheel"
    summed = f", summed over {listed(held)}" * (len(held) > 1)
    return {
        r"\sum v_\perp^2"
        if summed
        else r"v_\perp^2": f"v<sub>⊥</sub> = {speed}, the speed across {which} where "
        f"{why} keeps it from the heading that rolls{summed}"
    }


def slip(
    projection: Projection, steered: bool, couplings: Mapping[str, str], steering: Mapping[str, str]
) -> list[str]:
    """What `slip` is made of: ``couplings`` and ``steering`` leave their parts."""
    forms, more = forms_of(projection), {**couplings, **steering}
    forced = "that the commanded twist would force on the contact points"
    follow = ["Nothing is taken away from the twist here: the wheels follow as well as they can."]
    blocks = follow if forms and projection.twist == XI else []
    if not forms and not couplings:
        blocks = [_admissible(steered, bool(steering))]
    if more:
        then = "Then " if blocks and not forms else ""
        sums, mean = _mean_square(projection)
        parts = {mean: f"the sliding speed {forced}"} | more if forms else more
        return [
            *blocks,
            f"{then}`slip` [m/s] is made of {', and of '.join(parts.values())}:",
            *_root(sums, " + ".join(parts)),
        ]
    if not forms or (forms in ([XI[0]], [XI[1]]) and projection.twist != XI):  # said where it is taken away
        return blocks
    words = f"`slip` is the sliding speed [m/s] {forced}"
    if len(forms) == 1:
        times = fix(sqrt_poly(Poly.of(projection.weight)), {})
        return [*blocks, f"{words}:", *math(rf"\mathrm{{slip}} = \left|{latex(times * forms[0])}\right|")]
    return [*blocks, f"{words}, root of the sum of squares:", *_root(*_mean_square(projection))]


def _root(sums: list[str], total: str) -> list[str]:
    """slip as the root of a total, with the lines of sums that are too wide to stand under it."""
    if not sums:
        return math(rf"\mathrm{{slip}} = \sqrt{{{total}}}")
    return aligned(
        [*sums[:_MANY], *[r"&\vdots"] * (len(sums) > _MANY), rf"\mathrm{{slip}} &= \sqrt{{{total}}}"]
    )


def _mean_square(projection: Projection) -> tuple[list[str], str]:
    """What the admissible twist leaves of the commanded one; lines that name the sums in it, where they are wide."""
    forms, sums = forms_of(projection), list[str]()
    counts = squares(forms)
    if width(" + ".join(counts)) > _ROOT:
        sums = [rf"s_{{{k}}} &= {latex(p)}" for k, p in enumerate(dict.fromkeys(forms), 1)]
        counts = Counter({rf"s_{{{k}}}^2": n for k, n in enumerate(counts.values(), 1)})
    each = min(counts.values()) if len(set(counts.values())) == 1 else 1
    parts = multiples(counts, each)
    mean = " + ".join([*parts[:_MANY], *[r"\cdots"] * (len(parts) > _MANY)])
    if projection.weight * each == 1:
        return sums, mean
    factor = latex(Poly.of(projection.weight * each))
    return sums, rf"{factor}\left[ {mean} \right]" if len(parts) > 1 else rf"{factor}\,{mean}"


def _admissible(steered: bool, held: bool) -> str:
    """No fixed axle forbids a twist."""
    if not steered:
        return "Every twist is admissible, so `slip`, the distance to the nearest admissible twist, is 0."
    unless = ", unless a limit or a coupling keeps a wheel from its angle" if held else ""
    return (
        "At given steering angles not every twist is admissible, but for every twist there are angles at which it is. "
        f"`inverse` asks for these, so `slip`, the distance to the nearest admissible twist, is 0{unless}."
    )


def _root_of_square(g: Gen) -> Poly | None:
    """n x, whose sign does not matter, for the root of n² x²."""
    if g.kind != "sqrt" or len(g.args[0].terms) > 1:
        return None
    ((square, number),) = g.args[0].terms.items()
    root = sqrt_poly(Poly.of(number)).constant
    if root is None or any(e % 2 for _, e in square):
        return None
    return Poly({tuple((h, e // 2) for h, e in square): root})


def forms_of(projection: Projection) -> list[Poly]:
    """What is squared, each with the sign that it is read with."""
    forms = [p if len(p.terms) > 1 else p.substitute(_root_of_square) for p in projection.residuals if p]
    return [-p if latex(p).startswith("-") else p for p in forms]
