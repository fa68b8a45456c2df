"""``wmrgen lint``: likely mistakes in robot files and in other descriptions of robots."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Base, Json, Package, argument, robot_files, verb
from wmrgen.cli.loading import linted, paths_and_arguments
from wmrgen.errors import NotDerivableError, StaleError, UsageError, WmrgenError

if TYPE_CHECKING:
    from wmrgen.tools.comparing.record import Layout
    from wmrgen.tools.lint import Finding


@verb("lint")
def lint(
    robots: Annotated[
        list[str],
        argument("ROBOT.yaml...", "Robot files, URDF, xacro, SDF; NAME:=VALUE for xacro.", robot_files),
    ],
    base: Base = None,
    package: Package = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen lint robots/pioneer3dx.yaml

    Report likely mistakes in robots that can be derived, each finding with a code. Exit code 1 if there are findings.
    To keep a line as it is, add the comment # wmrgen: ignore CODE to it.
    """
    from wmrgen.tools.comparing.sources import layouts

    paths, arguments = paths_and_arguments(robots)
    findings: list[Finding] = []
    errors: list[WmrgenError] = []
    not_compared: list[str] = []
    robot: Layout | None = None  # the robot that parameters and headers after it are compared with
    for path in paths:
        try:
            for layout in layouts(path, arguments, package or (), base):
                if _is_robot(layout, robot):
                    found, skipped, refused = _findings_of(layout, path)
                    errors += refused
                    robot = layout
                elif robot is not None:
                    found, skipped = _differences(robot, layout)
                elif errors:
                    continue  # the robot before it is probably the one that cannot be read
                else:
                    raise UsageError(
                        f"{layout.source} has parameters of a controller, and no robot before it to compare them "
                        "with. Give a robot file or description first. A robot file begins with wmrgen: 1."
                    )
                findings += found
                not_compared += skipped
        except WmrgenError as error:
            errors += error.parts
    if as_json:
        found_data = {"findings": [_as_data(f) for f in findings], "not_compared": not_compared}
        console.data({**found_data, **console.all_as_data(errors)})
    else:
        _show(findings, errors, not_compared, len(paths))
    if errors:
        return errors[0].exit_code
    return StaleError.exit_code if findings else 0


def _is_robot(layout: Layout, robot: Layout | None) -> bool:
    """Return whether a file is checked by itself, rather than compared with the ``robot`` before it.

    Robot files are; descriptions are, except after a robot file. Parameters of controllers and headers never are.
    """
    from wmrgen.tools.comparing.record import DESCRIPTION, ROBOT_FILE

    if layout.form == ROBOT_FILE:
        return True
    return layout.form == DESCRIPTION and (robot is None or robot.form == DESCRIPTION)


def _findings_of(layout: Layout, path: Path) -> tuple[list[Finding], list[str], list[WmrgenError]]:
    """Return the findings in a robot file or description, what was not checked, and why it cannot be derived."""
    from wmrgen.tools.comparing.compare import labelled
    from wmrgen.tools.comparing.record import ROBOT_FILE

    if layout.form == ROBOT_FILE:
        spec, built = wmrgen.read(path)
        derivation = wmrgen.derive(built)
        found = linted(spec, derivation)
        try:
            _ = derivation.mobility
        except NotDerivableError as error:
            return found, [], list(error.parts)
        return found, [], []
    unchecked = (
        f"{layout.source}: only the names of its wheels are checked against their positions; `wmrgen import` makes a "
        "robot file, in which `lint` checks everything"
    )
    return list(labelled(layout)), [unchecked], []


def _differences(robot: Layout, layout: Layout) -> tuple[list[Finding], list[str]]:
    """Return the differences between a robot and a file about it, and what was not compared, in words."""
    from wmrgen.tools.comparing.compare import compare, findings

    comparison = compare(robot, layout)
    return list(findings(comparison)), [f"not compared: {words}" for words in comparison.unsaid]


def _show(
    findings: Sequence[Finding], errors: Sequence[WmrgenError], not_compared: Sequence[str], files: int
) -> None:
    """Print findings to stdout, errors and what was not compared to stderr."""
    for finding in findings:
        console.result(str(finding))
    for error in errors:
        console.failure(str(error))
    for words in not_compared:
        console.note(f"note: {words}")
    if findings:
        console.note(
            "Correct the lines, or add # wmrgen: ignore CODE to a line. `wmrgen explain CODE` says more."
        )
    elif not errors:
        noun = "file" if not_compared else "robot"
        where = " in what was compared" if not_compared else ""
        console.result(f"{files} {noun}{'s' * (files != 1)}: no findings{where}")


def _as_data(finding: Finding) -> dict[str, Any]:
    return {
        "code": finding.code,
        **console.place(finding.mark),
        "what": finding.what,
        "instead": finding.instead,
    }
