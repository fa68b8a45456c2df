"""Small robot files for the tests."""

from __future__ import annotations

import pytest

from wmrgen.errors import RobotFileError
from wmrgen.geometry.layout import build
from wmrgen.robotfile.load import read_text
from wmrgen.robotfile.records import Binary, Call, Expr, Neg, Num, Param, Pi, RobotSpec, WheelSpec

HEAD = "wmrgen: 1\nname: bot\n"
KEYS = {
    "fixed": "x: 0, y: 0.1, heading: 0, r: 0.05",
    "steered": "x: 0, y: 0.1, heading: 0, r: 0.05",
    "castor": "x: 0, y: 0.1, d: 0.02, r: 0.05",
    "swedish": "x: 0, y: 0.1, heading: 0, r: 0.05",
    "spherical": "x: 0, y: 0.1",
}


def robot(*wheels: str, top: str = "") -> str:
    """A robot file with lines ``top`` and these wheels, each the inside of a flow mapping."""
    lines = "".join(f"  - {{{wheel}}}\n" for wheel in wheels or (wheel("a"),))
    return f"{HEAD}{top}wheels:\n{lines}"


def wheel(name: str, type_name: str = "fixed", extra: str = "", **values: str) -> str:
    """The inside of a valid wheel; ``values`` replace keys, an empty one drops the key."""
    keys = dict(part.split(": ", 1) for part in KEYS[type_name].split(", "))
    keys = {"name": name, "type": type_name, **keys, **values}
    return ", ".join([f"{k}: {v}" for k, v in keys.items() if v] + ([extra] if extra else []))


def read(text: str) -> RobotSpec:
    return read_text(text, "bot.yaml")


def one_wheel(inside: str, top: str = "") -> WheelSpec:
    return read(robot(inside, top=top)).wheels[0]


def places(error: RobotFileError) -> str:
    """The code and the place of each error, such as ``WMR104 3:9``, joined by commas."""
    return ", ".join(
        f"{part.code} {part.mark.line}:{part.mark.column}" if part.mark else str(part.code)
        for part in error.parts
    )


def refused(text: str, built: bool = False) -> RobotFileError:
    """The error of a robot file, or of its layout if ``built``. Each part can be printed and says what to write."""
    with pytest.raises(RobotFileError) as caught:
        build(read(text)) if built else read(text)
    str(caught.value).encode()
    assert all(part.why or part.instead for part in caught.value.parts)
    return caught.value


def show(expr: Expr) -> str:
    """A tree as fully bracketed text."""
    match expr:
        case Num(value):
            return str(value)
        case Pi():
            return "pi"
        case Param(name):
            return name
        case Neg(arg):
            return f"-{show(arg)}"
        case Binary(op, left, right):
            return f"({show(left)} {op} {show(right)})"
        case Call(function, args):
            return f"{function}({', '.join(map(show, args))})"
