"""A model on one page: state, inputs, equations, vector fields, and where it is singular."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from functools import cmp_to_key
from typing import Any, NamedTuple

import sympy

from wmrgen.functions.system import Domain, Lag, System, rate_port
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.notation import plain
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.printing import Latex, Reader, Text, Writer, exact, size
from wmrgen.geometry.symbolic import Expr, number, signal

LONGEST = 4000  # nodes of an expression that is still written out: some pages of text
_ORDER = cmp_to_key(sympy.Basic.compare)  # the order of the terms of a sum in sympy


class Equation(NamedTuple):
    """An equation ``left`` = ``right``."""

    left: str  # name of the quantity
    right: Expr
    rate: bool = False  # whether ``left`` is primed: the rate of the quantity


class Sheet(NamedTuple):
    """The page of a model."""

    form: str
    text: str
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    parameters: tuple[Port, ...]
    where: tuple[Equation, ...]  # definitions of quantities that the equations use
    equations: tuple[Equation, ...]  # rates of the state
    fields: tuple[tuple[str, tuple[Expr, ...]], ...]  # input name -> components in the order of the state
    domain: tuple[Domain, ...]

    @property
    def ports(self) -> tuple[Port, ...]:
        """Return every quantity that has a name in the contract."""
        named = (Port(e.left, Role.COMMAND, "") for e in self.where)
        return (*self.state, *self.inputs, *self.parameters, *named)


def sheet_of(form: str, system: System) -> Sheet:
    """Return the page of a system, with every expression in closed form."""
    equations = tuple(
        Equation(p.name, tidy(rate), True) for p, rate in zip(system.state, system.rates, strict=True)
    )
    return Sheet(
        form, system.text, system.state, system.inputs, system.geometry, (), equations,
        tuple((p.name, tuple(map(tidy, f))) for p, f in zip(system.inputs, system.fields, strict=True)),
        tuple(Domain(tidy(d.expression), d.text) for d in system.domain),
    )  # fmt: skip


def with_lags(sheet: Sheet, lags: Mapping[str, Lag], text: str) -> Sheet:
    """Return the page with commanded steering angles as inputs, and the rates that follow from them.

    Args:
        sheet: The page with steering rates as inputs.
        lags: Commands by the name of the rate that follows.
        text: The new description of the model.
    """
    where = tuple(Equation(name, tidy(lag.rate)) for name, lag in lags.items())
    inputs = tuple(lags[p.name].command if p.name in lags else p for p in sheet.inputs)
    return sheet._replace(inputs=inputs, where=(*sheet.where, *where), text=text)


def tidy(expr: Expr) -> Expr:
    """Return the expression with signs and numbers collected, and sin/cos as tan; a long one is returned unchanged."""
    return _tidied(expr, {}) if size(expr) <= LONGEST else expr


def _tidied(expr: Expr, memo: dict[Expr, Expr]) -> Expr:
    """Return a tidy expression; ``memo`` keeps the results of shared parts."""
    if not expr.args or isinstance(expr, sympy.Piecewise):
        return expr
    if expr not in memo:
        args = [_tidied(a, memo) for a in expr.args]
        if expr.is_Add:
            memo[expr] = _sum(args)
        elif expr.is_Mul:
            factors = Counter(factor for arg in args for factor in sympy.Mul.make_args(arg))
            memo[expr] = _tangent(sympy.Mul(*(factor**power for factor, power in factors.items())))
        elif isinstance(expr, (sympy.sin, sympy.cos)):
            memo[expr] = expr.func(*args, evaluate=not args[0].is_Add)
        else:
            memo[expr] = expr.func(*args) if expr.is_Pow else expr
    return memo[expr]


def _sum(parts: Iterable[Expr]) -> Expr:
    """Return the sum in sympy's order. Only like terms need its evaluation, which loads tensors."""
    terms = [term for part in parts for term in sympy.Add.make_args(part) if term]
    alike = len({term.as_coeff_Mul()[1] for term in terms}) < len(terms)
    return sympy.Add(*terms) if alike else sympy.Add(*sorted(terms, key=_ORDER), evaluate=False)


def _tangent(product: Expr) -> Expr:
    """Return a product with tan(a) for sin(a)/cos(a)."""
    for arg in product.args:
        if isinstance(arg, sympy.sin) and sympy.cos(arg.args[0]) ** -1 in product.args:
            rest = [a for a in product.args if a not in (arg, sympy.cos(arg.args[0]) ** -1)]
            return sympy.Mul(*rest, sympy.tan(arg.args[0]))
    return product


