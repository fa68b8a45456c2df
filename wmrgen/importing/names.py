"""Names of robot files as near to those of a description as they may be."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.names import robot_name, wheel_name
from wmrgen.spec.text import Scalar

_KINDS_OF_JOINT = re.compile("((?i:_(joint|link|wheel|spin|axle|hinge))|Joint|Link|Wheel|Spin|Axle|Hinge)+$")
_MOST = 28  # characters, which leave room for a number


def near_robot_name(name: str) -> str:
    near = _plain(name)[:_MOST].strip("_")
    return _first((near, near.lower(), f"{near.lower()}_1"), robot_name) or "imported_robot"


def near_wheel_names(joints: Sequence[str]) -> list[str]:
    """Names of wheels, without what says that a joint is one; none twice in any case of letters."""
    names: list[str] = []
    for number, joint in enumerate(joints, 1):
        near = _KINDS_OF_JOINT.sub("", _plain(joint))[:_MOST].strip("_")
        tries = (near, near.lower(), f"{near.lower()}_{number}", f"wheel_{number}")
        name = _first(tries, wheel_name) or f"wheel_{number}"
        clashes = name.lower() in (other.lower() for other in names)
        names.append(f"{name[: _MOST - 2]}_{number}" if clashes else name)
    return names


def _plain(name: str) -> str:
    return re.sub("[^A-Za-z0-9]+", "_", name).strip("_")


def _first(tries: Iterable[str], check: Callable[[Scalar], str]) -> str | None:
    """The first that a robot file accepts."""
    for name in tries:
        try:
            return check(Scalar(Mark("", 0, 0, ""), name, True))
        except RobotFileError:
            continue
    return None
