"""Write ``numerics.md``: costs of calls, proved ranges and rounding errors, ranks, further functions."""

from __future__ import annotations

from wmrgen.analysis.kinematics.pose import SWITCH, WORST_ERROR
from wmrgen.analysis.kinematics.records import Formula, substituted
from wmrgen.analysis.mobility.records import TOLERANCE, Rank
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.derivation.program import asked
from wmrgen.functions.models.sheet import latex as equations
from wmrgen.functions.models.sheet import sheet_of, tidy
from wmrgen.geometry import notation
from wmrgen.geometry.printing import Latex, by_hand, size
from wmrgen.geometry.symbolic import Expr, add
from wmrgen.ir.bounds.robot import SINGULAR, TIES, Bounds, beyond, described, error
from wmrgen.ir.bounds.robot import listed as listed_ranges
from wmrgen.ir.nodes import count
from wmrgen.report.sections.latex import (
    PAGE,
    WIDE,
    width,
    wrapped,
)
from wmrgen.report.sections.markdown import (
    aligned,
    capitalised,
    code,
    foot,
    in_symbols,
    items,
    keyed,
    listed,
    math,
    minus,
    sentence,
    table,
    written,
)

FILE = "numerics.md"
_GIVES = {
    "inverse": "twist to joints", "inverse_slip": "slip of the same twist",
    "forward": "joints to twist", "forward_slip": "the same with the residual",
    "odometry": "pose after a step", "dynamics": "rates of the posture model", "prepare": "once per calibration",
}  # fmt: skip


@in_symbols
def numerics(d: Derivation, facts: Facts) -> list[str]:
    """Return the blocks of the page."""
    name = d.robot.name
    return [
        f"# Numerics of {code(name)}",
        "The derivation is in [report.md](report.md). This page has the numbers behind it and behind the code.",
        *_cost(d), *_ranges(d.bounds), *_ranks(d), *_series(), *further(d), *_places(name, facts), *_files(d),
        *foot(facts),
    ]  # fmt: skip


def _cost(d: Derivation) -> list[str]:
    """Return the number of operations of each C function."""
    module = d.c_in_operations
    rows = []
    for f in module.every:
        c = count(f)
        cells = (c.additions, c.multiplications, c.divisions, c.roots, c.sines, c.arctangents, c.comparisons)
        rows.append([code(f.name), sentence(_GIVES.get(f.name, f.text)), *map(str, cells)])
    head = ["function", "result", "+ −", "×", "÷", "√", "sin, cos", "atan2", "select"]
    prepare = "`prepare` runs when a tunable parameter changes. No other function divides by geometry."
    return [
        "## What a call costs",
        "Operations of one call. A sine or an arctangent counts as one operation, although the C evaluates it as a "
        "polynomial. Some choices of a sign are operations on bits in C.",
        *table(head, rows, "llr"),
        *([prepare] if module.prepare else []),
    ]


def _ranks(d: Derivation) -> list[str]:
    """Return the singular values behind the ranks of section 5, and their margin."""
    m = d.mobility
    steered = any(w.kind.steers for w in d.robot.wheels)
    at = " The steering angles are such that all axles meet in one ICR." if steered else ""
    head = ["matrix", "rank", "rank in exact arithmetic", "singular values", "margin"]
    return [
        "## How clear the ranks are",
        *table(head, [_rank("C<sub>1f</sub>", m.rank_C1f), _rank("C₁", m.rank_C1)], "lr"),
        f"Rows are scaled to m/s.{at} A singular value counts if it exceeds {TOLERANCE:g} times the largest one. The "
        "margin is the factor by which the smallest counted value exceeds this limit.",
    ]


def _rank(name: str, r: Rank) -> list[str]:
    values = ", ".join("0" if v < 1e-12 else f"{v:.4g}" for v in r.singular_values) or "no rows"
    exact = "not decided exactly (coupled steering)" if r.exact is None else str(r.exact)
    return [name, str(r.value), exact, values, f"{r.margin:.2g}" if r.value else "—"]


