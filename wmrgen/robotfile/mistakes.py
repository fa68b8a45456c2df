"""The kinds of mistakes in robot files, as `wmrgen explain` tells them; a message says the rest."""

from __future__ import annotations

from typing import NamedTuple

from wmrgen.errors import Code


class Mistake(NamedTuple):
    """``title``: the mistake. ``text``: why it is one. ``wrong``, ``right``: robot files without their first two lines;
    the first has this mistake and no other, the second none. ``form``: what the examples are instead."""

    code: str
    title: str
    text: str
    wrong: str
    right: str
    form: str = "yaml"


_WHEELS = "wheels:\n  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 50 mm}\n"
_SECOND = _WHEELS.removeprefix("wheels:\n").replace("left", "right").replace("0.2", "-0.2")
_TURNING = """\
wheels:
  - {name: front, type: steered, x: 0.3, y: 0, heading: 0, r: 50 mm}
  - {name: rear, type: steered, x: -0.3, y: 0, heading: 0, r: 50 mm}
couplings: [{equal: [front.steer, rear.steer]}]
"""
_KEYS = (
    "The reference of robot files (`wmrgen schema --markdown`) lists the keys and what stands behind each."
)

MISTAKES = {
    mistake.code: mistake._replace(wrong=mistake.wrong + _SECOND, right=mistake.right + _SECOND)
    for mistake in (
        Mistake(
            Code.NOT_YAML, "not the YAML of robot files",
            "A robot file is a page of YAML in UTF-8: lines `key: value`, lists of lines that begin with `- `, or { } "
            "and [ ] on one line, indented by spaces. Anchors, aliases, tags and characters that cannot be seen are "
            "refused.",
            _WHEELS.replace("}", ""), _WHEELS,
        ),
        Mistake(
            Code.UNKNOWN_KEY, "an unknown key",
            f"A key that nothing reads is a key misspelt: it would have no effect and nobody would see it. {_KEYS}",
            _WHEELS.replace("r:", "radius:"), _WHEELS,
        ),
        Mistake(
            Code.MISSING, "something that must be said is not",
            f"Nothing is guessed that changes the motion: place, rolling direction and radius of every wheel. {_KEYS}",
            _WHEELS.replace(", heading: 0", ""), _WHEELS,
        ),
        Mistake(
            Code.FORM, "a value of another form",
            "A quantity is a number, a number with a unit of its kind, or an expression of parameters; other keys take "
            f"a word, a list or keys of their own. {_KEYS}",
            _WHEELS.replace("50 mm", "50 deg"), _WHEELS,
        ),
        Mistake(
            Code.NAME, "a word that cannot be a name",
            "Names of robots, wheels and parameters become identifiers of C, C++, Rust and Python, and file names, as "
            "they are written: letters, digits and _, a letter first, at most 31, for C need compare "
            "only the first 63 characters of a macro such as ROBOT_WHEEL_SPIN. Words that one of these languages or "
            "its library keeps are no names, in whatever case, nor is a robot called as a namespace or library is that "
            "its packages meet.",
            _WHEELS.replace("left", "rear-left"), _WHEELS.replace("left", "rearLeft"),
        ),
        Mistake(
            Code.TWICE, "two that exclude each other",
            "What is said twice could disagree: a key or a name that stands twice, a wheel placed by l, alpha and "
            "by x, y, a key that contradicts the type of the wheel. Names that differ in case alone count as the same: "
            "macros are in upper case, and many disks do not tell files apart by case.",
            _WHEELS.replace("heading: 0", "heading: 0, beta: 0"), _WHEELS,
        ),
        Mistake(
            Code.UNDECLARED, "a name that nothing declares",
            "Expressions use parameters of the file and pi; couplings, virtual wheels and functions name wheels, "
            "joints and functions that there are.",
            _WHEELS.replace("0.2", "track/2"), "parameters: {track: 0.4}\n" + _WHEELS.replace("0.2", "track/2"),
        ),
        Mistake(
            Code.OPEN, "an open question",
            "`wmrgen import` writes TODO where the description that it read does not say what decides the motion, such "
            "as the direction of rollers. Nothing is derived until the answer stands there.",
            _WHEELS.replace("50 mm", "TODO"), _WHEELS,
        ),
        Mistake(
            Code.VALUE, "a value that makes no sense",
            "The value can be computed, or has a division by zero in it, and no wheel or robot can have it: a radius "
            "of 0, a castor with d = 0 (it is a steered wheel), limits of which the lower is above the upper.",
            _WHEELS.replace("50 mm", "0"), _WHEELS,
        ),
    )
}  # fmt: skip

CALLS = {
    mistake.code: mistake
    for mistake in (
        Mistake(
            Code.FILE, "a file that cannot be read",
            "There is none of that name, it is a folder, it may not be read, it is too large or in another encoding."
            " Nothing of it was read.",
            "wmrgen derive robots/\n", "wmrgen derive robots/my_robot.yaml\n", "sh",
        ),
        Mistake(
            Code.DESCRIPTION, "a robot description that cannot be imported",
            "It is no XML, its numbers are none, its joints go in a circle or to links that are not there, or it has "
            "no wheel. Document types and entities are refused, and xacro that would read or run something else.",
            "<robot name='my_robot'>\n  <link name='base_link'>\n</robot>\n",
            "<robot name='my_robot'>\n  <link name='base_link'/>\n</robot>\n", "xml",
        ),
        Mistake(
            Code.USAGE, "a call with words that the command does not take",
            "An option, a name or a value that it does not have, too many or too few. `wmrgen COMMAND --help` lists "
            "its words, `wmrgen functions ROBOT.yaml` the functions of a robot.",
            "wmrgen eval my_robot.yaml invers vx=1\n", "wmrgen eval my_robot.yaml inverse vx=1 vy=0 omega=0\n", "sh",
        ),
        Mistake(
            Code.UNDERIVABLE, "a robot that cannot be derived, or not so",
            "The robot file is in order, and what is asked for does not follow from it: a function that a robot of its "
            "kind cannot have, a controller that does not fit its wheels, couplings through which steering alone would "
            "move it. The exit code is 3. `wmrgen functions ROBOT.yaml` lists what a robot has, and says of the rest "
            "why not.",
            _TURNING.replace("rear, type: steered", "rear, type: castor, d: -0.04"), _TURNING,
        ),
        Mistake(
            Code.ENVIRONMENT, "something outside is missing, or refuses",
            "A compiler, a browser or a package that is not there, a folder that cannot be written, a full disk. The "
            "exit code is 4, and nothing is wrong with the robot file. What was there stays as it was.",
            "wmrgen export my_robot.yaml --to urdf -o my_robot.yaml/out\n",
            "wmrgen export my_robot.yaml --to urdf -o out\n", "sh",
        ),
    )
}  # fmt: skip
