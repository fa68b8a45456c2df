"""Names that a robot file gives: which words may be names, and that no two are the same."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace

from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.reserved_words import AVR_MACROS, why_reserved
from wmrgen.robotfile.text import Node, Scalar, latin, lookalike, quoted

MAX_NAME = 31
NAME_PATTERN = f"^[A-Za-z][A-Za-z0-9_]{{0,{MAX_NAME - 1}}}$"
_WHY_SO_LONG = (
    f"C need compare only the first 63 of a macro (C99, 5.2.4.1), which are a robot's name, _ and a wheel's, each of "
    f"{MAX_NAME} at most."
)
_ENDS = {"front": "front", "fore": "front", "fwd": "front", "middle": "middle", "center": "middle"}
_ENDS |= dict.fromkeys(("rear", "back", "hind", "aft"), "rear")
_SIDES = {"left": "left", "right": "right"}
_WHOLE = {**_ENDS, **_SIDES}
_WORDS = re.compile(r"(?<![A-Z])(?:[FMRB][LR]|[LR][FMB])(?=[a-z]{2})|[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_LETTERS = {"f": "front", "m": "middle", "r": "rear", "b": "rear"}, {"l": "left", "r": "right"}
_PAIRS = [(end, side) for end in _ENDS.items() for side in (_SIDES | _LETTERS[1]).items()]
_PAIRS += [(end, side) for end in _LETTERS[0].items() for side in _LETTERS[1].items()]
_TOGETHER = {a[0] + b[0]: [end[1], side[1]] for end, side in _PAIRS for a, b in ((end, side), (side, end))}
_INITIALS = re.compile(  # f_l, R_F
    r"(?i)(?<=(?<![a-z])[fmrb])_(?=[lr](?![a-z]))|(?<=(?<![a-z])[lr])_(?=[fmrb](?![a-z]))"
)
_DEVICES = {
    "con",
    "prn",
    "aux",
    "nul",
    "clock",
    *(f"{port}{i}" for port in ("com", "lpt") for i in range(10)),
}
_FILE_NAMES = {
    *"math stdio stdint stdlib stdbool string stddef stdarg float limits tgmath fenv inttypes".split(),
    *"numpy sympy casadi wmrgen".split(),
}
# C++ namespaces, functions of POSIX and Arduino, crates.
_SCOPES = {
    *"std boost eigen ros rclcpp rcl rclpy rmw ament tf2 alloc core".split(),
    *"accept access alarm bind brk chdir chmod chown close connect creat crypt daemon dup execl execv execve fcntl "
    "fork fsync getpid ioctl kill link listen lockf lseek mkdir mount nice open pause pipe poll pread pwrite read "
    "readlink reboot recv rmdir sbrk select send sleep socket stat swab symlink sync syscall truncate umask umount "
    "unlink usleep vfork wait waitpid write delay loop micros millis setup".split(),
}
_EXPRESSION_WORDS = {*"pi sqrt sin cos tan atan2".split()}
_CONTRACT_WORDS = {*"vx vy omega slip x y theta dt".split()}


def _reserved(name: str) -> str:
    """Why no name may be this word, in any case; nothing where it may."""
    if name.endswith("_t"):
        return "POSIX keeps names that end in _t for types."
    if "__" in name:
        return "C++ keeps names with a double underscore for the implementation."
    device = name.lower() in _DEVICES
    return why_reserved(name) or ("Windows keeps that name for a device." if device else "")


def _refusal(name: str, what: str) -> tuple[str, str] | None:
    """Why a robot, wheel or parameter may not have this word for its name, and what to write instead."""
    word = name.lower()
    if what == "robot":
        if word == "textbook":
            return (
                "`wmrgen textbook` writes a folder of that name: one would replace the other.",
                "textbook_robot",
            )
        if word in _FILE_NAMES:
            return "The generated files would be taken for a standard header or module.", f"{name}_robot"
        if AVR_MACROS.keeps(name):
            return AVR_MACROS.why, _free(name)
        if word in _SCOPES:
            why = "Packages name a C++ namespace, a library or a crate after the robot, and one of that name is there."
            return why, f"{name}_robot"
    words = word in _EXPRESSION_WORDS or name in _CONTRACT_WORDS or re.fullmatch(r"eta[0-9]+", name)
    if what == "parameter" and words:
        why = "Expressions or the inputs and outputs of the model use that word already."
        return why, "pi as it is" if word == "pi" else f"{name}_0 or a longer name"
    why = _reserved(name)
    return (why, _free(name)) if why else None


def _check(node: Scalar, what: str) -> str:
    """The name, when it is one; ``what`` says whose: robot, wheel, parameter."""
    name = node.text
    if not name:
        raise _no_name(node, f"the {what} name is empty", "", "front_left")
    if not re.fullmatch(NAME_PATTERN, name):
        why = "Names become identifiers of generated C: letters a-z and A-Z, digits and _, at most 31, a letter first."
        if len(name) > MAX_NAME:
            why = f"It has {len(name)} characters. {_WHY_SO_LONG}"
        elif latin(name) != name:
            why = lookalike(name)
        raise _no_name(node, f"{quoted(name)} is not a valid {what} name", why, _repaired(name, what))
    refusal = _refusal(name, what)
    if refusal:
        raise _no_name(node, f"the {what} name {quoted(name)} is reserved", *refusal)
    return name


def _no_name(node: Scalar, what: str, why: str, instead: str) -> RobotFileError:
    return node.error(what, why, f"Write {instead or 'a name such as front_left'}.", code=Code.NAME)


def _free(name: str) -> str:
    """A name near a reserved one that is not reserved: in lower case where that will do."""
    if not _reserved(name.lower()):
        return name.lower()
    return re.sub(r"__+", "_", name.removesuffix("_t"))[:28].rstrip("_") + "_1"


def _repaired(name: str, what: str) -> str:
    """A valid name near ``name``, or nothing."""
    name = re.sub("[Α-Ωα-ω]", lambda letter: unicodedata.name(letter[0]).split()[3].lower(), name)
    near = re.sub(r"[^A-Za-z0-9]+", "_", latin(name)).strip("_")[:MAX_NAME].rstrip("_")
    return near if re.fullmatch(NAME_PATTERN, near) and not _refusal(near, what) else ""


def robot_name(node: Scalar) -> str:
    """A robot's name, which also names its files and folder."""
    return _check(node, "robot")


