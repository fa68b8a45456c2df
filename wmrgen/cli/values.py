"""Input values of verbs: NAME=VALUE words or a JSON file, with numbers and units as robot files have them."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from wmrgen.cli import console
from wmrgen.errors import EnvironmentFailure, Mark, RobotFileError, UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port
from wmrgen.robotfile.expressions import UndeclaredParameter
from wmrgen.robotfile.numbers import Kind
from wmrgen.robotfile.quantities import Scope
from wmrgen.robotfile.text import Scalar, bytes_of, quoted, read_stream, suggestion

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot

MAX_BYTES = 16 << 20  # bytes of a file of cases: about 100,000 cases
_KINDS = {
    "m": Kind.LENGTH, "rad": Kind.ANGLE, "m/s": Kind.SPEED, "rad/s": Kind.RATE, "m/s^2": Kind.ACCELERATION,
    "rad/s^2": Kind.ANGULAR_ACCELERATION, "s": Kind.TIME,
}  # fmt: skip
Case = Mapping[str, Exact]
_PLAIN = re.compile(r"[+-]?(\d{1,40}(\.\d{0,40})?|\.\d{1,40})([eE][+-]?\d{1,3})?")  # a decimal number
_LARGEST = Fraction(2) ** 1024  # doubles are smaller
_DUST = Exact(Fraction(1, 10**40))  # exact results use 60 digits of pi: below this they are zero
_MINUS_ZERO = re.compile(r"\s*-\s*(0+\.?0*|\.0+)([eE][+-]?\d+)?\s*[a-z/]*\s*")


class _Words(NamedTuple):
    """How messages name a value."""

    name: str  # of the value: ``time``, ``--time``
    given: str  # the value as the user writes it: ``time = '5 kg'``, ``--time '5 kg'``
    example: str  # what comes before a number that is right: ``time=``, ``--time ``


class _MinusZero(Exact):
    """Zero that is -0.0 as a float: generated C reads the sign."""

    __slots__ = ()

    def __float__(self) -> float:
        return -0.0


def from_words(words: Iterable[str], ports: Sequence[Port], robot: Robot | None = None) -> Case:
    """Read words like ``vx=0.5 omega='30 deg'``.

    Args:
        words: the words.
        ports: the inputs that the words may name.
        robot: the robot whose tunable parameters may be among the inputs.

    Returns:
        The exact value of each given input, in SI units.

    Raises:
        UsageError: for an unknown input or a wrong value, and if ``robot`` cannot be built with its parameters.
    """
    case: dict[str, Exact] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise UsageError(f"{word!r} is not NAME=VALUE. Inputs are: {_names(ports)}.")
        port = _port(name.strip(), ports, "")
        if port.name in case:
            raise UsageError(f"{port.name} is given twice")
        case[port.name] = _number(text, port, _pair(port.name, text))
    if robot is not None:
        robot.refuse(case)
    return case


def from_option(option: str, text: str, ports: Sequence[Port], example: str | None = None) -> list[Exact]:
    """Read the numbers of an option, such as ``--twist '0.5, 0, 30 deg/s'``.

    Args:
        option: the option, as messages name it.
        text: its numbers, separated by commas, with units if the user writes them.
        ports: what the numbers are.
        example: what comes before a number that is right, in messages about a single number; None for the option.

    Returns:
        The exact value of each number, in SI units.

    Raises:
        UsageError: for another count of numbers, and for a wrong value.
    """
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != len(ports):
        names = ",".join(port.name.upper() for port in ports)
        values = "1 value" if len(parts) == 1 else f"{len(parts)} values"
        raise UsageError(f"{option} {text[:60]!r} has {values}, not {len(ports)}. Write {option} {names}.")
    numbers = []
    for part, port in zip(parts, ports, strict=True):
        words = _Words(option, f"{option} {part[:60]!r}", f"{option} " if example is None else example)
        if len(ports) > 1:
            words = _Words(port.name, f"{option}: {port.name} = {part[:60]!r}", "")
        numbers.append(_number(part, port, words))
    return numbers


def with_joints(words: Iterable[str], robot: Robot, joint: str, ports: Sequence[Port] = ()) -> list[str]:
    """Complete the names of wheels: ``left=4`` becomes ``left.spin=4``.

    Args:
        words: NAME=VALUE words.
        robot: the robot whose wheels may be named.
        joint: the joint of a wheel that a bare name means, spin or steer.
        ports: inputs of a function; if it has one input for a wheel, the bare name means this input instead.

    Returns:
        The words, those that name a wheel with a joint.
    """
    wheels = {w.name for w in robot.wheels}
    result = []
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip()
        if not equals or name not in wheels:
            result.append(word)
            continue
        inputs = [p.name for p in ports if p.name.startswith(f"{name}.")]
        full = inputs[0] if len(inputs) == 1 else f"{name}.{joint}"
        result.append(f"{full}={value}")
    return result


def note_zeros(ports: Iterable[Port], cases: Sequence[Case]) -> None:
    """Print which of ``ports`` are missing in a case: they are taken as 0."""
    names = []
    for port in ports:
        if any(port.name not in case for case in cases):
            names.append(port.name)
    if names:
        console.note(f"not given, taken as 0: {' '.join(names)}")


def from_file(file: str, ports: Sequence[Port], robot: Robot | None = None) -> list[Case]:
    """Read a JSON file with a list of {name: value}; values are numbers or strings like "pi/2".

    Args:
        file: the path, ``-`` for standard input.
        ports: the inputs that a case may have.
        robot: the robot whose tunable parameters may be among the inputs.

    Returns:
        For each case the exact values of its inputs, in SI units.

    Raises:
        UsageError: if the file is no such list, and as `from_words` does.
        RobotFileError: if the file cannot be read.
    """
    name = "standard input" if file == "-" else file
    data = _content(file, name)
    try:
        # Numbers remain text here and are read as those of robot files: exactly, and without NaN.
        cases = json.loads(data, parse_float=str, parse_int=str, parse_constant=str, object_pairs_hook=_once)
    except (ValueError, RecursionError) as error:
        raise UsageError(
            f'{name} is not JSON: {error}. Write a list of objects: [{{"vx": 0.5}}, …]'
        ) from error
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        raise UsageError(f'{name} must be a list of objects: [{{"vx": 0.5}}, …]')
    read = [_case(case, f"{name}, case {k}: ", ports) for k, case in enumerate(cases)]
    if robot is not None:
        _refuse(robot, read, name)
    return read


def _refuse(robot: Robot, cases: Sequence[Case], file: str) -> None:
    """Raise UsageError for the first case with whose tunable parameters the robot cannot be built."""
    names = [p.name for p in robot.tunable]
    tried = set[tuple[Exact | None, ...]]()
    for k, case in enumerate(cases):
        parameters = tuple(case.get(name) for name in names)
        if parameters in tried:
            continue
        tried.add(parameters)
        try:
            robot.refuse(case)
        except UsageError as error:
            raise UsageError(f"{file}, case {k}: {error.what}") from None


def _content(file: str, name: str) -> bytes:
    """Return the bytes of a file of cases, ``-`` for standard input. Messages call it ``name``."""
    if file != "-":
        data = bytes_of(file, MAX_BYTES + 1)
    elif sys.stdin is None:
        raise EnvironmentFailure(f"cannot read {name}: it is closed")
    else:
        try:
            data = read_stream(sys.stdin.buffer, MAX_BYTES + 1)
        except OSError as error:
            raise EnvironmentFailure(f"cannot read {name}: {error.strerror}") from error
    if len(data) > MAX_BYTES:
        raise UsageError(
            f"{name} is larger than {MAX_BYTES >> 20} MiB. Split it: cases do not depend on each other."
        )
    return data


def _once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    """Return the object of JSON with these members. Raise UsageError if two have the same name."""
    members: dict[str, object] = {}
    for name, value in pairs:
        if name in members:
            raise UsageError(f"{name[:60]} is given twice")
        members[name] = value
    return members


def _case(case: Mapping[str, object], place: str, ports: Sequence[Port]) -> Case:
    """Return the values of one case of a file; ``place`` starts messages."""
    result = {}
    for name, value in case.items():
        port = _port(name, ports, place)
        if not isinstance(value, str):
            raise UsageError(f"{place}{name} is {json.dumps(value)[:60]}, not a number")
        result[name] = _number(value, port, _pair(port.name, value, place))
    return result


def _pair(name: str, text: str, place: str = "") -> _Words:
    """Return how messages name the value of a pair NAME=VALUE; ``place`` starts messages."""
    return _Words(name, f"{place}{name} = {text[:60]!r}", f"{name}=")


def _names(ports: Sequence[Port]) -> str:
    return " ".join(port.name for port in ports)


def _port(name: str, ports: Sequence[Port], place: str) -> Port:
    """Return the input called ``name``. Raise UsageError with a suggestion if there is none."""
    for port in ports:
        if port.name == name:
            return port
    hint = suggestion(name, [port.name for port in ports])
    every = "" if hint.startswith("Valid") else f" Inputs are: {_names(ports)}."
    if not ports:
        raise UsageError(f"{place}there is no input {quoted(name)}: the function takes none")
    raise UsageError(f"{place}there is no input {quoted(name)}. {hint}{every}")


def _number(text: str, port: Port, words: _Words) -> Exact:
    """Return the exact SI value of ``text``, which may have a unit that fits the port. A zero keeps its sign."""
    value = _unsigned_zero(text, port, words)
    return value if value or not _MINUS_ZERO.fullmatch(text) else _MinusZero(0)


def _unsigned_zero(text: str, port: Port, words: _Words) -> Exact:
    """Return the exact SI value of ``text``; -0 as 0."""
    from wmrgen.geometry.layout.expressions import evaluate
    from wmrgen.robotfile.quantities import read_quantity

    number = f"0.5{' ' + port.unit if port.unit else ''}"
    hint = f"Write a number, such as {words.example}0.5 or {words.example}'{number}'."
    if not text.strip():
        raise UsageError(f"{words.given}: the value is missing. {hint}")
    text = _without_unit(text, port, words)
    if _PLAIN.fullmatch(text):
        value = Fraction(text)
        if abs(value) < _LARGEST:
            return Exact(value)  # also sizes that robot files reject: another program may print 1e-40 m/s
    scalar = Scalar(Mark("", 1, 1, ""), text, True)
    try:
        return evaluate(read_quantity(scalar, _KINDS.get(port.unit, Kind.ANY), words.name, Scope()), {})
    except UndeclaredParameter as error:  # a file declares names, the command line does not
        raise UsageError(f"{words.given} is not a number. {hint}") from error
    except RobotFileError as error:
        hint = " ".join(part for part in (error.why, error.instead) if part)
        raise UsageError(f"{words.given}: {error.what}. {hint}".rstrip()) from error


def _without_unit(text: str, port: Port, words: _Words) -> str:
    """Remove the unit of the port from ``text``: ``2.3 1/s`` becomes ``2.3``.

    Raise UsageError for another unit, if robot files have no unit of this kind.
    """
    unit = port.unit
    if not unit:
        return text
    space = r"\s+" if unit[0].isdigit() else r"\s*"
    match = re.fullmatch(rf"(.*[\d.)]){space}{re.escape(unit)}\s*", text)
    if match:
        return match[1]
    if unit in _KINDS:
        return text
    without_exponents = re.sub(r"[\d.][eE][+-]?\d", "", text)
    if re.search(r"[\d.)]\s*[a-zµ°\"]", without_exponents):
        raise UsageError(f"{words.given}: {words.name} is in {unit}. Write the number alone.")
    return text


def rounded(values: Mapping[str, Exact]) -> dict[str, float]:
    """Round results to the nearest doubles; what 60 digits of pi leave of a zero is 0."""
    return {name: float(value) if abs(value) > _DUST else 0.0 for name, value in values.items()}
