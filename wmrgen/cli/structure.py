"""``wmrgen structure``: what integrates, what Lie brackets reach, what is flat, whether a chained form exists."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.errors import NotDerivableError

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

Shown = Callable[[Any], str]


def run(path: Path, *, as_json: bool) -> int:
    """Print Frobenius's test with its proofs, integrals, Lie brackets, flat outputs and the chained form."""
    from wmrgen.printing import exact

    with derived(path) as derivation:
        if as_json:
            console.data(_facts(derivation, exact))
            return 0
        lines = _lines(derivation)
    console.result("\n".join(lines))
    return 0


def _lines(d: Derivation) -> list[str]:
    """What a reader sees: fractions too long to read as decimals."""
    from wmrgen.printing import Reader

    shown = Reader()
    facts = _facts(d, shown)
    lines = [facts["text"]]
    lines += [f"  {row['wheel']}, {row['kind']}: {row['proof']}" for row in facts["constraints"]]
    lines += [f"  integrates to: {text}" for text in facts["integrals"]]
    lines += [f"brackets: {facts['brackets']}"]
    lines += [f"  {name} = ({', '.join(field)})" for name, field in facts["fields"].items()]
    lines += [f"{key}: {facts[key]}" for key in ("flat", "chained")]
    return [*lines, shown.note] if shown.note else lines


def _facts(d: Derivation, shown: Shown) -> dict[str, Any]:
    tests = d.integrability
    return {
        "text": tests.text,
        "holonomic": tests.holonomic,
        "ddof": tests.ddof,
        "dof": tests.dof,
        "constraints": [
            {
                "wheel": r.wheel, "kind": r.kind, "integrable": r.integrable, "value": shown(r.value),
                "proof": r.proof_in(shown), "latex": r.latex,
            }
            for r in tests.rows
        ],
        "integrals": [i.text for i in tests.integrals],
        **_growth(d, shown),
        "flat": _or_why(lambda: _flat(d)),
        "chained": _or_why(lambda: _chained(d)),
    }  # fmt: skip


def _growth(d: Derivation, shown: Shown) -> dict[str, Any]:
    """Dimensions that input fields and brackets span, by order, and brackets that add one."""
    try:
        growth = d.growth
    except NotDerivableError as error:
        return {"growth_vector": [], "brackets": f"none: {error}", "fields": {}}
    fields = {b.name: list(b.written(shown)) for b in growth.brackets}
    return {"growth_vector": list(growth.vector), "brackets": growth.text, "fields": fields}


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
        return f"none: {error}"
