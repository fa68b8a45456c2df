"""Rules about numbers in a wrong unit: degrees without their unit, millimetres, sizes that do not fit together."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from math import degrees, pi, tau

from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.robotfile.numbers import UNITS
from wmrgen.robotfile.records import Limit, Quantity
from wmrgen.tools.lint.record import PAIR, Finding, Subject, rule

LARGEST = 20.0  # [m]; the largest robot
APART = 100.0  # largest ratio of two sizes of a robot
FASTEST = 10 * tau  # [rad/s]; ten turns a second of a body or a steering joint
_SPEED = 100.0  # [m/s]; the fastest robot
_SLOWEST = 10.0  # [s]; the longest time constant of a joint
_MOST = {
    "steer": (tau, "rad", "deg"),
    **dict.fromkeys(("omega", "steer_rate"), (FASTEST, "rad/s", "deg/s")),
    **dict.fromkeys(("vx", "vy"), (_SPEED, "m/s", "mm/s")),
}
_ANGLES = ("alpha", "beta", "heading", "gamma")
_NUMBER = re.compile(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?")
_UNIT = re.compile(r"deg|rad|°|/s")
_MEANT = re.compile(r"deg|°|/s")  # units of a limit that is surely meant as written
_LENGTH = re.compile(rf"({_NUMBER.pattern}) *(m|mm|cm|in)?")  # without parameters
_CHECK = "Check the number and its unit."
_PI = re.compile(r"pi|π")
ROUNDED = 2e-3  # [rad]; a turn may be written as 6.28 or 6.2832


@rule(
    "WMR001",
    "angle of more than a turn",
    """An angle without a unit is in radians unless the file says `angles: deg`. An angle of more than a turn is most
    likely in degrees.""",
    PAIR + "  - {name: tail, type: castor, x: -0.3, y: 0, heading: 180, d: 0.04, r: 0.05}\n",
    PAIR + "  - {name: tail, type: castor, x: -0.3, y: 0, heading: 180 deg, d: 0.04, r: 0.05}\n",
)
def turns(subject: Subject) -> Iterator[Finding]:
    for w in subject.spec.wheels:
        for key in _ANGLES:
            quantity: Quantity | None = getattr(w, key)
            if (
                quantity
                and not _UNIT.search(quantity.text)
                and abs(value := subject.value(quantity)) > tau + ROUNDED
            ):
                yield Finding(
                    quantity.mark,
                    f"{w.name}: {key} = {quantity.text} is {value:.4g} rad, {abs(value) / tau:.3g} turns",
                    _in_degrees(quantity, value),
                )


def _in_degrees(quantity: Quantity, value: float) -> str:
    """Advise what to write in place of an angle of ``value`` [rad] that has no unit."""
    if _PI.search(quantity.text):
        return f"Write {value % tau / pi:.6g}*pi, unless something else was meant."
    if not _NUMBER.fullmatch(quantity.text):
        return "Write deg after the numbers of the expression."
    if abs(float(quantity.text) - value) > ROUNDED:  # the file's angles are in degrees
        return f"Write {degrees(value) % 360:.6g}, unless something else was meant."
    return f"Did you mean {quantity.text} deg?"


def _limits(subject: Subject) -> Iterator[tuple[str, Limit]]:
    yield from (("the robot", limit) for limit in subject.spec.limits)
    yield from ((w.name, limit) for w in subject.spec.wheels for limit in w.limits)


@rule(
    "WMR002",
    "implausible limit or lag",
    """No robot has a steering limit of more than a turn, a speed or rim speed above 100 m/s, or a lag above 10 s. No
    body and no steering joint turns ten times a second. Values without a unit are in radians, metres and
    seconds; degrees, turns per minute, millimetres or milliseconds were likely meant. A joint with a limit of 0
    does not move, and a speed whose acceleration has a limit of 0 never changes.""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, actuated: [steer], limits: {steer: [-35, 35]}}
