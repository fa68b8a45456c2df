"""The codes of errors with title, explanation and examples, as `wmrgen explain` shows them."""

from __future__ import annotations

from typing import NamedTuple

from wmrgen.errors import Code


class Mistake(NamedTuple):
    """A kind of mistake."""

    code: str
    title: str  # the name of the mistake
    text: str  # what it is, and why it is one
    wrong: str  # an example with this mistake and no other: a robot file without its first two lines, unless `form`
    right: str  # the same example without the mistake
    form: str = "yaml"  # the language of the examples


_WHEELS = "wheels:\n  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 50 mm}\n"
_SECOND = _WHEELS.removeprefix("wheels:\n").replace("left", "right").replace("0.2", "-0.2")
_TURNING = """\
wheels:
  - {name: front, type: steered, x: 0.3, y: 0, heading: 0, r: 50 mm}
  - {name: rear, type: steered, x: -0.3, y: 0, heading: 0, r: 50 mm}
couplings: [{equal: [front.steer, rear.steer]}]
"""
_KEYS = "The reference of robot files (`wmrgen schema --markdown`) lists the keys and their values."

MISTAKES = {
    mistake.code: mistake._replace(wrong=mistake.wrong + _SECOND, right=mistake.right + _SECOND)
    for mistake in (
        Mistake(
            Code.NOT_YAML, "invalid YAML",
            "A robot file is a page of YAML in UTF-8, indented by spaces. It has lines `key: value`. Lists have lines "
            "that begin with `- `, or { } and [ ] on one line. Anchors, aliases, tags and invisible characters are "
            "refused. Reading stops at the first such mistake.",
            _WHEELS.replace("}", ""), _WHEELS,
        ),
        Mistake(
            Code.UNKNOWN_KEY, "unknown key",
            "The robot file has a key that wmrgen does not know. It may be misspelt, and would have no effect. "
            f"{_KEYS}",
            _WHEELS.replace("r:", "radius:"), _WHEELS,
        ),
        Mistake(
            Code.MISSING, "missing key",
            "wmrgen does not guess what changes the motion: position, rolling direction and radius of each wheel. "
            f"{_KEYS}",
            _WHEELS.replace(", heading: 0", ""), _WHEELS,
        ),
        Mistake(
            Code.FORM, "wrong type",
            "The value of a key is not of the type that the key has. A quantity is a number, a number with a unit of "
            f"its kind, or an expression of parameters. Other keys have a word, a list or a mapping. {_KEYS}",
            _WHEELS.replace("50 mm", "50 deg"), _WHEELS,
        ),
        Mistake(
            Code.NAME, "invalid name",
            "Names of robots, wheels and parameters become identifiers in C, C++, Rust and Python, and file names. "
            "They have letters, digits and _, a letter first, and at most 31 characters, because C compilers need to "
            "compare only the first 63 characters of a macro such as ROBOT_WHEEL_SPIN. Words that a language or its "
            "library reserves are not names, in any case. A robot also cannot have the name of a namespace or "
            "library that its packages use.",
            _WHEELS.replace("left", "rear-left"), _WHEELS.replace("left", "rearLeft"),
        ),
        Mistake(
            Code.TWICE, "conflicting keys",
            "Two keys or names exclude each other. For example, a key or a name occurs twice, a wheel has l, alpha "
            "and x, y, or a key does not fit the type of the wheel. Names that differ only in case are equal, because "
            "macros are in upper case and many file systems ignore case.",
            _WHEELS.replace("heading: 0", "heading: 0, beta: 0"), _WHEELS,
        ),
        Mistake(
            Code.UNDECLARED, "undeclared name",
            "Expressions may use pi and the parameters of the file. Couplings, virtual wheels and functions may name "
            "only wheels, joints and functions that exist.",
            _WHEELS.replace("0.2", "track/2"), "parameters: {track: 0.4}\n" + _WHEELS.replace("0.2", "track/2"),
        ),
        Mistake(
            Code.OPEN, "open question",
            "`wmrgen import` writes TODO for a value that changes the motion and that the imported description does "
            "not have, such as the direction of rollers. Write the value before deriving.",
            _WHEELS.replace("50 mm", "TODO"), _WHEELS,
        ),
        Mistake(
            Code.VALUE, "invalid value",
            "The value has the right type, but no wheel or robot can have it. Examples are a radius of 0, a castor "
            "with d = 0 (which is a steered wheel), a lower limit above the upper one, and a division by zero.",
            _WHEELS.replace("50 mm", "0"), _WHEELS,
        ),
    )
}  # fmt: skip

CALLS = {
    mistake.code: mistake
    for mistake in (
        Mistake(
            Code.FILE, "unreadable file",
            "The file does not exist, is a folder, may not be read, is too large, or has another encoding than UTF-8.",
            "wmrgen derive robots/\n", "wmrgen derive robots/my_robot.yaml\n", "sh",
        ),
        Mistake(
            Code.DESCRIPTION, "invalid robot description",
            "The description is not XML, has an invalid number, has joints in a circle or to a missing link, or has no "
            "wheel. Document types, entities, and xacro that would read another file or run code are refused.",
            "<robot name='my_robot'>\n  <link name='base_link'>\n</robot>\n",
            "<robot name='my_robot'>\n  <link name='base_link'/>\n</robot>\n", "xml",
        ),
        Mistake(
            Code.USAGE, "invalid arguments",
            "The command does not have an option, a name or a value, or has too many or too few of them. "
            "`wmrgen COMMAND --help` lists the arguments, and `wmrgen functions ROBOT.yaml` the functions of a robot.",
            "wmrgen eval my_robot.yaml invers vx=1\n", "wmrgen eval my_robot.yaml inverse vx=1 vy=0 omega=0\n", "sh",
        ),
        Mistake(
            Code.UNDERIVABLE, "impossible derivation",
            "The robot file is valid, but the requested result cannot be derived from it. For example, this type of "
            "robot cannot have the function, a controller does not fit its wheels, or couplings let steering alone "
            "move the robot. The exit code is 3. `wmrgen functions ROBOT.yaml` lists the functions of a robot, "
            "with the reason for each missing function.",
            _TURNING.replace("rear, type: steered", "rear, type: castor, d: -0.04"), _TURNING,
        ),
        Mistake(
            Code.ENVIRONMENT, "missing program or permission",
            "A compiler, a browser or a package is missing, a folder cannot be written, or the disk is full. The exit "
            "code is 4. The robot file is not the cause, and existing files remain unchanged.",
            "wmrgen export my_robot.yaml --to urdf -o my_robot.yaml/out\n",
            "wmrgen export my_robot.yaml --to urdf -o out\n", "sh",
        ),
    )
}  # fmt: skip
