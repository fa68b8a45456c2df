"""A driftless control system q' = g_1(q) u_1 + ... + g_m(q) u_m, as every kinematic model is (Tzafestas (2.32))."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.kinematics.records import Formula
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, signal, times


@dataclass(frozen=True, slots=True)
class Domain:
    """The model holds where ``expression`` is not zero; ``text`` says what happens there."""

    expression: Expr
    text: str


@dataclass(frozen=True, slots=True)
class System:
    """State q, inputs u and vector fields. The symbol of a port is ``signal(port.name)``.

    ``fields[k][i]``: component i of g_k, an exact expression in the state and in ``geometry`` (tunable parameters).
    """

    name: str
    text: str
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    fields: tuple[tuple[Expr, ...], ...]
    geometry: tuple[Port, ...] = ()
    domain: tuple[Domain, ...] = ()

    def formula(self) -> Formula:
        """State and inputs to the rates of the state."""
        outputs = tuple(
            (
                _rate(port),
                add(
                    *(
                        times(field[i], signal(u.name))
                        for field, u in zip(self.fields, self.inputs, strict=True)
                    )
                ),
            )
            for i, port in enumerate(self.state)
        )
        return Formula(self.name, (*self.state, *self.inputs, *self.geometry), (), outputs, self.text)


def _rate(port: Port) -> Port:
    """``x`` -> ``x_rate``, ``front.steer`` -> ``front.steer_rate``."""
    return Port(
        f"{port.name}_rate", Role.COMMAND, f"{port.unit}/s" if port.unit else "1/s", f"rate of {port.name}"
    )
