"""Section 6: from a twist to every joint."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.markdown import aligned, listed, math
from wmrgen.backends.report.steering import alike, partners, steering
from wmrgen.backends.report.subject import CAP, Subject, cut_note
from wmrgen.backends.report.tex import broken, poly, summands, terms_of
from wmrgen.backends.report.wheelrows import TWIST
from wmrgen.constraints import driving_row, sliding_row, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.project import Projection, project

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel

ONE, ZERO = Poly.of(1), Poly({})


def inverse(s: Subject) -> list[str]:
    """Section 6."""
    wheels = [w for w in s.letters.wheels[:CAP] if w.has_spin]
    projection = project(s.letters, s.mobility)
    blocks = [
        "## 6 Inverse kinematics",
        "Given the twist ξ, what must every joint do? Each wheel answers with its own rows of section 2.",
        *_projection(projection),
    ]
    twist = _driven(projection)
    if not wheels:
        return [*blocks, "There is no joint to command."]
    plain_wheels = [w for w in wheels if not w.turns]
    castors = [w for w in wheels if w.kind.swivels]
    steered = [w for w in wheels if w.kind.steers]
    if plain_wheels:
        blocks += ["The rolling equation of a wheel that does not steer, solved for its rate:"]
        blocks += aligned(f"{_rate(w)} &= {_sum(_spin(w, twist))}" for w in plain_wheels)
    if castors:
        blocks += ["A castor follows: its rolling row gives the wheel rate, its sliding row the swivel rate."]
        blocks += aligned(line for w in castors for line in _castor(w, twist))
    if steered:
        blocks += steering(s, steered, twist)
    return [*blocks, *_coupled(s, twist), *cut_note(s), *_slip(s, projection, twist)]


def _sum(p: Poly) -> str:
    return broken(summands(terms_of(p)))


def _rate(w: Wheel, joint: str = "spin") -> str:
    return notation.port(f"{w.name}.{joint}")


def _spin(w: Wheel, twist: Row) -> Poly:
    g = working_view(w)
    return dot(driving_row(w, g), twist) * g.rolling_radius.inverse()


def _castor(w: Wheel, twist: Row) -> list[str]:
    g = working_view(w)
    slide = dot(sliding_row(w, g).row, twist) * g.d.inverse()
    return [f"{_rate(w)} &= {_sum(_spin(w, twist))}", f"{_rate(w, 'steer_rate')} &= {_sum(-slide)}"]


def _driven(projection: Projection) -> Row:
    """The twist that is driven; components that the projection changed carry a star."""
    parts = [
        p if p == q or not p else Poly.gen("input", f"{n}_driven")
        for p, q, n in zip(projection.twist, TWIST, notation.TWIST, strict=True)
    ]
    return parts[0], parts[1], parts[2]


def _projection(projection: Projection) -> list[str]:
    """The nearest admissible twist, where it is not the commanded one."""
    if projection.twist == TWIST:
        return []
    changed = [
        f"{notation.port(n)}^{{*}} &= {_sum(p)}"
        for p, q, n in zip(projection.twist, TWIST, notation.TWIST, strict=True)
        if p != q
    ]
    return [
        "Not every ξ is admissible. The part that the wheels forbid is taken away first, and the rest is driven:",
        *aligned(changed),
    ]


def _coupled(s: Subject, twist: Row) -> list[str]:
    """What couplings change."""
    blocks, same = [], []
    for joint, members in s.robot.couplings:
        if joint == "spin":
            blocks += [
                f"{listed(members)} turn at one speed: they share the least-squares rate Σ r·(r φ̇) / Σ r² of the "
                f"single solutions above.{_way(s, members)}"
            ]
        elif alike([s.letters.wheel(n) for n in members], twist):
            same.append(listed(members))
        else:
            blocks += [
                f"{listed(members)} share one angle that need not suit all: the one that leaves least sliding "
                "turns by half of atan2(Σ 2 u w, Σ (u² − w²)), the sums over the wheels seen from the first of "
                "them."
            ]
    if same:
        blocks += [f"{'; '.join(same)} share one angle, and the formula gives the same ψ⁺ for each."]
    return blocks


def _way(s: Subject, members: tuple[str, ...]) -> str:
    """How a steered wheel among wheels with one speed picks its heading."""
    steered = [n for n in members if s.letters.wheel(n).kind.steers]
    if (
        not steered
        or s.robot.steer_group[s.robot.wheel(members[0]).index]
        == s.robot.steer_group[s.robot.wheel(members[-1]).index]
    ):
        return ""
    return f" Of its two headings {listed(steered)} takes the one that rolls the way the others do."


def _slip(s: Subject, projection: Projection, twist: Row) -> list[str]:
    unlike = _unlike(s, twist)
    said = _forbidden(projection, bool(unlike))
    if unlike:
        said += [
            f"A common rate need not suit all wheels of a coupling. Of {'; of '.join(map(listed, unlike))} the mean "
            "square of what it leaves over, r φ̇ against the rim speed of each wheel, or d β̇ against its sideways "
            "speed, is added under the root."
        ]
    held = [w.name for w in s.letters.wheels if w.kind.steers and _held(s, w, twist)]
    if not held:
        return said
    return [
        *said,
        "A steered wheel that a limit or a coupling keeps from its heading slides as well, at w cos Δ − u sin Δ. "
        f"The mean square of these speeds over {listed(held)} is added under the root.",
    ]


def _held(s: Subject, w: Wheel, twist: Row) -> bool:
    """True when the wheel's command may differ from the heading that rolls."""
    return s.robot.limit(w, "steer") is not None or not alike(partners(s, w), twist)


def _unlike(s: Subject, twist: Row) -> list[list[str]]:
    """Coupled wheels whose common spin or swivel rate may leave something to sliding (see `turned_unlike`)."""
    castors = s.letters.together("steer", (w for w in s.letters.wheels if w.kind.swivels))
    spun = s.letters.together("spin", (w for w in s.letters.wheels if w.has_spin))
    spun = [
        wheels
        for wheels in spun
        if any(w.turns for w in wheels)
        and not (all(w in partners(s, wheels[0]) for w in wheels) and alike(wheels, twist))
    ]
    return [[w.name for w in wheels] for wheels in (*castors, *spun) if len(wheels) > 1]


def _forbidden(projection: Projection, coupled: bool) -> list[str]:
    forms = [p for p in projection.residuals if p]
    if not forms and coupled:
        return []
    if not forms:
        return ["Every twist is admissible, so `slip`, the distance to the nearest admissible twist, is 0."]
    words = "`slip` is the sideways speed [m/s] that the commanded twist would force on the contact points"
    if projection.twist == TWIST:
        words += "; nothing is projected away here, the wheels follow as well as they can"
    if len(forms) == 1:
        return [f"{words}:", *math(rf"\mathrm{{slip}} = \left|{poly(forms[0])}\right|")]
    squares = Counter(rf"\left({poly(p)}\right)^2" for p in forms)
    parts = [text if n == 1 else rf"{n}\,{text}" for text, n in squares.items()]
    shown = " + ".join([*parts[:4], *([r"\cdots"] if len(parts) > 4 else [])])
    weight = "" if projection.weight == 1 else rf"{poly(Poly.of(projection.weight))}\left[ {shown} \right]"
    return [
        f"{words}, root mean square over the wheels:",
        *math(rf"\mathrm{{slip}} = \sqrt{{{weight or shown}}}"),
    ]
