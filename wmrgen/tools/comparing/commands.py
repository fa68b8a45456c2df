"""The joint commands of a controller, held against those that the robot needs for the same twist.

The record of the controller (`tools/controllers`) gives the commands, under the joints that its file names. The robot's
own inverse kinematics gives the needed ones.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from wmrgen.tools.comparing.joints import CommandedJoint, commanded_joints
from wmrgen.tools.comparing.motion import Array, Command, command_of
from wmrgen.tools.comparing.quantities import centre, forward, in_ring, lengths, mean, parts, roles
from wmrgen.tools.comparing.record import SAME, Difference, Layout, Side
from wmrgen.tools.controllers.parameters import Terms
from wmrgen.tools.controllers.record import ControllerType, Numbers, Twist

COMMAND, LIMIT, RELEASE = "WMR052", "WMR053", "WMR054"
# The radius of the test curves in sizes of the robot, wider than the least turn of gz AckermannSteering; and rad or
# rad/s that rounding errors of two formulas do not reach.
_CURVE, _NOISE = 4.0, 1e-9


class Motion(NamedTuple):
    """A twist that is compared, with a name for messages."""

    words: str
    twist: Twist  # of the controller's base frame


class Unequal(NamedTuple):
    """A joint with a wrong command, in the motion where the command is farthest off."""

    joint: CommandedJoint
    motion: str
    commanded: float  # [rad/s] or [rad], in the joint's own count
    needed: float
    excess: float  # the error as a multiple of the tolerance


@dataclass(frozen=True, slots=True)
class Evaluation:
    """A controller evaluated for a robot."""

    wheels: tuple[Side, ...]  # of the robot, with radii
    record: ControllerType
    numbers: Numbers  # of the controller, completed by the robot's own lengths
    joints: tuple[CommandedJoint, ...]
    motions: tuple[Motion, ...]
    layout: Layout  # of the controller
    middle: complex  # the origin of the controller's base frame from P, x ahead [m]

    def commands(self, numbers: Numbers, twist: Twist) -> Iterator[tuple[CommandedJoint, float]]:
        """Yield each joint with its command [rad/s] or [rad]."""
        given = self.record.formula(self.layout.distro)(numbers, twist)
        for joint in self.joints:
            values = given[joint.term]
            yield joint, values[joint.place] if len(values) > 1 else values[0]

    def needed(self, twist: Twist) -> list[Command]:
        """Return the commands that the robot's wheels need for a twist of the controller's base frame."""
        own = own_twist(self.wheels, self.middle, twist)
        return [command_of(w, own) for w in self.wheels]

    def applied(self, own: Array) -> list[Command]:
        """Return the commands of the robot's wheels for a twist of P: those of the controller, where it gives them.

        A controller that needs vx gives no commands without it.
        """
        result = [command_of(w, own) for w in self.wheels]
        indices = {id(w): i for i, w in enumerate(self.wheels)}
        try:
            given = list(self.commands(self.numbers, controller_twist(self.wheels, self.middle, own)))
        except ZeroDivisionError:
            given = []
        for joint, value in given:
            i = indices[id(joint.wheel)]
            key = "steer" if joint.kind == "steer" else "spin"
            result[i] = replace(result[i], **{key: value * joint.sign})
        return result

    def unequal(self, numbers: Numbers) -> list[Unequal]:
        """Return the joints with wrong commands if the controller has these numbers."""
        worst: dict[str, Unequal] = {}
        for motion in self.motions:
            for found in self._unequal_in(motion, numbers):
                known = worst.get(found.joint.key)
                if known is None or found.excess > known.excess:
                    worst[found.joint.key] = found
        return list(worst.values())

    def lengths_matter(self) -> bool:
        """Return whether any command changes if the controller has the robot's own lengths."""
        own = corrected(self)
        for motion in self.motions:
            pairs = zip(
                self.commands(self.numbers, motion.twist), self.commands(own, motion.twist), strict=True
            )
            if any(not math.isclose(p, q, abs_tol=_NOISE) for (_, p), (_, q) in pairs):
                return True
        return False

    def _unequal_in(self, motion: Motion, numbers: Numbers) -> Iterator[Unequal]:
        """Yield the joints with wrong commands in one motion; half a turn of steering reverses the spin."""
        needed = {id(w): c for w, c in zip(self.wheels, self.needed(motion.twist), strict=True)}
        fastest = max(abs(c.spin) for c in needed.values())
        given = list(self.commands(numbers, motion.twist))
        reversed_: set[int] = set()
        for joint, value in given:
            if joint.kind == "steer":
                wanted = needed[id(joint.wheel)].steer
                apart = value * joint.sign - wanted
                error = math.remainder(apart, math.pi)
                if round((apart - error) / math.pi) % 2:
                    reversed_.add(id(joint.wheel))
                if abs(error) > SAME:
                    yield Unequal(joint, motion.words, value, wanted * joint.sign, abs(error) / SAME)
        for joint, value in given:
            if joint.kind == "spin" and fastest > 0:
                wanted = needed[id(joint.wheel)].spin * (-1 if id(joint.wheel) in reversed_ else 1)
                error = abs(value * joint.sign - wanted) / fastest
                if error > SAME:
                    yield Unequal(joint, motion.words, value, wanted * joint.sign, error / SAME)


