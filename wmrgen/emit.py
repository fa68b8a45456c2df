"""All files of one robot, in memory: model.json and what every backend makes."""

from __future__ import annotations

import hashlib
import json
from importlib.metadata import version
from math import degrees
from typing import TYPE_CHECKING, SupportsFloat

from wmrgen import __version__
from wmrgen.backends.meta import Meta
from wmrgen.backends.registry import BACKENDS
from wmrgen.ir.cost import count

if TYPE_CHECKING:
    from wmrgen.derivation import Derivation
    from wmrgen.layout.records import Wheel

MODEL = "model.json"


def artifacts(derivation: Derivation, scalar: str = "float") -> dict[str, bytes]:
    """File name -> content of everything that stands in ``DIR/<name>/``, the manifest aside.

    ``scalar`` is the type of the generated C, float or double.
    """
    model = (json.dumps(derivation.model(), indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
    facts = meta(derivation, scalar, model)
    files = {MODEL: model}
    for entry in BACKENDS.values():
        made = entry.load().emit(getattr(derivation, entry.source), facts)
        clash = files.keys() & made.keys()
        if clash:
            raise ValueError(f"backend {entry.name} writes {sorted(clash)} again")
        files.update(made)
    return files


def meta(derivation: Derivation, scalar: str, model: bytes) -> Meta:
    """What the generated files say about themselves. The hash covers model, scalar type and version."""
    digest = hashlib.sha256(model)
    digest.update(f"{scalar} {__version__}".encode())
    return Meta(
        description=derivation.robot.description,
        wheel_lines=tuple(_wheel_line(w) for w in derivation.robot.wheels),
        count_lines=tuple(f"{f.name}: {count(f)}" for f in derivation.c_module.functions),
        model_hash=digest.hexdigest()[:32],
        wmrgen_version=__version__,
        sympy_version=version("sympy"),
        scalar=scalar,
    )


def _wheel_line(w: Wheel) -> str:
    """``left: fixed, x 0 m, y 0.1655 m, heading 0 deg, r 0.0975 m`` and what else the type has."""
    g = w.nominal
    parts = [f"{w.name}: {w.type}, x {_short(g.x)} m, y {_short(g.y)} m"]
    if w.has_spin:
        parts.append(f"heading {_short(degrees(w.heading))} deg")
    parts.append(f"r {_short(g.r)} m")
    if g.d:
        parts.append(f"castor offset d {_short(g.d)} m")
    if g.o:
        parts.append(f"lateral offset {_short(g.o)} m")
    if w.type == "swedish":
        parts.append(f"roller axis at the ground {_short(degrees(w.gamma))} deg from the wheel plane")
    return ", ".join(parts)


def _short(value: SupportsFloat) -> str:
    """Six significant digits, no negative zero."""
    return f"{round(float(value), 12) + 0.0:.6g}"
