"""``wmrgen derive``: robot files in, folders of generated files out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.artifacts import Written, write_tree
from wmrgen.cli import console
from wmrgen.cli.gains import warn
from wmrgen.cli.loading import noted
from wmrgen.errors import UsageError

if TYPE_CHECKING:
    from wmrgen.ir.kernels.choice import Choice
    from wmrgen.layout.records import Robot
    from wmrgen.robot import Derivation


def load_all(paths: Sequence[Path]) -> list[Robot]:
    """All robots, before any is derived: a bad file must leave nothing behind. Names are unique."""
    robots = [wmrgen.load(path) for path in paths]
    seen: dict[str, Path] = {}
    for robot, path in zip(robots, paths, strict=True):
        if robot.name in seen:
            raise UsageError(f"{path} and {seen[robot.name]} both describe a robot called {robot.name}")
        seen[robot.name] = path
    return robots


def run(paths: Sequence[Path], out: Path, *, as_json: bool, choice: Choice, fuzz: bool = False) -> int:
    """Derive every robot, then write every robot, then print."""
    from wmrgen.emit import MODEL, artifacts

    done: list[tuple[Derivation, dict[str, bytes]]] = []
    with console.progress() as step:
        for robot in load_all(paths):
            step(f"deriving {robot.name} ({len(done) + 1} of {len(paths)})")
            noted(robot)
            if robot.gains:
                warn(robot)
            derivation = wmrgen.derive(robot)
            for found in derivation.mobility.singularities:
                if found.everywhere:
                    console.note(f"{robot.name}: warning: {found.meaning}")
            done.append((derivation, artifacts(derivation, choice, fuzz)))
    words = choice.words()
    written = [write_tree(out / derivation.robot.name, files, words) for derivation, files in done]
    if as_json:
        models = [files[MODEL].decode().rstrip("\n") for _, files in done]
        console.result(models[0] if len(models) == 1 else "[\n" + ",\n".join(models) + "\n]")
        return 0
    for (derivation, _), report in zip(done, written, strict=True):
        _summary(derivation, report, out)
    return 0


def _summary(derivation: Derivation, written: Written, out: Path) -> None:
    m = derivation.mobility
    kind = "degenerate" if m.robot_type is None else f"type ({m.robot_type[0]}, {m.robot_type[1]})"
    console.result(
        f"{derivation.robot.name}: {kind}, mobility {m.degree_of_mobility}, "
        f"steerability {m.degree_of_steerability}, maneuverability {m.degree_of_maneuverability}",
        "bold",
    )
    if m.reasons:
        console.result(f"  {m.reasons[0].splitlines()[0]}")
    files = written.changed + written.unchanged
    state = f"{len(written.changed)} new or changed" if written.changed else "all up to date"
    console.result(f"  {(out / derivation.robot.name).as_posix()}/ ({state}): {' '.join(sorted(files))}")
    for name in written.removed:
        console.note(f"{derivation.robot.name}: removed {name}, which is no longer produced")
