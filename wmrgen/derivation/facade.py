"""The facade: the whole pipeline of one robot, each stage computed when first asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from wmrgen.analysis.kinematics.forward import readable_twist
from wmrgen.analysis.kinematics.inverse import readable_spins
from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pose import arc
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.codegen.registry import BACKENDS, CasadiFunction, CasadiSymbol, VectorForm
from wmrgen.derivation.analysis import Analysis
from wmrgen.derivation.model_json import model
from wmrgen.derivation.needs import with_needs
from wmrgen.derivation.program import (
    WITHOUT_SLIP,
    Program,
    asked,
    for_c,
    formula,
    optimised,
    standard,
    vector_form,
    vector_forms,
    with_calls,
)  # fmt: skip
from wmrgen.errors import NotDerivableError, UsageError
from wmrgen.functions.registry import system_builder
from wmrgen.geometry.constraints import nominal_view, seen
from wmrgen.geometry.exact.lowest import Product
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.symbolic import Expr, expression, number, parameter, signal, times
from wmrgen.ir.bounds.assumptions import library
from wmrgen.ir.bounds.robot import Bounds, bounds
from wmrgen.ir.calls import inlined_calls, select
from wmrgen.ir.interpret import EXACT, evaluate, in_the_field
from wmrgen.ir.kernels.choice import DEFAULT, HOST, Choice, choice
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function, Module

if TYPE_CHECKING:
    from types import SimpleNamespace

    from wmrgen.functions.models.state_space import StateSpace
    from wmrgen.functions.system import System


class Derivation(Analysis):
    """The exact model of a robot: matrices, mobility, kinematics and code. ``functions``: only those instead of what is
    generated for the robot (see `wmrgen.derivation.program`).
    """

    def __init__(self, robot: Robot, functions: Sequence[str] | None = None) -> None:
        super().__init__(robot)
        self._functions = functions
        self._formulas: dict[str, Formula] = {}
        self._lowered: dict[str, Function] = {}

    @property
    def itself(self) -> Derivation:
        """What backends for readers (report, drawing) are given."""
        return self

    @cached_property
    def without_gyro(self) -> Derivation:
        """The derivation of the robot as its joints alone show it."""
        if self.robot.gyro is None:
            return self
        return Derivation(replace(self.robot, gyro=None), self._functions)

    @cached_property
    def driven(self) -> Derivation:
        """The derivation of what wheel speeds and motion follow from: itself, unless it has an effective track."""
        if self.mobility.driven is None:
            return self
        robot, mobility = self.mobility.driven
        driven = Derivation(robot, self._functions)
        driven.mobility = mobility
        return driven

    @cached_property
    def in_symbols(self) -> Derivation:
        """The same derivation with every named parameter, lengths and angles, as a symbol, as if all were tunable."""
        if len(self.robot.tunable) == len(self.robot.parameters):
            return self
        named = Derivation(self.robot.in_symbols, self._functions)
        named.mobility = self.mobility.in_symbols
        return named

    def formula_in_symbols(self, name: str) -> Formula:
        """A function with every named parameter as a symbol; with numbers if a parameter has the name of an input."""
        try:
            return self.in_symbols.formula(name)
        except NotDerivableError:
            return self.formula(name)

    @cached_property
    def nearest(self) -> tuple[Poly, Poly, Poly]:
        """The twist without what the wheels forbid, from a commanded one, at nominal values."""
        return project(seen(self.driven.robot, nominal_view), self.driven.mobility).twist

    # Functions, in symbols and at exact values.

    @cached_property
    def program(self) -> Program:
        """The functions of the model in symbols."""
        names = standard(self.robot) if self._functions is None else self._functions
        return Program(self.robot.name, tuple(map(self.formula, names)))

    def formula(self, name: str) -> Formula:
        """Any function of the robot in symbols. NotDerivableError where it does not have it."""
        if name not in self._formulas:
            self._formulas[name] = formula(self.robot, self.mobility, name)
        return self._formulas[name]

    def system(self, name: str, symbolic: bool = False) -> System:
        """A model q' = G(q) u: posture, configuration, trailer, zeta or eta. NotDerivableError where there is none.

        ``symbolic`` keeps every named parameter as a symbol, else only tunable ones.
        """
        return system_builder(name)(*driving(self.robot, self.mobility), symbolic)

    @cached_property
    def forms(self) -> dict[str, System]:
        """The forms of the model that the robot has, every named parameter as a symbol."""
        from wmrgen.functions.models.state_space import forms

        return forms(self.robot, self.mobility)

    def state_space(
        self, form: str | None = None, discrete: str | None = None, dt: float | CasadiSymbol | None = None
    ) -> CasadiFunction:
        """Return a model of motion as a casadi.Function of vectors; p is nominal if a call leaves it out.

        Args:
            form: posture, twist, eta, configuration, zeta or trailer. None: the form that model.json describes under
                ``state_space``.
            discrete: rk4, exact or collocation: return a step of constant inputs instead of rates.
            dt: Length of the step [s]. If it is left out, or is a CasADi symbol, dt is the fourth input of the step.

        Returns:
            ``(x, u, p) -> xdot``; for a step ``(x, u, p) -> (xnext, A, B, c)``, to first order xnext = A x + B u + c;
            with a free dt ``(x, u, p, dt) -> (xnext, A, B, c, by_dt)``, by_dt the derivative of xnext by dt.
            `entries` names the entries of the vectors.

        Raises:
            NotDerivableError: The robot has no such model.
            UsageError: Unknown form or step, or a dt that is no positive number.
        """
        model = self._of_vectors("ode", form)
        if discrete is None and dt is None:
            return model
        if discrete is None:
            raise UsageError(f"dt is {dt}, and there is no step to take. Write discrete='rk4' too.")
        return BACKENDS["casadi"].offers("step")(model, lower(arc()), discrete, dt)

    def rolling(self) -> CasadiFunction | None:
        """casadi.Function (x, u, p) -> g [m/s] of the model in twist inputs, 0 where no steered wheel slides; None
        without steered wheels."""
        return self._of_vectors("rolling", "twist")

    def entries(self, form: str | None = None) -> dict[str, object]:
        """Of x, u and p of `state_space` and what `rolling` and `limits` give: names, units, bounds, nominal values; of
        the default form what model.json says under ``state_space``."""
        from wmrgen.functions.models.state_space import data, state_space

        return data(state_space(self.robot, self.mobility, form))

    def limits(self, form: str | None = None) -> CasadiFunction | None:
        """casadi.Function (x, u, p) -> h of a form of the model, see `state_space`: what the robot file limits and is
        neither in x nor in u; ``limits`` of `entries` has their bounds. None where there is nothing."""
        return self._of_vectors("limits", form)

    def _of_vectors(self, name: str, form: str | None) -> CasadiFunction | None:
        """The `vector_form` called ``name`` of a form of the model, as a casadi.Function."""
        from wmrgen.functions.models.state_space import state_space

        vectors = vector_form(self.robot, state_space(self.robot, self.mobility, form), name)
        return vectors and BACKENDS["casadi"].offers("of_vectors")(vectors, self.robot.name)

    @cached_property
    def default_state_space(self) -> StateSpace | None:
        """What `state_space` is unless told otherwise; None where the robot has no model of motion."""
        from wmrgen.functions.models.state_space import default_state_space

        return default_state_space(self.robot, self.mobility)

    @cached_property
    def vector_forms(self) -> tuple[VectorForm, ...]:
        """`default_state_space` as functions of vectors: rates and, where there are some, constraints."""
        return vector_forms(self.robot, self.default_state_space)

    def evaluate(self, name: str, values: Mapping[str, Exact], digits: int | None = None) -> dict[str, Exact]:
        """Any function at exact values. Inputs left out are 0, parameters nominal; UsageError for parameters without a
        geometry.

        Args:
            name: The function.
            values: Input -> value in SI units.
            digits: Intermediate results with more than twice as many digits keep this many. None: 2,000.

        Returns:
            Output -> value in SI units.
        """
        self.robot.refuse(values)
        function = self._in_operations(name)
        missing = {p.name: ZERO for p in function.inputs if p.default is None}
        return evaluate(function, missing | dict(values), in_the_field(digits) if digits else EXACT)

    def _in_operations(self, name: str) -> Function:
        """Any function, not optimised."""
        if name not in self._lowered:
            self._lowered[name] = lower(self.formula(name))
        return self._lowered[name]

    @property
    def inverse(self) -> dict[str, Expr]:
        """Output name -> expression: joint commands of a twist. Named parameters are symbols, see `nominal`."""
        named = self.in_symbols
        spins = readable_spins(*driving(named.robot, named.mobility))
        return self.formula_in_symbols("inverse").closed() | spins

    @cached_property
    def forward(self) -> dict[str, Expr]:
        """Output name -> expression: twist and slip of sensed joint rates. Named parameters are symbols, see `nominal`.

        Where the geometry allows it, each component of the twist is one product in lowest terms.
        """
        outputs = self.formula_in_symbols("forward").closed()
        for k, product in enumerate(self.twist_in_symbols or ()):
            outputs[TWIST_NAMES[k]] = times(expression(product.factor), expression(product.rest))
        return outputs

    @cached_property
    def twist_in_symbols(self) -> list[Product] | None:
        """The twist of `forward` in lowest terms, every named parameter a symbol; None where it has no short form."""
        return readable_twist(driving(self.in_symbols.robot, self.in_symbols.mobility)[0])

    @property
    def odometry(self) -> dict[str, Expr]:
        """Output name -> expression: pose after a step."""
        return self.formula_in_symbols("odometry").closed()

    @property
    def dynamics(self) -> dict[str, Expr]:
        """Output name -> expression: rates of the posture model. Named parameters are symbols, see `nominal`."""
        return self.formula_in_symbols("dynamics").closed()

    @property
    def symbols(self) -> dict[str, Expr]:
        """Contract name of each input of the functions, and name of each parameter -> its symbol in expressions."""
        inputs = {
            p.name: signal(p.name) for f in self.program.formulas for p in f.inputs if p.default is None
        }
        return {p.name: parameter(p.name) for p in self.robot.parameters} | inputs

    @property
    def nominal(self) -> dict[Expr, Expr]:
        """Symbol of each named parameter -> its value, for ``expression.subs(derivation.nominal)``."""
        return {parameter(p.name): number(p.nominal) for p in self.robot.parameters}

    # Code.

    @cached_property
    def raw_module(self) -> Module:
        """The functions as written, not optimised: what the exact backend evaluates."""
        return Module(self.robot.name, tuple(self._in_operations(f.name) for f in self.program.formulas))

    @cached_property
    def _kept_whole(self) -> Module:
        """Every function, optimised, with calls of kernels where formulas name them."""
        return optimised(with_calls(self.program, self.raw_module), self.raw_module)

    @cached_property
    def module(self) -> Module:
        """The functions with every output of the contract, optimised, kernels in operations."""
        return self._in_operations_of({f.name: f.name for f in self.program.formulas})

    @cached_property
    def array_module(self) -> Module:
        """`module`, and its `forward` and `inverse` without slip: `forward_twist` and `inverse_joints`."""
        names = [name for f in self.program.formulas for name in (f.name, WITHOUT_SLIP.get(f.name)) if name]
        return self._in_operations_of({name: name for name in names})

    def _in_operations_of(self, names: dict[str, str]) -> Module:
        return inlined_calls(select(self._kept_whole, names))

    @cached_property
    def c_module(self) -> Module:
        """The functions for C: forward with and without the residual, inverse without slip, which has a function of
        its own, no posture model unless asked for. They call kernels, see `wmrgen.ir.calls`.

        What is passive and not sensed is left out, unless this is a derivation of some functions alone."""
        wanted = asked(self.robot) if self._functions is None else self._functions
        names = self.program.in_c(wanted)
        module = for_c(self._kept_whole, self.robot, names, passive=self._functions is not None)
        return with_needs(module, self.robot)

    @cached_property
    def c_in_operations(self) -> Module:
        """`c_module` with the operations of its kernels in the place of their calls."""
        return inlined_calls(self.c_module)

    @cached_property
    def bounds(self) -> Bounds:
        """`bounds_of` C as it is written unless asked otherwise."""
        return self.bounds_of(DEFAULT)

    def bounds_of(self, choice: Choice) -> Bounds:
        """Proved ranges and rounding errors of the C functions in float, where the robot file has limits."""
        return bounds(self.robot, self.c_in_operations, library(choice))

    # What backends make of them.

    def model(self) -> dict[str, object]:
        """The content of model.json."""
        space = self.default_state_space
        return model(self.robot, self.mobility, self.raw_module, self.c_in_operations, self.bounds, space)

    def casadi(self) -> dict[str, CasadiFunction]:
        """Function name -> casadi.Function, with inputs and outputs by contract name."""
        offer = BACKENDS["casadi"].offers("functions")
        functions: dict[str, CasadiFunction] = offer(self.module, self.raw_module)
        return functions

    def numpy(self) -> SimpleNamespace:
        """The functions, vectorised over NumPy arrays, and the state space over their last axis."""
        functions: SimpleNamespace = BACKENDS["numpy"].offers("functions")(
            self.array_module, self.vector_forms
        )
        return functions

    def __repr__(self) -> str:
        """``<Derivation pioneer3dx: type (2, 0), 3 wheels>``"""
        wheels = self.robot.wheels
        try:
            kind = f"type {self.mobility.robot_type}" if self.mobility.robot_type else "degenerate"
        except NotDerivableError:
            kind = "not derivable"
        return f"<Derivation {self.robot.name}: {kind}, {len(wheels)} wheel{'s' * (len(wheels) != 1)}>"

    def compiled(self, scalar: str = "double") -> SimpleNamespace:
        """The functions of `numpy` as C, compiled here for arrays: a compiler of the system is needed.

        ``scalar``: double, or float, whose sines the processor computes for several states at once.
        """
        module = self.array_module
        compute = BACKENDS["c99"].offers("compiled")(module, choice(scalar, target=HOST))
        offer = BACKENDS["numpy"].offers("functions")
        functions: SimpleNamespace = offer(module, (), lambda f, inputs: compute(f.name, inputs))
        return functions

    def _repr_latex_(self) -> str:
        """J1, C1, N and the degrees, for notebooks."""
        from wmrgen.geometry.printing import Latex

        m, printed = self.mobility, Latex()
        matrices = (("J_1", self.J1), ("C_1", self.C1), ("N", self.null_space))
        lines = [f"{name} &= {printed.doprint(value)}" for name, value in matrices if value.rows * value.cols]
        degrees = zip(
            "msM", (m.degree_of_mobility, m.degree_of_steerability, m.degree_of_maneuverability), strict=True
        )
        lines.append(
            r",\quad ".join(rf"\delta_{letter} {'&' * (letter == 'm')}= {n}" for letter, n in degrees)
        )
        body = " \\\\\n".join(lines)
        return f"$$\\begin{{aligned}}\n{body}\n\\end{{aligned}}$$"

    @cached_property
    def figures(self) -> dict[str, tuple[str, str]]:
        """File name -> a sentence that says what is seen, and the SVG text; the top view is the first."""
        return {f.file: (f.alt, f.svg) for f in BACKENDS["drawing"].offers("figures")(self)}

    def _repr_svg_(self) -> str:
        return self.figures["layout.svg"][1]
