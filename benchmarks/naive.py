"""Layouts of all families with models typed from contact physics alone, as a user of CasADi writes them: the rolling
and sliding rows of the wheels, put into `ca.solve`. They share no code with the derivation."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import casadi as ca

import wmrgen
from wmrgen.derivation.facade import Derivation

Values = Mapping[str, Any]  # parameters by name: numbers or SX
Rows = list[tuple[list[Any], Any]]  # coefficients of vx, vy, omega, and what they sum to


@dataclass(frozen=True)
class Wheel:
    """One wheel; lengths, angles and the radius are parameters, "-name" negative, or numbers."""

    name: str
    type: str
    x: str | float = 0
    y: str | float = 0
    polar: tuple[str, str] | None = None  # l and alpha in place of x and y; beta is 0
    r: str = "r"
    gamma: float = 0
    actuated: tuple[str, ...] = ("spin",)


@dataclass(frozen=True)
class Layout:
    """A robot; ``parameters`` are tunable or not; ``trailers``: (length, hitch) of each."""

    name: str
    parameters: Mapping[str, float]
    wheels: Sequence[Wheel]
    trailers: Sequence[tuple[str, str]] = ()

    def text(self, tunable: bool) -> str:
        """The robot file."""
        lines = ["wmrgen: 1", f"name: {self.name}", "parameters:"]
        lines += [
            f"  {k}: {{value: {v}, tunable: {str(tunable).lower()}}}" for k, v in self.parameters.items()
        ]
        if self.trailers:
            lines += ["trailers:", *(f"  - {{length: {a}, hitch: {h}}}" for a, h in self.trailers)]
        lines += ["wheels:"]
        for w in self.wheels:
            polar = w.polar and f"l: {w.polar[0]}, alpha: {w.polar[1]}, beta: 0"
            place = polar or f"x: {w.x}, y: {w.y}, heading: 0"
            roller = f", gamma: {w.gamma} deg" if w.type == "swedish" else ""
            drives = f", actuated: [{', '.join(w.actuated)}]"
            lines.append(f"  - {{name: {w.name}, type: {w.type}, {place}, r: {w.r}{roller}{drives}}}")
        return "\n".join(lines) + "\n"


def _omni(count: int, angles: bool = False) -> Layout:
    names = [f"w{i}" for i in range(count)]
    parameters: dict[str, float] = {}
    for i in range(count):
        parameters |= {f"l{i}": round(0.2 + 0.01 * i, 3), f"r{i}": round(0.05 + 0.001 * i, 4)}
        parameters |= {f"a{i}": round(math.tau * i / count + 0.2, 3)} if angles else {}
    wheels = [
        Wheel(w, "swedish", polar=(f"l{i}", f"a{i}" if angles else f"{360 * i // count} deg"), r=f"r{i}")
        for i, w in enumerate(names)
    ]
    return Layout(f"omni_{count}" + "_angles" * angles, parameters, wheels)


def _corners(**more: Any) -> list[Wheel]:
    places = (("fl", "a", "b"), ("fr", "a", "-b"), ("rl", "-a", "b"), ("rr", "-a", "-b"))
    return [Wheel(name, x=x, y=y, **more) for name, x, y in places]


_AXLE = [Wheel("left", "fixed", 0, "b"), Wheel("right", "fixed", 0, "-b")]
_IDLE = [Wheel(w.name, w.type, w.x, w.y, actuated=()) for w in _AXLE]
_PAIR = [Wheel(f"front_{w.name}", "steered", "base", w.y, actuated=("steer",)) for w in _AXLE]
_FRONT = Wheel("front", "steered", "base", 0, actuated=("steer", "spin"))
LAYOUTS = (
    Layout("differential", {"b": 0.2, "r": 0.05}, _AXLE),
    Layout("car", {"base": 2.5, "b": 0.8, "r": 0.3}, [*_AXLE, *_PAIR]),
    Layout("tricycle", {"base": 1.0, "b": 0.4, "r": 0.1}, [_FRONT, *_IDLE]),
    Layout(
        "bicycle", {"base": 1.0, "r": 0.3},
        [Wheel("rear", "fixed"), Wheel("front", "steered", "base", 0, actuated=("steer",))],
    ),
    _omni(3), _omni(3, angles=True), _omni(4), _omni(6),
    Layout(
        "mecanum", {"a": 0.2, "b": 0.15, "r": 0.05},
        [
            replace(w, gamma=gamma)
            for w, gamma in zip(_corners(type="swedish"), (-45, 45, 45, -45), strict=True)
        ],
    ),
    Layout("swerve", {"a": 0.3, "b": 0.25, "r": 0.05}, _corners(type="steered", actuated=("spin", "steer"))),
    Layout("tractor", {"b": 0.3, "r": 0.1, "bar": 0.8, "behind": 0.2}, _AXLE, [("bar", "behind"), ("bar", "0")]),
    Layout(
        "train", {"base": 1.4, "r": 0.2, "first": 1.1, "second": 0.9},
        [Wheel("rear", "fixed"), Wheel("front", "steered", "base", 0, actuated=("steer",))],
        [("first", "0"), ("second", "0")],
    ),
)  # fmt: skip


# ---- what the ground asks


class Naive:
    """A layout in CasADi's symbols."""

    def __init__(self, layout: Layout, tunable: bool) -> None:
        self.layout = layout
        self.p = [ca.SX.sym(name) for name in layout.parameters] if tunable else []
        self.values: Values = (
            dict(zip(layout.parameters, self.p, strict=True)) if tunable else layout.parameters
        )

    def value(self, text: str | float) -> Any:
        """Return a length, an angle or a radius."""
        if not isinstance(text, str):
            return text
        if text.startswith("-"):
            return -self.value(text[1:])
        if text in self.values:
            return self.values[text]
        number, _, unit = text.partition(" ")
        return math.radians(float(number)) if unit == "deg" else float(number)

    def rolling(self, w: Wheel, angle: Any) -> list[Any]:
        """Return the coefficients of the twist in the speed of a wheel along its rollers' axes or its rim."""
        x, y, h = self._place(w)
        gamma = math.radians(w.gamma)
        return _along(x, y, h + angle + gamma)

    def sliding(self, w: Wheel, angle: Any) -> list[Any]:
        """Return the coefficients of the twist in the speed of a wheel along its axle."""
        x, y, h = self._place(w)
        return _along(x, y, h + angle + math.pi / 2)

    def rim(self, w: Wheel) -> Any:
        """Return the coefficient of the wheel speed in a rolling row."""
        return self.value(w.r) * math.cos(math.radians(w.gamma))

    def _place(self, w: Wheel) -> tuple[Any, Any, Any]:
        if w.polar is None:
            return self.value(w.x), self.value(w.y), 0.0
        length, alpha = map(self.value, w.polar)
        return length * _exact(ca.cos(alpha)), length * _exact(ca.sin(alpha)), alpha - math.pi / 2

    def forward(self, names: Sequence[str]) -> ca.Function:
        """Joints (and parameters) to vx vy omega slip: all rows that are measured, in least squares if they are more
        than three."""
        joints = {name: ca.SX.sym(name) for name in names if name not in self.layout.parameters}
        rows: Rows = []
        for w in self.layout.wheels:
            angle = joints.get(f"{w.name}.steer", 0.0)
            if "spin" in w.actuated:
                rows.append((self.rolling(w, angle), self.rim(w) * joints[f"{w.name}.spin"]))
            if w.type != "swedish":
                rows.append((self.sliding(w, angle), 0.0))
        distinct = _distinct(rows)
        twist, slip = _solved(distinct if len(distinct) == 3 else rows)
        return ca.Function("naive", [*joints.values(), *self._named(names)], [*ca.vertsplit(twist), slip])

    def inverse(self, names: Sequence[str]) -> ca.Function:
        """Return the function from vx vy omega (and parameters) to the speeds of wheels that do not steer."""
        twist = [ca.SX.sym(name) for name in ("vx", "vy", "omega")]
        spins = [
            sum(a * b for a, b in zip(self.rolling(w, 0.0), twist, strict=True)) / self.rim(w)
            for w in self.layout.wheels
        ]
        return ca.Function("naive", [*twist, *self._named(names)], spins)

    def _named(self, names: Sequence[str]) -> list[ca.SX]:
        return [p for name, p in zip(self.layout.parameters, self.p, strict=False) if name in names]

    def ode(self, state: Sequence[str], inputs: Sequence[str]) -> ca.Function:
        """(x, u, p) to the rates: rows of the wheels that are driven and of those that slide, solved and turned."""
        x, u = ca.SX.sym("x", len(state)), ca.SX.sym("u", len(inputs))
        q, v = dict(zip(state, ca.vertsplit(x), strict=True)), dict(zip(inputs, ca.vertsplit(u), strict=True))
        if "vx" in v:
            twist = ca.vertcat(v["vx"], v["vy"], v["omega"])
        else:
            rows: Rows = []
            for w in self.layout.wheels:
                angle = q.get(f"{w.name}.steer", 0.0)
                if f"{w.name}.spin" in v:
                    rows.append((self.rolling(w, angle), self.rim(w) * v[f"{w.name}.spin"]))
                if w.type == "fixed" or f"{w.name}.steer" in q:
                    rows.append((self.sliding(w, angle), 0.0))
            twist, _ = _solved(_distinct(rows))
        c, s = ca.cos(q["theta"]), ca.sin(q["theta"])
        rates = [c * twist[0] - s * twist[1], s * twist[0] + c * twist[1], twist[2]]
        rates += [v[f"{name}_rate"] for name in state if name.endswith(".steer")]
        rates += self._trailers(q["theta"], [q[name] for name in state if name.startswith("trailer")], twist)
        return ca.Function("naive", [x, u, ca.vertcat(*self.p)], [ca.vertcat(*rates)])

    def _trailers(self, ahead: Any, headings: Iterable[Any], twist: Any) -> list[Any]:
        """Yaw rates: the coupling moves as what pulls it, the trailer's axle along its heading."""
        along, turn, rates = twist[0], twist[2], []
        for heading, (length, hitch) in zip(headings, self.layout.trailers, strict=True):
            across = -self.value(hitch) * turn
            c, s = ca.cos(ahead - heading), ca.sin(ahead - heading)
            turn = (s * along + c * across) / self.value(length)
            along, ahead = c * along - s * across, heading
            rates.append(turn)
        return rates


