"""What a robot's model is, and what a robot file may say, written down.

``wmrgen model``: state, inputs and equations, or a step of constant inputs. ``wmrgen structure``: what integrates, what
Lie brackets reach, what is flat, whether a chained form exists. ``wmrgen schema``: the keys of robot files, for editors
and validators or to read.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_words
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.artifacts import write_file
from wmrgen.errors import NotDerivableError, UsageError
from wmrgen.functions.models.state_space import data as entries
from wmrgen.functions.models.state_space import default_form, lags, limit_lines, regularity, state_space
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.functions.system import System

    Shown = Callable[[Any], str]


def model(
    robot: Path,
    values: Sequence[str] | None,
    form: str | None,
    discrete: str | None,
    dt: str | None,
    out: Path | None,
    as_latex: bool,
    as_json: bool,
) -> int:
    """Print one form of the model of a robot: the chained form transforms state and inputs, others are systems. With
    ``discrete``, its step of ``dt``."""
    from wmrgen.functions.models.sheet import conditions, data, latex, lines, sheet_of, with_lags
    from wmrgen.functions.trailers.chained_sheet import chained_sheet

    if discrete is None and (dt or out or values):
        raise UsageError("--dt, -o and values are for the step of --discrete. Write --discrete rk4 too.")
    if as_latex and (as_json or discrete is not None):
        raise UsageError("--latex writes the equations of a form. Leave out --json and --discrete.")
    with derived(robot) as derivation:
        form = form or default_form(derivation.robot, derivation.mobility)
        if discrete is not None:
            return _step(derivation, form, discrete, dt, values or (), out, as_json)
        if form == "chained":
            sheet, space = chained_sheet(derivation.robot, derivation.mobility), None
        else:
            system = derivation.system(form, symbolic=True)
            space = state_space(derivation.robot, derivation.mobility, form)
            sheet = with_lags(sheet_of(form, system), lags(derivation.robot, system), space.text)
        sets = regularity(derivation.robot, derivation.mobility)
        sets.setdefault(form, conditions(sheet))
        if as_json:
            more = {} if space is None else {"state_space": entries(space)}
            console.data({**data(sheet), "singular_sets": sets, **more})
            return 0
        regular = {name: f"but where {'; '.join(w)}" if w else "in every motion" for name, w in sets.items()}
        width = max(map(len, regular))
        told = [f"  {name:<{width}} {words}" for name, words in regular.items()]
        limits = [] if space is None else [f"  {line}" for line in limit_lines(space)]
        shown = [*lines(sheet), *(["", "limits:", *limits] if limits else []), "", "regular:", *told]
        text = latex(sheet) if as_latex else "\n".join(shown)
    console.result(text)
    return 0


def _step(
    derivation: Derivation,
    form: str,
    discrete: str,
    dt: str | None,
    values: Sequence[str],
    out: Path | None,
    as_json: bool,
) -> int:
    """Write the step to the file ``out``, or print what it gives at ``values``: state after it, A, B and c.

    Without ``dt`` the file has it as the fourth input.
    """
    if form == "chained":
        raise UsageError("the chained form has no step. Write any --form but chained.")
    span = None if dt is None else float(from_words([f"dt={dt}"], [Port("dt", Role.COMMAND, "s")])["dt"])
    step = derivation.state_space(form, discrete, span)
    if out is not None:
        write_file(out, BACKENDS["casadi"].offers("content")(step))
        console.result(str(out))
        return 0
    if span is None:
        raise UsageError(
            "a step takes --dt. Write --dt 0.05 [s], or -o FILE for a step with dt as its fourth input."
        )
    space = state_space(derivation.robot, derivation.mobility, form)
    groups = (space.state, space.inputs, space.geometry)
    case = from_words(values, [port for ports in groups for port in ports], derivation.robot)
    point = [[float(case.get(p.name, p.default or ZERO)) for p in ports] for ports in groups]
    try:
        after, a, b, c = (part.full().tolist() for part in step(*point))
    except RuntimeError:
        raise UsageError(
            f"the {discrete} step of {span:g} s does not converge. Write a smaller --dt, or --discrete rk4."
        ) from None
    finite = all(isfinite(v) for part in (after, a, b, c) for row in part for v in row)
    if not finite or (space.singular and _unbounded(derivation.system(form), case)):
        where = (
            f"{form} does not hold where {'; '.join(space.singular)}"
            if space.singular
            else "numbers overflow"
        )
        raise UsageError(f"{where}. Write other values, or another --form.")
    x, u = ([p.name for p in ports] for ports in (space.state, space.inputs))
    xnext, affine = ([row[0] for row in column] for column in (after, c))
    if as_json:
        facts = {"form": form, "discrete": discrete, "dt": span, "x": x, "u": u}
        console.data({**facts, "xnext": xnext, "A": a, "B": b, "c": affine})
        return 0
    console.result(f"{form}, a step of {span:g} s by {discrete}: xnext = A x + B u + c, to first order\n")
    head = ["", "xnext", *(f"A {name}" for name in x), *(f"B {name}" for name in u), "c"]
    numbers = zip(xnext, a, b, affine, strict=True)
    rows = [[f"{v:.6g}" for v in (first, *own, *by, last)] for first, own, by, last in numbers]
    table = [head, *([name, *row] for name, row in zip(x, rows, strict=True))]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        console.result("  ".join(f"{text:>{width}}" for text, width in zip(row, widths, strict=True)))
    return 0


def _unbounded(system: System, case: Mapping[str, Exact]) -> bool:
    """Whether a divisor of the model is zero there but for the rounding of doubles: functions with guards differ."""
    at = {**{p.name: ZERO for p in system.state}, **case, **{p.name: ONE for p in system.inputs}}
    kept, free = (evaluate(lower(system.formula(guards)), at, FLOAT64) for guards in (True, False))
    return not all(abs(kept[name] - free[name]) < 1 for name in kept)


def structure(robot: Path, form: str | None, as_json: bool) -> int:
    """Print Frobenius's test with its proofs, integrals, Lie brackets (of the model called ``form``), flat outputs and
    the chained form."""
    from wmrgen.geometry.printing import exact

    with derived(robot) as derivation:
        if as_json:
            console.data(_facts(derivation, form, exact))
            return 0
        lines = _lines(derivation, form)
    console.result("\n".join(lines))
    return 0


def functions(robot: Path, as_json: bool) -> int:
    """Print the functions that a robot has, in a sentence each, and why it does not have the others."""
    from wmrgen.functions.registry import names, standard

    with derived(robot) as derivation:
        generated = {d.name for d in standard()} | set(derivation.robot.functions)
        formulas, absent = [], {}
        for name in names():
            try:
                formulas.append(derivation.formula(name))
            except NotDerivableError as error:
                absent[name] = error.what
    if as_json:
        console.data(
            {
                "robot": derivation.robot.name,
                "functions": [
                    {
                        "name": f.name, "text": f.text, "source": f.source, "generated": f.name in generated,
                        "inputs": [p.name for p in f.inputs], "outputs": [p.name for p, _ in f.outputs],
                    }
                    for f in formulas
                ],
                "absent": [{"name": name, "why": why} for name, why in absent.items()],
            }
        )  # fmt: skip
        return 0
    width = max(map(len, names()))
    for f in formulas:
        console.result(f"{'*' if f.name in generated else ' '} {f.name:<{width}}  {f.text}")
    if absent:
        console.result("\nIt does not have:")
    for name, why in absent.items():
        reason = why.splitlines()[0].split(": ", 1)[-1]
        console.result(f"  {name:<{width}}  {reason}")
    return 0


def schema(as_markdown: bool, as_json: bool) -> int:
    """Print the JSON Schema of robot files, or their reference in Markdown."""
    from wmrgen.functions.registry import optional_names
    from wmrgen.robotfile.reference import reference
    from wmrgen.robotfile.schema import json_schema

    if as_markdown and as_json:
        raise UsageError("there are --json and --markdown. Give one of them, not both.")
    if as_markdown:
        console.result(reference().rstrip("\n"))
    else:
        console.data(json_schema(optional_names()))
    return 0


def _lines(d: Derivation, form: str | None) -> list[str]:
    """What a reader sees: fractions too long to read as decimals."""
    from wmrgen.geometry.printing import Reader

    shown = Reader()
    facts = _facts(d, form, shown)
    lines = [facts["text"]]
    lines += [f"  {row['wheel']}, {row['kind']}: {row['proof']}" for row in facts["constraints"]]
    lines += [f"  integrates to: {text}" for text in facts["integrals"]]
    lines += [f"brackets: {facts['brackets']}"]
    for other in facts["exceptional"] or ():
        vector = ", ".join(map(str, other["growth_vector"]))
        lines.append(
            f"  where {other['condition']}: {f'growth vector ({vector})' if vector else 'another one may hold'}"
        )
    lines += [f"  {name} = ({', '.join(field)})" for name, field in facts["fields"].items()]
    lines += [f"{key}: {facts[key]}" for key in ("flat", "chained")]
    return [*lines, shown.note] if shown.note else lines


def _facts(d: Derivation, form: str | None, shown: Shown) -> dict[str, Any]:
    tests = d.integrability
    return {
        "text": tests.text,
        "holonomic": tests.holonomic,
        "ddof": tests.ddof,
        "dof": tests.dof,
        "constraints": [
            {
                "wheel": r.wheel, "kind": r.kind, "integrable": r.integrable, "value": shown(r.value),
                "proof": r.proof(shown), "latex": r.latex,
            }
            for r in tests.rows
        ],
        "integrals": [i.text for i in tests.integrals],
        **_growth(d, form, shown),
        "flat": _or_why(lambda: _flat(d)),
        "chained": _or_why(lambda: _chained(d)),
    }  # fmt: skip


def _growth(d: Derivation, form: str | None, shown: Shown) -> dict[str, Any]:
    """Dimensions that input fields and brackets span, by order, brackets that add one, and where there are others."""
    from wmrgen.functions.models.exceptional import exceptional
    from wmrgen.functions.models.growth import growing, growth

    try:
        system = growing(d.robot, d.mobility) if form is None else d.system(form, symbolic=True)
        found = growth(system)
    except NotDerivableError as error:
        return {"growth_vector": [], "brackets": f"none: {error.what}", "fields": {}, "exceptional": None}
    sets = exceptional(system, found)
    return {
        "growth_vector": list(found.vector),
        "brackets": found.told(everywhere=sets == ()),
        "fields": {b.name: list(b.written(shown)) for b in found.brackets},
        "exceptional": None if sets is None else [
            {"condition": f"{shown(s.condition)} = 0", "growth_vector": list(s.vector)} for s in sets
        ],
        "state": list(found.state),
    }  # fmt: skip


def _flat(d: Derivation) -> str:
    from wmrgen.functions.trailers.flat import flatness

    flat = flatness(d.robot, d.mobility)
    return f"{flat.outputs}: {flat.text}"


def _chained(d: Derivation) -> str:
    from wmrgen.functions.trailers.train import train

    size = train(d.robot, d.mobility).size
    return f"(2,{size}) chain; `wmrgen model ROBOT.yaml --form chained` writes it down"


def _or_why(fact: Callable[[], str]) -> str:
    """The fact, or why the robot does not have it."""
    try:
        return fact()
    except NotDerivableError as error:
        return f"none: {error.what}"