def _series() -> list[str]:
    """Write the series of odometry near omega = 0."""
    switch = rf"\frac{{{SWITCH.numerator}}}{{{SWITCH.denominator}}}"
    return [
        "## Odometry where the robot hardly turns",
        "Near σ = ω Δt / 2 = 0, a series replaces the quotient sin σ / σ. This makes the step smooth:",
        *math(
            r"\mathrm{sinc}(\sigma) = \begin{cases} 1 - \frac{\sigma^2}{6} + \frac{\sigma^4}{120}",
            rf"- \frac{{\sigma^6}}{{5040}} & |\sigma| < {switch} \\[4pt]",
            r"\frac{\sin\sigma}{\sigma} & \mathrm{else} \end{cases}",
        ),
        keyed(
            "numerics.series_error",
            "The first omitted term is σ⁸/9!. Hence the largest error is less than one unit in the last place of a "
            "double just below 1, which is 2⁻⁵³:",
        ),
        *math(rf"\frac{{1}}{{9!}}\left({switch}\right)^8 = {notation.decimal(float(f'{WORST_ERROR:.2e}'))}"),
    ]


def _ranges(bounds: Bounds) -> list[str]:
    """Return proved ranges and rounding errors, or the limits that the robot file lacks for them."""
    title = "## Proved ranges and rounding errors"
    if bounds.missing:
        return [
            title,
            "No ranges and rounding errors are proved, because the robot file has no limits of "
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
        "Proved for all inputs within the limits of the robot file: there is no NaN, no infinity and no division by "
        "zero, and the outputs are within these bounds:",
        *table(head, rows, "llrrlr"),
        f"The limits are {listed_ranges(bounds.declared)}. Inputs without limits are assumed to be in "
        f"{listed_ranges(bounds.assumed)}. The rounding error is the difference from the exact formula, with the same "
        f"results of comparisons ({described(bounds.library)}). In it, speed is the speed [m/s] of the pivot of a "
        "steered wheel that moves." + (f" {TIES}" if bounds.steers else ""),
    ]
    for f in bounds.functions:
        wider = beyond(f, bounds)
        if wider and f.proved:
            blocks += [f"For {code(f.name)}, inputs are assumed to be in {listed_ranges(wider)}."]
        singular_outputs = ", ".join(code(o.name) for o in f.outputs if o.singular)
        if not f.proved:
            why = "; ".join(f.alarms) or f"no range is known for {', '.join(code(n) for n in f.unknown)}"
            blocks += [f"Not proved: {code(f.name)} ({why})."]
        elif singular_outputs:
            blocks += [f"No bound for {singular_outputs} of {code(f.name)}: {SINGULAR}."]
    return blocks


def _files(d: Derivation) -> list[str]:
    """Return the list of generated files."""
    return ["## Files", *items(f"{', '.join(map(_link, names))}: {what}" for names, what in written(d))]


def _link(name: str) -> str:
    """Return the name of a file as a link; a pattern of several names has none."""
    return code(name) if "*" in name else f"[{code(name)}]({name})"


def _places(name: str, facts: Facts) -> list[str]:
    """Return the table of code lines and the quantities that they compute."""
    blocks = ["## Lines of the code"] if facts.places else []
    for file in dict.fromkeys(place.file for place in facts.places):
        rows = []
        for place in (p for p in facts.places if p.file == file):
            quantities = ", ".join(f"{line} {text}" for text, line in place.quantities).replace("_", r"\_")
            rows.append([code(place.function.removeprefix(f"{name}_")), str(place.line), quantities])
        blocks += [f"Lines of `{file}`; comments in this file name the quantities of the report:"]
        blocks += table(["function", "line", "computed quantities, each with its line"], rows, "lrl")
    return blocks


_LONG = (
    600  # operations and symbols of formulas that are written out: two pages; longer ones stay in the code
)
_ROWS = 18  # lines of one block of formulas: a block is not broken over pages of a PDF (wpilib_swervebot)
_SMALL = 6  # operations and symbols of an intermediate result that is inserted where it is used


def further(d: Derivation) -> list[str]:
    """Return inputs, outputs and formulas of the functions that the robot file requests."""
    blocks = [block for f in wanted(d) for block in _function(d, f)]
    return ["## Further functions", *blocks] if blocks else []


def wanted(d: Derivation) -> list[Formula]:
    """Return the formulas of the functions that the robot file requests."""
    names = asked(d.robot)
    return [f for f in d.program.formulas if f.name in names]