def _along(x: Any, y: Any, h: Any) -> list[Any]:
    """Return the velocity of the point (x, y) in the direction h, as coefficients of the twist."""
    c, s = _exact(ca.cos(h)), _exact(ca.sin(h))
    return [c, s, x * s - y * c]


def _exact(value: Any) -> Any:
    """0 and 1 in place of what rounding of pi makes of them: a user types 0 and 1, too."""
    return value if isinstance(value, ca.SX) or abs(value - round(value)) > 1e-12 else float(round(value))


def _distinct(rows: Rows) -> Rows:
    """Return the rows without repetitions: two wheels of one axle have the same sliding row."""
    kept: Rows = []
    for row, value in rows:
        equal = any(
            all(ca.is_equal(ca.SX(a), ca.SX(b), 9) for a, b in zip([*row, value], [*other, old], strict=True))
            for other, old in kept
        )
        if not equal:
            kept.append((row, value))
    return kept


def _solved(rows: Rows) -> tuple[Any, Any]:
    """Return the least-squares twist and the norm of the residual."""
    h = ca.vertcat(*(ca.horzcat(*row) for row, _ in rows))
    z = ca.vertcat(*(value for _, value in rows))
    if len(rows) == 3:
        return ca.solve(h, z), ca.SX(0)
    twist = ca.solve(h.T @ h, h.T @ z)
    return twist, ca.norm_2(z - h @ twist)


