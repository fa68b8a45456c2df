"""``numerics.md``: what a call costs, which ranges and rounding errors are proved, and which line computes what."""

from __future__ import annotations

from wmrgen.analysis.kinematics.pose import SWITCH, WORST_ERROR
from wmrgen.analysis.mobility.records import TOLERANCE, Rank
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.ir.bounds.robot import SINGULAR, TIES, Bounds, beyond, described, error, listed
from wmrgen.ir.nodes import count
from wmrgen.report.sections.further import further
from wmrgen.report.sections.markdown import code, foot, items, math, minus, page, sentence, table, written

FILE = "numerics.md"
_GIVES = {
    "inverse": "twist to joints", "inverse_slip": "slip of the same twist",
    "forward": "joints to twist", "forward_slip": "the same with the residual",
    "odometry": "pose after a step", "dynamics": "rates of the posture model", "prepare": "once per calibration",
}  # fmt: skip


def numerics(d: Derivation, facts: Facts) -> str:
    """The page."""
    name = d.robot.name
    return page([
        f"# Numerics of {code(name)}",
        "The derivation is in [report.md](report.md). Here are the numbers behind it and behind the code.",
        *_cost(d), *_ranges(d.bounds), *_ranks(d), *_series(), *further(d), *_places(name, facts), *_files(d),
        *foot(facts),
    ])  # fmt: skip


def _cost(d: Derivation) -> list[str]:
    """Operations of each function of the C."""
    module = d.c_in_operations
    rows = []
    for f in module.every:
        c = count(f)
        cells = (c.additions, c.multiplications, c.divisions, c.roots, c.sines, c.arctangents, c.comparisons)
        rows.append([code(f.name), sentence(_GIVES.get(f.name, f.text)), *map(str, cells)])
    head = ["function", "what it gives", "+ −", "×", "÷", "√", "sin, cos", "atan2", "select"]
    prepare = "`prepare` runs when a tunable parameter changes; no step divides by geometry."
    return [
        "## What a call costs",
        "Operations of one call, a sine or an arctangent counted as one (the C writes them out as polynomials, "
        "and many choices of a sign as bits):",
        *table(head, rows, "llr"),
        *([prepare] if module.prepare else []),
    ]


def _ranks(d: Derivation) -> list[str]:
    """How clear the ranks are that section 5 of the report counts with."""
    m = d.mobility
    steered = any(w.kind.steers for w in d.robot.wheels)
    at = " The steering is one for which all axles agree on one ICR." if steered else ""
    head = ["matrix", "rank", "rank in exact arithmetic", "singular values", "margin"]
    return [
        "## How clear the ranks are",
        *table(head, [_rank("C<sub>1f</sub>", m.rank_C1f), _rank("C₁", m.rank_C1)], "lr"),
        f"Rows are scaled to m/s.{at} A singular value counts when it exceeds {TOLERANCE:g} of the largest; the margin "
        "says how many times over the smallest of those does.",
    ]


def _rank(name: str, r: Rank) -> list[str]:
    values = ", ".join("0" if v < 1e-12 else f"{v:.4g}" for v in r.singular_values) or "no rows"
    exact = "not decided exactly (coupled steering)" if r.exact is None else str(r.exact)
    return [name, str(r.value), exact, values, f"{r.margin:.2g}" if r.value else "—"]


def _series() -> list[str]:
    """How odometry passes through omega = 0."""
    switch = rf"\frac{{{SWITCH.numerator}}}{{{SWITCH.denominator}}}"
    return [
        "## Odometry where the robot hardly turns",
        "Near σ = ω Δt / 2 = 0 a series takes the place of the quotient sin σ / σ, which makes the step smooth:",
        *math(
            r"\mathrm{sinc}(\sigma) = \begin{cases} 1 - \frac{\sigma^2}{6} + \frac{\sigma^4}{120}",
            rf"- \frac{{\sigma^6}}{{5040}} & |\sigma| < {switch} \\[4pt]",
            r"\frac{\sin\sigma}{\sigma} & \mathrm{else} \end{cases}",
        ),
        "The first term left out is σ⁸/9!, so the worst error is less than one unit in the last place of a double just "
        "below 1, 2⁻⁵³:",
        *math(rf"\frac{{1}}{{9!}}\left({switch}\right)^8 = {notation.decimal(float(f'{WORST_ERROR:.2e}'))}"),
    ]


def _ranges(bounds: Bounds) -> list[str]:
    """Proved ranges and rounding errors, or what the robot file must say for them."""
    title = "## Proved ranges and rounding errors"
    if bounds.missing:
        return [
            title,
            "Nothing is proved about ranges and rounding: the robot file has no limits of "
            f"{' and '.join(code(name) for name in bounds.missing)} (`wmrgen prove` says what to write).",
        ]
    rows = [
        [
            code(f.name),
            code(o.name),
            minus(f"{o.low:.6g}"),
            minus(f"{o.high:.6g}"),
            o.unit or "1",
            error(o),
        ]
        for f in bounds.functions
        if f.proved
        for o in f.outputs
        if not o.singular
    ]
    head = ["function", "output", "at least", "at most", "unit", "rounding error at most"]
    blocks = [
        title,
        "Proved for all inputs within the limits of the robot file: no NaN, no infinity, no division by zero, and",
        *table(head, rows, "llrrlr"),
        f"The limits are {listed(bounds.declared)}. Inputs that have none are taken to be in {listed(bounds.assumed)}. "
        "The error is that against the exact formula, comparisons decided as the code decides them "
        f"({described(bounds.library)}). There, speed is that of the steered wheel's pivot [m/s], where it is "
        "defined at all." + (f" {TIES}" if bounds.steers else ""),
    ]
    for f in bounds.functions:
        wider = beyond(f, bounds)
        if wider and f.proved:
            blocks += [f"{code(f.name)} is looked at for {listed(wider)}."]
        singular_outputs = ", ".join(code(o.name) for o in f.outputs if o.singular)
        if not f.proved:
            why = "; ".join(f.alarms) or f"no range is known of {', '.join(code(n) for n in f.unknown)}"
            blocks += [f"Not proved: {code(f.name)} ({why})."]
        elif singular_outputs:
            blocks += [f"No bound for {singular_outputs} of {code(f.name)}: {SINGULAR}."]
    return blocks


def _files(d: Derivation) -> list[str]:
    """What the backends write beside the page."""
    return ["## Files", *items(f"{', '.join(map(code, names))}: {what}" for names, what in written(d))]


def _places(name: str, facts: Facts) -> list[str]:
    """Which line of the code computes which quantity of this page."""
    blocks = ["## Lines of the code"] if facts.places else []
    for file in dict.fromkeys(place.file for place in facts.places):
        rows = []
        for place in (p for p in facts.places if p.file == file):
            quantities = ", ".join(f"{line} {text}" for text, line in place.quantities).replace("_", r"\_")
            rows.append([code(place.function.removeprefix(f"{name}_")), str(place.line), quantities])
        blocks += [f"Lines of `{file}`, where comments name the quantities of the report:"]
        blocks += table(["function", "line", "what is computed in which line"], rows, "lrl")
    return blocks