def wheel_name(node: Scalar) -> str:
    return _check(node, "wheel")


def numbered_names(node: Scalar, count: int) -> tuple[str, ...]:
    """The names of the ``count`` drives of one wheel: its own, or with several of them ``name_1``, ``name_2``."""
    if count == 1:
        return (wheel_name(node),)
    return tuple(_check(replace(node, text=f"{node.text}_{k + 1}"), "wheel") for k in range(count))


def parameter_name(node: Scalar) -> str:
    """A parameter's name, which must not be a word of expressions or of the contract either."""
    return _check(node, "parameter")


class Names:
    """Names that a file gives, of which no two may be the same or differ in case alone."""

    def __init__(self) -> None:
        self._named: dict[str, tuple[str, str, int]] = {}

    def add(self, name: str, what: str, node: Node) -> None:
        """Enter the name of ``what``, which stands at ``node``. RobotFileError where it is taken."""
        if name.lower() not in self._named:
            self._named[name.lower()] = name, what, node.mark.line
            return
        other, whose, line = self._named[name.lower()]
        if other != name:
            problem = f"{quoted(name)} and {quoted(other)}, {whose} on line {line}, differ in case alone"
            why = "Macros in upper case and files on many disks could not tell them apart."
        else:
            problem, why = f"{quoted(name)} is the name of {whose} already", f"It stands on line {line}."
        raise node.error(problem, why, "Write another name.", code=Code.TWICE)


def role(*texts: str) -> str:
    """What names say of a wheel's place: "front left"; of several texts the first that says it counts, in a text whole
    words before letters: fr beside left is the front."""
    told: dict[str, str] = {}
    for text in texts:
        joined = _INITIALS.sub("", text)
        words = [word.lower() for word in _WORDS.findall(joined)]
        words.sort(key=lambda word: word not in _WHOLE)
        for side in (side for word in words for side in _sides(word)):
            told.setdefault("y" if side in _SIDES else "x", side)
        if "r" in words and "x" in told:  # beside an end it is no rear
            told.setdefault("y", "right")
    return " ".join(told[axis] for axis in "xy" if axis in told)


def _sides(word: str) -> list[str]:
    """The sides that a word in lower case names: rear, lf, frontleft, lfront, flwheel; l, which is no end as r is."""
    word = word.removeprefix("wheel").removesuffix("wheel")
    if word in _WHOLE:
        return [_WHOLE[word]]
    return _TOGETHER.get(word, ["left"] if word == "l" else [])
