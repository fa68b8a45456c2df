"""The result on top: top view, type, inverse and forward in closed form, an example with numbers, the files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING

from wmrgen.backends.report.closed import closed_forward, closed_inverse
from wmrgen.backends.report.markdown import code, pictures, table, written
from wmrgen.backends.report.overview import kind_of_robot
from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ports import TWIST_NAMES
from wmrgen.wiring import admissible

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

Values = Mapping[str, Exact]
_NO_SLIP = 1e-5  # m/s; of numbers with six digits
_TRIED = 4  # twists
_DIGITS = 5  # of a round number, with its point
_MANY = 24  # values of one step of an example
_SPEEDS: tuple[tuple[Fraction | int, ...], ...] = (
    (5, 2, 4), (5, 0, 4), (5, 0, 2), (5, 0, 1), (5, 0, Fraction(1, 2)), (5, 0, Fraction(1, 10)), (0, 0, 4), (5, 2, 0),
    (5, 0, 0), (0, 5, 0),
)  # tenths  # fmt: skip
_SCALES = (Fraction(1, 10), Fraction(1, 20), Fraction(1, 50), Fraction(1, 100), Fraction(1, 1000))


def result(d: Derivation) -> list[str]:
    """The section before the first one."""
    return [
        "## The result",
        *pictures(d.figures, "layout.svg", "motion.svg"),
        kind_of_robot(d),
        "**Inverse kinematics** (`inverse`), from the twist ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) to the joints "
        "(section 6):",
        *closed_inverse(d.driven),
        "**Forward kinematics** (`forward`), from measured joints to the twist (section 7):",
        *closed_forward(d.driven),
        *_example(d), *_files(d),
    ]  # fmt: skip


def _example(d: Derivation) -> list[str]:
    """A twist, its wheel speeds, the twist of these, the pose after a second, and the commands that say so."""
    steps = example(d)
    if not steps:
        return []
    rows = []
    for function, inputs, outputs in steps:
        units = {p.name: p.unit for p, _ in d.program.formula(function).outputs}
        shown = ", ".join(f"{n} = {_short(v)}{_unit(units[n])}" for n, v in outputs.items())
        words = " ".join(f"{n}={_short(v)}" for n, v in inputs.items() if v)
        rows.append([shown, code(f"wmrgen eval {d.robot.name}.yaml {function} {words}")])
    again = "the same twist again"
    if len(steps) > 2 and any(abs(float(steps[1][2][n] - v)) > _NO_SLIP for n, v in steps[0][1].items()):
        again = "the part of the twist that is measured"
    head = f"**An example**: twist, joints, {f'{again}, ' if len(steps) > 2 else ''}and the pose after one second."
    return [head, *table(["result", "command"], rows, "l")]


def example(d: Derivation) -> list[tuple[str, Values, Values]]:
    """Function, inputs and outputs of each step; nothing where the robot has no joint to command or cannot move."""
    if not any(w.actuated for w in d.robot.wheels):
        return []
    tried = islice(_driven(d), _TRIED)
    first = next(tried, None)
    if first is None:
        return []
    twist, joints = next((pair for pair in chain([first], tried) if _repeats(d, *pair)), first)
    own = {n: v for n, v in joints.items() if d.robot.wheel(n.rpartition(".")[0]).actuated}
    steps = [("inverse", twist, own)]
    measured = _measured(d, joints)
    if measured and len(measured) <= _MANY:
        again = d.evaluate("forward", measured)
        steps.append(("forward", measured, {n: again[n] for n in TWIST_NAMES}))
    pose = d.evaluate("odometry", {**twist, "dt": ONE})
    return [*steps, ("odometry", {**twist, "dt": ONE}, pose)]


def _measured(d: Derivation, joints: Values) -> Values:
    """What `forward` is told of the joints."""
    sensed = (p.name for p in d.program.formula("forward").inputs if p.default is None)
    return {n: joints.get(n, ZERO) for n in sensed}


def _repeats(d: Derivation, twist: Values, joints: Values) -> bool:
    """Whether the six digits of the joints that a command has give the twist again, where they are printed."""
    measured = _measured(d, joints)
    if len(measured) > _MANY:
        return True
    again = d.evaluate("forward", {n: Exact(Fraction(_short(v))) for n, v in measured.items()})
    return all(abs(float(again[n] - v)) < _NO_SLIP for n, v in twist.items())


def _driven(d: Derivation) -> Iterator[tuple[Values, Values]]:
    """Round twists, without what the wheels forbid, that the robot can drive inside its limits, with their joints."""
    sample = [float(v) for v in d.mobility.admissible.sample] if d.mobility.degree_of_mobility else [0.0]
    size = 2 * max(map(abs, sample))
    rounded = [tuple(Fraction(round(10**7 * v / size), 10**6) for v in sample)] if size else []
    for scale in _SCALES:
        asked = (
            {n: Exact(k * scale) for n, k in zip(TWIST_NAMES, s, strict=True)} for s in (*_SPEEDS, *rounded)
        )
        allowed = [{n: _six(v) for n, v in admissible(d, twist).items()} for twist in asked]
        for twist in sorted(allowed, key=_plain):
            if not any(twist.values()) or not all(_inside(d, n, v) for n, v in twist.items()):
                continue
            joints = d.evaluate("inverse", twist)
            slip = joints.pop("slip")
            if abs(float(slip)) < _NO_SLIP and all(_inside(d, n, v) for n, v in joints.items()):
                yield twist, joints


def _plain(twist: Values) -> tuple[bool, bool]:
    """What turns comes first, of that what has few digits."""
    return not twist["omega"], any(len(_short(v)) > _DIGITS for v in twist.values())


def _six(value: Exact) -> Exact:
    """Six decimals, as a command has it."""
    return Exact(Fraction(round(10**6 * float(value)), 10**6))


def _inside(d: Derivation, name: str, value: Exact) -> bool:
    owner, _, joint = name.rpartition(".")
    limit = d.robot.limit(d.robot.wheel(owner), joint) if owner else d.robot.limits.get(name)
    return limit is None or float(limit.low) <= float(value) <= float(limit.high)


def _short(value: Exact) -> str:
    """As `wmrgen eval` reads it."""
    return f"{round(float(value), 12) + 0.0:.6g}"


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""


def _files(d: Derivation) -> list[str]:
    """What the backends write beside this page, numerics.md saying what each is."""
    names = [name for names, _ in written(d) for name in names]
    return [f"**Files** (what each is: [numerics.md](numerics.md)): {' · '.join([*map(_link, names)])}"]


def _link(name: str) -> str:
    return code(name) if "*" in name else f"[{code(name)}]({name})"
