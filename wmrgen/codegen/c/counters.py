"""`<robot>_joints_from_counters`: `joints_from_counts` for readings of encoders, whose differences it computes.

A reading is an unsigned integer. If the encoder wraps as that integer does, the function subtracts two readings in the
width of the integer and takes the difference as signed. If it wraps at another modulus m, the function subtracts in 32
bits and wraps the difference to [-m/2, m/2). The difference is right if the encoder moves by less than half its range
in a step. For an absolute encoder, the angle is the difference from the encoder's offset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from wmrgen.codegen.c.functions import declared as declared_in_c
from wmrgen.codegen.c.text import block_comment, prototype, struct
from wmrgen.codegen.signature import IN
from wmrgen.codegen.unit import Parameter, Step, Struct
from wmrgen.geometry.ports import Reading
from wmrgen.ir.nodes import Module, Port

FUNCTION = "joints_from_counts"
_READ = {
    "spin_counts": "spin",
    "steer_counts": "steer",
    "steer_rate_counts": "steer",
}  # end of a port's name -> joint whose encoder it reads
_TEXTS = {
    "spin": "reading of the encoder of the wheel's rotation",
    "steer": "reading of the encoder of the steering angle",
}


def counting(module: Module, contract: Mapping[str, Step], scalar: str) -> tuple[Struct, Step] | None:
    """Return the type of a robot's counters and the function that takes them.

    Args:
        module: The functions of the robot.
        contract: Its C functions by name.
        scalar: ``float`` or ``double``.

    Returns:
        None if the robot has no encoders.
    """
    if FUNCTION not in contract:
        return None
    step, robot = contract[FUNCTION], module.name
    ports = {p.name: (p, p.reading) for p in module.function(FUNCTION).inputs if p.reading}
    encoders = {_encoder(p): replace(p, name=_encoder(p), text=_TEXTS[_joint(p)]) for p, _ in ports.values()}
    counters = struct(f"{robot}_counters", [*encoders.values()], "Readings of the encoders. They may wrap.")
    counts_type = next(s for s in step.structs if s.name.endswith(f"_{IN}"))
    (counts,) = (p for p in step.parameters if p.type == counts_type.name)
    declared, lines = [f"{counts_type.name} counts;"], []
    for name, (port, reading) in ports.items():
        member, local = counters.members[_encoder(port)], name.replace(".", "_")
        start = _start(port, reading, f"last->{member}")
        declared.append(_difference(local, f"now->{member}", start, reading))
        if not reading.wraps_as_integer:
            lines += _wrapped(local, reading.modulus)
        value = f"(int{reading.width}_t){local}" if reading.wraps_as_integer else local
        lines.append(f"counts.{counts.reads[name]} = ({scalar}){value};")
    if not any("last->" in line for line in declared):
        lines.append("(void)last;")
    if "dt" in counts.reads:
        lines.append(f"counts.{counts.reads['dt']} = dt;")
    passed = ("&counts" if p is counts else p.name for p in step.parameters)
    lines.append(f"{step.name}({', '.join(passed)});")
    text = (
        f"{step.name}() for readings of encoders: those of now and those of the last step. A reading may wrap if the "
        "encoder moves by less than half its range in a step."
    )
    comment = tuple(block_comment([text], doxygen=True))
    name = f"{robot}_joints_from_counters"
    parameters = _parameters(step, counts, counters, scalar)
    head = (prototype(f"void {name}", declared_in_c(parameters)),)
    body = (*declared, "", *lines)
    return counters, Step("joints_from_counters", name, parameters, comment, head, body)


def counter_types(counters: Struct) -> dict[str, str]:
    """Return the unsigned integer type of each member of ``counters``, by contract name."""
    return {port.name: f"uint{port.reading.width}_t" for port in counters.ports if port.reading}


def _parameters(step: Step, counts: Parameter, counters: Struct, scalar: str) -> tuple[Parameter, ...]:
    """Return the parameters of ``step`` with two readings and dt in the place of ``counts``."""
    readings = [Parameter(time, counters.name, {}, {}, counters) for time in ("now", "last")]
    timed = [Parameter("dt", scalar, {"dt": ""}, {})] if "dt" in counts.reads else []
    others = [p for p in step.parameters if p is not counts]
    changed = [p for p in others if p.reads and p.writes]
    return (*changed, *readings, *timed, *(p for p in others if p not in changed))


def _start(port: Port, reading: Reading, last: str) -> str:
    """Return the reading from which a difference is computed: an absolute encoder's offset, or the last reading."""
    absolute = reading.offset is not None and port.name.endswith(".steer_counts")
    if not absolute:
        return last
    suffix = "ul" if reading.width == 32 else "u"  # some processors have an int of 16 bits
    return f"{reading.offset}{suffix}"


def _difference(local: str, now: str, last: str, reading: Reading) -> str:
    """Return the declaration of the variable ``local``, the difference of two readings."""
    if reading.wraps_as_integer:
        unsigned = f"uint{reading.width}_t"
        return f"const {unsigned} {local} = ({unsigned})({now} - {last});"
    return f"int32_t {local} = (int32_t)((uint32_t){now} - (uint32_t){last});"


def _wrapped(local: str, modulus: int) -> list[str]:
    """Return the statements that wrap a difference to [-modulus/2, modulus/2)."""
    half = modulus // 2
    lines = []
    for beyond, sign in ((f">= {modulus - half}l", "-"), (f"< -{half}l", "+")):
        lines += [f"if ({local} {beyond}) {{", f"    {local} {sign}= {modulus}l;", "}"]
    return lines


def _joint(port: Port) -> str:
    return _READ[port.name.rpartition(".")[2]]


def _encoder(port: Port) -> str:
    """Return the encoder that a port reads: ``left.spin``."""
    return f"{port.name.rpartition('.')[0]}.{_joint(port)}"
