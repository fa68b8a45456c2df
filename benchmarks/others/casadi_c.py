"""CasADi's code generator with its real type set to float."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import casadi as ca

from wmrgen.derivation.facade import Derivation


def source(
    derivation: Derivation, function: str, outputs: tuple[str, ...]
) -> tuple[str, str, tuple[str, ...]]:
    """C of some outputs, the name of its function and the inputs. One vector in and one out: the shortest form."""
    compiled = derivation.casadi()[function]
    names = tuple(compiled.name_in(k) for k in range(compiled.n_in()))
    inputs = [ca.SX.sym(f"x{k}") for k in range(len(names))]
    results = dict(
        zip((compiled.name_out(k) for k in range(compiled.n_out())), compiled.call(inputs), strict=True)
    )
    name = f"casadi_{derivation.robot.name}_{function}"
    flat = ca.Function(name, [ca.vertcat(*inputs)], [ca.vertcat(*(results[n] for n in outputs))])
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # generate() takes no folder
        try:
            flat.generate(f"{name}.c", {"casadi_real": "float", "casadi_int": "int"})
            return Path(f"{name}.c").read_text(), name, names
        finally:
            os.chdir(before)