def evaluated(a: Layout, b: Layout) -> tuple[Evaluation | None, list[Difference], list[str]]:
    """Return a controller ready to evaluate for a robot.

    Args:
        a: The robot.
        b: The controller.

    Returns:
        The evaluation, or None if it is not possible; differences of single joints; what is not compared.
    """
    if b.evaluable is None or a.controller is not None:
        return None, [], []
    record, terms = b.evaluable
    driving = parts(a.wheels)
    other_release = list(_of_another_release(b, terms))
    notes: list[str] = []
    unknown = [w.name for w in driving if w.kind.rollers and "gamma" not in w.values]
    unknown += [w.name for w in driving if w.kind.swivels]
    has_formula = bool(terms.joints or terms.parameters.keys() & record.lengths.keys())
    if unknown or not driving or not has_formula:
        return None, other_release, notes
    foreign = _foreign(b, record, terms)
    if foreign:
        notes.append(f"the joint commands, because {record.name} has no parameter {foreign}")
        return None, other_release, notes
    own = own_lengths(driving)
    numbers = dict(terms.numbers)
    if record.kind == "omni":
        numbers["count"] = float(len(terms.joints.get("ring", ())) or len(driving))
    if _skids(driving):
        numbers["separation_factor"] = 1.0  # it corrects for skidding
    numbers = record.completed(numbers, own)
    radius = numbers.get("radius", numbers.get("left_radius", 1.0))
    wheels = tuple(replace(w, values={"r": abs(radius), **w.values}) for w in driving)
    joints, differences = commanded_joints(replace(a, wheels=wheels), record, terms)
    differences = [*other_release, *differences]
    unnamed = [joint.name for joint in joints if not joint.by_name and joint.mark]
    if unnamed:
        notes.append(
            f"the joint names {', '.join(unnamed)}: the wheels where the controller expects them are used"
        )
    motions = tuple(_motions(wheels, record))
    result = Evaluation(wheels, record, numbers, tuple(joints), motions, b, base_frame(wheels, record))
    try:
        result.unequal(numbers)
    except (KeyError, ZeroDivisionError) as error:
        notes.append(f"the joint commands, because the file has no value of {error}")
        return None, differences, notes
    return (result if joints else None), differences, notes


def _of_another_release(b: Layout, terms: Terms) -> Iterator[Difference]:
    """Yield the parameters that the release of a controller ignores, because another release has them."""
    for name, mark in terms.unread:
        words = f"{name} is a parameter of another release, which {b.distro} ignores"
        yield Difference(RELEASE, "parameter", "", None, name, words, (mark,) if mark else ())


def _foreign(b: Layout, record: ControllerType, terms: Terms) -> str:
    """Return a parameter of lengths or joints that the record lacks, as other software of the same type has; or ""."""
    if not terms.complete or b.controller is None:
        return ""
    known = {name.lower() for name in record.known_names()}
    needs_more = not record.lengths.keys() <= terms.numbers.keys()
    for setting in (*b.controller.lengths.values(), *b.controller.multipliers.values()):
        if needs_more and setting.key.lower() not in known:
            return setting.key
    return "for its joints" if b.controller.joints and not terms.joints else ""


def unexplained(e: Evaluation, known: Sequence[Difference]) -> Iterator[Difference]:
    """Yield the joints whose commands stay wrong with the robot's own lengths in the controller.

    Args:
        e: The evaluation.
        known: Differences that explain a wheel on their own, such as a wheel on the other side.
    """
    wheels = {d.wheel for d in known}
    for found in e.unequal(corrected(e)):
        if found.joint.wheel.name not in wheels:
            unit = "rad" if found.joint.kind == "steer" else "rad/s"
            words = (
                f"{found.joint.name}: {found.motion}, it is commanded {found.commanded:+.3f} {unit},"
                f" the robot needs {found.needed:+.3f} {unit}"
            )
            marks = (found.joint.mark,) if found.joint.mark else ()
            yield Difference(
                COMMAND, "command", found.joint.wheel.name, found.needed, found.commanded, words, marks
            )


