"""``wmrgen designs``: layouts side by side, and sweeps over their parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robots, count_option, option, output, verb
from wmrgen.cli.values import from_option
from wmrgen.errors import UsageError
from wmrgen.geometry.ports import Port, Role

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.tools.designs.figures import Design, Facts
    from wmrgen.tools.workers import Map

_MOST = 100_000  # designs: hours of work
_SIDE_BY_SIDE = 6  # designs: more columns do not fit into a terminal
_BATCH = 8  # designs that a worker takes at once: transfers take less time than the work
_DENOMINATOR = 10**9  # of an end of a range: micrometres and microradians stay exact


class Range(NamedTuple):
    """A varied parameter: NAME=LOW:HIGH:N."""

    name: str
    ends: tuple[str, str]  # as the user writes them, with units
    number: int


@verb("designs")
def designs(
    robots: Robots,
    vary: Annotated[
        list[str] | None,
        option(
            "Vary a parameter of the robot files in N steps; several options are a grid.", "NAME=LOW:HIGH:N"
        ),
    ] = None,
    svg: Annotated[Path | None, option("Write a picture.", "FILE")] = None,
    workers: Annotated[int | None, count_option("--workers", "Derive the designs in N processes.")] = None,
    scheduler: Annotated[
        str | None, option("Derive the designs on the Dask cluster of this scheduler.", "ADDRESS")
    ] = None,
    out: Annotated[
        Path,
        output("DIR", "The folder of derived robots; it has the flash of robots whose budget was measured."),
    ] = Path("generated"),
    as_json: Json = False,
) -> int:
    """Example:  wmrgen designs robots/pioneer3dx.yaml robots/festo_robotino.yaml

    Compare designs: degrees of mobility, drives, the fastest motions within the limits, isotropy, the accuracy of
    odometry, the margin to tip over, operations and flash. With --vary, compute them for many values of parameters.
    """
    found = list(_qualities(_designs(robots, vary or [], out), workers, scheduler))
    names = [_range(word).name for word in vary or []]
    if svg is not None:
        from wmrgen.derivation.artifacts import write_file
        from wmrgen.tools.designs.picture import differing, picture

        if not differing(found):
            console.note("the picture has no panel, because no figure differs between the designs")
        write_file(svg, picture(found, names[0] if len(names) == 1 else None).svg.encode())
    if as_json:
        console.data({"designs": found})
        return 0
    rows = _columns(found) if len(found) <= _SIDE_BY_SIDE and not names else _rows(found, names)
    for row in _aligned(rows):
        console.result(row)
    failed = [facts for facts in found if "error" in facts]
    if failed:
        console.note(f"{len(failed)} of {len(found)} designs are impossible. The first: {failed[0]['error']}")
    return 0


def _designs(robots: Sequence[Path], vary: Sequence[str], out: Path) -> list[Design]:
    """Return the designs: every robot file with every combination of the varied values."""
    from wmrgen.tools.designs.figures import Design, flash_of, varied

    ranges = [_range(word) for word in vary]
    names = [varying.name for varying in ranges]
    if len(set(names)) < len(names):
        raise UsageError(f"--vary names a parameter twice: {', '.join(names)}")
    count = len(robots)
    for varying in ranges:
        count *= varying.number
    if count > _MOST:
        raise UsageError(f"these are {count} designs, more than {_MOST}. Write fewer steps.")
    result = []
    for path in robots:
        spec, robot = wmrgen.read(path)
        if not names:
            result.append(Design(spec, (), flash_of(robot.name, path, out)))
            continue
        for point in product(*(_values(varying, robot) for varying in ranges)):
            chosen = dict(zip(names, point, strict=True))
            varied(spec, chosen)  # UsageError for a name that the file does not have
            result.append(Design(spec, tuple(chosen.items())))
    return result


def _range(word: str) -> Range:
    """Return the parameter of NAME=LOW:HIGH:N with its range. Raise UsageError for another form."""
    name, equals, text = word.partition("=")
    parts = text.split(":")
    number = parts[2].strip() if len(parts) == 3 else ""
    if not equals or not (number.isascii() and number.isdigit()) or not 1 <= int(number) <= _MOST:
        raise UsageError(f"--vary {word[:60]!r} is not NAME=LOW:HIGH:N. Write --vary half_track=0.1:0.3:21.")
    return Range(name.strip(), (parts[0], parts[1]), int(number))


def _values(varying: Range, robot: Robot) -> list[Fraction]:
    """Return equally spaced values of a parameter, in SI units.

    Raises:
        UsageError: If an end is no number, or has a unit that does not fit the parameter.
    """
    from wmrgen.analysis.kinematics.records import parameter_ports

    known = {port.name: port for port in parameter_ports(robot)}
    port = known.get(varying.name, Port(varying.name, Role.GEOMETRY, ""))  # `varied` refuses an unknown name
    ends = [from_option(f"--vary {port.name}", end, [port], example="")[0] for end in varying.ends]
    low, high = (Fraction(float(end)).limit_denominator(_DENOMINATOR) for end in ends)
    steps = max(1, varying.number - 1)
    return [low + (high - low) * k / steps for k in range(varying.number)]


def _qualities(work: Sequence[Design], workers: int | None, scheduler: str | None) -> Iterator[Facts]:
    """Yield the figures of merit of designs, in their order."""
    from wmrgen.tools.designs.figures import qualities

    with console.progress() as step, _mapped(len(work), workers, scheduler) as mapped:
        size = (
            _BATCH if mapped is None else max(_BATCH, len(work) // 20)
        )  # 5 % of the work between two reports
        for first in range(0, len(work), size):
            step(f"deriving design {first + 1} of {len(work)}")
            part = work[first : first + size]
            yield from map(qualities, part) if mapped is None else mapped(qualities, part)


@contextmanager
def _mapped(count: int, workers: int | None, scheduler: str | None) -> Iterator[Map | None]:
    """Yield the map over the workers that the user asks for; None to work in this process."""
    from wmrgen.cli.parallel import processes_for
    from wmrgen.tools.workers import cluster, pool

    if scheduler and workers:
        raise UsageError("there are both --workers and --scheduler. Give one of them.")
    processes = processes_for(count, workers)
    with cluster(scheduler) if scheduler else pool(processes) if processes > 1 else nullcontext() as mapped:
        yield mapped


# ---- Tables.


def _columns(found: Sequence[Facts]) -> list[list[str]]:
    """Return a row for each quality and a column for each design."""
    from wmrgen.tools.designs.figures import QUALITIES

    rows = [["", *(str(facts["name"]) for facts in found)]]
    for quality in QUALITIES:
        title = f"{quality.title} [{quality.unit}]" if quality.unit else quality.title
        rows.append([title, *(_shown(facts.get(quality.name)) for facts in found)])
    return rows


def _rows(found: Sequence[Facts], names: Sequence[str]) -> list[list[str]]:
    """Return a row for each design, with the qualities that some design has."""
    from wmrgen.tools.designs.figures import QUALITIES

    known: dict[str, object] = {}
    for facts in found:
        known |= {name: value for name, value in facts.items() if value is not None}
    shown = [*names, *(quality.name for quality in QUALITIES if quality.name in known)]
    rows = [["name", *shown]]
    for facts in found:
        rows.append([str(facts["name"]), *(_shown(facts.get(name)) for name in shown)])
    return rows


def _shown(value: Any) -> str:
    """Return a value of the table; - for what the robot file does not determine."""
    return "-" if value is None else f"{value:.4g}"


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table; numbers are aligned at the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for first, *cells in rows:
        right = [f"{cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True)]
        lines.append("  ".join([f"{first:<{widths[0]}}", *right]))
    return lines
