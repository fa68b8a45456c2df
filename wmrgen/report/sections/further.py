"""The further functions that a robot file asks for, and their formulas."""

from __future__ import annotations

from wmrgen.analysis.kinematics.records import Formula, substituted
from wmrgen.derivation.facade import Derivation
from wmrgen.derivation.program import asked
from wmrgen.functions.models.sheet import tidy
from wmrgen.geometry import notation
from wmrgen.geometry.printing import Latex, by_hand, size
from wmrgen.geometry.symbolic import Expr, add
from wmrgen.report.sections.letters import model
from wmrgen.report.sections.markdown import aligned, capitalised, code, sentence, table
from wmrgen.report.sections.terms import WIDE, width, wrapped

_LONG = 600  # operations and symbols of formulas that are still written out
_ROWS = 18  # of formulas in one piece
_SMALL = 6  # operations and symbols of an intermediate result that is written where it is used


def further(d: Derivation) -> list[str]:
    """Their ports and formulas."""
    blocks = [block for f in wanted(d) for block in _function(d, f)]
    return ["## Further functions", *blocks] if blocks else []


def wanted(d: Derivation) -> list[Formula]:
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
        return [*blocks, "(The formulas are long; they stand in the code.)"]
    steps, results = _inlined(short[0])
    names = by_hand([symbol for symbol, _ in steps], [e for _, e in (*steps, *results)])
    memo: dict[Expr, Expr] = {}
    printer = Latex((p for p, _ in ports), mul_symbol=r" \, ")

    def shown(expr: Expr) -> str:
        """A sum, the greatest or the least of several on several lines where it is long."""
        expr = substituted(expr, names, memo)
        text = str(printer.doprint(expr))
        if width(text) <= WIDE:
            return text
        return wrapped([f"{part} " for part in printer.parts(_as_sum(expr))]).strip()

    intermediate = [f"{shown(symbol)} &= {shown(expr)}" for symbol, expr in steps]
    own = {p.name for p in f.inputs}
    equations = [(notation.port(n) + "'" * (n in own), shown(e)) for n, e in results]
    # x' = x tells nothing.
    changed = [f"{name} &= {value}" for name, value in equations if name != f"{value}'"]
    blocks += ["With", *_short(intermediate)] if intermediate else []
    return [*blocks, *_short(changed)]


def _size(f: Formula) -> int:
    return sum(size(e) for _, e in (*f.locals, *f.outputs))


def _as_sum(expr: Expr) -> Expr:
    """k (a + b) as k a + k b, which can be broken."""
    inner = [e for e in expr.args if e.is_Add] if expr.is_Mul else []
    if len(inner) != 1:
        return expr
    rest = [e for e in expr.args if e is not inner[0]]
    return add(*(expr.func(*rest, term) for term in inner[0].args))


def _short(formulas: list[str]) -> list[str]:
    """Formulas one below the other, in pieces that fit on a sheet of paper."""
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
    """Intermediate results and outputs; a small intermediate result stands where it is used."""
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