def _written(printer: Writer, expr: Expr) -> str:
    """Return an expression as text, or a note if it is too long."""
    return printer(expr) if size(expr) <= LONGEST else "(too long to write out; see the generated code)"


def lines(sheet: Sheet) -> list[str]:
    """Return the page as plain text, one equation a line; long fractions become decimals."""
    printer = Reader(Text(sheet.ports).doprint)
    rows = [f"{sheet.form}: {sheet.text}"]
    if sheet.state:
        rows.append(f"state:  {' '.join(p.name for p in sheet.state)}")
    rows.append(f"inputs: {' '.join(_with_unit(p) for p in sheet.inputs)}")
    if sheet.parameters:
        values = (f"{p.name} = {printer(number(p.default or ZERO))}" for p in sheet.parameters)
        rows.append(f"with:   {', '.join(values)}")
    rows += ["", *_aligned([(e.left, _written(printer, e.right)) for e in sheet.where])]
    rows += [""] if sheet.where else []
    rows += _aligned(
        [(f"{e.left}'" if e.rate else e.left, _written(printer, e.right)) for e in sheet.equations]
    )
    if sheet.fields:
        rows += ["", "vector fields:"]
        for name, field in sheet.fields:
            rows.append(f"  {name}: [{', '.join(_written(printer, e) for e in field)}]")
    if sheet.state:
        rows += ["", "singular:" if sheet.domain else "singular: nowhere"]
        rows += [f"  {line}" for line in _sets(sheet.domain, printer)]
    return [*rows, "", printer.note] if printer.note else rows


def singular_sets(system: System) -> tuple[str, ...]:
    """Return where a model does not hold: a condition and a reason in each line."""
    ports = (*system.state, *system.inputs, *system.geometry)
    domain = (Domain(tidy(d.expression), d.text) for d in system.domain)
    return tuple(_sets(domain, Reader(Text(ports).doprint)))


def conditions(sheet: Sheet) -> tuple[str, ...]:
    """Return where the model of a page does not hold: a condition and a reason in each line."""
    return tuple(_sets(sheet.domain, Reader(Text(sheet.ports).doprint)))


def _sets(domain: Iterable[Domain], printer: Writer) -> list[str]:
    """Return conditions with their reasons."""
    return [f"{_written(printer, d.expression)} = 0: {plain(d.text)}" for d in domain]


def _with_unit(port: Port) -> str:
    """Return the name of a port with its unit."""
    return f"{port.name} [{port.unit}]" if port.unit else port.name


def _aligned(pairs: list[tuple[str, str]]) -> list[str]:
    """Return equations with aligned equals signs."""
    width = max((len(left) for left, _ in pairs), default=0)
    return [f"  {left:<{width}} = {right}" for left, right in pairs]


def data(sheet: Sheet) -> dict[str, Any]:
    """Return the page as plain data, with expressions in Python syntax over names with underscores."""

    def shown(expr: Expr) -> str:
        return _written(exact, expr)

    return {
        "form": sheet.form,
        "text": sheet.text,
        "state": [p.name for p in sheet.state],
        "inputs": [p.name for p in sheet.inputs],
        "parameters": {p.name: float(p.default) for p in sheet.parameters if p.default is not None},
        "where": {e.left: shown(e.right) for e in sheet.where},
        "equations": {
            rate_port(Port(e.left, sheet.state[0].role, "")).name if e.rate else e.left: shown(e.right)
            for e in sheet.equations
        },
        "fields": {name: list(map(shown, field)) for name, field in sheet.fields},
        "domain": [
            {"condition": f"{shown(d.expression)} = 0", "meaning": plain(d.text)} for d in sheet.domain
        ],
    }


def latex(sheet: Sheet) -> str:
    """Return the equations as an aligned environment of LaTeX."""
    printer = Latex(sheet.ports, order=None)
    shown = Reader(printer.doprint)
    rows = []
    for e in (*sheet.where, *sheet.equations):
        left = printer.doprint(signal(e.left))
        left = rf"\frac{{d}}{{dt}} {left}" if e.rate else left
        rows.append(f"{left} &= {_written(shown, e.right)}")
    return "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"
