"""A description with what controllers beside it say: which joints are driven, and that wheels have rollers.

Their lengths are hints where the description has none; where it has one they are compared, never taken.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from wmrgen.importing.records import Controller, Description
from wmrgen.spec.text import quoted

_ROLLERS = ("mecanum", "omni")  # kinds of controllers that drive wheels with rollers


def instructed(description: Description, controllers: Sequence[Controller]) -> Description:
    """The description, of which the joints that controllers name are driven too. Names that it lacks are noted."""
    joints = {joint.name for joint in description.joints}
    named = {
        (joint.joint, c.name): _joint_called(joint.joint, joints) for c in controllers for joint in c.joints
    }
    driven = frozenset(joint for joint in named.values() if joint)
    lost = [
        f"{quoted(c)} names the joint {quoted(j)}, which the file has not"
        for (j, c), k in named.items()
        if not k
    ]
    return replace(
        description,
        driven=driven | (description.driven or frozenset()) if driven else description.driven,
        transmitted=description.transmitted - driven,
        words=(*description.words, *(c.type or c.kind for c in controllers if c.kind in _ROLLERS)),
        notes=(*description.notes, *(note for c in controllers for note in c.notes), *lost),
        controllers=(*description.controllers, *controllers),
    )


def _joint_called(name: str, joints: Collection[str]) -> str | None:
    """The joint of a name, or the only one that has a prefix before it."""
    prefixed = [joint for joint in joints if joint.endswith((f"_{name}", f"/{name}"))]
    return name if name in joints else prefixed[0] if len(prefixed) == 1 else None
