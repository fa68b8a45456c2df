"""WPILib: constants and its kinematics in Java and in C++ (https://docs.wpilib.org, kinematics and odometry).

Its speeds are in m/s along the robot's x, of swerve modules along the module: radii, joints that turn the other way and
the direction of modules at steering angle 0 stand beside.
"""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import wrap

from wmrgen.backends.c99.text import comment_text
from wmrgen.errors import NotDerivableError
from wmrgen.exporting.drives import Drive, drive_of
from wmrgen.exporting.text import banner, decimal
from wmrgen.layout.records import Robot, Wheel

_CLASSES = {"differential": "DifferentialDrive", "mecanum": "MecanumDrive", "swerve": "SwerveDrive"}
_YEARS = (
    "For WPILib 2026. In 2027 the packages are org.wpilib.math.kinematics and org.wpilib.math.geometry; in C++ the "
    "namespaces are wpi::math and wpi::units, the headers wpi/math/kinematics/, wpi/math/geometry/, wpi/units/ (.hpp)."
)


@dataclass(frozen=True, slots=True)
class _Constant:
    """``kind``: length, flag, angle, place or kinematics; ``values`` are numbers as written, or names."""

    kind: str
    name: str
    values: tuple[str, ...]
    text: str


def wpilib(robot: Robot) -> dict[str, str]:
    """A Java class and a C++ header. NotDerivableError where WPILib has no kinematics of the robot, and why."""
    try:
        drive = drive_of(robot)
        if drive.kind not in _CLASSES:
            raise NotDerivableError(f"it has none for {drive.kind} drives")
    except NotDerivableError as error:
        raise NotDerivableError(f"{robot.name}: no kinematics of WPILib fits: {error}.") from None
    kinematics = f"{_CLASSES[drive.kind]}Kinematics"
    constants = _constants(drive)
    about = [line for text in (*banner(robot), _YEARS, *drive.notes) for line in wrap(comment_text(text), 96)]
    name = "".join(part[:1].upper() + part[1:] for part in robot.name.split("_")) + "Constants"
    return {
        f"{name}.java": _java(name, kinematics, constants, about),
        f"{name}.h": _cpp(robot.name, kinematics, constants, about),
    }


def _constants(drive: Drive) -> list[_Constant]:
    constants = [constant for wheel in drive.wheels for constant in _wheel(drive, wheel)]
    arguments = tuple(f"{wheel.name.upper()}_LOCATION" for wheel in drive.wheels)
    track = drive.terms.get("separation")
    if isinstance(track, float):
        text = "From the left to the right wheels [m]."
        constants.append(_Constant("length", "TRACK_WIDTH", (decimal(track),), text))
        arguments = ("TRACK_WIDTH",)
    order = ", ".join(wheel.name for wheel in drive.wheels)
    return [*constants, _Constant("kinematics", "KINEMATICS", arguments, f"Wheels in the order {order}.")]


def _wheel(drive: Drive, wheel: Wheel) -> list[_Constant]:
    name, g = wheel.name.upper(), wheel.nominal
    constants = [
        _Constant("place", f"{name}_LOCATION", (decimal(g.x), decimal(g.y)), "x forward, y left [m]."),
        _Constant("length", f"{name}_RADIUS", (decimal(g.r),), "[m]"),
    ]
    if drive.kind == "swerve":
        text = "Direction of the module at steering angle 0 of the robot file [rad]: add it to the angle."
        return [*constants, _Constant("angle", f"{name}_ZERO", (decimal(wheel.heading),), text)]
    backward = "true" if wheel.name in drive.backward else "false"
    text = "Whether a positive rate of the joint rolls the robot backward."
    return [*constants, _Constant("flag", f"{name}_INVERTED", (backward,), text)]


def _java(name: str, kinematics: str, constants: list[_Constant], about: list[str]) -> str:
    def written(c: _Constant) -> str:
        types = {
            "length": "double", "angle": "double", "flag": "boolean",
            "place": "Translation2d", "kinematics": kinematics,
        }  # fmt: skip
        kind, values = types[c.kind], ", ".join(c.values)
        value = f"new {kind}({values})" if c.kind in ("place", "kinematics") else values
        return f"  /** {c.text} */\n  public static final {kind} {c.name} = {value};\n"

    used = ["geometry.Translation2d", f"kinematics.{kinematics}"]
    return "\n".join(
        [
            "package frc.robot;\n",
            *(f"import edu.wpi.first.math.{each};" for each in used),
            "\n/**", *(f" * {line}" for line in about), " */",
            f"public final class {name} {{\n  private {name}() {{}}\n",
            *map(written, constants),
        ]
    )[:-1] + "\n}\n"  # fmt: skip


def _cpp(name: str, kinematics: str, constants: list[_Constant], about: list[str]) -> str:
    modules = f"<{len(constants[-1].values)}>" if kinematics.startswith("Swerve") else ""
    types = {
        "length": "constexpr units::meter_t", "angle": "constexpr units::radian_t", "flag": "constexpr bool",
        "place": "const frc::Translation2d", "kinematics": f"const frc::{kinematics}{modules}",
    }  # fmt: skip

    def written(c: _Constant) -> str:
        values = [f"units::meter_t{{{v}}}" for v in c.values] if c.kind == "place" else c.values
        return f"/// {c.text}\ninline {types[c.kind]} {c.name}{{{', '.join(values)}}};"

    headers = [
        "frc/geometry/Translation2d.h",
        f"frc/kinematics/{kinematics}.h",
        "units/angle.h",
        "units/length.h",
    ]
    return "\n".join(
        [
            "/**", *(f" * {line}" for line in about), " */", "#pragma once\n",
            *(f"#include <{header}>" for header in headers),
            f"\nnamespace {name} {{\n", *map(written, constants), f"\n}}  // namespace {name}\n",
        ]
    )  # fmt: skip
