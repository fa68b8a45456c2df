"""``wmrgen lint``: likely mistakes in robot files and in other descriptions of robots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Base, Json, Package, argument, robot_files, verb
from wmrgen.cli.loading import linted, paths_and_arguments
from wmrgen.errors import StaleError, UsageError, WmrgenError

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
    paths, arguments = paths_and_arguments(robots)
    report = _Report()
    for path in paths:
        try:
            report.read(path, arguments, base, package or ())
        except WmrgenError as error:
            report.errors += error.parts
    if as_json:
        findings = {"findings": [_as_data(f) for f in report.findings], "not_compared": report.not_compared}
        console.data({**findings, **console.all_as_data(report.errors)})
    else:
        _show(report, len(paths))
    if report.errors:
        return report.errors[0].exit_code
    return StaleError.exit_code if report.findings else 0


@dataclass
class _Report:
    """The findings of all files that were read."""

    findings: list[Finding] = field(default_factory=list)
    errors: list[WmrgenError] = field(default_factory=list)
    not_compared: list[str] = field(default_factory=list)  # what no check covers, in words
    robot: Layout | None = None  # the robot that parameters and headers after it are compared with

    def read(self, path: Path, arguments: Sequence[str], base: str | None, package: Sequence[str]) -> None:
        """Add the findings of one file.

        A robot file is checked itself. Parameters, headers, and a description after a robot file are compared with the
        robot before them.

        Args:
            path: the file.
            arguments: NAME:=VALUE of a xacro file.
            base: the link that is the robot's frame.
            package: NAME=DIR of packages that a description refers to.

        Raises:
            WmrgenError: if the file cannot be read, or if there is no robot to compare it with.
        """
        from wmrgen.tools.comparing.compare import compare, findings, labelled
        from wmrgen.tools.comparing.record import DESCRIPTION, ROBOT_FILE
        from wmrgen.tools.comparing.sources import layouts

        for layout in layouts(path, arguments, package, base):
            if layout.form == ROBOT_FILE:
                spec, built = wmrgen.read(path)
                self.findings += linted(spec, wmrgen.derive(built))
                self.robot = layout
            elif layout.form == DESCRIPTION and (self.robot is None or self.robot.form == DESCRIPTION):
                self.findings += labelled(layout)
                self.not_compared.append(
                    f"{layout.source}: only the names of its wheels are checked against their positions; "
                    "`wmrgen import` makes a robot file, in which `lint` checks everything"
                )
                self.robot = layout
            elif self.robot is not None:
                comparison = compare(self.robot, layout)
                self.findings += findings(comparison)
                self.not_compared += [f"not compared: {words}" for words in comparison.unsaid]
            elif not self.errors:  # else the robot before it is probably the one with the error
                raise UsageError(
                    f"{layout.source} has no robot before it: give a robot file or description first"
                )


def _show(report: _Report, files: int) -> None:
    """Print findings to stdout, errors and what was not compared to stderr."""
    for finding in report.findings:
        console.result(str(finding))
    for error in report.errors:
        console.failure(str(error))
    for words in report.not_compared:
        console.note(f"note: {words}")
    if report.findings:
        console.note(
            "Correct the lines, or add # wmrgen: ignore CODE to a line. `wmrgen explain CODE` says more."
        )
    elif not report.errors:
        noun = "file" if report.not_compared else "robot"
        where = " in what was compared" if report.not_compared else ""
        console.result(f"{files} {noun}{'s' * (files != 1)}: no findings{where}")


def _as_data(finding: Finding) -> dict[str, Any]:
    return {
        "code": finding.code,
        **console.place(finding.mark),
        "what": finding.what,
        "instead": finding.instead,
    }
