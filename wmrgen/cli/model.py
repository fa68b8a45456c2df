"""``wmrgen model``: state, inputs and equations of a robot's model, or one step of it with constant inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, Words, flag, option, output, verb, words
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_option, from_words
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.robotfile.text import quoted

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.functions.models.state_space import StateSpace
    from wmrgen.functions.system import System


@verb("model")
def model(
    robot: Robot,
    values: Annotated[
        Words, words("With --discrete: the state and inputs at which A, B and c are printed.")
    ] = None,
    form: Annotated[
        Literal["posture", "configuration", "twist", "eta", "zeta", "trailer", "chained"] | None,
        option(
            "The inputs or state of the model: driven speeds, all joints, twist, null-space inputs, front wheel, "
            "trailers, chained. Default: twist if two axles steer, castors are driven or wheels skid; else trailer or "
            "posture.",
        ),
    ] = None,
    discrete: Annotated[
        Literal["rk4", "exact", "collocation"] | None,
        option("A step of constant inputs with its derivatives A, B and c. exact needs a constant twist."),
    ] = None,
    dt: Annotated[
        str | None,
        option("The duration of the step [s]. With -o it may be omitted: dt is then an input.", "T"),
    ] = None,
    out: Annotated[Path | None, output("FILE", "Write the step for casadi.Function.load.")] = None,
    as_latex: Annotated[bool, flag("--latex", "Print LaTeX.")] = False,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen model robots/bicycle.yaml --form posture

    Print a model x' = G(x) u of a robot: state, inputs, equations, vector fields, and where it is singular. With
    --discrete print its step x, u, p -> xnext, A, B, c, where xnext = A x + B u + c to first order.
    """
    from wmrgen.functions.models.state_space import default_form

    for word in values or ():
        if "=" not in word:
            raise UsageError(f"{quoted(word)} is not NAME=VALUE. A form is an option: --form posture.")
    if discrete is None and (dt or out or values):
        raise UsageError("--dt, -o and values are for the step of --discrete. Write --discrete rk4 too.")
    if as_latex and (as_json or discrete is not None):
        raise UsageError("--latex writes the equations of a form. Leave out --json and --discrete.")
    with derived(robot) as derivation:
        chosen = form or default_form(derivation.robot, derivation.mobility)
        if discrete is None:
            _equations(derivation, chosen, as_latex, as_json)
        else:
            _step(derivation, chosen, discrete, dt, values or (), out, as_json)
    return 0


def _equations(derivation: Derivation, form: str, as_latex: bool, as_json: bool) -> None:
    """Print the equations of one form of the model, its limits, and where each form is singular."""
    from wmrgen.functions.models.sheet import conditions, data, latex, lines, sheet_of, with_lags
    from wmrgen.functions.models.state_space import data as entries
    from wmrgen.functions.models.state_space import lags, limit_lines, regularity, state_space
    from wmrgen.functions.trailers.chained_sheet import chained_sheet

    space = None
    if form == "chained":  # a transformation of state and inputs, no system
        sheet = chained_sheet(derivation.robot, derivation.mobility)
    else:
        system = derivation.system(form, symbolic=True)
        space = state_space(derivation.robot, derivation.mobility, form)
        sheet = with_lags(sheet_of(form, system), lags(derivation.robot, system), space.text)
    singular = regularity(derivation.robot, derivation.mobility)
    singular.setdefault(form, conditions(sheet))
    if as_json:
        more = {} if space is None else {"state_space": entries(space)}
        console.data({**data(sheet), "singular_sets": singular, **more})
        return
    if as_latex:
        console.result(latex(sheet))
        return
    shown = [*lines(sheet)]
    limits = [] if space is None else limit_lines(space)
    if limits:
        shown += ["", "limits:", *(f"  {line}" for line in limits)]
    shown += ["", "regular:"]
    width = max(map(len, singular))
    for name, where in singular.items():
        regular = f"except where {'; '.join(where)}" if where else "in every motion"
        shown.append(f"  {name:<{width}} {regular}")
    console.result("\n".join(shown))


