"""Compare two descriptions of one robot: their differences, and the effect of these on its motion."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.names import role
from wmrgen.tools.comparing.commands import evaluated, limit_differences, unexplained
from wmrgen.tools.comparing.differences import CODES, KIND, MISSING, ORDER, PLACE, SIGN, shown, with_layout
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
    reported = [d for d in found.differences if not _is_ignored(d)]
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
    unsaid = (*_unsaid(a, b, found.silent), *found.unsaid)
    return Comparison(a, b, tuple(reported), moved, tuple(notes), unsaid, compared)


def _is_ignored(d: Difference) -> bool:
    """Return whether a comment beside one of its places says to ignore a difference."""
    return any(d.code in ignored(mark) for mark in d.marks)


class _Found(NamedTuple):
    """The differences of two files, before comments are considered."""

    differences: list[Difference]
    pairs: Pairs
    notes: list[str]
    silent: Silent
    compared: bool
    effects: Callable[[], Iterator[Effect]] | None = None  # of joint commands, if they are known
    unsaid: tuple[str, ...] = ()  # what else is not compared


def _with_layout(a: Layout, b: Layout) -> _Found:
    """Return the differences of two files that describe wheels."""
    differences, pairs, notes, silent = with_layout(a, b)
    return _Found(differences, _turning(a, b, pairs), notes, silent, bool(pairs))


def _with_controller(a: Layout, b: Layout, controller: Controller) -> _Found:
    """Return the differences of a robot and a controller.

    The joint commands decide, if the controller has a record. Lengths that change no command are no difference.
    """
    by_length = with_controller(a, controller)
    notes = [*by_length.notes, *controller.notes]
    evaluation, of_joints, unsaid = evaluated(a, b)
    limits, of_limits = limit_differences(a, b)
    differences, result = by_length.differences, None
    if evaluation:
        if not evaluation.unequal(evaluation.numbers):
            codes = {KIND, MISSING, *(CODES.values() if evaluation.lengths_matter() else ())}
            differences = [d for d in differences if d.code in codes]
        elif not any(d.code == KIND for d in differences):
            sides = [d for d in differences if d.code in (PLACE, SIGN)]
            differences = [*differences, *unexplained(evaluation, sides)]
        wheels, ties = evaluation.wheels, a.ties or ()
        result = partial(effects_of, wheels, ties, evaluation.applied, wheels)
    known = {d.wheel for d in differences if d.code == MISSING and d.wheel}
    differences = [*differences, *(d for d in of_joints if not d.wheel or d.wheel not in known), *limits]
    notes += of_limits
    limited = b.evaluable is not None and bool(a.limits.keys() & b.evaluable[1].parameters.keys())
    compared = by_length.compared or evaluation is not None or limited
    return _Found(differences, by_length.pairs, notes, by_length.silent, compared, result, tuple(unsaid))


def _unsaid(a: Layout, b: Layout, silent: Silent) -> tuple[str, ...]:
    """Return sentences about values that only one file has."""
    several = zip((a, b), silent, strict=True)
    return tuple(
        f"{', '.join(words)}, which {owner.source} does not have" for owner, words in several if words
    )


def _turning(a: Layout, b: Layout, pairs: Pairs) -> Pairs:
    """Return the pairs at the positions of the equivalent differential drives of robots that skid.

    An effective track that one file lacks is taken from the other.
    """
    first, second = a.effective_track or b.effective_track, b.effective_track or a.effective_track
    if not (first and second and pairs):
        return pairs
    mine, others = zip(*pairs, strict=True)
    return list(zip(as_driven(mine, first[0]), as_driven(others, second[0]), strict=True))


class _Unknown(Exception):
    """A value that the kinematics need and neither file has."""


def _filled(pairs: Pairs) -> Pairs:
    """Return the pairs that move the robot, with missing values from the other file; a radius that both lack is 1."""
    result = []
    for v, w in pairs:
        mine = replace(v, values={"r": 1.0, **w.values, **v.values})
        its = replace(w, values={"r": 1.0, **v.values, **w.values})
        for side in (mine, its):
            kind = side.kind
            if kind.rollers and "gamma" not in side.values:
                raise _Unknown(f"no file has the angle of the rollers of {v.name}")
            if kind.swivels and not side.of("d"):
                raise _Unknown(f"no file has the castor offset of {v.name}")
        result.append((mine, its))
    if not result:
        raise _Unknown("no wheel is known to be driven")
    return result


def findings(c: Comparison) -> list[Finding]:
    """Return the differences as findings at their places in the second file; the first has the effect of them all."""
    does = "; ".join(effect.words for effect in c.effects if effect.words)
    instead = f"The first number is that of {c.a.source}."
    instead += (
        f" Commanded by {c.b.source}, the robot {re.sub('^yaw rate', 'turns with a yaw rate', does)}."
        if does
        else ""
    )
    nowhere = Mark(c.b.file, 1, 1, "")
    found = [Finding((*d.marks, nowhere)[0], d.words, "", d.code) for d in c.differences]
    return [*(replace(first, instead=instead) for first in found[:1]), *found[1:]]


def labelled(layout: Layout) -> Iterator[Finding]:
    """Yield the wheels of a description whose names contradict their positions: WMR011, as for robot files.

    Twin wheels are skipped, because their names have the sides of their module.
    """
    wheels = parts(layout.wheels)
    for w, where in zip(wheels, roles(wheels), strict=True):
        alone = all(v is w or abs(v.pivot - w.pivot) > 1e-3 for v in wheels)
        for word in role(*w.names).split() if alone else ():
            if _OPPOSITE.get(word) in where.split():
                what = (
                    f"{w.names[-1]} is at {shown([w.pivot])}, {where} of the middle of the wheels: not {word}"
                )
                mark = w.marks.get("", Mark(layout.file, 1, 1, ""))
                yield from () if "WMR011" in ignored(mark) else (Finding(mark, what, "", "WMR011"),)
