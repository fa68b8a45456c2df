"""The content of model.json: the analysis as plain data, with matrices as strings in Python syntax."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from wmrgen.analysis.mobility.analyse import driving
from wmrgen.analysis.mobility.records import Mobility, Rank, Singularity
from wmrgen.derivation.program import asked
from wmrgen.functions.registry import has_system, system_builder
from wmrgen.geometry.constraints import XI, Constraints, constrain, pfaffian, pfaffian_rates, working_view
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, dot
from wmrgen.geometry.layout.records import DEFAULT_FRAME, Encoder, Gyro, Interval, Noise, Robot, Wheel
from wmrgen.geometry.notation import plain
from wmrgen.ir.bounds.robot import Bounds
from wmrgen.ir.bounds.robot import data as bounds_data
from wmrgen.ir.nodes import Function, Module, count

if TYPE_CHECKING:
    from wmrgen.functions.models.state_space import StateSpace

FORMAT = 1  # version of the layout of model.json, without a unit


def model(
    robot: Robot, mobility: Mobility, formulas: Module, code: Module, bounds: Bounds, space: StateSpace | None
) -> dict[str, Any]:
    """Return the content of model.json, in the documented order.

    Args:
        robot: The robot.
        mobility: Its mobility.
        formulas: The functions as their formulas are written.
        code: The functions of the C, in operations.
        bounds: Proved bounds of ``code``.
        space: The default state space; None if the robot has no model of motion.

    Returns:
        What json.dumps takes.
    """
    c = constrain(robot, working_view)
    spins = [-dict(r.rates)[r.wheel.index, "spin"] for r in c.rolling]
    diagonal = [[spins[i] if i == j else Poly({}) for j in range(len(spins))] for i in range(len(spins))]
    return {
        **_identity(robot),
        **_mobility(mobility),
        "J1": strings([r.row for r in c.rolling]),
        "J2": strings(diagonal),
        "C1f": strings([r.row for r in c.sliding_fixed]),
        "C1s": strings([r.row for r in c.sliding_steered]),
        "null_space": [[text(column[i]) for column in mobility.scaled] for i in range(3)],
        "functions": {f.name: _ports(f) for f in formulas.functions},
        "operations": {f.name: count(f)._asdict() for f in code.functions},
        **({} if bounds.missing else {"bounds": bounds_data(bounds)}),
        **(_slips(c) if robot.slip else {}),
        **_domains(robot, mobility),
        **_state_space(space),
    }


def _ports(function: Function) -> dict[str, list[str]]:
    """Return the names of the inputs and outputs of a function."""
    inputs = [p.name for p in function.inputs]
    outputs = [p.name for p in function.outputs]
    return {"inputs": inputs, "outputs": outputs}


def _slips(c: Constraints) -> dict[str, Any]:
    return {"pfaffian": strings(pfaffian(c, slip=True)), "pfaffian_rates": list(pfaffian_rates(c))}


def _state_space(space: StateSpace | None) -> dict[str, Any]:
    if space is None:
        return {}
    from wmrgen.functions.models.state_space import data

    return {"state_space": data(space)}


def _domains(robot: Robot, mobility: Mobility) -> dict[str, Any]:
    """Return where the models that the file requests are singular, as where a trailer jack-knifes."""
    names = [name for name in asked(robot) if has_system(name)]
    if not names:
        return {}
    from wmrgen.functions.models.sheet import data, sheet_of

    sheets = {name: sheet_of(name, system_builder(name)(*driving(robot, mobility), False)) for name in names}
    return {"singular_models": {name: data(sheet)["domain"] for name, sheet in sheets.items()}}


def _identity(robot: Robot) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "name": robot.name,
        "description": robot.description,
        "source": robot.source,
        **({"frame": robot.frame} if robot.frame != DEFAULT_FRAME else {}),
        "parameters": [
            {
                "name": p.name,
                "value": float(p.nominal),
                "exact": str(p.nominal),
                "tunable": p.tunable,
                **({"range": [float(p.low), float(p.high)]} if p.tunable else {}),
            }
            for p in robot.parameters
        ],
        "wheels": [_wheel(w) for w in robot.wheels],
        "couplings": [_coupling(robot, joint, wheels) for joint, wheels in robot.couplings],
        "limits": _limits(robot.limits),
        **_of_joints(robot),
        **_gyro(robot.gyro),
        **({"effective_track": float(track.nominal)} if (track := robot.effective_track) else {}),
        **({"deadband": float(robot.deadband)} if robot.deadband else {}),
        "notes": [plain(note) for note in robot.notes],
    }


def _coupling(robot: Robot, joint: str, wheels: Sequence[str]) -> dict[str, Any]:
    ratios = robot.ratios(joint, wheels)
    return {"joint": joint, "wheels": list(wheels), **({"ratios": [*map(float, ratios)]} if ratios else {})}


def _mobility(m: Mobility) -> dict[str, Any]:
    return {
        "degree_of_mobility": m.degree_of_mobility,
        "degree_of_steerability": m.degree_of_steerability,
        "degree_of_maneuverability": m.degree_of_maneuverability,
        "rank_C1f": m.rank_C1f.value,
        "rank_C1": m.rank_C1.value,
        "ranks": {"C1f": _rank(m.rank_C1f), "C1": _rank(m.rank_C1)},
        "ddof": m.ddof,
        "dof": m.dof,
        "growth_vector": list(m.growth_vector),
        "degree_of_nonholonomy": m.degree_of_nonholonomy,
        "holonomic": m.holonomic,
        "omnidirectional": m.omnidirectional,
        "robot_type": list(m.robot_type) if m.robot_type else None,
        "degenerate": m.degenerate,
        "reasons": list(m.reasons),
        "actuation": list(map(str, m.actuation)),
        "singularities": [_singularity(s) for s in m.singularities],
    }


def _singularity(s: Singularity) -> dict[str, Any]:
    conditions = [c if isinstance(c, Poly) else dot(c, XI) for c in s.conditions]
    return {
        "kind": s.kind,
        "wheels": list(s.wheels),
        "meaning": plain(s.meaning),
        "conditions": [f"{text(c)} = 0" for c in conditions],
    }


def _rank(rank: Rank) -> dict[str, Any]:
    return {
        "value": rank.value,
        "exact": rank.exact,
        "singular_values": [float(f"{s:.9g}") for s in rank.singular_values],
    }


def _wheel(w: Wheel) -> dict[str, Any]:
    g = w.nominal
    entry: dict[str, Any] = {
        "name": w.name, "type": w.type, "x": float(g.x), "y": float(g.y), "l": w.l, "alpha": w.alpha, "beta": w.beta,
        "heading": w.heading, "r": float(g.r),
    }  # fmt: skip
    if w.kind.rollers:
        entry["gamma"] = w.gamma
        if g.r_sw:
            entry["r_sw"] = float(g.r_sw)
    if w.kind.swivels:
        entry["d"] = float(g.d)
    if w.turns:
        entry["offset_y"] = float(g.o)
    if g.per_steer:
        entry["per_steer"] = float(g.per_steer)
    entry["actuated"], entry["sensed"] = list(w.actuated), list(w.sensed)
    if w.weight != ONE:
        entry["weight"] = float(w.weight)
    limits = {"limits": _limits(w.limits)} if w.limits else {}
    names = {joint: {"name": n.name, "reversed": n.reversed} for joint, n in w.joints.items()}
    return {**entry, **_of_joints(w), **limits, **({"joints": names} if names else {})}


def _limits(limits: Mapping[str, Interval]) -> dict[str, list[float]]:
    return {name: [float(i.low), float(i.high)] for name, i in limits.items()}


def _of_joints(part: Robot | Wheel) -> dict[str, Any]:
    """Return noise, encoders and lag of the joints of a robot or a wheel; a key is left out if it would be empty."""
    facts = {
        "noise": {joint: _noise(noise) for joint, noise in part.noise.items()},
        "encoder": {joint: _encoder(e) for joint, e in part.encoders.items()},
        "lag": {joint: float(time) for joint, time in part.lag.items()},
    }
    return {key: of_joints for key, of_joints in facts.items() if of_joints}


def _gyro(gyro: Gyro | None) -> dict[str, Any]:
    if gyro is None:
        return {}
    return {"gyro": {"weight": float(gyro.weight), "noise": _noise(gyro.noise)}}


def _noise(noise: Noise) -> dict[str, float]:
    return {"proportional": float(noise.proportional), "constant": float(noise.constant)}


def _encoder(e: Encoder) -> dict[str, Any]:
    offset = {} if e.reading.offset is None else {"offset": e.reading.offset}
    return {"counts_per_turn": float(e.turn), "modulus": e.reading.modulus, **offset}


def strings(rows: Sequence[Sequence[Poly]]) -> list[list[str]]:
    """Return a matrix of polynomials as strings."""
    return [[text(p) for p in row] for row in rows]


def text(poly: Poly) -> str:
    """Return a polynomial in Python syntax over parameter names, ``<wheel>_steer``, sqrt, sin and cos."""
    terms = []
    for monomial, coefficient in poly.ordered:
        factors = "*".join(_power(g, e) for g, e in monomial)
        terms.append(_term(coefficient, factors))
    return (" + ".join(terms) or "0").replace("+ -", "- ")


def _term(coefficient: Exact, factors: str) -> str:
    if not factors:
        return str(coefficient)
    if coefficient.is_rational:
        c: Fraction = coefficient.parts[0]
        head = "" if abs(c.numerator) == 1 else f"{abs(c.numerator)}*"
        tail = "" if c.denominator == 1 else f"/{c.denominator}"
        return f"{'-' if c < 0 else ''}{head}{factors}{tail}"
    return f"({coefficient})*{factors}"


def _power(gen: Gen, exponent: int) -> str:
    base = _generator(gen)
    if exponent == 1:
        return base
    return f"{base}**{exponent}" if exponent > 0 else f"{base}**({exponent})"


def _generator(gen: Gen) -> str:
    if gen.kind in ("cos", "sin"):
        return f"{gen.kind}({gen.name}_steer)"
    if gen.kind in ("param", "input", "local"):
        return gen.name.replace(".", "_")
    if gen.kind == "pi":
        return "pi"
    args = ", ".join(text(a) for a in gen.args)
    if gen.kind == "inv":
        return f"(1/({args}))"
    return f"{gen.kind.removesuffix('f')}({args})"
