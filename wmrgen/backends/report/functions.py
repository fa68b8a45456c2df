"""Section 11: the further functions that the robot file asks for, as formulas."""

from __future__ import annotations

from wmrgen import notation
from wmrgen.backends.report.markdown import aligned, code, sentence, table
from wmrgen.backends.report.subject import Subject
from wmrgen.kinematics.records import Formula
from wmrgen.printing import Latex
from wmrgen.program import asked
from wmrgen.symbolic import Expr

_LONG = 600  # operations and symbols of formulas that are still written out


def functions(s: Subject) -> list[str]:
    """Section 11, where there is any."""
    wanted = asked(s.robot)
    further = [f for f in s.derivation.program.formulas if f.name in wanted]
    if not further:
        return []
    return ["## 11 Further functions", *(line for f in further for line in _function(f))]


def _function(f: Formula) -> list[str]:
    blocks = [f"### `{f.name}`", sentence(f.text[:1].upper() + f.text[1:]).removesuffix(".") + "."]
    blocks += [f"In the texts: {f.source.replace('_', chr(92) + '_')}."]
    ports = [(p, "in") for p in f.inputs] + [(p, "out") for p, _ in f.outputs]
    rows = [[code(p.name), way, p.unit or "1", sentence(p.text)] for p, way in ports]
    blocks += table(["port", "", "unit", "meaning"], rows, "l")
    printer = Latex(p for p, _ in ports)
    if sum(_size(e) for _, e in (*f.locals, *f.outputs)) > _LONG:
        return [*blocks, "(The formulas are long; they stand in the code.)"]
    intermediate = [f"{printer.doprint(symbol)} &= {printer.doprint(expr)}" for symbol, expr in f.locals]
    pairs = [(notation.port(p.name), printer.doprint(expr)) for p, expr in f.outputs]
    results = [f"{name} &= {value}" for name, value in pairs if name != value]  # x = x tells nothing
    blocks += ["With", *aligned(intermediate)] if intermediate else []
    return blocks + (aligned(results) if results else [])


def _size(expr: Expr) -> int:
    return 1 + sum(_size(a) for a in expr.args)
