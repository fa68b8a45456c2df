"""The kinds of drives that ``wmrgen new`` offers: a picture, the numbers to measure, and the wheels as text.

A robot file made from a drive has nothing but what every such drive has: no castor, limits, encoders or noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Number(NamedTuple):
    """A number of a drive, which the user measures."""

    name: str  # of the parameter in the robot file
    meaning: str  # what it measures, and how
    example: str  # a valid value; it checks the other answers and is never written


class Drive(NamedTuple):
    """A kind of drive."""

    summary: str
    picture: str  # seen from above, forward is up
    numbers: tuple[Number, ...]
    wheels: str  # the section `wheels`, over the names of the numbers

    def robot_file(self, name: str, description: str, words: Mapping[str, str]) -> str:
        """Return the robot file with the values ``words`` of numbers. A number without a value is TODO with a hint.

        Args:
            name: the name of the robot.
            description: its description, as a YAML value.
            words: values by the name of the number, as YAML values, in SI units or with a unit.

        Returns:
            The text of the file.
        """
        from wmrgen.robotfile.load import OPEN

        lines = ["wmrgen: 1", f"name: {name}", f"description: {description}", "parameters:"]
        for number in self.numbers:
            lines += [f"  # {number.meaning}", f"  {number.name}: {words.get(number.name, OPEN)}"]
        return "\n".join([*lines, "wheels:", *self.wheels.strip("\n").split("\n")]) + "\n"


RADIUS = Number("radius", "radius of a wheel: from the ground to its axle, under load", "0.1")
TRACK = Number(
    "track", "track: distance between the middles of a left and a right wheel, on the ground", "0.4"
)
WHEELBASE = Number("wheelbase", "wheelbase: distance from the rear axle to the front axle", "0.6")

DRIVES = {
    "differential": Drive(
        "two driven wheels on one axle; the robot turns by their difference",
        """
    [ left ]---P---[ right ]
""",
        (TRACK, RADIUS),
        """
  - {name: left,  type: fixed, x: 0, y: track/2,  heading: 0, r: radius}
  - {name: right, type: fixed, x: 0, y: -track/2, heading: 0, r: radius}
""",
    ),
    "ackermann": Drive(
        "a car: two driven wheels at the rear, two steered wheels at the front",
        """
    / front_left /      / front_right /
          |                   |
    [ rear_left ]---P---[ rear_right ]
""",
        (WHEELBASE, TRACK, RADIUS),
        """
  - {name: rear_left,   type: fixed,   x: 0, y: track/2,  heading: 0, r: radius}
  - {name: rear_right,  type: fixed,   x: 0, y: -track/2, heading: 0, r: radius}
  - {name: front_left,  type: steered, x: wheelbase, y: track/2,  heading: 0, r: radius, actuated: [steer]}
  - {name: front_right, type: steered, x: wheelbase, y: -track/2, heading: 0, r: radius, actuated: [steer]}
""",
    ),
    "swerve": Drive(
        "four wheels that are driven and steered, one by one",
        """
    / front_left /     / front_right /
                    P
    / rear_left /      / rear_right /
""",
        (WHEELBASE, TRACK, RADIUS),
        """
  - {name: front_left,  type: steered, x: wheelbase/2,  y: track/2,  heading: 0, r: radius}
  - {name: front_right, type: steered, x: wheelbase/2,  y: -track/2, heading: 0, r: radius}
  - {name: rear_left,   type: steered, x: -wheelbase/2, y: track/2,  heading: 0, r: radius}
  - {name: rear_right,  type: steered, x: -wheelbase/2, y: -track/2, heading: 0, r: radius}
""",
    ),
    "omni": Drive(
        "three omni wheels on a circle, 120 deg apart, one of them behind P; positive speeds turn the robot left",
        """
    // left         right \\\\
              P
            =rear=
""",
        (Number("distance", "distance from P, the middle, to the middle of a wheel", "0.2"), RADIUS),
        """
  - {name: left,  type: swedish, l: distance, alpha: pi/3,  beta: pi, gamma: 0, r: radius}
  - {name: rear,  type: swedish, l: distance, alpha: pi,    beta: pi, gamma: 0, r: radius}
  - {name: right, type: swedish, l: distance, alpha: -pi/3, beta: pi, gamma: 0, r: radius}
""",
    ),
    "mecanum": Drive(
        "four mecanum wheels; their rollers on top form an X, and at the ground an O",
        """
    \\\\ front_left       front_right //
                      P
    // rear_left         rear_right \\\\
""",
        (WHEELBASE, TRACK, RADIUS),
        """
  # gamma: roller axis at the ground against the wheel plane
  - {name: front_left,  type: swedish, x: wheelbase/2,  y: track/2,  heading: 0, gamma: -45 deg, r: radius}
  - {name: front_right, type: swedish, x: wheelbase/2,  y: -track/2, heading: 0, gamma: 45 deg,  r: radius}
  - {name: rear_left,   type: swedish, x: -wheelbase/2, y: track/2,  heading: 0, gamma: 45 deg,  r: radius}
  - {name: rear_right,  type: swedish, x: -wheelbase/2, y: -track/2, heading: 0, gamma: -45 deg, r: radius}
""",
    ),
}
