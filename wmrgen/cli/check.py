"""``wmrgen check``: is everything under generated/ what the robot files give today?"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import wmrgen
from wmrgen.artifacts import Difference, differences, made_with
from wmrgen.cli import console
from wmrgen.errors import StaleError, UsageError, WmrgenError

_WHY = {
    "missing": "missing",
    "differs": "not what the robot file gives today",
    "not produced": "no robot file produces it",
}


def run(paths: Sequence[Path], out: Path) -> int:
    """Compare byte for byte; without paths, every robots/*.yaml, and nothing else may stand under ``out``."""
    robots = list(paths) or sorted(Path("robots").glob("*.yaml"))
    if not robots:
        raise UsageError("no robot file given, and no robots/*.yaml here")
    found: list[Difference] = []
    names: set[str] = set()
    code = 0
    with console.progress() as step:
        for number, path in enumerate(robots, 1):
            step(f"checking {path} ({number} of {len(robots)})")
            try:
                name, stale = _stale(path, out)
            except WmrgenError as error:
                console.failure(str(error))
                code = code or error.exit_code
                continue
            names.add(name)
            found += stale
    if not paths and not code:
        from wmrgen.cli.textbook import ERRATA, FOLDER, differing

        try:
            found += differing(out)
        except WmrgenError as error:  # the folder is here, the library is not
            console.failure(str(error))
            code = error.exit_code
        found += [Difference(p, "not produced") for p in _strangers(out, {*names, FOLDER, ERRATA})]
    for difference in found:
        console.result(f"{difference.path.as_posix()}: {_WHY[difference.why]}")
    if found:
        console.note("run `wmrgen derive` on the robot files (make generate), or remove what has none")
    elif not code:
        console.result(
            f"{len(robots)} robot{'s' * (len(robots) != 1)}: everything under {out.as_posix()}/ is up to date"
        )
    return code or (StaleError.exit_code if found else 0)


def _stale(path: Path, out: Path) -> tuple[str, list[Difference]]:
    from wmrgen.emit import artifacts
    from wmrgen.ir.kernels.choice import noted

    robot = wmrgen.load(path)
    place = out / robot.name
    choice = noted(made_with(place))
    return robot.name, differences(place, artifacts(wmrgen.derive(robot), choice), choice.words())


def _strangers(out: Path, names: set[str]) -> list[Path]:
    """What stands under ``out`` and belongs to no robot."""
    return [p for p in sorted(out.iterdir()) if p.name not in names] if out.is_dir() else []
