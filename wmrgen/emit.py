"""All files of one robot, in memory: model.json and what every backend makes."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

import sympy

from wmrgen import __version__
from wmrgen.backends.registry import BACKENDS, Facts
from wmrgen.backends.wheels import wheel_lines
from wmrgen.bounds.robot import header_lines
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ports import Site

if TYPE_CHECKING:
    from wmrgen.layout.records import Robot
    from wmrgen.robot import Derivation

MODEL = "model.json"


def artifacts(derivation: Derivation, choice: Choice = DEFAULT, fuzz: bool = False) -> dict[str, bytes]:
    """File name -> content of everything that stands in ``DIR/<name>/``, the manifest aside.

    ``choice`` is of the generated C; ``fuzz`` adds a fuzzing harness to it.
    """
    model = (json.dumps(derivation.model(), indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
    common = facts(derivation, choice, model)
    chosen = {**asdict(choice), "fuzz": fuzz}
    files = {MODEL: model}
    for entry in sorted(BACKENDS.values(), key=lambda entry: entry.source == "itself"):  # readers come last
        options = {name: chosen[name] for name in (*entry.options, *entry.switches)}
        lines = _bound_lines(derivation, choice) if entry.proved else ()
        own = replace(common, options=options, bound_lines=lines)
        written = entry.load().emit(getattr(derivation, entry.source), own)
        clash = files.keys() & written.keys()
        if clash:
            raise ValueError(f"backend {entry.name} writes {sorted(clash)} again")
        files.update(written)
        places = entry.offers("places")
        if places:
            common = replace(common, places=(*common.places, *places(written)))
    return files


def facts(derivation: Derivation, choice: Choice, model: bytes) -> Facts:
    """What the generated files say about themselves. The hash covers model, choice and version."""
    digest = hashlib.sha256(model)
    digest.update(f"{' '.join(choice.words().values())} {__version__}".encode())
    return Facts(
        description=derivation.robot.description,
        wheel_lines=wheel_lines(derivation.robot),
        model_hash=digest.hexdigest()[:32],
        wmrgen_version=__version__,
        sympy_version=sympy.__version__,
        site=site(derivation.robot),
        formulas=derivation.raw_module.functions,
    )


def _bound_lines(derivation: Derivation, choice: Choice) -> tuple[str, ...]:
    """Nothing for double, which is not bounded."""
    if choice.scalar != DEFAULT.scalar:
        return ()
    return header_lines(derivation.bounds if choice == DEFAULT else derivation.bounds_of(choice))


def site(robot: Robot) -> Site:
    """Limits and pivots of ``robot`` as numbers; a wheel's own limit comes before the robot's."""
    limits = {name: limit for name, limit in robot.limits.items() if name in ("vx", "vy", "omega")}
    for wheel in robot.wheels:
        joints = (*(["spin"] if wheel.has_spin else []), *(["steer", "steer_rate"] if wheel.turns else []))
        for joint in joints:
            limit = robot.limit(wheel, joint)
            if limit is not None:
                limits[f"{wheel.name}.{joint}"] = limit
    pivots = tuple((w.name, float(w.nominal.x), float(w.nominal.y)) for w in robot.wheels)
    return Site({name: (float(v.low), float(v.high)) for name, v in limits.items()}, pivots)
