"""``wmrgen functions``: the functions that a robot has, and why it does not have the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, verb
from wmrgen.cli.loading import derived
from wmrgen.cli.textbook import LIBRARY, installed, is_library
from wmrgen.errors import NotDerivableError

if TYPE_CHECKING:
    from wmrgen.analysis.kinematics.records import Formula


@verb("functions")
def functions(robot: Robot, as_json: Json = False) -> int:
    """Example:  wmrgen functions robots/pioneer3dx.yaml

    List the functions that a robot has, each with a sentence, and why it does not have the others. Functions marked *
    are generated; a robot file requests more under `functions`. `wmrgen eval` computes all of them.
    With the word textbook instead of a robot, list the formulas of the texts that need no robot.
    """
    if is_library(robot):
        return _print_library(as_json)
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
                "functions": [_as_data(f, f.name in generated) for f in formulas],
                "absent": [{"name": name, "why": why} for name, why in absent.items()],
            }
        )
        return 0
    width = max(map(len, names()))
    for f in formulas:
        console.result(f"{'*' if f.name in generated else ' '} {f.name:<{width}}  {f.text}")
    console.note(
        "* is generated. List others under functions: in the robot file, or compute them by wmrgen eval."
    )
    if absent:
        console.result("\nIt does not have:")
    for name, why in absent.items():
        reason = why.splitlines()[0].split(": ", 1)[-1]
        console.result(f"  {name:<{width}}  {reason}")
    return 0


def _print_library(as_json: bool) -> int:
    """Print the functions of the textbook library. Return the exit code."""
    formulas = installed().formulas()
    if as_json:
        console.data({"robot": LIBRARY, "functions": [_as_data(f, True) for f in formulas], "absent": []})
        return 0
    width = max(len(f.name) for f in formulas)
    for f in formulas:
        console.result(f"{f.name:<{width}}  {f.text}")
    return 0


def _as_data(formula: Formula, generated: bool) -> dict[str, Any]:
    """Return a function for JSON."""
    return {
        "name": formula.name,
        "text": formula.text,
        "source": formula.source,
        "generated": generated,
        "inputs": [port.name for port in formula.inputs],
        "outputs": [port.name for port, _ in formula.outputs],
    }
