"""Section 9, singular configurations, and the last one, cost and files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen.backends.registry import BACKENDS
from wmrgen.backends.report.markdown import aligned, code, items, sentence, table
from wmrgen.backends.report.numbers import plain
from wmrgen.backends.report.subject import CAP, Subject, grouped
from wmrgen.backends.report.tex import Term, broken, summands, terms_of
from wmrgen.backends.report.wheelrows import TWIST
from wmrgen.bounds.robot import SINGULAR
from wmrgen.bounds.text import described, error, listed
from wmrgen.exact.number import ONE
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.cost import count

if TYPE_CHECKING:
    from wmrgen.backends.registry import Facts
    from wmrgen.mobility.records import Singularity


def singular(s: Subject) -> list[str]:
    """Section 9."""
    singularities = s.mobility.singularities
    blocks = ["## 9 Singular configurations"]
    if not singularities:
        return [*blocks, "There are none: no rank drops and no angle is undefined, whatever the robot does."]
    pivots = [f for f in singularities if f.kind == "icr_on_pivot"]
    if pivots:
        blocks += _pivots(s, pivots)
    for f in singularities:
        if f.kind != "icr_on_pivot":
            words = sentence(f.meaning[:1].upper() + f.meaning[1:]).removesuffix(".") + "."
            blocks += [f"{words} This happens where", *_conditions(f)] if f.conditions else [words]
    return blocks


def _pivots(s: Subject, pivots: list[Singularity]) -> list[str]:
    """A steered wheel whose pivot is the ICR."""
    wheels = [s.robot.wheel(f.wheels[0]) for f in pivots[:CAP]]
    places = grouped((f"({plain(w.nominal.x)}, {plain(w.nominal.y)})", w.name) for w in wheels)
    rows = [[", ".join(code(n) for n in who), place] for place, who in places.items()]
    blocks = [
        "A steered wheel whose pivot is the ICR stands still. Its heading is undefined there, and `inverse` holds "
        "the present angle. Close by, a small change of the twist asks for a large change of the angle. The "
        "condition is that the pivot's velocity vanishes,",
        *aligned([r"v_x - y\,\omega &= 0", r"v_y + x\,\omega &= 0"]),
        "with the ICR at",
        *table(["wheel", "(x, y)"], rows, "l"),
    ]
    return blocks + ([f"({len(pivots) - CAP} more wheels likewise.)"] if len(pivots) > CAP else [])


def _conditions(f: Singularity) -> list[str]:
    return aligned(f"{broken(summands(_bare(c)))} &= 0" for c in f.conditions)


def _bare(condition: Poly | Row) -> list[Term]:
    """The terms of a condition; a single one without its number, which does not matter."""
    terms = terms_of(condition if isinstance(condition, Poly) else dot(condition, TWIST))
    return [Term(ONE, t.factors) for t in terms] if len(terms) == 1 else terms


_TEXT = {
    "inverse": "twist to joints", "inverse_slip": "the sliding left, of the same twist",
    "forward": "joints to twist", "forward_slip": "the same with the residual",
    "odometry": "pose after a step", "dynamics": "rates of the posture model", "prepare": "once per calibration",
}  # fmt: skip


def _bounds(s: Subject) -> list[str]:
    """Proved ranges and rounding errors, or what the robot file must say for them."""
    bounds = s.derivation.bounds
    if bounds.missing:
        return [
            "Nothing is proved about ranges and rounding: the robot file has no limits of "
            f"{' and '.join(code(name) for name in bounds.missing)} (`wmrgen prove` says what to write)."
        ]
    blocks = [
        "Proved for all inputs within the limits of the robot file: no NaN, no infinity, no division by zero, and"
    ]
    rows = [
        [code(f.name), code(o.name), f"{o.low:.6g}", f"{o.high:.6g}", o.unit or "1", error(o)]
        for f in bounds.functions
        if f.proved
        for o in f.outputs
        if not o.singular
    ]
    blocks += table(
        ["function", "output", "at least", "at most", "unit", "rounding error at most"], rows, "llrrlr"
    )
    blocks += [
        f"The limits are {listed(bounds.declared)}. Inputs that have none: {listed(bounds.assumed)}. The error is "
        "that against the exact formula, comparisons decided as the code decides them "
        f"({described(bounds.library)}). h is the speed [m/s] of the pivot of the steered wheel, where it is "
        "defined at all."
    ]
    for f in bounds.functions:
        if not f.proved:
            why = "; ".join(f.alarms) or f"no range is known of {', '.join(code(n) for n in f.unknown)}"
            blocks += [f"Not proved: {code(f.name)} ({why})."]
        singular = [code(o.name) for o in f.outputs if f.proved and o.singular]
        if singular:
            blocks += [f"No bound for {', '.join(singular)} of {code(f.name)}: {SINGULAR}."]
    return blocks


def _places(name: str, facts: Facts) -> list[str]:
    """Which line of the code computes which quantity of this page."""
    blocks = []
    for file in dict.fromkeys(place.file for place in facts.places):
        rows = []
        for place in (p for p in facts.places if p.file == file):
            named = ", ".join(f"{line} {text}" for text, line in place.quantities)
            rows.append(
                [code(place.function.removeprefix(f"{name}_")), str(place.line), named.replace("_", r"\_")]
            )
        blocks += [f"Lines of `{file}`, where comments name the quantities of sections 6 to 8:"]
        blocks += table(["function", "line", "what is computed in which line"], rows, "lrl")
    return blocks


def _files(name: str) -> list[str]:
    """What the backends write beside this page."""
    return [
        f"{', '.join(code(file.format(robot=name)) for file in files.names)}: {files.what}"
        for entry in BACKENDS.values()
        for files in entry.files
        if files.what
    ]


def cost(s: Subject, facts: Facts, number: int) -> list[str]:
    """The last section and the foot of the page."""
    module = inlined_calls(s.derivation.c_module)
    functions = [*([module.prepare] if module.prepare else []), *module.functions]
    rows = []
    for f in functions:
        c = count(f)
        cells = (c.additions, c.multiplications, c.divisions, c.roots, c.sines, c.arctangents, c.comparisons)
        rows.append([code(f.name), _TEXT.get(f.name, f.text), *(str(n) for n in cells)])
    head = ["function", "what it gives", "+ −", "×", "÷", "√", "sin, cos", "atan2", "select"]
    name = s.robot.name
    blocks = [
        f"## {number} What it costs, and what else is in this folder",
        "Operations of one call, a sine or an arctangent counted as one (the C writes them out as polynomials, "
        "and many choices of a sign as bits):",
    ]
    blocks += table(head, rows, "llr")
    if module.prepare:
        blocks += ["`prepare` runs when a tunable parameter changes; no step divides by geometry."]
    blocks += _bounds(s)
    blocks += _places(name, facts)
    files = [*_files(name), "`model.json`: what this page says, as data"]
    return [
        *blocks,
        *items(files),
        "---",
        f"wmrgen {facts.wmrgen_version} · model {facts.model_hash or 'unhashed'}",
    ]
