"""What stands in the output directory: robot files in, folders of generated files out.

``wmrgen derive`` writes them, ``wmrgen check`` says whether they are those of today.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import linted, noted, warn_of_gains
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.artifacts import Difference, Written, differences, made_with, write_tree
from wmrgen.errors import ErrorCollector, NotDerivableError, StaleError, UsageError, WmrgenError

if TYPE_CHECKING:
    from wmrgen.codegen.packages import Package
    from wmrgen.derivation.facade import Derivation
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.ir.kernels.choice import Choice
    from wmrgen.robotfile.records import RobotSpec

_WHY = {
    "missing": "missing",
    "differs": "not what the robot file gives today",
    "not produced": "no robot file produces it",
}


def derive(
    robots: Sequence[Path],
    out: Path,
    as_json: bool,
    scalar: str,
    math: str | None,
    target: str,
    fuzz: bool,
    batch: bool,
    package: Sequence[str] | None,
    html: bool,
    pdf: bool,
) -> int:
    """Derive every robot, then write every robot, then print."""
    from wmrgen.ir.kernels.choice import choice

    kinds: list[Package] = []
    if package:
        from wmrgen.codegen.packages import of_kinds

        kinds = of_kinds(package)
    chosen = choice(scalar, math, target)
    formats = [name for name, wanted in (("html", html), ("pdf", pdf)) if wanted]
    switches = [name for name, wanted in (("fuzz", fuzz), ("batch", batch)) if wanted]
    results: list[tuple[Derivation, dict[str, bytes]]] = []
    with console.progress() as step:
        files_read = _load_all(robots)
        # This loads sympy, for which a file that is refused need not wait.
        from wmrgen.derivation.emit import MODEL, artifacts
        from wmrgen.derivation.emit import package as packaged

        for spec, robot in files_read:
            step(f"deriving {robot.name} ({len(results) + 1} of {len(robots)})")
            derivation = derived(spec, robot)
            files = artifacts(derivation, chosen, switches)
            if formats:
                from wmrgen.report.pages.formats import formatted

                files |= formatted(derivation, files, formats)
            results.append((derivation, files))
    packages = [
        (out / kind.folder / d.robot.name, packaged(kind, d, chosen, files))
        for d, files in results
        for kind in kinds
    ]
    options = _options(chosen, switches, formats)
    written = [write_tree(out / d.robot.name, files, options) for d, files in results]
    for folder, files in packages:
        write_tree(folder, files, _options(chosen, switches))
    if as_json:
        models = [files[MODEL].decode().rstrip("\n") for _, files in results]
        console.result(models[0] if len(models) == 1 else '{"robots": [\n' + ",\n".join(models) + "\n]}")
        return 0
    for (derivation, _), changes in zip(results, written, strict=True):
        _summary(derivation, changes, out, len(results) == 1)
    for folder, files in packages:
        console.result(f"  {folder.as_posix()}/: {' '.join(files)}")
    return 0


def _options(choice: Choice, switches: Sequence[str], formats: Sequence[str] = ()) -> dict[str, str]:
    """What the manifest of a folder notes of how its files were made."""
    said = dict.fromkeys(switches, "yes") | ({"formats": " ".join(formats)} if formats else {})
    return choice.words() | said


def derived(spec: RobotSpec, robot: Robot) -> Derivation:
    """The derivation of a robot, with its notes and likely mistakes told. NotDerivableError for one that stops it."""
    derivation = wmrgen.derive(robot)
    findings = linted(spec, derivation)
    noted(robot, but={finding.what for finding in findings})
    warn_of_gains(robot, asked="goto_pose" in robot.functions)
    for finding in findings:
        if finding.stops:
            ignored = f"To derive it all the same write beside the line: # wmrgen: ignore {finding.code}"
            raise NotDerivableError(finding.what, finding.mark, finding.instead, ignored, finding.code)
        console.note(str(finding))
    _refuse_functions(spec, derivation)
    return derivation


def _refuse_functions(spec: RobotSpec, derivation: Derivation) -> None:
    """NotDerivableError for all functions that the robot file asks for and the robot does not have, where it asks."""
    lacking = []
    for name, mark in spec.functions:
        try:
            derivation.formula(name)
        except NotDerivableError as error:
            error.mark = error.mark or mark
            lacking.append(error)
    if lacking:
        joined = NotDerivableError(lacking[0].what, lacking[0].mark)
        joined.parts = tuple(lacking)
        raise joined


def _load_all(paths: Sequence[Path]) -> list[tuple[RobotSpec, Robot]]:
    """All robots, before any is derived: a bad file must leave nothing behind. Names are unique."""
    collector, robots = ErrorCollector(), []
    for path in paths:
        with collector:
            robots.append(wmrgen.read(path))
    collector.end()
    seen: dict[str, Path] = {}
    for (_, robot), path in zip(robots, paths, strict=True):
        word = robot.name.lower()  # disks may not tell folders apart by case
        if word in seen:
            raise UsageError(f"{path} and {seen[word]} both describe a robot called {robot.name}")
        seen[word] = path
    return robots


def _summary(derivation: Derivation, written: Written, out: Path, alone: bool) -> None:
    """What a robot is and what was written; on a terminal what it looks like, where it is the only one."""
    m, name = derivation.mobility, derivation.robot.name
    kind = "degenerate" if m.robot_type is None else f"type ({m.robot_type[0]}, {m.robot_type[1]})"
    console.result(
        f"{name}: {kind}, mobility {m.degree_of_mobility}, "
        f"steerability {m.degree_of_steerability}, maneuverability {m.degree_of_maneuverability}",
        "bold",
    )
    if m.deciding:
        console.result(f"  {m.deciding.splitlines()[0]}")
    if alone and console.on_a_terminal():
        for line in BACKENDS["drawing"].offers("sketch")(derivation.robot):
            console.result(f"    {line}".rstrip())
    files = written.changed + written.unchanged
    state = f"{len(written.changed)} new or changed" if written.changed else "all up to date"
    console.result(f"  {(out / name).as_posix()}/ ({state}): {_listed(files)}")
    unproved = [f.name for f in derivation.bounds.functions if f.alarms]
    if unproved:
        console.note(
            f"{name}: not proved, although limits are given: {', '.join(unproved)} (numerics.md says why)"
        )
    for file in written.removed:
        console.note(f"{name}: removed {file}, which is no longer produced")


def _listed(files: Sequence[str]) -> str:
    """Names of files; where more than four end alike, how many they are."""
    endings = [PurePosixPath(file).suffix for file in files]
    count = Counter(endings)
    words = {f"*{e} ({count[e]})" if count[e] > 4 else file for file, e in zip(files, endings, strict=True)}
    return " ".join(sorted(words))


def check(robots: Sequence[Path] | None, out: Path, as_json: bool) -> int:
    """Compare byte for byte; without ``robots``, every robots/*.yaml, and nothing else may stand under ``out``."""
    paths = robots or sorted(Path("robots").glob("*.yaml"))
    if not paths:
        raise UsageError("no robot file is given, and there is no robots/*.yaml here. Name a robot file.")
    stale: list[Difference] = []
    names: set[str] = set()
    errors: list[WmrgenError] = []
    with console.progress() as step:
        for number, path in enumerate(paths, 1):
            step(f"checking {path} ({number} of {len(paths)})")
            try:
                name, files = _differing_robot(path, out)
            except WmrgenError as error:
                errors.append(error)
                continue
            names.add(name)
            stale += files
    if not robots and not errors:
        from wmrgen.cli.gallery import differing_gallery
        from wmrgen.cli.textbook import differing_library

        try:
            stale += differing_library(out)
        except WmrgenError as error:  # the folder is here, the library is not
            errors.append(error)
        stale += [*differing_gallery(out), *(Difference(p, "not produced") for p in _strangers(out, names))]
    for failure in errors:
        console.failure(str(failure))
    _tell_stale(stale, errors, len(paths), out, as_json)
    return errors[0].exit_code if errors else (StaleError.exit_code if stale else 0)


def _tell_stale(
    stale: Sequence[Difference], errors: Sequence[WmrgenError], robots: int, out: Path, as_json: bool
) -> None:
    files = [(difference.path.as_posix(), _WHY[difference.why]) for difference in stale]
    if as_json:
        entries = [{"file": file, "why": why} for file, why in files]
        console.data({"robots": robots, "stale": entries, **console.all_as_data(errors)})
        return
    for file, why in files:
        console.result(f"{file}: {why}")
    if stale:
        console.note(
            "Run `wmrgen derive` on the robot files, then `wmrgen gallery`; remove what has no robot file."
        )
    elif not errors:
        count = f"{robots} robot{'s' * (robots != 1)}"
        console.result(f"{count}: everything under {out.as_posix()}/ is up to date")


def _differing_robot(path: Path, out: Path) -> tuple[str, list[Difference]]:
    """The name of a robot, and which files of its folder and its packages are not what its file gives today."""
    from wmrgen.codegen.packages import PACKAGES
    from wmrgen.derivation.emit import artifacts
    from wmrgen.derivation.emit import package as packaged
    from wmrgen.ir.kernels.choice import noted as noted_choice

    robot = wmrgen.load(path)
    derivation = wmrgen.derive(robot)
    folders = {out / kind.folder / robot.name: kind for kind in PACKAGES.values()}
    stale: list[Difference] = []
    for folder in (out / robot.name, *(folder for folder in folders if folder.is_dir())):
        words = made_with(folder)
        choice, formats = noted_choice(words), words.get("formats", "").split()
        switches = [name for name in ("fuzz", "batch") if name in words]
        files = artifacts(derivation, choice, switches)
        if folder in folders:
            files = packaged(folders[folder], derivation, choice, files)
        if formats:
            files |= _noted_formats(derivation, files, folder, formats)
        stale += differences(folder, files, _options(choice, switches, formats))
    return robot.name, stale


def _noted_formats(
    derivation: Derivation, files: Mapping[str, bytes], folder: Path, formats: Sequence[str]
) -> dict[str, bytes]:
    """The report in the formats that a manifest notes; of a PDF, which browsers print unlike, what stands there."""
    from wmrgen.report.pages.formats import PDF, formatted

    again = formatted(derivation, files, [name for name in formats if name == "html"])
    printed = folder / PDF
    return {**again, PDF: printed.read_bytes()} if "pdf" in formats and printed.is_file() else again


def _strangers(out: Path, names: set[str]) -> list[Path]:
    """What stands under ``out``, or in a folder of packages there, and belongs to no robot."""
    from wmrgen.cli.textbook import ERRATA, FOLDER
    from wmrgen.codegen.packages import PACKAGES
    from wmrgen.report.pages.overview import PAGES

    packages = [kind.folder for kind in PACKAGES.values()]
    places = {
        out: {*names, FOLDER, ERRATA, *PAGES, *packages},
        **{out / folder: names for folder in packages},
    }
    return [
        p
        for place, expected in places.items()
        if place.is_dir()
        for p in sorted(place.iterdir())
        if p.name not in expected
    ]
