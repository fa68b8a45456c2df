"""All files of one robot, in memory: model.json and what every backend makes."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING

import sympy

from wmrgen import __version__
from wmrgen.backends.meta import Meta
from wmrgen.backends.registry import BACKENDS
from wmrgen.backends.wheels import wheel_lines
from wmrgen.ir.kernels.choice import DEFAULT, Choice

if TYPE_CHECKING:
    from wmrgen.derivation import Derivation

MODEL = "model.json"


def artifacts(derivation: Derivation, choice: Choice = DEFAULT) -> dict[str, bytes]:
    """File name -> content of everything that stands in ``DIR/<name>/``, the manifest aside."""
    model = (json.dumps(derivation.model(), indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
    facts = meta(derivation, choice, model)
    files = {MODEL: model}
    for entry in BACKENDS.values():
        made = entry.load().emit(getattr(derivation, entry.source), facts)
        clash = files.keys() & made.keys()
        if clash:
            raise ValueError(f"backend {entry.name} writes {sorted(clash)} again")
        files.update(made)
    return files


def meta(derivation: Derivation, choice: Choice, model: bytes) -> Meta:
    """What the generated files say about themselves. The hash covers model, choice and version."""
    digest = hashlib.sha256(model)
    digest.update(f"{' '.join(choice.words().values())} {__version__}".encode())
    return Meta(
        description=derivation.robot.description,
        wheel_lines=wheel_lines(derivation.robot),
        model_hash=digest.hexdigest()[:32],
        wmrgen_version=__version__,
        sympy_version=sympy.__version__,
        **choice.words(),
    )