def corrected(e: Evaluation) -> Numbers:
    """Return the terms of a controller with the robot's own lengths."""
    return e.record.own_lengths(e.numbers, e.record.lengths, own_lengths(e.wheels))


def limit_differences(a: Layout, b: Layout) -> tuple[list[Difference], list[str]]:
    """Return the limits of the twist that a controller has beyond the robot's, and notes on the limits it lacks."""
    differences: list[Difference] = []
    if b.evaluable is None:
        return [], []
    record, terms = b.evaluable
    every = {term for terms_ in record.names.values() for term in terms_.split()}
    missing = []
    for key, own in a.limits.items():
        unit = "m/s" if key.startswith("v") else "rad" if key.startswith("steer") else "rad/s"
        if "rate" in key:
            unit += "^2"
        if key in terms.parameters:
            parameter, mark = terms.parameters[key]
            value = terms.numbers[key]
            if abs(value) > abs(own) * (1 + SAME) or value * own < 0:
                words = f"{parameter}: the robot's limit is {own:.6g} {unit}, the controller allows {value:.6g} {unit}"
                marks = (mark,) if mark else ()
                differences.append(Difference(LIMIT, "limit", "", own, value, words, marks))
        elif key in every and terms.complete:
            missing.append(f"{key.split('.')[0]} ({own:.6g} {unit})")
    notes = [f"{b.source} does not limit {', '.join(dict.fromkeys(missing))}"] if missing else []
    return differences, notes


def own_twist(wheels: Sequence[Side], middle: complex, twist: Twist) -> Array:
    """Return the twist of P for a twist of the controller's base frame.

    Args:
        wheels: The robot, which decides the direction ahead.
        middle: The origin of the controller's base frame from P, x ahead [m].
        twist: The twist of the controller's base frame.
    """
    velocity = forward(wheels) * (complex(twist.vx, twist.vy) - 1j * twist.omega * middle)
    return np.array([velocity.real, velocity.imag, twist.omega])


def controller_twist(wheels: Sequence[Side], middle: complex, own: Array) -> Twist:
    """Return the twist of the controller's base frame for a twist of P: the reverse of `own_twist`.

    Args:
        wheels: The robot, which decides the direction ahead.
        middle: The origin of the controller's base frame from P, x ahead [m].
        own: The twist of P.
    """
    velocity = forward(wheels).conjugate() * complex(*own[:2]) + 1j * float(own[2]) * middle
    return Twist(velocity.real, velocity.imag, float(own[2]))


def base_frame(wheels: Sequence[Side], record: ControllerType) -> complex:
    """Return the origin of the controller's base frame from P, x ahead [m].

    It is the middle of a fixed axle, else the middle of all wheels. Only a controller with an offset of its base frame
    has a formula for P.
    """
    along = forward(wheels).conjugate()
    fixed = [along * w.pivot for w in wheels if w.kind.fixed_axle]
    if fixed:
        return complex(mean(p.real for p in fixed), mean(p.imag for p in fixed))
    has_offset = any(term.startswith("offset_") for term in record.defaults)
    return 0j if has_offset else centre([along * w.pivot for w in wheels], in_ring(wheels))


def _motions(wheels: Sequence[Side], record: ControllerType) -> Iterator[Motion]:
    """Yield the motions that the controller and the robot both can do."""
    size = max(abs(w.pivot - v.pivot) for w in wheels for v in wheels) or 1.0
    bend = 1 / (_CURVE * size)
    yield Motion("driving straight", Twist(1.0, 0.0, 0.0))
    if record.turns_on_spot:
        yield Motion("turning", Twist(0.0, 0.0, 1.0))
    yield Motion("driving a curve to the left", Twist(1.0, 0.0, bend))
    yield Motion("driving a curve to the right", Twist(1.0, 0.0, -bend))
    yield Motion("reversing in a curve", Twist(-1.0, 0.0, bend))
    if record.strafes and not any(w.kind.fixed_axle for w in wheels):
        yield Motion("strafing", Twist(0.0, 1.0, 0.0))
        yield Motion("driving aslant and turning", Twist(0.6, 0.8, 1 / size))


def _skids(wheels: Sequence[Side]) -> bool:
    """Whether all wheels are fixed, and some are in front of others."""
    return all(w.kind.fixed_axle for w in wheels) and any("front" in word for word in roles(wheels))


def own_lengths(wheels: Sequence[Side]) -> Mapping[str, float]:
    """Return the lengths of a robot by the terms of controllers [m]: those of `lengths` and the steering track."""
    along = forward(wheels)
    result = lengths(wheels, roles(wheels), along)
    steered = [(along.conjugate() * w.pivot).imag for w in wheels if w.kind.steers]
    if len(steered) > 1:
        result["steering_track"] = max(steered) - min(steered)
    return result