""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, actuated: [steer], limits: {steer: [-35 deg, 35 deg]}}
""",
)
def limits(subject: Subject) -> Iterator[Finding]:
    radius = max(float(w.nominal.r) for w in subject.robot.wheels)
    most = _MOST | ({"spin": (_SPEED / radius, "rad/s", "rpm, or deg/s")} if radius else {})
    for name, limit in _limits(subject):
        bound, unit, meant = most.get(limit.name, (0.0, "", ""))
        worst = max((limit.low, limit.high), key=lambda q: abs(subject.value(q)))
        value = subject.value(worst)
        if bound and not _MEANT.search(worst.text) and abs(value) > bound:
            turns = f", {abs(value) / tau:.3g} turns{' a second' * ('/' in unit)}" if "rad" in unit else ""
            yield Finding(
                limit.mark,
                f"{name}: a limit {limit.name} of {value:.4g} {unit}{turns}",
                f"Did you mean {meant}? Write the unit.",
            )
        elif not value and limit.name not in TWIST_NAMES:
            stays = limit.name.removesuffix("_rate")
            what = f"{name}: a limit {limit.name} of 0: {stays} never changes"
            yield Finding(limit.mark, what, "Write the largest value, or delete the key.")
    lags = [("the robot", lag) for lag in subject.spec.lag]
    lags += [(w.name, lag) for w in subject.spec.wheels for lag in w.lag]
    for name, (joint, time) in lags:
        if (value := subject.value(time)) > _SLOWEST:
            what = f"{name}: a lag of {joint} of {value:.4g} s"
            yield Finding(time.mark, what, "Did you mean ms? Write the unit.")


@rule(
    "WMR003",
    "robot larger than 20 m",
    """Lengths without a unit are in metres. A base of more than 20 m, or one that far from its origin, was likely
    written in millimetres. The same holds for a trailer, a centre of gravity or an effective track.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 165,  heading: 0, r: 97}
  - {name: right, type: fixed, x: 0, y: -165, heading: 0, r: 97}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 165 mm,  heading: 0, r: 97 mm}
  - {name: right, type: fixed, x: 0, y: -165 mm, heading: 0, r: 97 mm}
""",
)
def huge(subject: Subject) -> Iterator[Finding]:
    extent, wheel = subject.extent
    largest = max(subject.robot.wheels, key=lambda w: float(w.nominal.r))
    if (r := float(largest.nominal.r)) > LARGEST:
        yield Finding(
            subject.mark(largest),
            f"{largest.name}: a wheel of radius {r:.4g} m",
            _meant(r, 0.01, 0.5),
        )
    elif extent > LARGEST:
        yield Finding(
            subject.mark(wheel),
            f"the wheels are up to {extent:.4g} m apart",
            _meant(extent),
        )
    elif abs((far := max(subject.robot.wheels, key=lambda w: abs(w.pivot))).pivot) > LARGEST:
        what = f"{far.name} is {abs(far.pivot):.4g} m from the origin P"
        yield Finding(subject.mark(far), what, _meant(abs(far.pivot)))
    for words, quantity in _lengths(subject):
        if abs(size := subject.value(quantity)) > LARGEST:
            yield Finding(quantity.mark, f"{words} of {size:.4g} m", _meant(abs(size)))


def _meant(size: float, least: float = 0.1, most: float = 3.0) -> str:
    """Ask for the unit: those in which a size between ``least`` and ``most`` [m] results."""
    units = [unit for unit in ("mm", "cm", "in") if least <= size * float(UNITS[unit].factor) <= most]
    return f"Did you mean {' or '.join(units)}? Write the unit." if units else _CHECK


def _lengths(subject: Subject) -> Iterator[tuple[str, Quantity]]:
    """Yield the lengths that do not belong to a wheel: the start of a sentence, and the quantity."""
    spec = subject.spec
    lengths = [(f"the trailer {t.name} has a length", q) for t in spec.trailers for q in (t.length, t.hitch)]
    lengths += [(f"the centre of gravity has a {key}", getattr(spec.cg, key, None)) for key in "xyz"]
    lengths.append(("the robot has an effective track", spec.effective_track))
    yield from ((words, quantity) for words, quantity in lengths if quantity)


@rule(
    "WMR004",
    "sizes a hundred times apart",
    """If radii of the wheels and the distance between them differ by more than a factor of 100, they were likely
    written in different units. The rule also reports a contact offset or a roller radius that is
    larger than the robot, or a hundred times smaller than its wheels, and a trailer of that size.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1 mm}
