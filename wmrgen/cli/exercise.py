"""``wmrgen exercise``: a robot as an exercise for students, and its solution."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, count_option, flag, option, output, verb
from wmrgen.cli.loading import derived

Format = Literal["md", "tex", "html"]
_SUFFIXES: dict[str, Format] = {".tex": "tex", ".html": "html", ".htm": "html"}


@verb("exercise")
def exercise(
    robot: Robot,
    seed: Annotated[
        int,
        count_option("--seed", "The number of the exercise, which chooses the motion. Default: 0.", least=0),
    ] = 0,
    solution: Annotated[bool, flag("--solution", "Write the results too.")] = False,
    form: Annotated[
        Format | None,
        option("Markdown, LaTeX or HTML. Default: by the name of FILE, else md.", name="--format"),
    ] = None,
    out: Annotated[
        Path | None, output("FILE", "Write FILE, and for md and tex the figures next to it.")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen exercise robots/bicycle.yaml --seed 7 --solution -o solution.html

    Write the derivation of a robot as an exercise: its layout, a motion with short numbers, and questions on matrices,
    ranks, degrees, wheel rates, an encoder error and the pose. The same seed gives the same exercise everywhere.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.report.pages.exercise import document

    chosen = form or (_SUFFIXES.get(out.suffix.lower(), "md") if out else "md")
    with derived(robot, []) as derivation:
        text, figures = document(derivation, seed, solution, chosen)
    if out is None:
        if as_json:
            console.data({"text": text, "figures": {name: svg.decode() for name, svg in figures.items()}})
        else:
            console.result(text.rstrip("\n"))
        return 0
    write_file(out, text.encode())
    for name, svg in figures.items():
        write_file(out.with_name(name), svg)
    if as_json:
        console.data({"file": str(out), "figures": [str(out.with_name(name)) for name in figures]})
    else:
        console.result(str(out))
    return 0
