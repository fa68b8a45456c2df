"""Rules about full sizes in place of halves: tracks, wheelbases and diameters written as distances and radii."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations

from wmrgen.errors import Mark
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.robotfile.records import ParameterSpec
from wmrgen.tools.lint.record import Finding, Subject, rule

_WHOLE = r"^(?:(?:robot|body|base|chassis|frame|platform|vehicle|car|total|overall)_?)?"  # a size of the robot itself
_SPANS = {
    "x": re.compile(rf"wheel_?base(?!_?(radius|link))|{_WHOLE}(?:base|length)$"),
    "y": re.compile(
        rf"track|separation|gauge|tread|spacing|wheel_distance|between|axle_length|{_WHOLE}width$"
    ),
}
# Other names may be sizes of the body.
_SURE = re.compile(
    r"wheel_?base|track|separation|gauge|tread|spacing|wheel_distance|between|^axle(_?(length|width|base|distance))?$"
)
_HALF = re.compile("half|semi")
_ROUND = re.compile(r"diam|(^|_)dia(_|$)|^(?!.*(base|robot|body)).*radius")
_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}
_NUMBER = r"(?:\s+(?:of|is|width))*[\s:=~]*(\d+(?:\.\d+)?)\s*(mm|cm|m|in)?\b"
_WRITTEN = {
    "diameter": re.compile(rf"(?:\bdia(?:meter|m)?\b\.?|[Øø⌀]){_NUMBER}", re.IGNORECASE),
    "x": re.compile(rf"(?<!half )\bwheel[ -]?base\b{_NUMBER}", re.IGNORECASE),
    "y": re.compile(rf"(?<!half[ -])\b(?:track|wheel separation|gauge)\b{_NUMBER}", re.IGNORECASE),
}
_DIAMETER = re.compile(r"(?:the )?(?:wheel )?(?:diameter|dia\.?|[Øø⌀])", re.IGNORECASE)
_CLOSE = 1e-6  # relative; equal but for rounding of decimals
_ABOUT = 1e-3  # relative; texts give sizes with three or four digits
_LEAST = 0.95  # least effective track, as a share of the track of the wheels; 1 but for tyre width


@rule(
    "WMR005",
    "full size in place of a half",
    """A parameter called track, wheelbase or width is the distance between wheels; one called diameter is twice a
    radius. If a wheel is that far from the middle, or has that radius, the robot is twice as large as meant and
    turns half as fast. Divide by 2, or call the parameter half_track if it is the half. The rule also finds: a
    half that is halved again; a comment or a description that gives such a size; a wheel with twice the value
    of the wheel that faces it; wheels that are larger than the robot; and an effective track below the track of
    the wheels, because skidding makes a robot turn slower, never faster.""",
    """
parameters: {track: 0.331, diameter: 0.195}
wheels:
  - {name: left,  type: fixed, x: 0, y: track,  heading: 0, r: diameter}
  - {name: right, type: fixed, x: 0, y: -track, heading: 0, r: diameter}
""",
    """
parameters: {track: 0.331, diameter: 0.195}
wheels:
  - {name: left,  type: fixed, x: 0, y: track/2,  heading: 0, r: diameter/2}
  - {name: right, type: fixed, x: 0, y: -track/2, heading: 0, r: diameter/2}