""",
    PAIR,
)
def sizes(subject: Subject) -> Iterator[Finding]:
    wheels = [w for w in subject.robot.wheels if float(w.nominal.r) > 0]
    if not wheels:
        return
    radii = sorted(float(w.nominal.r) for w in wheels)
    usual, extent = radii[len(radii) // 2], subject.extent[0]
    odd = [w for w in wheels if not 1 / APART < float(w.nominal.r) / usual < APART]
    for w in odd:
        what = f"{w.name}: a radius of {float(w.nominal.r):.4g} m, where other wheels have {usual:.4g} m"
        yield Finding(subject.mark(w), what, _other_unit(_radius(subject, w), usual / 5, usual * 5))
    if extent and not odd and not 1 / APART < usual / extent < APART:
        what = f"wheels with a radius of {usual:.4g} m are {extent:.4g} m apart"
        instead = _other_unit(_radius(subject, wheels[0]), extent / 50, extent / 2)
        yield Finding(subject.mark(wheels[0]), what, instead)
    for spec, w in subject.wheels:
        for key in ("d", "offset_y", "r_sw"):
            quantity: Quantity | None = getattr(spec, key)
            size = abs(subject.value(quantity)) if quantity else 0.0
            if quantity and size and (size > max(usual, extent) or not size / usual > 1 / APART):
                what = f"{w.name}: {key} = {quantity.text} is {size:.4g} m, and the radius is {usual:.4g} m"
                yield Finding(quantity.mark, what, _other_unit(quantity, usual / 10, usual * 3))
    for trailer in subject.spec.trailers:
        if (size := abs(subject.value(trailer.length))) and not size / usual > 1 / APART:
            what = f"{trailer.name}: a length of {size:.4g} m, and wheels have a radius of {usual:.4g} m"
            yield Finding(trailer.length.mark, what, _other_unit(trailer.length, usual, usual * 50))


def _radius(subject: Subject, wheel: Wheel) -> Quantity | None:
    """Return the radius of a wheel as the file has it."""
    return next((spec.r for spec, w in subject.wheels if w is wheel), None)


def _other_unit(quantity: Quantity | None, least: float, most: float) -> str:
    """Ask for the unit in which the number of the file is a likely length.

    Args:
        quantity: The length as the file has it.
        least: The smallest likely length [m].
        most: The largest likely length [m].

    Returns:
        The question with the number and each such unit; without one, a request to check the number.
    """
    match = _LENGTH.fullmatch(quantity.text) if quantity else None
    if match is None:
        return _CHECK
    number, written = match[1], match[3] or "m"
    likely = [
        f"{number} {unit}"
        for unit in ("m", "cm", "mm", "in")
        if unit != written and least <= abs(float(number)) * float(UNITS[unit].factor) <= most
    ]
    return f"Did you mean {' or '.join(likely)}?" if likely else _CHECK


@rule(
    "WMR006",
    "overlapping wheels",
    """Two wheels that roll along one line are closer together than the sum of their radii. The radii are likely
    diameters, or the distance is wrong.""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0,    y: 0, heading: 0, r: 0.34}
  - {name: front, type: steered, x: 0.55, y: 0, heading: 0, r: 0.34, actuated: [steer]}
""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0,   y: 0, heading: 0, r: 0.34}
  - {name: front, type: steered, x: 1.1, y: 0, heading: 0, r: 0.34, actuated: [steer]}
""",
)
def overlapping(subject: Subject) -> Iterator[Finding]:
    wheels = [w for w in subject.robot.wheels if w.kind.directed and not w.kind.swivels]
    placed = [(w, w.pivot, w.zero_heading, float(w.nominal.r)) for w in wheels]
    for (a, p, p_heading, p_radius), (b, q, q_heading, q_radius) in combinations(placed, 2):
        apart = p_heading.conjugate() * (q - p)
        turned = abs((p_heading.conjugate() * q_heading).imag)
        ahead, aside = abs(apart.real), abs(apart.imag) + abs(float(a.nominal.o - b.nominal.o))
        radii = p_radius + q_radius
        if turned < 1e-3 and aside < 0.05 * radii and 0.05 * radii < ahead < radii:
            yield Finding(
                subject.mark(b),
                f"{b.name} is {ahead:.4g} m from {a.name}, in line with it, "
                f"and their radii add up to {radii:.4g} m",
                "r is the radius, not the diameter; x and y are distances from P.",
            )
