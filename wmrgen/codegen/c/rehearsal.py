"""The loop of a robot's example in double precision: which twist its commands drive, by `forward`."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot

from wmrgen.codegen.loop import Stage, loop
from wmrgen.codegen.signature import arguments
from wmrgen.geometry.ports import GYRO, TWIST_NAMES
from wmrgen.ir.calls import by_name, inline_prepare, inlined
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Module

Twist = tuple[float, float, float]  # m/s, m/s, rad/s
_Variables = dict[str, dict[str, float]]
_RATELESS = {"limit_twist", "inverse", "desaturate"}  # the functions of the loop that limit no rates
_LAGGING = {"compensate_steering"}  # it drives what was commanded a step before, which is long here


class Rehearsal:
    """The commands that the loop of a robot with the C functions of ``module`` gives, steps of ``dt`` [s] apart."""

    def __init__(self, module: Module, dt: float) -> None:
        kernels = by_name(module.kernels)
        self._functions = {
            f.name: inline_prepare(inlined(f, kernels), module.prepare) for f in module.functions
        }
        self._joints, self._dt = module.joints, dt
        self.whole = {"inverse", "forward"} <= self._functions.keys()
        has = self._functions.keys() - _LAGGING
        self._acts = loop(module, has).acts if self.whole else ()

    def driven(self, wanted: Twist, last: Twist | None = None) -> Twist:
        """Return the twist of the commands for the ``wanted`` one, a step after those for ``last``.

        Without ``last``, the robot has been at the wanted twist for long.
        """
        variables = self._settled(wanted if last is None else last)
        if last is not None:
            commands = variables["commands"]
            variables |= {"wheels": dict(commands), "before": dict(commands), "wanted": _named(wanted)}
            for stage in self._acts:
                self._call(stage, variables)
        found = self._results("forward", variables["commands"] | {GYRO.name: wanted[2]})
        return found["vx"], found["vy"], found["omega"]

    def slides(self, twist: Twist, share: float) -> bool:
        """Whether a wheel slides at ``twist`` by more than this ``share`` of its speed, whatever is commanded."""
        if "inverse_slip" not in self._functions:
            return False
        commands = self._settled(twist)["commands"]
        return self._results("inverse_slip", commands | _named(twist))["slip"] > share * hypot(*twist[:2])

    def _settled(self, wanted: Twist) -> _Variables:
        variables: _Variables = {"wanted": _named(wanted), "commands": {}}
        for stage in self._acts:
            variables["driven"] = dict(variables["wanted"])
            if stage.function in _RATELESS:
                self._call(stage, variables)
        return variables

    def _call(self, stage: Stage, variables: _Variables) -> None:
        function = self._functions[stage.function]
        own = [(stage.variables.get(a.name, a.name), a) for a in arguments(function, self._joints)]
        given = {
            port: variables.get(variable, {}).get(member, 0.0)
            for variable, argument in own
            for port, member in argument.reads.items()
        }
        results = self._results(stage.function, given | {"dt": self._dt})
        for variable, argument in own:
            written = {member: results[port] for port, member in argument.writes.items()}
            variables[variable] = variables.get(variable, {}) | written

    def _results(self, name: str, given: Mapping[str, float]) -> dict[str, float]:
        function = self._functions[name]
        values = {p.name: given.get(p.name, 0.0) for p in function.inputs if p.default is None}
        return evaluate(function, values, FLOAT64)


def _named(twist: Twist) -> dict[str, float]:
    return dict(zip(TWIST_NAMES, twist, strict=True))
