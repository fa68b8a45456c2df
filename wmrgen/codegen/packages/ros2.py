"""The variables of the templates of the ROS 2 package: joints, covariances, parameters."""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.codegen.packages.cpp import loop
from wmrgen.geometry.ports import GYRO, POSE_COVARIANCE, TWIST_COVARIANCE
from wmrgen.ir.nodes import Module

_QUANTITIES = {  # joint -> ending of its name in ROS, field of a joint state
    "spin": ("spin", "velocity"),
    "steer": ("steer", "position"),
    "steer_rate": ("steer", "velocity"),
}
_AXES = (0, 1, 5)  # indices of x, y and yaw among the six axes of a message
_PAIRS = [(i, j) for k, i in enumerate(_AXES) for j in _AXES[k:]]
_NOTE = "pose_variance, twist_variance: variances of x, y, yaw and of their rates (there is no odometry_covariance)"


def context(module: Module, scalar: str) -> Mapping[str, object]:
    """Return the variables of the templates for a robot.

    ``joints`` has for each joint its default name in ROS, the quantity (velocity or position), and whether it must be
    measured. ``commanded`` has index and quantity of the joints that the robot drives.
    """
    steps = loop(module, scalar)
    functions = {function.name: function for function in module.functions}
    joints = []
    for name in module.joints or ():
        wheel, _, joint = name.rpartition(".")
        ending, quantity = _QUANTITIES[joint]
        joints.append((f"{wheel}_{ending}", quantity, str(name in steps.measured).lower()))
    driven = {port.name for port in functions["inverse"].outputs}
    parts = ("pose", POSE_COVARIANCE), ("twist", TWIST_COVARIANCE)
    values = []  # part of the message, row, column, expression
    for part, ports in parts:
        if steps.covariance:
            for (i, j), port in zip(_PAIRS, ports, strict=True):
                values.append((part, i, j, f"{part}_covariance.{port.name}"))
        else:
            values += [(part, i, i, f"{part}_variance_[{k}]") for k, i in enumerate(_AXES)]
    names = [] if steps.covariance else [f"{part}_variance" for part, _ in parts]
    default = "std::vector<double>{1e-3, 1e-3, 1e-3}"
    return {
        "ros": f"{module.name.lower()}_kinematics",
        "joints": joints,
        "variables": list(steps.variables.items()),
        "gyro": GYRO.name in steps.variables,
        "prepare": [f"{call.text()};" for call in steps.prepare],
        "sense": [call.text("_checked") for call in steps.sense],
        "keep": steps.keep,
        "act": [call.text("_checked") for call in steps.act],
        "commanded": [(k, joints[k][1]) for k, name in enumerate(module.joints or ()) if name in driven],
        "covariances": [
            f"message.{part}.covariance[{6 * a + b}] = {value};"
            for part, i, j, value in values
            for a, b in sorted({(i, j), (j, i)})
        ],
        "variance_notes": [_NOTE] if names else [],
        "declared_variances": [
            line
            for name in names
            for line in (
                f'{name}_ = declare_parameter<std::vector<double>>("{name}", {default});',
                f"{name}_.resize(3);",
            )
        ],
        "variance_members": [f"std::vector<double> {name}_;" for name in names],
        "variance_readme": [
            "",
            "The covariances are parameters. To propagate them from the joints, write `noise:` for the joints and",
            "`functions: [forward_covariance, odometry_covariance]` into the robot file.",
        ]
        if names
        else ["", "The covariances are propagated from the noise of the joints; slip increases them."],
    }