def _function(d: Derivation, f: Formula) -> list[str]:
    ports = [(p, "in") for p in f.inputs] + [(p, "out") for p, _ in f.outputs]
    rows = [[code(p.name), way, p.unit or "1", sentence(p.text)] for p, way in ports]
    blocks = [f"### `{f.name}`", f"{capitalised(f.text)} Source: {sentence(f.source)}."]
    blocks += table(["port", "", "unit", "meaning"], rows, "l")
    if written := model(d, f):
        return [*blocks, *written]
    short = [g for g in (d.formula_in_symbols(f.name), f) if _size(g) <= _LONG]
    if not short:
        return [*blocks, "(The formulas are long; see the code.)"]
    steps, results = _inlined(short[0])
    names = by_hand([symbol for symbol, _ in steps], [e for _, e in (*steps, *results)])
    memo: dict[Expr, Expr] = {}
    printer = Latex((p for p, _ in ports), mul_symbol=r" \, ")

    def shown(expr: Expr) -> str:
        """Return LaTeX; a long sum, minimum or maximum is broken into lines."""
        expr = substituted(expr, names, memo)
        text = str(printer.doprint(expr))
        if width(text) <= WIDE:
            return text
        return wrapped([f"{part} " for part in printer.parts(_as_sum(expr))]).strip()

    intermediate = [f"{shown(symbol)} &= {shown(expr)}" for symbol, expr in steps]
    own = {p.name for p in f.inputs}
    equations = [(notation.port(n) + "'" * (n in own), shown(e)) for n, e in results]
    # x' = x is no information.
    changed = [f"{name} &= {value}" for name, value in equations if name != f"{value}'"]
    blocks += ["With", *_short(intermediate)] if intermediate else []
    return [*blocks, *_short(changed)]


def _size(f: Formula) -> int:
    return sum(size(e) for _, e in (*f.locals, *f.outputs))


def _as_sum(expr: Expr) -> Expr:
    """Expand k (a + b) to k a + k b, which can be broken into lines (wpilib_swervebot)."""
    inner = [e for e in expr.args if e.is_Add] if expr.is_Mul else []
    if len(inner) != 1:
        return expr
    rest = [e for e in expr.args if e is not inner[0]]
    return add(*(expr.func(*rest, term) for term in inner[0].args))


def _short(formulas: list[str]) -> list[str]:
    """Return formulas below each other, in blocks that fit on a sheet of paper."""
    groups: list[list[str]] = []
    rows = _ROWS
    for formula in formulas:
        own = 1 + formula.count("\n")
        if rows + own > _ROWS:
            groups.append([])
            rows = 0
        groups[-1].append(formula)
        rows += own
    return [block for group in groups for block in aligned(group)]


def _inlined(f: Formula) -> tuple[list[tuple[Expr, Expr]], list[tuple[str, Expr]]]:
    """Return intermediate results and outputs. Small intermediate results are inserted where they are used."""
    values: dict[Expr, Expr] = {}
    memo: dict[Expr, Expr] = {}
    steps = []
    for symbol, expr in f.locals:
        step = tidy(substituted(expr, values, memo))
        if size(step) <= _SMALL:
            values[symbol] = step
        else:
            steps.append((symbol, step))
    return steps, [(p.name, tidy(substituted(e, values, memo))) for p, e in f.outputs]


_MODELS = ("posture", "configuration", "zeta", "trailer")  # functions that `wmrgen model` writes


def model(d: Derivation, f: Formula) -> list[str]:
    """Return a function that is a model as `wmrgen model` prints it; [] for other functions and for long models."""
    if f.name not in _MODELS:
        return []
    text = equations(sheet_of(f.name, d.system(f.name, symbolic=True)))
    if max(map(width, text.split("\n"))) > 2 * PAGE:
        return []
    rest = [p.name for p, _ in f.outputs if not p.name.endswith(("_rate", ".spin"))]
    blocks = [
        "The model as `wmrgen model` prints it, without the code that keeps divisors off 0:",
        *math(text),
    ]
    return [*blocks, keyed("numerics.rest_in_code", f"See the code for {listed(rest)}.")] if rest else blocks
