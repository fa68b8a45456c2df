"""Write the result on top of a report: type, inverse and forward in closed form, an example, the files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from itertools import islice, product
from math import degrees

from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import GYRO, TWIST_NAMES
from wmrgen.report.sections.forward import closed_forward
from wmrgen.report.sections.inverse import closed_inverse
from wmrgen.report.sections.markdown import code, keyed, listed, pictures, table
from wmrgen.report.sections.numerics import wanted
from wmrgen.report.sections.overview import kind_of_robot
from wmrgen.report.wiring import admissible

Values = Mapping[str, Exact]
Texts = Mapping[str, str]
NO_SLIP = 1e-5  # m/s: rounding of a twist with six digits causes less than this
_TRIED = 8  # number of twists that are tried: the one with the shortest joints is shown; more take too long
_FEW, _EVERY = 6, 12  # significant digits of printed joints: as few as recover the twist
_DIGITS = 5  # characters of a round number, with its decimal point
_MANY = 24  # values in one step of an example; more do not fit on its line
# Twists that are tried, in tenths of a unit: (vx, vy, omega).
_SPEEDS: tuple[tuple[Fraction | int, ...], ...] = (
    (5, 2, 4), (5, 0, 4), (5, 0, 2), (5, 0, 1), (5, 0, Fraction(1, 2)), (5, 0, Fraction(1, 10)), (0, 0, 4), (5, 2, 0),
    (5, 0, 0), (0, 5, 0), (4, 0, 2), (3, 0, 2), (6, 0, 4), (4, 0, 4), (3, 0, 4), (6, 0, 2), (4, 2, 4), (3, 3, 2),
)  # fmt: skip
_SCALES = (Fraction(1, 10), Fraction(1, 20), Fraction(1, 50), Fraction(1, 100), Fraction(1, 1000))


def result(d: Derivation) -> list[str]:
    """Return the section before section 1."""
    return [
        "## The result",
        *pictures(d.figures, "layout.svg", "motion.svg"),
        kind_of_robot(d),
        "**Inverse kinematics** (`inverse`, section 6), from the twist ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) to the "
        "joints:",
        *closed_inverse(d.driven),
        "**Forward kinematics** (`forward`, section 7), from measured joints to the twist:",
        *closed_forward(d.driven),
        *_example(d), *_files(d),
    ]  # fmt: skip


def _example(d: Derivation) -> list[str]:
    """Return a twist, its joints, the twist of these joints and the pose after a second, each with its command."""
    steps = example(d)
    if not steps:
        return []
    rows = []
    for function, inputs, outputs in steps:
        units = {p.name: p.unit for p, _ in d.formula(function).outputs}
        shown = ", ".join(f"{n} = {v} {units[n]}".rstrip() for n, v in outputs.items())
        words = " ".join(f"{n}={v}" for n, v in inputs.items() if v != "0")
        rows.append([shown, code(f"wmrgen eval {d.robot.name}.yaml {function} {words}")])
    again = keyed("example.same_twist", "the same twist again")
    if len(steps) > 2 and any(steps[1][2][n] != v for n, v in steps[0][1].items()):
        again = keyed("example.measured_part", "the part of the twist that is measured")
    head = f"**An example**: twist, joints, {f'{again}, ' if len(steps) > 2 else ''}and the pose after one second."
    return [head, *table(["result", "command"], rows, "l")]


def example(d: Derivation) -> list[tuple[str, Texts, Texts]]:
    """Return the function, inputs and outputs of each step, as they are printed.

    The result is [] if the robot has no joint to command, or cannot move.
    """
    if not any(w.actuated for w in d.robot.wheels):
        return []
    tried = [(twist, joints, _again(d, twist, joints)) for twist, joints in islice(_driven(d), _TRIED)]
    if not tried:
        return []
    repeated = [t for t in tried if not t[2] or t[2] == _each(six_decimals, t[0])] or tried[:1]
    alike = [t for t in repeated if _parts(t[0]) == _parts(repeated[0][0])]
    twist, joints, again = min(alike, key=lambda t: _digits(t[1]))
    digits = next((k for k in range(_FEW, _EVERY) if _again(d, twist, joints, k) == again), _EVERY)
    own = {n: v for n, v in joints.items() if d.robot.wheel(n.rpartition(".")[0]).actuated}
    steps = [("inverse", _each(six_decimals, twist), _each(_short, own, digits))]
    if again:
        steps.append(("forward", _each(_short, _measured(d, twist, joints), digits), again))
    pose = d.evaluate("odometry", {**twist, "dt": ONE})
    return [*steps, ("odometry", {**_each(six_decimals, twist), "dt": "1"}, _each(_short, pose))]


def _measured(d: Derivation, twist: Values, joints: Values) -> Values:
    """Return the inputs of `forward` for a twist and its joints; {} if they do not fit on a line."""
    sensed = [p.name for p in d.formula("forward").inputs if p.default is None]
    shown = {**joints, GYRO.name: twist["omega"]}
    return {n: shown.get(n, ZERO) for n in sensed} if len(sensed) <= _MANY else {}


def _again(d: Derivation, driven: Values, joints: Values, digits: int = _EVERY) -> Texts:
    """Return the twist that `forward` gives for joints printed with ``digits`` digits."""
    measured = _measured(d, driven, joints)
    twist = measured and d.evaluate(
        "forward", {n: read_number(_short(v, digits)) for n, v in measured.items()}
    )
    return {n: six_decimals(twist[n]) for n in TWIST_NAMES if twist}


def _driven(d: Derivation) -> Iterator[tuple[Values, Values]]:
    """Yield admissible twists of round numbers that are within the limits of the robot, with their joints."""
    sample = [float(v) for v in d.mobility.admissible.sample] if d.mobility.degree_of_mobility else [0.0]
    size = 2 * max(map(abs, sample))
    rounded = [tuple(Fraction(round(10**7 * v / size), 10**6) for v in sample)] if size else []
    for goes, scale in product((True, False), _SCALES):  # twists that drive and turn first
        asked = (
            {n: Exact(k * scale) for n, k in zip(TWIST_NAMES, s, strict=True)} for s in (*_SPEEDS, *rounded)
        )
        allowed = [
            {n: read_number(six_decimals(v)) for n, v in admissible(d, twist).items()} for twist in asked
        ]
        for twist in sorted(allowed, key=_plain):
            if _goes(twist) != goes or not any(twist.values()):
                continue
            if not all(within_limits(d, n, v) for n, v in twist.items()):
                continue
            joints = d.evaluate("inverse", twist)
            slip = joints.pop("slip")
            if abs(float(slip)) < NO_SLIP and all(within_limits(d, n, v) for n, v in joints.items()):
                yield twist, joints


def _parts(twist: Values) -> tuple[bool, ...]:
    """Return which components of a twist are not 0."""
    return tuple(bool(twist[n]) for n in TWIST_NAMES)


def _digits(joints: Values) -> int:
    """Return how many characters joints take, angles in degrees."""
    shown = (degrees(float(v)) if n.endswith(".steer") else float(v) for n, v in joints.items())
    return sum(len(f"{round(v, 6) + 0.0:.{_FEW}g}") for v in shown)


def _goes(twist: Values) -> bool:
    """Return whether P moves and the robot turns."""
    return bool(twist["omega"]) and any(twist[n] for n in ("vx", "vy"))


def _plain(twist: Values) -> tuple[bool, bool]:
    """Return the sort key of a twist: twists that turn first, then twists of few digits."""
    return not twist["omega"], any(len(six_decimals(v)) > _DIGITS for v in twist.values())


def _each(shown: Callable[..., str], values: Values, *digits: int) -> Texts:
    return {n: shown(v, *digits) for n, v in values.items()}


def six_decimals(value: Exact) -> str:
    """Return a component of the twist with six decimals."""
    return f"{round(float(value), 6) + 0.0:.{_EVERY}g}"


def within_limits(d: Derivation, name: str, value: Exact) -> bool:
    """Return whether the robot allows a value.

    Args:
        d: the derivation.
        name: a component of the twist, or a joint such as ``left.spin``.
        value: its value, in SI units.

    Returns:
        Whether it is within the limits; True if there are none.
    """
    limit = d.robot.limit_of(name)
    return limit is None or float(limit.low) <= float(value) <= float(limit.high)


def _short(value: Exact, digits: int = _FEW) -> str:
    """Return a number as `wmrgen eval` reads it."""
    return f"{round(float(value), 12) + 0.0:.{digits}g}"


def read_number(text: str) -> Exact:
    """Return a printed number."""
    return Exact(Fraction(text))


def _files(d: Derivation) -> list[str]:
    """Say where the generated files are described."""
    further = [f.name for f in wanted(d)]
    more = ""
    if further:
        more = keyed("files.further", f", and has formulas of the further functions {listed(further)}")
    return [
        f"**Files**: [numerics.md](numerics.md) lists the generated files{more}. [wiring.md](wiring.md) is a check "
        "sheet for commissioning."
    ]
