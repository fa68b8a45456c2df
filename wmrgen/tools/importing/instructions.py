"""A description with what controllers beside it say: which joints are driven, and that wheels have rollers.

Their lengths are hints where the description has none; where it has one they are compared, never taken. How far a robot
turns that skids no description says: that is theirs.
"""

from __future__ import annotations

import cmath
from collections.abc import Collection, Sequence
from dataclasses import replace
from fractions import Fraction

from wmrgen.geometry.layout.skid import parallel
from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, SPHERICAL
from wmrgen.tools.importing.records import Controller, Description, Wheel

_EQUAL = 1e-6  # of the track, by which wheels of a side stand beside one another
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


def skid_track(wheels: Sequence[Wheel], controllers: Sequence[Controller]) -> tuple[Fraction, str] | None:
    """The effective track of wheels that are fixed on several axles and skid in curves: the track of the controllers of
    differential drives, or of the wheels where they leave it to them, times its multiplier, which is made for that;
    None where they have none, or two."""
    fixed = [w for w in wheels if w.type == FIXED.name]
    if len(fixed) < 3 or any(w.type not in (FIXED.name, CASTOR.name, SPHERICAL.name) for w in wheels):
        return None
    headings = [cmath.rect(1, w.heading or 0.0) for w in fixed]
    seen = [headings[0].conjugate() * complex(w.x, w.y) for w in fixed]
    ahead, aside = [z.real for z in seen], [z.imag for z in seen]
    size = max(aside) - min(aside)
    if not parallel(headings) or size == 0 or max(ahead) - min(ahead) < size / 10:
        return None
    two_lines = all(min(y - min(aside), max(aside) - y) < _EQUAL * size for y in aside)
    told = {}
    for c in controllers:
        track, factor = c.lengths.get("track"), c.multipliers.get("track")
        if c.kind == "differential" and factor and factor.value != 1 and (track or two_lines):
            own = f"{quoted(track.key)} {float(track.value):g}" if track else f"the track {size:g}"
            where = f"; {factor.mark.file.rpartition('/')[2]}, line {factor.mark.line}" if factor.mark else ""
            product = f"{own} times {quoted(factor.key)} {float(factor.value):g}{where}"
            told[(track.value if track else Fraction(size)) * factor.value] = product
    return next(iter(told.items())) if len(told) == 1 else None
