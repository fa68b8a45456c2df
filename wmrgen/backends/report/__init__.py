"""The derivation report: one robot as a worked textbook example, in Markdown that GitHub renders.

Each section is a function from the derivation to blocks of Markdown. Here are the order of the sections and the last
ones, which say what of it is computed, where, and what that costs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.registry import BACKENDS, Facts
from wmrgen.backends.report.forward import forward, motion
from wmrgen.backends.report.inverse import inverse
from wmrgen.backends.report.letters import model
from wmrgen.backends.report.markdown import aligned, capitalised, code, items, page, sentence, table
from wmrgen.backends.report.mobility import analysis, singular
from wmrgen.backends.report.overview import layout, opening
from wmrgen.backends.report.rows import matrices, null_space, wheel_rows
from wmrgen.backends.report.texts import texts
from wmrgen.bounds.robot import SINGULAR, TIES, beyond, described, error, listed
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.nodes import count
from wmrgen.printing import Latex, size
from wmrgen.program import asked

if TYPE_CHECKING:
    from wmrgen.bounds.robot import Bounds
    from wmrgen.kinematics.records import Formula
    from wmrgen.robot import Derivation

FILE = "report.md"
_SECTIONS = (
    opening, layout, wheel_rows, matrices, null_space, analysis, inverse, forward, motion, singular, texts,
)  # fmt: skip
_LONG = 600  # operations and symbols of formulas that are still written out
_GIVES = {
    "inverse": "twist to joints", "inverse_slip": "slip of the same twist",
    "forward": "joints to twist", "forward_slip": "the same with the residual",
    "odometry": "pose after a step", "dynamics": "rates of the posture model", "prepare": "once per calibration",
}  # fmt: skip


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """``report.md``; its picture, ``layout.svg``, is another backend's."""
    blocks = [block for section in _SECTIONS for block in section(derivation)]
    further = _further_functions(derivation)
    blocks += further + _cost(derivation, facts, 12 if further else 11)
    return {FILE: page(blocks).encode()}


def _further_functions(d: Derivation) -> list[str]:
    """Section 11: the further functions that the robot file asks for, as formulas, where there are any."""
    wanted = asked(d.robot)
    blocks = [block for f in d.program.formulas if f.name in wanted for block in _function(d, f)]
    return ["## 11 Further functions", *blocks] if blocks else []


def _function(d: Derivation, f: Formula) -> list[str]:
    ports = [(p, "in") for p in f.inputs] + [(p, "out") for p, _ in f.outputs]
    rows = [[code(p.name), way, p.unit or "1", sentence(p.text)] for p, way in ports]
    source = f.source.replace("_", r"\_")
    blocks = [f"### `{f.name}`", capitalised(f.text), f"In the texts: {source}."]
    blocks += table(["port", "", "unit", "meaning"], rows, "l")
    if written := model(d, f):
        return [*blocks, *written]
    if sum(size(e) for _, e in (*f.locals, *f.outputs)) > _LONG:
        return [*blocks, "(The formulas are long; they stand in the code.)"]
    shown = Latex(p for p, _ in ports).doprint
    intermediate = [f"{shown(symbol)} &= {shown(expr)}" for symbol, expr in f.locals]
    results = [(notation.port(p.name), shown(expr)) for p, expr in f.outputs]
    equations = [f"{name} &= {value}" for name, value in results if name != value]  # x = x tells nothing
    blocks += ["With", *aligned(intermediate)] if intermediate else []
    return blocks + (aligned(equations) if equations else [])


def _cost(d: Derivation, facts: Facts, number: int) -> list[str]:
    """The last section, cost and files, and the foot of the page."""
    module = inlined_calls(d.c_module)
    rows = []
    for f in module.every:
        c = count(f)
        cells = (c.additions, c.multiplications, c.divisions, c.roots, c.sines, c.arctangents, c.comparisons)
        rows.append([code(f.name), _GIVES.get(f.name, f.text), *map(str, cells)])
    head = ["function", "what it gives", "+ −", "×", "÷", "√", "sin, cos", "atan2", "select"]
    prepare = "`prepare` runs when a tunable parameter changes; no step divides by geometry."
    return [
        f"## {number} What it costs, and what else is in this folder",
        "Operations of one call, a sine or an arctangent counted as one (the C writes them out as polynomials, "
        "and many choices of a sign as bits):",
        *table(head, rows, "llr"),
        *([prepare] if module.prepare else []),
        *_bounds(d.bounds),
        *_places(d.robot.name, facts),
        *items([*_files(d.robot.name), "`model.json`: what this page says, as data"]),
        "---",
        f"wmrgen {facts.wmrgen_version} · model {facts.model_hash or 'unhashed'}",
    ]


def _bounds(bounds: Bounds) -> list[str]:
    """Proved ranges and rounding errors, or what the robot file must say for them."""
    if bounds.missing:
        return [
            "Nothing is proved about ranges and rounding: the robot file has no limits of "
            f"{' and '.join(code(name) for name in bounds.missing)} (`wmrgen prove` says what to write)."
        ]
    rows = [
        [code(f.name), code(o.name), f"{o.low:.6g}", f"{o.high:.6g}", o.unit or "1", error(o, "speed")]
        for f in bounds.functions
        if f.proved
        for o in f.outputs
        if not o.singular
    ]
    head = ["function", "output", "at least", "at most", "unit", "rounding error at most"]
    blocks = [
        "Proved for all inputs within the limits of the robot file: no NaN, no infinity, no division by zero, and",
        *table(head, rows, "llrrlr"),
        f"The limits are {listed(bounds.declared)}. Inputs that have none: {listed(bounds.assumed)}. The error is "
        "that against the exact formula, comparisons decided as the code decides them "
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


def _places(name: str, facts: Facts) -> list[str]:
    """Which line of the code computes which quantity of this page."""
    blocks = []
    for file in dict.fromkeys(place.file for place in facts.places):
        rows = []
        for place in (p for p in facts.places if p.file == file):
            quantities = ", ".join(f"{line} {text}" for text, line in place.quantities).replace("_", r"\_")
            rows.append([code(place.function.removeprefix(f"{name}_")), str(place.line), quantities])
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
