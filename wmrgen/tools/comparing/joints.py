"""Which joint of a robot is meant by a name in the file of a controller."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.names import role
from wmrgen.tools.comparing.matching import bare
from wmrgen.tools.comparing.quantities import roles
from wmrgen.tools.comparing.record import JOINTS, Difference, Layout, Side
from wmrgen.tools.controllers.parameters import NamedJoint, Terms
from wmrgen.tools.controllers.record import ControllerType

MISSING = "WMR048"


class CommandedJoint(NamedTuple):
    """A joint that a controller commands."""

    term: str  # of the controller's formula
    place: int  # in the list of the term
    kind: str  # spin or steer
    name: str  # as the controller writes it, else that of the robot
    wheel: Side
    by_name: bool  # the name determines the wheel, not the place where the controller expects it
    mark: Mark | None

    @property
    def sign(self) -> int:
        """Return -1 if the joint counts against the wheel's own angle."""
        known = self.wheel.joints.get(self.kind)
        return known.sign if known else 1

    @property
    def key(self) -> str:
        """Return a name that no other joint of the robot has."""
        return f"{self.wheel.name}.{self.kind}"


def commanded_joints(
    a: Layout, record: ControllerType, terms: Terms
) -> tuple[list[CommandedJoint], list[Difference]]:
    """Return the joints that a controller commands.

    A name decides, if the robot has it. A robot file without such a name takes the joint at the place where the
    controller expects it.

    Args:
        a: The robot.
        record: The controller.
        terms: What its file gives.

    Returns:
        The joints, and the joints that should not be commanded or are not.
    """
    result: list[CommandedJoint] = []
    differences: list[Difference] = []
    for term, places in record.places.items():
        kind = "steer" if term in record.steering else "spin"
        written = terms.joints.get(term, ())
        if len(places) > 1 and len(written) > len(places):
            differences.append(_too_many(written, len(places)))
            written = written[: len(places)]
        for index, joint in enumerate(written):
            found, by_name = _by_name(a, joint.name, kind), True
            place = places[min(index, len(places) - 1)] if places else None
            if found is None and a.joints is None and place is not None:
                taken = {each.key for each in result}
                free = (w for w in _at(a, place, kind) if f"{w.name}.{kind}" not in taken)
                found, by_name = next(((w, kind) for w in free), None), False
            if found is None:
                continue
            wheel, own_kind = found
            if own_kind == kind:
                result.append(CommandedJoint(term, index, kind, joint.name, wheel, by_name, joint.mark))
            else:
                words = f"{joint.name} is a {own_kind} joint, the controller commands it as a {kind} joint"
                marks = (joint.mark,) if joint.mark else ()
                differences.append(Difference(MISSING, "joint", wheel.name, own_kind, kind, words, marks))
        for index, place in enumerate(places if not written else ()):
            for w in _at(a, place, kind):
                name = w.joints[kind].name if kind in w.joints else w.name
                result.append(CommandedJoint(term, index, kind, name, w, False, None))
    if any(joint.by_name for joint in result):
        differences += _motors(a, result)
    return result, differences


def _too_many(written: Sequence[NamedJoint], most: int) -> Difference:
    """Return the difference of a list with more joints than the controller has commands for."""
    words = f"the controller commands {most} joints here, the file names {len(written)}"
    mark = written[most].mark
    return Difference(MISSING, "joint", "", most, len(written), words, (mark,) if mark else ())


def _by_name(a: Layout, name: str, kind: str) -> tuple[Side, str] | None:
    """Return the wheel and the kind of joint that a name means; None if the robot has no such joint.

    The whole name counts first, then its end, because a file may leave a prefix to an argument, then the words that
    distinguish it.
    """
    if not name:
        return None
    known = [(w, each, w.joints[each].name) for w in a.wheels for each in JOINTS if each in w.joints]
    for exactly in (True, False):
        found = [(w, each) for w, each, own in known if own == name or (not exactly and own.endswith(name))]
        found = [pair for pair in found if pair[1] == kind] or found
        if len(found) == 1:
            return found[0]
    alike = [w for w in a.wheels if bare(name) and _has_bare_name(w, bare(name))]
    if len(alike) == 1 and (not alike[0].joints or a.joints is None):
        return alike[0], kind
    if a.joints is None and (where := role(name)):
        alike = [w for w, word in zip(a.wheels, roles(a.wheels), strict=True) if word == where]
        return (alike[0], kind) if len(alike) == 1 else None
    return None


def _has_bare_name(w: Side, wanted: str) -> bool:
    return any(bare(own) == wanted for own in w.names)


def _at(a: Layout, place: str, kind: str) -> Iterator[Side]:
    """Yield the wheels with a joint of a kind at a place, such as "rigid right"; the motors decide, if they are known.

    Args:
        a: The robot.
        place: Words for ends, sides, and whether the wheel is rigid or steering.
        kind: spin or steer.
    """
    for w, word in zip(a.wheels, roles(a.wheels), strict=True):
        own = {*word.split(), "steering" if w.kind.steers else "rigid"}
        has_joint = kind in (w.kind.joints if w.actuated is None else w.actuated)
        if set(place.split()) <= own and has_joint:
            yield w


def _motors(a: Layout, joints: Sequence[CommandedJoint]) -> Iterator[Difference]:
    """Yield joints with a motor that are not commanded, and commanded joints without a motor."""
    commanded = {joint.key: joint for joint in joints}
    followers = {f"{name}.{tie.joint}" for tie in a.ties or () for name in list(tie.turns)[1:]}
    for w in a.wheels:
        for kind in w.kind.joints if w.actuated is not None else ():
            key = f"{w.name}.{kind}"
            has_motor = kind in (w.actuated or ())
            if has_motor and key not in commanded and key not in followers:
                words = f"{key} has a motor, and the controller does not command it"
                yield Difference(MISSING, "joint", w.name, key, None, words)
            elif key in commanded and not has_motor and key not in followers:
                joint = commanded[key]
                words = f"{joint.name} has no motor, and the controller commands it"
                marks = (joint.mark,) if joint.mark else ()
                yield Difference(MISSING, "joint", w.name, None, joint.name, words, marks)
