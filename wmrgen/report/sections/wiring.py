"""Write ``wiring.md``, a check sheet: the sign of every driven joint for each motion, and symptoms of wrong wiring."""

from __future__ import annotations

from math import degrees

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Robot
from wmrgen.report.sections.markdown import code, foot, items, keyed, listed, pictures, some, table
from wmrgen.report.wiring import Motion, faults, motions

FILE = "wiring.md"


def wiring(d: Derivation, facts: Facts) -> list[str]:
    """Return the blocks of the page."""
    name = code(d.robot.name)
    blocks = [f"# Wiring check of {name}"]
    every = motions(d)
    possible = [m for m in every if m.joints]
    if not possible:
        nothing = keyed(
            "wiring.nothing_driven", "No joint of this robot is driven, so there is nothing to check."
        )
        return [*blocks, nothing, *foot(facts)]
    forbidden = [m.title.partition(",")[0] for m in every if m.joints is None]
    turns = any(w.turns and w.actuated for w in d.robot.wheels)
    start = (
        keyed("wiring.angles_at_zero", "All steering and castor angles are 0 at the start. ") if turns else ""
    )
    forbids = ""
    if forbidden:
        forbids = keyed("wiring.forbidden", f" The wheels do not allow {' and '.join(forbidden)}.")
    return [
        *blocks,
        "Lift the robot so that its wheels turn freely, and go through the list from the top. Arrows in the "
        "[top view](layout.svg) show the direction of positive rolling.",
        *items(_steps(d, possible[-1]), lambda k: f"{k}."),
        *pictures(d.figures, "wiring.svg"),
        *table(["joint", *(m.title for m in possible)], _rows(possible), "l"),
        f"{start}Arrows show the rolling direction of each wheel.{forbids}",
        *_faults(d, possible),
        *foot(facts),
    ]  # fmt: skip


def _steps(d: Derivation, last: Motion) -> list[str]:
    robot = d.robot
    driven = [w for w in robot.wheels if w.actuated]
    counted = any(w.sensed for w in robot.wheels)
    steers = any("steer" in w.actuated for w in driven)
    words = " ".join(f"{n}={float(v):g}" for n, v in last.twist.items() if v)
    steps = [
        "Command one motor at a time with a slow positive speed. Its wheel, and no other, must roll in the direction "
        "of its arrow. If another wheel turns, exchange the two motor plugs. If the wheel rolls backwards, exchange "
        "the two leads of the motor, or invert it in the controller, but not both." + _coupled(robot)
    ]
    if counted:
        steps.append(
            f"Watch the encoder of that wheel: {_counts(robot)}, exchange its channels A and B, or "
            "invert it in the controller. If another encoder counts, exchange the two plugs."
        )
    if steers:
        steps.append(
            "Set every steering angle to 0. Each wheel must point along its heading in the layout table. A small "
            "positive angle must turn it counter-clockwise, seen from above. If it turns clockwise, invert both motor "
            "and encoder of the steering."
        )
    steps.append(
        f"Command each motion below (`wmrgen eval {robot.name}.yaml inverse {words}` prints the numbers). Every sign "
        "must agree with the table."
    )
    return steps


def _coupled(robot: Robot) -> str:
    """Say which wheels turn together."""
    sets = robot.together("spin", (w for w in robot.wheels if w.has_spin))
    coupled = [w for wheels in sets if len(wheels) > 1 for w in wheels]
    if not coupled:
        return ""
    against = any(robot.spin_ratio(w).sign < 0 for w in coupled)
    opposite = ""
    if against:
        opposite = keyed("wiring.negative_ratio", ", against its arrow if the ratio is negative")
    return keyed(
        "wiring.coupled",
        f" A coupled wheel ({some(coupled)}) turns together with the wheels to which it is coupled{opposite}.",
    )


def _counts(robot: Robot) -> str:
    """Say whether encoders of wheels count up or down, and begin the sentence on those that do not."""
    counters = [w for w in robot.wheels if "spin" in w.sensed]
    down = [w for w in counters if (e := robot.encoder_of(w, "spin")) is not None and e.turn.sign < 0]
    if not down:
        return keyed("wiring.counts_up", "it must count up. If it counts down")
    up = "" if down == counters else f"up, but the encoder of {listed([w.name for w in down])} must count "
    key = "wiring.some_count_down" if up else "wiring.counts_down"
    return keyed(
        key, f"it must count {up}down (`reversed` in the robot file). If it counts in the other direction"
    )


def _rows(possible: list[Motion]) -> list[list[str]]:
    names = list(dict.fromkeys(n for m in possible for n in m.joints or {}))
    rows = []
    for name in names:
        cells = [_cell(name, (m.joints or {}).get(name, 0.0)) for m in possible]
        rows.append([code(name), *cells])
    return rows


def _cell(name: str, value: float) -> str:
    """Return the sign of a rate, or a steering angle in degrees."""
    if name.endswith(".steer"):
        return f"{round(degrees(value), 1) + 0.0:g}°".replace("-", "−")
    return "0" if abs(value) < NEGLIGIBLE else "+" if value > 0 else "−"


def _faults(d: Derivation, possible: list[Motion]) -> list[str]:
    """Return the table of symptoms of wrong wiring."""
    rows = [[f.text, *f.seen] for f in faults(d, possible)]
    if not rows:
        return []
    head = ["fault", *(m.title for m in possible)]
    return ["On the ground, a robot with wrong wiring moves differently:", *table(head, rows, "l")]