def _step(
    derivation: Derivation,
    form: str,
    discrete: str,
    dt: str | None,
    values: Sequence[str],
    out: Path | None,
    as_json: bool,
) -> None:
    """Write the step to the file ``out``, or print it at ``values``: the next state, A, B and c.

    Without ``dt`` the step in the file has the duration as its fourth input.
    """
    from wmrgen.codegen.registry import BACKENDS
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.functions.models.state_space import state_space

    if form == "chained":
        raise UsageError("the chained form has no step. Write any --form but chained.")
    span = None if dt is None else float(from_option("--dt", dt, [Port("dt", Role.COMMAND, "s")])[0])
    step = derivation.state_space(form, discrete, span)
    if out is not None:
        write_file(out, BACKENDS["casadi"].offers("content")(step))
        console.result(str(out))
        return
    if span is None:
        raise UsageError(
            "a step takes --dt. Write --dt 0.05 [s], or -o FILE for a step with dt as its fourth input."
        )
    space = state_space(derivation.robot, derivation.mobility, form)
    groups = (space.state, space.inputs, space.geometry)
    case = from_words(values, [port for ports in groups for port in ports], derivation.robot)
    point = [[float(case.get(p.name, p.default or ZERO)) for p in ports] for ports in groups]
    try:
        xnext, a, b, c = (part.full().tolist() for part in step(*point))
    except RuntimeError:
        raise UsageError(
            f"the {discrete} step of {span:g} s does not converge. Write a smaller --dt, or --discrete rk4."
        ) from None
    matrices = {"xnext": xnext, "A": a, "B": b, "c": c}
    finite = all(isfinite(value) for matrix in matrices.values() for row in matrix for value in row)
    if not finite or (space.singular and _is_singular(derivation.system(form), case)):
        where = "numbers overflow"
        if space.singular:
            where = f"{form} does not hold where {'; '.join(space.singular)}"
        raise UsageError(f"{where}. Write other values, or another --form.")
    for name in ("xnext", "c"):
        matrices[name] = [row[0] for row in matrices[name]]
    if as_json:
        facts = {"form": form, "discrete": discrete, "dt": span}
        names = {"x": [p.name for p in space.state], "u": [p.name for p in space.inputs]}
        console.data({**facts, **names, **matrices})
        return
    console.result(f"{form}, a step of {span:g} s by {discrete}: xnext = A x + B u + c, to first order\n")
    for line in _table(space, matrices):
        console.result(line)


def _table(space: StateSpace, matrices: Mapping[str, Any]) -> list[str]:
    """Return a table of a step: a row for each state, with its next value and its rows of A, B and c."""
    states, inputs = [p.name for p in space.state], [p.name for p in space.inputs]
    table = [["", "xnext", *(f"A {name}" for name in states), *(f"B {name}" for name in inputs), "c"]]
    for k, name in enumerate(states):
        numbers = [matrices["xnext"][k], *matrices["A"][k], *matrices["B"][k], matrices["c"][k]]
        table.append([name, *(f"{value:.6g}" for value in numbers)])
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = []
    for row in table:
        cells = zip(row, widths, strict=True)
        lines.append("  ".join(f"{text:>{width}}" for text, width in cells))
    return lines


def _is_singular(system: System, case: Mapping[str, Exact]) -> bool:
    """Return whether a divisor of the model is zero in a state, up to rounding.

    A model with guards gives 0 for a quotient whose divisor is zero. It then differs from the model without guards.
    """
    from wmrgen.ir.interpret import FLOAT64, evaluate
    from wmrgen.ir.lower import lower

    at = {p.name: ZERO for p in system.state} | dict(case) | {p.name: ONE for p in system.inputs}
    guarded = evaluate(lower(system.formula(guards=True)), at, FLOAT64)
    unguarded = evaluate(lower(system.formula(guards=False)), at, FLOAT64)
    return not all(abs(guarded[name] - unguarded[name]) < 1 for name in guarded)
