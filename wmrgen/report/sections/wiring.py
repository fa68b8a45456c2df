"""``wiring.md``, a check sheet for the bench: the sign of every driven joint for each motion, what is wrong when."""

from __future__ import annotations

from math import degrees

from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Robot
from wmrgen.report.sections.markdown import code, foot, items, listed, page, pictures, some, table
from wmrgen.report.wiring import Motion, faults, motions

FILE = "wiring.md"
_STILL = 1e-9


def wiring(d: Derivation, facts: Facts) -> str:
    """The page."""
    name = code(d.robot.name)
    blocks = [f"# Wiring check of {name}"]
    every = motions(d)
    possible = [m for m in every if m.joints]
    if not possible:
        return page(
            [*blocks, "No joint of this robot is driven, so there is nothing to check.", *foot(facts)]
        )
    forbidden = [m.title.partition(",")[0] for m in every if m.joints is None]
    turns = any(w.turns and w.actuated for w in d.robot.wheels)
    start = "All angles are 0 before; an" if turns else "An"
    return page([
        *blocks,
        "Lift the robot, so that its wheels turn freely, and go through the list from the top. Arrows in the "
        "[top view](layout.svg) show the way of positive rolling.",
        *items(_steps(d, possible[-1]), lambda k: f"{k}."),
        *pictures(d.figures, "wiring.svg"),
        *table(["joint", *(m.title for m in possible)], _rows(possible), "l"),
        f"{start} arrow shows which way a wheel rolls."
        + (f" The wheels forbid {' and '.join(forbidden)}." if forbidden else ""),
        *_faults(d, possible),
        *foot(facts),
    ])  # fmt: skip


def _steps(d: Derivation, last: Motion) -> list[str]:
    robot = d.robot
    driven = [w for w in robot.wheels if w.actuated]
    counted = any(w.sensed for w in robot.wheels)
    steers = any("steer" in w.actuated for w in driven)
    words = " ".join(f"{n}={float(v):g}" for n, v in last.twist.items() if v)
    steps = [
        "Command one motor at a time, slowly and by a positive speed: its wheel, and no other, rolls the way of its "
        "arrow. If another wheel turns, exchange the two motor plugs; if it rolls backwards, exchange the motor's two "
        "leads, or invert it in the controller, not both." + _coupled(robot)
    ]
    if counted:
        steps.append(
            f"Watch the encoder of that wheel: {_counts(robot)}, exchange its channels A and B, or "
            "invert it in the controller; if another one counts, exchange the two plugs."
        )
    if steers:
        steps.append(
            "Set every steering angle to 0: each wheel points along its heading of the layout table. A small positive "
            "angle turns it counter-clockwise, seen from above. If it turns the other way, invert motor and encoder "
            "of the steering together."
        )
    steps.append(
        f"Command each motion below (`wmrgen eval {robot.name}.yaml inverse {words}` prints the numbers): every "
        "sign is that of the table."
    )
    return steps


def _coupled(robot: Robot) -> str:
    """What turns with a motor beside its own wheel."""
    sets = robot.together("spin", (w for w in robot.wheels if w.has_spin))
    coupled = [w for wheels in sets if len(wheels) > 1 for w in wheels]
    if not coupled:
        return ""
    against = any(robot.spin_ratio(w).sign < 0 for w in coupled)
    way = ", against its arrow where the ratio is negative" if against else ""
    return f" Of the coupled wheels ({some(coupled)}) each turns with those that it is coupled to{way}."


def _counts(robot: Robot) -> str:
    """Which way encoders of wheels count, and that one may count the other way."""
    counters = [w for w in robot.wheels if "spin" in w.sensed]
    down = [w for w in counters if (e := robot.encoder_of(w, "spin")) is not None and e.turn.sign < 0]
    if not down:
        return "it counts up. If it counts down"
    up = "" if down == counters else f"up, that of {listed([w.name for w in down])} "
    return f"it counts {up}down (`reversed` in the robot file). If it counts the other way"


def _rows(possible: list[Motion]) -> list[list[str]]:
    names = list(dict.fromkeys(n for m in possible for n in m.joints or {}))
    return [[code(n), *(_cell(n, (m.joints or {}).get(n, 0.0)) for m in possible)] for n in names]


def _cell(name: str, value: float) -> str:
    """A sign; of a steering angle the angle."""
    if name.endswith(".steer"):
        return f"{round(degrees(value), 1) + 0.0:g}°".replace("-", "−")
    return "0" if abs(value) < _STILL else "+" if value > 0 else "−"


def _faults(d: Derivation, possible: list[Motion]) -> list[str]:
    """What the robot on the ground does instead."""
    rows = [[f.text, *f.seen] for f in faults(d, possible)]
    if not rows:
        return []
    head = ["what is wrong", *(m.title for m in possible)]
    return ["On the ground a robot that is wired wrongly does this instead:", *table(head, rows, "l")]