def counts(function: ca.Function) -> tuple[int, int]:
    """Return the number of instructions of a function and of its Jacobian by all inputs."""
    inputs = [
        ca.SX.sym(name.replace(".", "_"), function.size1_in(i)) for i, name in enumerate(function.name_in())
    ]
    outputs = ca.vertcat(*function.call(inputs))
    jacobian = ca.Function("jacobian", inputs, [ca.jacobian(outputs, ca.vertcat(*inputs))])
    return function.n_instructions(), jacobian.n_instructions()


def pairs(
    layout: Layout, derivation: Derivation, tunable: bool
) -> dict[str, tuple[ca.Function, ca.Function]]:
    """Functions of wmrgen and the same typed: `ode`, `forward`, and `inverse` if no wheel steers.

    Args:
        layout: The robot.
        derivation: Its derivation, from ``layout.text(tunable)``.
        tunable: Whether parameters are inputs.

    Returns:
        By name the function of wmrgen and the typed one, with the same inputs and outputs.
    """
    naive, every = Naive(layout, tunable), derivation.casadi()
    form = "trailer" if layout.trailers else None
    entries, ode, forward = derivation.entries(form), derivation.state_space(form), every["forward"]
    state, inputs = ([e["name"] for e in entries[key]] for key in "xu")
    found = {
        "ode": (ode, naive.ode(state, inputs)),
        "forward": (forward, naive.forward(forward.name_in())),
    }
    if all(w.type != "steered" for w in layout.wheels):
        inverse = _spins(every["inverse"])
        found["inverse"] = inverse, naive.inverse(inverse.name_in())
    return found


def _spins(inverse: ca.Function) -> ca.Function:
    """`inverse` without the slip of a twist that wheels forbid."""
    inputs, names = inverse.sx_in(), inverse.name_out()
    results = zip(names, inverse.call(inputs), strict=True)
    spins = {name: value for name, value in results if name.endswith(".spin")}
    return ca.Function("spins", inputs, list(spins.values()), inverse.name_in(), list(spins))


# ---- the tables


def table() -> Iterator[str]:
    """Instructions of every function and of its Jacobian, beside those of what is typed."""
    yield "| layout | parameters | function | wmrgen | typed | Jacobian, wmrgen | typed |"
    yield "|---|---|---|---:|---:|---:|---:|"
    with tempfile.TemporaryDirectory() as folder:
        for layout, tunable in product(LAYOUTS, (True, False)):
            path = Path(folder) / f"{layout.name}.yaml"
            path.write_text(layout.text(tunable), encoding="utf-8")
            what = "tunable" if tunable else "numbers"
            for name, functions in pairs(layout, wmrgen.derive(wmrgen.load(path)), tunable).items():
                (own, own_jacobian), (typed, typed_jacobian) = map(counts, functions)
                yield (
                    f"| {layout.name} | {what} | {name} | {own} | {typed} | {own_jacobian} | {typed_jacobian} |"
                )
