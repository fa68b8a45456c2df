"""`<robot>_joints_from_counters`: `joints_from_counts` of encoders as they are read, whose differences it takes.

A reading is an unsigned integer. If it wraps as that integer does, the difference of two is taken in its width and
read as signed. If it wraps elsewhere, at the modulus m, the difference is taken in 32 bits and brought into
[-m/2, m/2). It is right as long as the counter turns by less than half its range in a step. The angle of an absolute
encoder is the difference from its offset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from wmrgen.codegen.c.records import Parameter, Step
from wmrgen.codegen.c.text import Struct, block_comment, struct
from wmrgen.codegen.signature import IN
from wmrgen.geometry.ports import Reading
from wmrgen.ir.nodes import Module, Port

FUNCTION = "joints_from_counts"
LONG = 32  # bits from which a literal of C needs a suffix on processors whose int has 16
_READ = {
    "spin_counts": "spin",
    "steer_counts": "steer",
    "steer_rate_counts": "steer",
}  # end of a port -> encoder
_TEXTS = {
    "spin": "reading of the encoder of the wheel's turn",
    "steer": "reading of the encoder of the steering angle",
}


def counting(module: Module, contract: Mapping[str, Step], scalar: str) -> tuple[Struct, Step] | None:
    """The type of a robot's counters and the function that takes them; None where it has no encoders."""
    if FUNCTION not in contract:
        return None
    counted, robot = contract[FUNCTION], module.name
    ports = {p.name: (p, p.reading) for p in module.function(FUNCTION).inputs if p.reading}
    members = {_encoder(p): replace(p, name=_encoder(p), text=_TEXTS[_joint(p)]) for p, _ in ports.values()}
    types = {_encoder(p): f"uint{reading.width}_t" for p, reading in ports.values()}
    note = "Readings of encoders as they are; they may wrap."
    counters = struct(f"{robot}_counters", tuple(members.values()), scalar, note, types)
    own = next(s for s in counted.structs if s.name.endswith(f"_{IN}"))
    (counts,) = (p for p in counted.parameters if p.type == own.name)
    readings = [Parameter(when, counters.name, {}, {}) for when in ("now", "last")]
    timed = [Parameter("dt", scalar, {"dt": ""}, {})] if "dt" in counts.reads else []
    others = [p for p in counted.parameters if p is not counts]
    changed = [p for p in others if p.reads and p.writes]
    declared, lines = [f"{own.name} counts;"], []
    for name, (port, reading) in ports.items():
        member, local = counters.members[_encoder(port)], name.replace(".", "_")
        declared.append(
            _difference(local, f"now->{member}", _from(port, reading, f"last->{member}"), reading)
        )
        if not reading.wraps_as_integer:
            lines += _wrapped(local, reading.modulus)
        value = f"(int{reading.width}_t){local}" if reading.wraps_as_integer else local
        lines.append(f"counts.{counts.reads[name]} = ({scalar}){value};")
    if not any("last->" in line for line in declared):
        lines.append("(void)last;")
    if timed:
        lines.append(f"counts.{counts.reads['dt']} = dt;")
    passed = ("&counts" if p is counts else p.name for p in counted.parameters)
    lines.append(f"{counted.name}({', '.join(passed)});")
    text = (
        f"{counted.name}() of encoders as they are read now and as they were read at the last step. Readings may wrap, "
        "by less than half their range in a step."
    )
    comment = tuple(block_comment([text], doxygen=True))
    parameters = (*changed, *readings, *timed, *(p for p in others if p not in changed))
    return counters, Step(f"{robot}_joints_from_counters", (), comment, (*declared, "", *lines), parameters)


def _from(port: Port, reading: Reading, last: str) -> str:
    """What the difference is taken from: the offset of an absolute encoder's angle, else the last reading."""
    absolute = reading.offset is not None and port.name.endswith(".steer_counts")
    return f"{reading.offset}u{'l' if reading.width == LONG else ''}" if absolute else last


def _difference(local: str, now: str, last: str, reading: Reading) -> str:
    """The declaration of the difference of two readings."""
    if reading.wraps_as_integer:
        unsigned = f"uint{reading.width}_t"
        return f"const {unsigned} {local} = ({unsigned})({now} - {last});"
    return f"int32_t {local} = (int32_t)((uint32_t){now} - (uint32_t){last});"


def _wrapped(local: str, modulus: int) -> list[str]:
    """The statements that bring a difference into [-modulus/2, modulus/2)."""
    half = modulus // 2
    beyond = ((f">= {modulus - half}l", "-"), (f"< -{half}l", "+"))
    return [
        line
        for sense, sign in beyond
        for line in (f"if ({local} {sense}) {{", f"    {local} {sign}= {modulus}l;", "}")
    ]


def _joint(port: Port) -> str:
    return _READ[port.name.rpartition(".")[2]]


def _encoder(port: Port) -> str:
    """The encoder that a port reads: ``left.spin``."""
    return f"{port.name.rpartition('.')[0]}.{_joint(port)}"
