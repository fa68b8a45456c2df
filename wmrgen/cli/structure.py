"""``wmrgen structure``: integrability, Lie brackets, flatness and the chained form of a robot's model."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, option, verb
from wmrgen.cli.loading import derived
from wmrgen.errors import NotDerivableError

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation

Shown = Callable[[Any], str]  # an expression -> its text


@verb("structure")
def structure(
    robot: Robot,
    form: Annotated[
        str | None,
        option(
            "The model whose Lie brackets are formed: configuration has the angles of wheels and castors.",
            "NAME",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen structure robots/unicycle.yaml --form configuration

    Test the integrability of each rolling constraint (Frobenius, with the proof) and of all together, and print the
    relations that they integrate to. Print the Lie brackets with the growth vector, and the configurations where it is
    different; flat outputs; the chained form, or why there is none.
    """
    from wmrgen.geometry.printing import Reader, exact

    with derived(robot) as derivation:
        if as_json:
            console.data(_facts(derivation, form, exact))
            return 0
        reader = Reader()  # prints long fractions as decimals
        lines = _lines(_facts(derivation, form, reader))
        if reader.note:
            lines.append(reader.note)
    console.result("\n".join(lines))
    return 0


def _lines(facts: dict[str, Any]) -> list[str]:
    """Return ``facts`` as lines to read."""
    lines = [facts["text"]]
    lines += [f"  {row['wheel']}, {row['kind']}: {row['proof']}" for row in facts["constraints"]]
    lines += [f"  integrates to: {text}" for text in facts["integrals"]]
    lines.append(f"brackets: {facts['brackets']}")
    for other in facts["exceptional"] or ():
        vector = ", ".join(map(str, other["growth_vector"]))
        growth = f"growth vector ({vector})" if vector else "the growth vector may be different"
        lines.append(f"  where {other['condition']}: {growth}")
    lines += [f"  {name} = ({', '.join(field)})" for name, field in facts["fields"].items()]
    lines += [f"{key}: {facts[key]}" for key in ("flat", "chained")]
    return lines


def _facts(derivation: Derivation, form: str | None, shown: Shown) -> dict[str, Any]:
    """Return the facts for JSON, with Lie brackets of the model ``form``; ``shown`` prints expressions."""
    tests = derivation.integrability
    constraints = [
        {
            "wheel": row.wheel,
            "kind": row.kind,
            "integrable": row.integrable,
            "value": shown(row.value),
            "proof": row.proof(shown),
            "latex": row.latex,
        }
        for row in tests.rows
    ]
    return {
        "text": tests.text,
        "holonomic": tests.holonomic,
        "ddof": tests.ddof,
        "dof": tests.dof,
        "constraints": constraints,
        "integrals": [integral.text for integral in tests.integrals],
        **_growth(derivation, form, shown),
        "flat": _or_why(lambda: _flat(derivation)),
        "chained": _or_why(lambda: _chained(derivation)),
    }


def _growth(derivation: Derivation, form: str | None, shown: Shown) -> dict[str, Any]:
    """Return the growth vector of the input fields, the brackets that increase it, and where it is different."""
    from wmrgen.functions.models.exceptional import exceptional
    from wmrgen.functions.models.growth import growing, growth

    try:
        if form is None:
            system = growing(derivation.robot, derivation.mobility)
        else:
            system = derivation.system(form, symbolic=True)
        found = growth(system)
    except NotDerivableError as error:
        return {"growth_vector": [], "brackets": f"none: {error.what}", "fields": {}, "exceptional": None}
    sets = exceptional(system, found)
    others = None
    if sets is not None:
        others = [{"condition": f"{shown(s.condition)} = 0", "growth_vector": list(s.vector)} for s in sets]
    return {
        "growth_vector": list(found.vector),
        "brackets": found.describe(everywhere=sets == ()),
        "fields": {bracket.name: list(bracket.written(shown)) for bracket in found.brackets},
        "exceptional": others,
        "state": list(found.state),
    }


def _flat(derivation: Derivation) -> str:
    from wmrgen.functions.trailers.flat import flatness

    flat = flatness(derivation.robot, derivation.mobility)
    return f"{flat.outputs}: {flat.text}"


def _chained(derivation: Derivation) -> str:
    from wmrgen.functions.trailers.train import train

    size = train(derivation.robot, derivation.mobility).size
    return f"(2,{size}) chain; `wmrgen model ROBOT.yaml --form chained` prints it"


def _or_why(fact: Callable[[], str]) -> str:
    """Return the fact, or why the robot does not have it."""
    try:
        return fact()
    except NotDerivableError as error:
        return f"none: {error.what}"
