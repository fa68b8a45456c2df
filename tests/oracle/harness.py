"""The public interface of wmrgen as the tests of truth use it: robot file text in, numbers out."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

import wmrgen
from tests.oracle.robot_file import NAMES

Array = NDArray[np.float64]
Layout = dict[str, Any]


def robot_text(
    layout: Layout, name: str = "sample", polar: bool = False, extra: str = "", tunable: bool = False
) -> str:
    """A robot file for a layout of floats (see `tests.oracle.oracle`); ``polar`` places by l, alpha, beta.

    ``tunable``: every length and angle of every wheel is a tunable parameter of its own.
    """
    parameters: dict[str, str] = {}
    lines = ["wheels:"]
    for w in layout["wheels"]:
        geometry = _place(w, polar) | {"r": repr(float(w["r"]))}
        for key, own in (("gamma", "gamma"), ("d", "d"), ("offset_y", "o"), ("r_sw", "r_sw")):
            if w.get(own):
                geometry[key] = repr(float(w[own]))
        directions = [str(d) for d in w["driven"]] if isinstance(w.get("driven"), list) else []
        if w.get("driven"):
            geometry = {key: value for key, value in geometry.items() if key not in ("heading", "beta")}
            own = w.get("text", {}).get("heading", repr(float(w["heading"])))
            geometry |= {f"driven{k}": d for k, d in enumerate(directions or [own])}
        if tunable:
            parameters |= {f"{w['name']}_{key}": value for key, value in geometry.items()}
            geometry = {key: f"{w['name']}_{key}" for key in geometry}
        driven = [value for key, value in geometry.items() if key.startswith("driven")]
        given = (f"{k}: {v}" for k, v in geometry.items() if not k.startswith("driven"))
        keys = [f"name: {w['name']}", f"type: {w['type']}", *given]
        if w.get("weight"):
            keys.append(f"weight: {float(w['weight'])!r}")
        if driven:
            keys.append(f"driven: [{', '.join(driven)}]")
        if "actuated" in w:
            keys.append(f"actuated: [{', '.join(w['actuated'])}]")
        if "sensed" in w:
            keys.append(f"sensed: [{', '.join(w['sensed'])}]")
        if "limits" in w:
            low, width = w["limits"]["steer"]
            keys.append(f"limits: {{steer: [{low} deg, {low + width} deg]}}")
        lines.append("  - {" + ", ".join(keys) + "}")
    if layout.get("couplings"):
        lines.append("couplings:")
        for joint, names in layout["couplings"]:
            lines.append(f"  - equal: [{', '.join(f'{n}.{joint}' for n in names)}]")
            signs = {w["name"]: w.get("sign", 1) for w in layout["wheels"]}
            if joint == "steer" and any(signs[n] < 0 for n in names):
                lines.append(f"    ratios: [{', '.join(str(signs[n]) for n in names)}]")
    head = [f"wmrgen: 1\nname: {name}"]
    if parameters:
        head += ["parameters:", *(f"  {k}: {{value: {v}, tunable: true}}" for k, v in parameters.items())]
    return "\n".join([*head, extra + lines[0], *lines[1:]]) + "\n"


def _place(w: dict[str, Any], polar: bool) -> dict[str, str]:
    """Placement and orientation. ``text`` holds exact expressions for keys whose float is rounded."""
    x, y, heading = float(w["x"]), float(w["y"]), float(w["heading"])
    if not polar:
        values = (("x", x), ("y", y), ("heading", heading))
        return {k: w.get("text", {}).get(k, repr(v)) for k, v in values}
    alpha = math.atan2(y, x)
    return {"l": repr(math.hypot(x, y)), "alpha": repr(alpha), "beta": repr(heading + math.pi / 2 - alpha)}


class Model:
    """A derived robot: functions by contract names, matrices at given steering angles."""

    def __init__(self, path: Path, functions: Sequence[str] | None = None) -> None:
        self.path = path
        self.robot = wmrgen.load(path)
        self.derivation = wmrgen.derive(self.robot, functions)
        self.nominal = {p.name: float(p.nominal) for p in self.robot.parameters}

    @cached_property
    def data(self) -> dict[str, Any]:
        """The content of model.json."""
        content: dict[str, Any] = json.loads(json.dumps(self.derivation.model()))
        return content

    @cached_property
    def functions(self) -> dict[str, Any]:
        """The CasADi functions."""
        return self.derivation.casadi()

    @cached_property
    def numpy(self) -> Any:
        """The functions over NumPy arrays."""
        return self.derivation.numpy()

    @classmethod
    def of(
        cls, text: str, folder: Path, stem: str = "sample", functions: Sequence[str] | None = None
    ) -> Model:
        """The model of a robot file's text: with ``functions`` those alone, else the standard ones."""
        path = folder / f"{stem}.yaml"
        path.write_text(text, encoding="utf-8")
        return cls(path, functions)

    def ports(self, function: str) -> tuple[list[str], list[str]]:
        """Contract names of the inputs and outputs of a function, as CasADi has them."""
        f = self.functions[function]
        return list(f.name_in()), list(f.name_out())

    def call(self, function: str, values: dict[str, float] | None = None) -> dict[str, float]:
        """A function by contract names; inputs not given are 0, parameters nominal."""
        f, values = self.functions[function], values or {}
        unknown = values.keys() - set(f.name_in())
        assert not unknown, f"{function} has no input {sorted(unknown)}"
        result = f.call([values.get(n, self.nominal.get(n, 0.0)) for n in f.name_in()])
        return {n: float(v) for n, v in zip(f.name_out(), result, strict=True)}

    def matrix(self, name: str, steer: dict[str, float] | None = None) -> Array:
        """A matrix of model.json at the steering angles (by wheel name, 0 where not given)."""
        scope = NAMES | self.nominal
        scope |= {f"{w.name}_steer": (steer or {}).get(w.name, 0.0) for w in self.robot.wheels}
        rows = [[float(eval(entry, {"__builtins__": {}}, scope)) for entry in row] for row in self.data[name]]
        return np.array(rows, dtype=float) if rows else np.zeros((0, 3))

    def evaluate(self, matrix: sympy.Matrix, steer: dict[str, float] | None = None) -> Array:
        """A sympy matrix of the derivation at the steering angles (by wheel name), parameters nominal."""
        values = self.nominal | {f"{w.name}_steer": (steer or {}).get(w.name, 0.0) for w in self.robot.wheels}
        at = {symbol: values[symbol.name] for symbol in matrix.free_symbols}
        return np.array(matrix.xreplace(at).evalf(), dtype=float).reshape(matrix.shape)


def twist_of(values: dict[str, float]) -> Array:
    """(vx, vy, omega) of a function's result."""
    return np.array([values["vx"], values["vy"], values["omega"]])


def named(twist: Array | list[float]) -> dict[str, float]:
    """A twist as named inputs."""
    return dict(zip(("vx", "vy", "omega"), map(float, twist), strict=True))


def turn(phi: float) -> Array:
    """Body to world: [[c, -s, 0], [s, c, 0], [0, 0, 1]]."""
    c, s = math.cos(phi), math.sin(phi)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rank(matrix: Array, tol: float = 1e-8) -> int:
    """Rank relative to the largest singular value."""
    if not matrix.size:
        return 0
    s = np.linalg.svd(matrix, compute_uv=False)
    return int((s > tol * max(s[0], 1e-300)).sum())


def same_span(a: Array, b: Array) -> bool:
    """True when the rows of a and b span the same space."""
    return rank(a) == rank(b) == rank(np.vstack([a, b]))
