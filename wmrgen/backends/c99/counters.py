"""`<robot>_joints_from_counters`: `joints_from_counts` of counters as they stand, whose differences it takes.

A counter is unsigned and as wide as the robot file says; the difference of two of its values is taken in that width and
read as a signed number, so that it is right as long as the counter turned by less than half its range in a step.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from wmrgen.backends.c99.records import Parameter, Step
from wmrgen.backends.c99.text import Struct, block_comment, struct
from wmrgen.interface import IN
from wmrgen.ir.nodes import Module, Port

FUNCTION = "joints_from_counts"
# What ends the name of a port -> the counter that it reads, and whether it is a difference of two readings.
_READ = {
    "spin_counts": ("spin", True),
    "steer_counts": ("steer", False),
    "steer_rate_counts": ("steer", True),
}
_TEXTS = {"spin": "counter of the wheel's turn", "steer": "counter of the steering angle, 0 where steer is 0"}


def counting(module: Module, contract: Mapping[str, Step], scalar: str) -> tuple[Struct, Step] | None:
    """The type of a robot's counters and the function that takes them; None where it has no encoders."""
    if FUNCTION not in contract:
        return None
    counted, robot = contract[FUNCTION], module.name
    ports = {p.name: p for p in module.function(FUNCTION).inputs if p.bits}
    members = {_counter(p): replace(p, name=_counter(p), text=_TEXTS[_read(p)[0]]) for p in ports.values()}
    types = {name: f"uint{p.bits}_t" for name, p in members.items()}
    note = "Counters of encoders as they stand; they may wrap."
    counters = struct(f"{robot}_counters", tuple(members.values()), scalar, note, types)
    own = next(s for s in counted.structs if s.name.endswith(f"_{IN}"))
    (counts,) = (p for p in counted.parameters if p.type == own.name)
    readings = [Parameter(when, counters.name, {}, {}) for when in ("now", "last")]
    timed = [Parameter("dt", scalar, {"dt": ""}, {})] if "dt" in counts.reads else []
    others = [p for p in counted.parameters if p is not counts]
    declared, lines = [f"{own.name} counts;"], []
    for name, port in ports.items():
        member, signed = counters.members[_counter(port)], f"int{port.bits}_t"
        value = f"now->{member}"
        if _read(port)[1]:
            value = name.replace(".", "_")
            declared.append(f"const u{signed} {value} = (u{signed})(now->{member} - last->{member});")
        lines.append(f"counts.{counts.reads[name]} = ({scalar})({signed}){value};")
    if len(declared) == 1:
        lines.append("(void)last;")
    if timed:
        lines.append(f"counts.{counts.reads['dt']} = dt;")
    passed = ("&counts" if p is counts else p.name for p in counted.parameters)
    lines.append(f"{counted.name}({', '.join(passed)});")
    text = (
        f"{counted.name}() of counters as they stand now and as they stood at the last step. They may wrap, by less "
        "than half their range in a step."
    )
    comment = tuple(block_comment([text], doxygen=True))
    return counters, Step(
        f"{robot}_joints_from_counters", (), comment, (*declared, "", *lines), (*readings, *timed, *others)
    )


def _read(port: Port) -> tuple[str, bool]:
    return _READ[port.name.rpartition(".")[2]]


def _counter(port: Port) -> str:
    """The counter that a port reads: ``left.spin``."""
    return f"{port.name.rpartition('.')[0]}.{_read(port)[0]}"
