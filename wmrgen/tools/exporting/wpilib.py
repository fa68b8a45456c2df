"""Write constants and kinematics for WPILib in Java and in C++ (https://docs.wpilib.org, kinematics and odometry).

Its speeds are in m/s along the robot's x, or along a swerve module. Radii, inverted joints and the directions of
modules at steering angle 0 are constants of their own.
"""

from __future__ import annotations

import re
from textwrap import wrap

from wmrgen.codegen.c.text import comment_text
from wmrgen.codegen.render import render
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.drives import drive_with, refusing
from wmrgen.tools.exporting.text import banner, decimal

_CLASSES = {"differential": "DifferentialDrive", "mecanum": "MecanumDrive", "swerve": "SwerveDrive"}
_YEARS = (
    "For WPILib 2026. In 2027 the packages are org.wpilib.math.kinematics and org.wpilib.math.geometry; in C++ the "
    "namespaces are wpi::math and wpi::units, the headers wpi/math/kinematics/, wpi/math/geometry/, wpi/units/ (.hpp)."
)


def wpilib(robot: Robot) -> dict[str, str]:
    """Return a Java class and a C++ header; raise NotDerivableError if WPILib has no kinematics of the robot."""
    with refusing(f"{robot.name}: no kinematics of WPILib fits"):
        drive, name = drive_with(robot, _CLASSES.get)
    swerve = drive.kind == "swerve"
    names = _constants([w.name for w in drive.wheels])
    tracks = [decimal(v) for v in drive.named({"": "separation"}, {}).values() if isinstance(v, float)]
    title = "".join(part[:1].upper() + part[1:] for part in robot.name.split("_")) + "Constants"
    context = {
        "about": [line for text in (*banner(robot), _YEARS, *drive.notes) for line in wrap(comment_text(text), 96)],
        "robot": robot.name, "title": title, "kinematics": f"{name}Kinematics",
        "wheels": [(names[w.name], *map(decimal, (w.nominal.x, w.nominal.y, w.nominal.r))) for w in drive.wheels],
        "inverted": [] if swerve else [(n, str(w in drive.backward).lower()) for w, n in names.items()],
        "zeros": [(names[w.name], decimal(w.heading)) for w in drive.wheels] if swerve else [],
        "tracks": tracks, "modules": f"<{len(names)}>" if swerve else "", "order": ", ".join(names),
        "arguments": "TRACK_WIDTH" if tracks else ", ".join(f"{name}_LOCATION" for name in names.values()),
    }  # fmt: skip
    return {f"{title}.{end}": render(f"export/Constants.{end}.j2", **context) for end in ("java", "h")}


def _constants(names: list[str]) -> dict[str, str]:
    """Return the names of wheels as constants, FRONT_LEFT for frontLeft, unless two would be equal."""
    words = {name: re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).upper() for name in names}
    return words if len(set(words.values())) == len(names) else {name: name.upper() for name in names}
