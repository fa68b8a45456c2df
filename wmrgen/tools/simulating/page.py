"""The page of a simulated drive: the live robots of reports, which play the drive, above its figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.figures.figure import Figure
from wmrgen.report.pages import live
from wmrgen.report.pages.document import REPORT, Report, page
from wmrgen.tools.simulating.drive import Drive

FUNCTIONS = live.FUNCTIONS  # which the derivation of a drive must have


def written(drives: Sequence[Drive], drawn: Figure) -> str:
    """Return the HTML. Robots with several starts play the first one.

    Args:
        drives: the drives.
        drawn: their figure.

    Returns:
        A page that needs nothing else.
    """
    reports = []
    for number, drive in enumerate(drives):
        derivation = drive.model.derivation
        robot = {**live.robot(derivation), "drive": recorded(drive)}
        files = (
            {}
            if number
            else {
                REPORT: f"# The drive\n\n![]({drawn.file})\n".encode(),
                drawn.file: _at_full_height(drawn.svg),
            }
        )
        reports.append(Report(drive.name, files, robot, live.code(derivation)))
    return page(reports)


def _at_full_height(svg: str) -> bytes:
    """Return a figure that is shown as high as it is, although pages limit the height of figures."""
    return svg.replace('class="wmrgen"', 'class="wmrgen" style="max-height: none"', 1).encode()


def recorded(drive: Drive) -> dict[str, Any]:
    """Return the first start of a drive as `templates/html/live.js` plays it: the pose and the angles at the start,
    and a list of [seconds, vx, vy, omega]."""
    angles = {}
    for name, column in drive.columns.items():
        if name.endswith((".steer", ".theta")):
            angles[name] = float(column[0, 0])
    segments: list[list[float]] = []
    seconds = np.diff(drive.t[:, 0])
    for row, dt in enumerate(seconds.tolist()):
        twist = [float(drive.columns[name][row, 0]) for name in TWIST_NAMES]
        if segments and segments[-1][1:] == twist:
            segments[-1][0] += dt
        elif dt > 0:
            segments.append([dt, *twist])
    return {"pose": list(drive.pose(0, 0)), "angles": angles, "segments": segments}