""",
)
def full(subject: Subject) -> Iterator[Finding]:
    yield from _called(subject)
    yield from _written(subject)
    yield from faced(subject)
    yield from _skids(subject)
    rolling = [w for w in subject.robot.wheels if w.has_spin]
    extent, _ = subject.extent
    large = [w for w in rolling if float(w.nominal.r) > extent > 0]
    if large and len(large) == len(rolling):
        what = f"a wheel of radius {float(large[0].nominal.r):.4g} m is larger than the robot, which is {extent:.4g} m"
        yield Finding(subject.mark(large[0]), what, "r is the radius, not the diameter.")


def _skids(subject: Subject) -> Iterator[Finding]:
    """Find an effective track that is shorter than the distance of the wheels across their heading."""
    effective = subject.spec.effective_track
    ahead = subject.robot.wheels[0].zero_heading.conjugate()
    sides = [(ahead * w.pivot).imag for w in subject.robot.wheels if w.kind.directed]
    if not effective:
        return
    size, track = subject.value(effective), max(sides) - min(sides)
    if size < _LEAST * track:
        what = f"effective_track = {effective.text} is {size:.4g} m, less than the track of the wheels, {track:.4g} m"
        yield Finding(
            effective.mark,
            what,
            "Write the full effective track, not half of it: it is 1.2 to 2 times the track of the wheels.",
        )


def _extent(subject: Subject, axis: str) -> float:
    """Return the distance between the outermost pivots along x or y [m]."""
    at = [w.pivot.real if axis == "x" else w.pivot.imag for w in subject.robot.wheels]
    return max(at) - min(at)


def _called(subject: Subject) -> Iterator[Finding]:
    """Find full sizes among the parameters, by their names."""
    for p in subject.spec.parameters:
        size, name, half = abs(subject.value(p.value)), p.name.lower(), bool(_HALF.search(p.name.lower()))
        sure = bool(_SURE.search(name))
        for axis, pattern in _SPANS.items() if size else ():
            span = _extent(subject, axis) / (2 * size if half else size)
            named = pattern.search(name) or (sure and _places(p, axis, subject))
            word = _times(span) if named else ""
            if word and (sure or (word == "twice" and not half)):
                yield _span(p, word, axis, half)
        right, whole = (f"{p.name}/2", size / 2) if "dia" in name else (p.name, size)
        for w in subject.spec.wheels if size and _ROUND.search(name) else ():
            word = _times(subject.value(w.r) / whole) if w.r and re.search(rf"\b{p.name}\b", w.r.text) else ""
            if w.r and word:
                what = f"{w.name}: r = {w.r.text} is {word} the radius that {p.name} gives"
                yield Finding(w.r.mark, what, f"Write r: {right}.")


def _places(p: ParameterSpec, axis: str, subject: Subject) -> bool:
    """Return whether a parameter is used in the places of wheels along ``axis``."""
    quantities = [getattr(w, axis) for w in subject.spec.wheels]
    return any(q and re.search(rf"\b{p.name}\b", q.text) for q in quantities)


def _span(p: ParameterSpec, word: str, axis: str, half: bool) -> Finding:
    """Return the finding for a parameter that names a distance of wheels, which are ``word`` as far apart."""
    what = f"{p.name} = {p.value.text}, and the wheels are {word} as far apart in {axis}"
    if half:
        instead = f"Write {p.name} in the places of the wheels, or rename it."
        return Finding(p.value.mark, f"{what} as twice that value", instead)
    name = f": half_{p.name}" if word == "twice" else ""
    return Finding(p.value.mark, what, f"Write {p.name}/2 in the places of the wheels, or rename it{name}.")


def _times(ratio: float) -> str:
    """Return "twice" or "half" if the ratio is 2 or 1/2 to rounding, else ""."""
    words = {"twice": 2, "half": 0.5}
    return next((word for word, times in words.items() if abs(ratio / times - 1) < _CLOSE), "")


def _written(subject: Subject) -> Iterator[Finding]:
    """Find full sizes by the comment next to a number, or by the description."""
    about = subject.spec.description or ""
    for spec, w in subject.wheels:
        r = float(w.nominal.r)
        comment = _comment(spec.r.mark) if spec.r else ""
        alone = spec.r is not None and spec.r.mark.text.lstrip(" -").startswith("r:")
        if r and (_says(f"{comment}; {about}", "diameter", r) or (alone and _DIAMETER.fullmatch(comment))):
            yield Finding(
                spec.r.mark if spec.r else spec.mark,
                f"{w.name}: the text gives a diameter of {r:.4g} m, and r has the same value",
                "Write half of it: r is the radius.",
            )
    lines = {spec.mark.line: spec.mark for spec in subject.spec.wheels}
    lines |= {q.mark.line: q.mark for w in subject.spec.wheels for q in (w.x, w.y, w.l) if q}
    for axis in _SPANS:
        half = _extent(subject, axis) / 2
        for mark in lines.values():
            if half and _says(f"{_comment(mark)}; {about}", axis, half):
                what = (
                    f"the text gives a size of {half:.4g} m, and the wheels are twice as far apart in {axis}"
                )
                yield Finding(mark, what, "Write half of it: x and y are distances from P.")
                break


def _comment(mark: Mark) -> str:
    """Return the comment of a line."""
    return mark.text.partition("#")[2].strip()


def _says(text: str, what: str, size: float) -> bool:
    """Return whether a text gives ``size`` [m] as a diameter, or as the full extent in x or y.

    A number without a unit may be in metres or in millimetres.
    """
    for match in _WRITTEN[what].finditer(text):
        scales = [_UNITS[match[2].lower()]] if match[2] else [1.0, 1e-3]
        if any(abs(float(match[1]) * scale - size) < _ABOUT * size for scale in scales):
            return True
    return False


def facing(robot: Robot) -> Iterator[tuple[Wheel, Wheel]]:
    """Yield pairs of wheels that are the only two of their type at one x, on two sides of the x axis."""
    for a, b in combinations(robot.wheels, 2):
        at_x = [w for w in robot.wheels if w.type == a.type and abs(w.pivot.real - a.pivot.real) < _CLOSE]
        if at_x == [a, b] and a.pivot.imag * b.pivot.imag < 0:
            yield a, b


def faced(subject: Subject) -> Iterator[Finding]:
    """Find wheels with twice the radius or twice the distance of the wheel that faces them across the x axis."""
    pairs = list(facing(subject.robot))
    for a, b in [*pairs, *((b, a) for a, b in pairs)]:
        spec = subject.spec.wheels[a.index]
        radii, sides = float(a.nominal.r) / (float(b.nominal.r) or 1), abs(a.pivot.imag / b.pivot.imag)
        if abs(radii - 2) < _CLOSE and abs(sides - 1) < _CLOSE:
            what = f"{a.name}: r is twice the radius of {b.name}, which faces it: is it a diameter?"
            yield Finding(spec.r.mark if spec.r else spec.mark, what, "Write the radius for both.")
        if abs(sides - 2) < _CLOSE and abs(radii - 1) < _CLOSE:
            what = (
                f"{a.name} is twice as far from the x axis as {b.name}, which faces it: is it the full track?"
            )
            yield Finding(spec.mark, what, f"Write the distance from P, as for {b.name}.")
