"""Controllers of other software, one record each: its parameters and joints, and the joint commands of a twist.

`export` writes the parameters of a record. `compare` reads them and evaluates the record. Formulas follow the sources
of each controller, which its module names. No released package of ros2_controllers has a swerve drive controller.
"""

from wmrgen.tools.controllers import diff_drive, gazebo, mecanum, omni, steering
from wmrgen.tools.controllers.record import ControllerType

CONTROLLER_TYPES: tuple[ControllerType, ...] = (
    *diff_drive.TYPES,
    *mecanum.TYPES,
    *omni.TYPES,
    *steering.TYPES,
    *gazebo.TYPES,
)


def controller_type(type_: str) -> ControllerType | None:
    """Return the record of a controller by its type as a file has it, such as a plugin's; None if there is none."""
    return next((each for each in CONTROLLER_TYPES if each.pattern.search(type_)), None)


def ros2_controller(kind: str) -> ControllerType | None:
    """Return the record of ros2_controllers for a kind of drive, which `export` writes; None if there is none."""
    return next((each for each in CONTROLLER_TYPES if each.kind == kind and "/" in each.name), None)


def gazebo_system(kind: str) -> ControllerType | None:
    """Return the record of Gazebo's system for a kind of drive; None if there is none."""
    return next((each for each in gazebo.TYPES if each.kind == kind), None)
