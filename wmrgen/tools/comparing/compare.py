"""Two descriptions of one robot: what differs, and what that does."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.names import role
from wmrgen.tools.comparing.commands import evaluated, limit_differences, unexplained
from wmrgen.tools.comparing.differences import KIND, MISSING, ORDER, PLACE, SIGN, shown, with_layout
from wmrgen.tools.comparing.motion import Pairs, effects, effects_of
from wmrgen.tools.comparing.parameters import standing, with_controller
from wmrgen.tools.comparing.quantities import as_driven, parts, roles
from wmrgen.tools.comparing.record import Comparison, Difference, Effect, Layout, Silent
from wmrgen.tools.importing.records import Controller
from wmrgen.tools.lint.record import Finding, ignored

_OPPOSITE = {"front": "rear", "rear": "front", "left": "right", "right": "left"}


def compare(a: Layout, b: Layout) -> Comparison:
    """Return the differences from ``a`` to ``b``, and how a robot like ``a`` moves by commands computed from ``b``.

    A controller for ``a`` is treated as a robot of its kind.
    """
    a = standing(a, b.controller)
    if b.controller and a.effective_track:
        a = replace(a, wheels=as_driven(a.wheels, a.effective_track[0]))
    found = _with_controller(a, b, b.controller) if b.controller else _with_layout(a, b)
    reported = [d for d in found.differences if not any(d.code in ignored(mark) for mark in d.marks)]
    notes = list(found.notes)
    if len(reported) < len(found.differences):
        notes.append(f"{len(found.differences) - len(reported)} differences are to be ignored")
    moved: tuple[Effect, ...] = ()
    ties = a.ties or (), b.ties or ()
    try:
        moved = tuple(found.effects() if found.effects else effects(_filled(found.pairs), *ties))
        if any(d.code == ORDER for d in reported) and len(a.wheels) == len(b.wheels):
            numbered = [(v, w) for v, w in zip(a.wheels, b.wheels, strict=True) if parts([v])]
            words = [e.words for e in effects(_filled(numbered), *ties) if e.words]
            notes += [f"wheels taken by number, not by name: {word}" for word in words]
    except _Unknown as why:
        notes.append(f"motion is not computed: {why}")
    compared = found.compared or bool(found.differences)
    return Comparison(a, b, tuple(reported), moved, tuple(notes), _unsaid(a, b, found.silent), compared)


class _Found(NamedTuple):
    """What two files have otherwise, before comments are considered."""

    differences: list[Difference]
    pairs: Pairs
    notes: list[str]
    silent: Silent
    compared: bool
    effects: Callable[[], Iterator[Effect]] | None = None  # of joint commands, if they are known


def _with_layout(a: Layout, b: Layout) -> _Found:
    """Return the differences of two files that describe wheels."""
    differences, pairs, notes, silent = with_layout(a, b)
    return _Found(differences, _turning(a, b, pairs), notes, silent, bool(pairs))


def _with_controller(a: Layout, b: Layout, controller: Controller) -> _Found:
    """Return the differences of a robot and a controller.

    The joint commands decide, if the controller has a record: lengths that differ explain wrong commands, and are no
    difference of right ones.
    """
    by_length = with_controller(a, controller)
    notes = [*by_length.notes, *controller.notes]
    evaluation, of_joints, more = evaluated(a, b)
    limits, of_limits = limit_differences(a, b)
    differences, result = by_length.differences, None
    if evaluation:
        if not evaluation.unequal(evaluation.numbers):
            differences = [d for d in differences if d.code in (KIND, MISSING)]
        elif not any(d.code == KIND for d in differences):
            sides = [d for d in differences if d.code in (PLACE, SIGN)]
            differences = [*differences, *unexplained(evaluation, sides)]
        wheels, applied = evaluation.wheels, evaluation.applied
        if len(evaluation.joints) > 0:
            result = lambda: effects_of(wheels, a.ties or (), applied, wheels)  # noqa: E731
    known = {d.wheel for d in differences if d.code == MISSING and d.wheel}
    differences = [*differences, *(d for d in of_joints if d.wheel not in known), *limits]
    notes += [*more, *of_limits]
    limited = b.evaluable is not None and bool(a.limits.keys() & b.evaluable[1].parameters.keys())
    compared = by_length.compared or evaluation is not None or limited
    return _Found(differences, by_length.pairs, notes, by_length.silent, compared, result)


def _unsaid(a: Layout, b: Layout, silent: Silent) -> tuple[str, ...]:
    """What one file alone says, in words."""
    several = zip((a, b), silent, strict=True)
    return tuple(
        f"{', '.join(words)}, which {owner.source} does not say" for owner, words in several if words
    )


def _turning(a: Layout, b: Layout, pairs: Pairs) -> Pairs:
    """The pairs where they stand of the differential drives as which robots turn that skid; what one file does not say
    is taken from the other."""
    first, second = a.effective_track or b.effective_track, b.effective_track or a.effective_track
    if not (first and second and pairs):
        return pairs
    own, told = zip(*pairs, strict=True)
    return list(zip(as_driven(own, first[0]), as_driven(told, second[0]), strict=True))


class _Unknown(Exception):
    """What kinematics need and neither file says."""


def _filled(pairs: Pairs) -> Pairs:
    """Pairs that move the robot, what one file does not say taken from the other; a radius that neither says is 1."""
    result = []
    for v, w in pairs:
        mine = replace(v, values={"r": 1.0, **w.values, **v.values})
        its = replace(w, values={"r": 1.0, **v.values, **w.values})
        for side in (mine, its):
            kind = side.kind
            if kind.rollers and "gamma" not in side.values:
                raise _Unknown(f"no file says how the rollers of {v.name} stand")
            if kind.swivels and not side.of("d"):
                raise _Unknown(f"no file says how far {v.name} trails")
        result.append((mine, its))
    if not result:
        raise _Unknown("no wheel is known to be driven")
    return result


def findings(c: Comparison) -> list[Finding]:
    """The differences as findings, each where the second file says it; with the first, what they do together."""
    does = "; ".join(effect.words for effect in c.effects if effect.words)
    instead = f"The first number is that of {c.a.source}."
    instead += (
        f" Commanded by {c.b.source}, the robot {re.sub('^yaw rate', 'turns with a yaw rate', does)}."
        if does
        else ""
    )
    nowhere = Mark(c.b.file, 1, 1, "")
    told = [Finding((*d.marks, nowhere)[0], d.words, "", d.code) for d in c.differences]
    return [*(replace(first, instead=instead) for first in told[:1]), *told[1:]]


def labelled(layout: Layout) -> Iterator[Finding]:
    """Wheels of a description whose names contradict their places: WMR011, as of robot files. Of twin wheels the sides
    are those of their module."""
    wheels = parts(layout.wheels)
    for w, where in zip(wheels, roles(wheels), strict=True):
        alone = all(v is w or abs(v.pivot - w.pivot) > 1e-3 for v in wheels)
        for word in role(*w.names).split() if alone else ():
            if _OPPOSITE.get(word) in where.split():
                what = f"{w.names[-1]} stands at {shown([w.pivot])}, {where} of the middle of the wheels: not {word}"
                mark = w.marks.get("", Mark(layout.file, 1, 1, ""))
                yield from () if "WMR011" in ignored(mark) else (Finding(mark, what, "", "WMR011"),)
