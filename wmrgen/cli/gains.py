"""``wmrgen gains``: a check of the gains of the polar feedback law, Siegwart (3.60)-(3.65), corrected."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Words, argument, verb
from wmrgen.cli.values import from_words
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.robotfile.numbers import NUMBER
from wmrgen.robotfile.text import quoted

if TYPE_CHECKING:
    from wmrgen.functions.control.gains import Verdict

_UNITS = {"k_rho": "1/s", "k_alpha": "1/s", "k_beta": "1/s", "eigenvalues": "1/s"}
_LARGEST = Exact(10**50)  # 1/s: the cubes of larger gains are beyond a double


@verb("gains")
def gains(
    values: Annotated[
        Words,
        argument(
            "[ROBOT.yaml] [NAME=VALUE]...",
            "k_rho k_alpha k_beta [1/s]; others are those of the robot file, or of the text.",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen gains k_rho=3 k_alpha=8 k_beta=-1.5

    Check the gains of the polar feedback law of goto_pose: whether it is stable near the goal, and from which poses,
    with the violated conditions and the eigenvalues (Siegwart (3.60)-(3.65), corrected). The decision is exact.

    strong_3_65: a goal in front stays in front if |beta| is at most 150 deg; strong_all_beta: at every beta.
    """
    from wmrgen.functions.control.gains import TEXTBOOK, judge, linearisation, nominal_gains, polynomial

    words = values or ()
    chosen = dict(TEXTBOOK)
    for word in words:
        if "=" not in word and (word in chosen or re.fullmatch(rf"[+-]?{NUMBER}", word)):
            raise UsageError(
                f"{quoted(word)} is not NAME=VALUE. Write gains as {' '.join(f'{n}=1' for n in chosen)}."
            )
    if words and "=" not in words[0]:
        chosen, words = nominal_gains(wmrgen.load(Path(words[0]))), words[1:]
    chosen |= from_words(words, [Port(name, Role.COMMAND, "1/s") for name in chosen])
    if any(abs(value) > _LARGEST for value in chosen.values()):
        raise UsageError(
            f"a gain is beyond {float(_LARGEST):g} in magnitude. Gains of robots are near 1 to 10."
        )
    verdict = judge(**chosen)
    facts: dict[str, Any] = {name: float(value) for name, value in chosen.items()}
    facts |= {
        "stable": verdict.stable,
        "strong_3_65": verdict.strong,
        "strong_all_beta": verdict.strong_all_beta,
        "violated": list(verdict.violated),
        "linearisation": [[float(v) for v in row] for row in linearisation(**chosen)],
        "polynomial": [float(v) for v in polynomial(**chosen)],
        "eigenvalues": [[e.real + 0.0, e.imag + 0.0] for e in verdict.eigenvalues],
    }
    if as_json:
        console.data(facts)
        return 0
    powers = zip(facts["polynomial"], ("s^3", "s^2", "s", ""), strict=True)
    texts = {name: _text(value) for name, value in facts.items()}
    texts["violated"] = ", ".join(verdict.violated) or "nothing"
    texts["polynomial"] = " ".join(f"{c:+.6g} {power}".rstrip() for c, power in powers)
    texts["eigenvalues"] = ", ".join(_complex(real, imaginary) for real, imaginary in facts["eigenvalues"])
    console.result(_sentence(verdict))
    console.values(texts, _UNITS)
    if verdict.stable:
        for text in verdict.lost:
            console.note(f"not from every pose: {text} fails")
    return 0


def _sentence(verdict: Verdict) -> str:
    """Return what a robot with these gains does, in one sentence."""
    if not verdict.stable:
        failing = " and ".join(verdict.violated)
        return f"Unstable: the robot does not converge to the goal, because the gains violate {failing}."
    if verdict.strong_all_beta:
        return "Stable: a goal in front of the robot stays in front of it, whatever the heading at the goal."
    if verdict.strong:
        return "Stable: a goal in front of the robot stays in front of it if |beta| is at most 150 deg at the start."
    return "Stable near the goal, but a goal in front of the robot may get behind it on the way."


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(value)


def _complex(real: float, imaginary: float) -> str:
    return f"{real:.6g}{imaginary:+.6g}i" if imaginary else f"{real:.6g}"
