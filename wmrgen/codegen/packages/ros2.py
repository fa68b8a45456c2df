"""What the templates of the ROS 2 package print of a robot: joints, covariances, parameters."""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.codegen.packages.cpp import loop
from wmrgen.geometry.ports import GYRO, POSE_COVARIANCE, TWIST_COVARIANCE
from wmrgen.ir.nodes import Module

_QUANTITIES = {
    "spin": ("spin", "velocity"),
    "steer": ("steer", "position"),
    "steer_rate": ("steer", "velocity"),
}
_AXES = (0, 1, 5)  # of x, y and yaw among the six of a message
_PAIRS = [(i, j) for k, i in enumerate(_AXES) for j in _AXES[k:]]
_NOTE = "pose_variance, twist_variance: of x, y, yaw and their rates; this robot has no odometry_covariance"


def context(module: Module, scalar: str) -> Mapping[str, object]:
    """``joints``: what ROS calls each by default, which quantity of it, whether it must be measured; ``commanded``:
    index and quantity of those that the robot drives; variables, calls and parameters of the node."""
    steps = loop(module, scalar)
    functions = {function.name: function for function in module.functions}
    joints = []
    for name in module.joints or ():
        wheel, _, joint = name.rpartition(".")
        ending, quantity = _QUANTITIES[joint]
        joints.append((f"{wheel}_{ending}", quantity, str(name in steps.measured).lower()))
    driven = {port.name for port in functions["inverse"].outputs}
    parts = ("pose", POSE_COVARIANCE), ("twist", TWIST_COVARIANCE)
    if steps.covariance:
        values = [
            (part, i, j, f"{part}_covariance.{port.name}")
            for part, ports in parts
            for (i, j), port in zip(_PAIRS, ports, strict=True)
        ]
    else:
        values = [(part, i, i, f"{part}_variance_[{k}]") for part, _ in parts for k, i in enumerate(_AXES)]
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
            "Its covariances are parameters: for propagated ones write `noise:` of the joints and",
            "`functions: [forward_covariance, odometry_covariance]` into the robot file.",
        ]
        if names
        else ["", "Its covariances are propagated from the noise of the joints; slip raises them."],
    }
