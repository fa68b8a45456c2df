"""The variables of the templates of the ROS 2 package: joints, limits, parameters, and calls of the C."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping, Sequence
from math import inf, isfinite

from wmrgen.codegen.packages.cpp import Call, Loop, call, loop
from wmrgen.codegen.registry import Facts
from wmrgen.geometry.ports import GYRO, POSE, POSE_COVARIANCE, TWIST, TWIST_COVARIANCE, TWIST_NAMES, Port
from wmrgen.ir.nodes import Module

_FIELDS = {
    "spin": "velocity",
    "steer": "position",
    "steer_rate": "velocity",
}  # joint -> field of a joint state
# A variable of the loop in a statement, not a member of a struct that has the same name.
_VARIABLE = re.compile(r"(?<![.\w])(commands|wheels|before)\b")


def context(module: Module, facts: Facts) -> Mapping[str, object]:
    """Return the variables of the templates for a robot.

    ``core_joints`` has for each joint its name in ROS, the field of a joint state, whether it must be measured, whether
    `inverse` computes it, and the sign of its rotation in ROS. ``cpp_joints`` has the same for C++, but it says whether
    the joint has a motor.
    """
    steps = loop(module, str(facts.options["scalar"]))
    driven = {port.name for port in module.function("inverse").outputs}
    joints, cpp_joints = [], []
    for name in module.joints or ():
        field = _FIELDS[name.rpartition(".")[2]]
        ros_name, sign = facts.joint_names[name]
        measured, motor = name in steps.measured, name in driven and name in facts.motors
        joints.append((ros_name, field, measured, name in driven, sign))
        cpp_joints.append(
            f"{{ {_quoted(ros_name)}, Interface::{field}, {_cpp(measured)}, {_cpp(motor)}, {sign:+.1f} }}"
        )
    tunable = _tunables(module)
    return {
        "ros": f"{module.name.lower()}_kinematics",
        "joints": module.joints or (),
        "core_joints": [repr(joint) for joint in joints],
        "core_limits": _limits(facts),
        "tunables": repr(tunable),
        "frame": repr(facts.frame),
        "cpp_joints": cpp_joints,
        "cpp_limits": _cpp_limits(facts),
        "cpp_tunables": [f"{{ {_quoted(name)}, {nominal!r} }}" for name, nominal in tunable.items()],
        "cpp_frame": _quoted(facts.frame),
        "yaml_joints": [_quoted(joint[0]) for joint in joints],
        "yaml_limits": _yaml_limits(facts),
        "yaml_tunables": [(name, repr(nominal)) for name, nominal in tunable.items()],
        "covariance": steps.covariance,
        "variables": list(steps.variables.items()),
        "gyro": GYRO.name in steps.variables,
        "prepare": [f"{_of_state(call)};" for call in steps.prepare],
        "tune": [
            f"s->params.{name} = ({facts.options['scalar']})values[{k}];" for k, name in enumerate(tunable)
        ],
        "sense": [_of_state(call, "_checked") for call in steps.sense],
        "keep": [_VARIABLE.sub(r"s->\1", statement) for statement in steps.keep],
        "act": [_of_state(call, "_checked") for call in steps.act],
        "results": _results(steps.covariance),
        **_motion_model(module, facts, steps),
        "variance_readme": _VARIANCES_PROPAGATED if steps.covariance else _VARIANCES_GIVEN,
    }


def _quoted(text: str) -> str:
    """Return a string literal of C++ and YAML."""
    return json.dumps(text)


def _cpp(condition: bool) -> str:
    return "true" if condition else "false"


def _of_state(call: Call, ending: str = "") -> str:
    """Return a call whose arguments are members of the state ``s``."""
    words = [f"&s->{word[1:]}" if word.startswith("&") else f"s->{word}" for word in call.words]
    return call._replace(words=tuple(words)).text(ending)


def _tunables(module: Module) -> dict[str, float]:
    """Return the tunable parameters with their nominal values, in the order of the C."""
    if module.prepare is None:
        return {}
    return {port.name: float(port.default) for port in module.prepare.inputs if port.default is not None}


def _limits(facts: Facts) -> str:
    """Return the limits of the twist as a Python expression."""
    entries = []
    for name in TWIST_NAMES:
        low, high = facts.site.limits.get(name, (-inf, inf))
        ends = [repr(end) if isfinite(end) else str(end).replace("inf", "math.inf") for end in (low, high)]
        entries.append(f'"{name}": ({ends[0]}, {ends[1]})')
    return f"{{{', '.join(entries)}}}"


def _motion_model(module: Module, facts: Facts, steps: Loop) -> dict[str, object]:
    """Return the variables of the templates of the motion model for Nav2.

    Robots of type (1, 1) have one, because Nav2's model of cars has a least turning radius about P and nothing else. It
    needs no measurement: `forward` reads joints that `inverse` commands.
    """
    names, scalar = {function.name for function in module.functions}, str(facts.options["scalar"])
    commanded = {port.name for port in module.function("inverse").outputs}
    read = set(module.joints or ()) & {port.name for port in module.function("forward").inputs}
    inverse = call(module, scalar, "inverse", {"now": "commands", "out": "commands"})
    forward = call(
        module, scalar, "forward_slip" if "forward_slip" in names else "forward", {"twist": "driven"}
    )
    members = {name: kind for each in steps.prepare for name, kind in each.variables.items()}
    variables = {"slip": scalar, **inverse.variables, **forward.variables}
    return {
        "motion_model": facts.robot_type == (1, 1) and read <= commanded and GYRO.name not in variables,
        "motion_prepare": [f"{_of_members(each, members)};" for each in steps.prepare],
        "motion_members": [(f"{name}_", kind) for name, kind in members.items()],
        "motion_variables": [
            (name, kind) for name, kind in variables.items() if name not in {*members, "driven"}
        ],
        "motion_inverse": _of_members(inverse, members),
        "motion_forward": _of_members(forward, members),
    }


def _of_members(call: Call, members: Collection[str]) -> str:
    """Return a call in which ``members`` are members of a class."""
    words = [f"{word}_" if word.removeprefix("&") in members else word for word in call.words]
    return call._replace(words=tuple(words)).text()


def _cpp_limits(facts: Facts) -> list[str]:
    """Return the limits of the twist as initializers of C++."""
    infinity = "std::numeric_limits<double>::infinity()"
    lines = []
    for name in TWIST_NAMES:
        ends = facts.site.limits.get(name, (-inf, inf))
        low, high = (repr(end) if isfinite(end) else str(end).replace("inf", infinity) for end in ends)
        lines.append(f"{{ {low}, {high} }}")
    return lines


def _yaml_limits(facts: Facts) -> list[tuple[str, str]]:
    """Return the name and the largest magnitude of each limit of the twist that the robot file has."""
    found = []
    for name in TWIST_NAMES:
        low, high = facts.site.limits.get(name, (-inf, inf))
        if isfinite(max(-low, high)):
            found.append((name, repr(max(-low, high))))
    return found


def _results(covariance: bool) -> Sequence[str]:
    """Return the C expressions of the results of a step, in the order in which the core reads them."""
    parts: list[tuple[str, Sequence[Port]]] = [("pose", POSE), ("twist", TWIST)]
    if covariance:
        parts += [("pose_covariance", POSE_COVARIANCE), ("twist_covariance", TWIST_COVARIANCE)]
    return [f"s->{part}.{port.name}" for part, ports in parts for port in ports]


_VARIANCES_PROPAGATED = (
    "",
    "The covariances are propagated from the noise of the joints; slip increases them.",
)
_VARIANCES_GIVEN = (
    "",
    "The covariances are parameters. To propagate them from the joints, write `noise:` for the joints and",
    "`functions: [forward_covariance, odometry_covariance]` into the robot file.",
)
