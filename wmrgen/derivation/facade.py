"""The facade: every stage of one robot, from constraints to code, computed when it is first used."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import sympy

from wmrgen.analysis.kinematics.forward import nominal_rank, readable_twist
from wmrgen.analysis.kinematics.inverse import readable_spins
from wmrgen.analysis.kinematics.least_squares import Measured, project
from wmrgen.analysis.kinematics.pose import arc
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.analysis.kinematics.sensing import Measurements, measurements
from wmrgen.analysis.mobility import Mobility, analyse
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.codegen.registry import BACKENDS, CasadiFunction, CasadiSymbol, VectorForm
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
from wmrgen.geometry.constraints import (
    ConstraintRow,
    Constraints,
    constrain,
    nominal_view,
    pfaffian,
    pfaffian_rates,
    seen,
    symbolic_view,
)  # fmt: skip
from wmrgen.geometry.exact.lowest import Product
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.symbolic import Expr, expression, matrix, number, parameter, signal, times
from wmrgen.ir.bounds.assumptions import library
from wmrgen.ir.bounds.robot import Bounds, bounds
from wmrgen.ir.calls import inlined_calls, select
from wmrgen.ir.interpret import EXACT, evaluate, in_the_field
from wmrgen.ir.kernels.choice import DEFAULT, HOST, Choice, choice
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function, Module

if TYPE_CHECKING:
    from types import SimpleNamespace

    from wmrgen.functions.models.frobenius import Integrability
    from wmrgen.functions.models.growth import Growth
    from wmrgen.functions.models.state_space import StateSpace
    from wmrgen.functions.system import System


class Derivation:
    """The exact model of a robot: constraints, mobility, matrices, kinematics and code.

    The matrices (J1, J2, C1f, C1s, pfaffian, null_space) keep named parameters as symbols.
    """

    def __init__(self, robot: Robot, functions: Sequence[str] | None = None) -> None:
        self.robot = robot
        self._functions = functions  # names of the only functions; None: those that `program.standard` lists
        self._formulas: dict[str, Formula] = {}
        self._lowered: dict[str, Function] = {}

    # Constraints and mobility.

    @cached_property
    def constraints(self) -> Constraints:
        """The rolling and sliding rows of all wheels; parameters are symbols."""
        return constrain(self.robot, symbolic_view)

    @cached_property
    def layout_mobility(self) -> Mobility:
        """Degrees, ranks and reasons of the wheels, whatever trailers and virtual wheels the robot file has."""
        return analyse(self.robot)

    @cached_property
    def mobility(self) -> Mobility:
        """Degrees, ranks and reasons. NotDerivableError if the layout cannot have its trailers or virtual wheels."""
        mobility = self.layout_mobility
        if self.robot.trailers or self.robot.virtual:
            from wmrgen.functions.models.virtual import check_virtual
            from wmrgen.functions.trailers.trailer import check_trailers

            check_virtual(self.robot, mobility)
            check_trailers(*driving(self.robot, mobility))
        return mobility

    @cached_property
    def measured(self) -> Measurements:
        """The equations between the sensed joint rates and the twist; parameters are symbols."""
        return measurements(seen(self.robot, symbolic_view))

    @cached_property
    def measured_at_nominal(self) -> list[Measured]:
        """The rows of `measured` at nominal parameter values."""
        return measurements(seen(self.robot, nominal_view)).rows

    @cached_property
    def determined(self) -> bool:
        """Whether the sensed joints determine all three components of the twist, at nominal parameter values."""
        return nominal_rank(self.measured_at_nominal, self.robot).value == 3

    @cached_property
    def integrability(self) -> Integrability:
        """Frobenius's test of each constraint and of all together, and the functions that they integrate to."""
        from wmrgen.functions.models.frobenius import integrability

        return integrability(self.robot, self.mobility)

    @cached_property
    def growth(self) -> Growth:
        """Vector fields, Lie brackets and growth vector of the posture model, with its trailers."""
        from wmrgen.functions.models.growth import robot_growth

        return robot_growth(self.robot, self.mobility)

    # Derivations of related robots.

    @property
    def itself(self) -> Derivation:
        """The derivation, as the source of back ends that describe a robot (report, drawing)."""
        return self

    @cached_property
    def without_gyro(self) -> Derivation:
        """The derivation of the same robot without its gyro."""
        if self.robot.gyro is None:
            return self
        return Derivation(replace(self.robot, gyro=None), self._functions)

    @cached_property
    def driven(self) -> Derivation:
        """The derivation that wheel speeds and motion follow from.

        It is that of the equivalent drive if the robot has an effective track, else this one.
        """
        if self.mobility.driven is None:
            return self
        robot, mobility = self.mobility.driven
        driven = Derivation(robot, self._functions)
        driven.mobility = mobility
        return driven

    @cached_property
    def in_symbols(self) -> Derivation:
        """The same derivation with every named parameter (lengths and angles) as a symbol, as if all were tunable."""
        if len(self.robot.tunable) == len(self.robot.parameters):
            return self
        named = Derivation(self.robot.in_symbols, self._functions)
        named.mobility = self.mobility.in_symbols
        return named

    def formula_in_symbols(self, name: str) -> Formula:
        """Return a function with every named parameter as a symbol; with numbers if an input has a parameter's name."""
        try:
            return self.in_symbols.formula(name)
        except NotDerivableError:
            return self.formula(name)

    @cached_property
    def nearest(self) -> tuple[Poly, Poly, Poly]:
        """The admissible twist nearest to a commanded one, as polynomials in its components, at nominal values."""
        return project(seen(self.driven.robot, nominal_view), self.driven.mobility).twist

    # Matrices. They keep named parameters as symbols.

    @property
    def J1(self) -> sympy.Matrix:
        """Rolling rows, (number of rolling wheels) x 3: J1 xi = J2 spin (Siegwart (3.24))."""
        return _of_twist(self.constraints.rolling)

    @property
    def J2(self) -> sympy.Matrix:
        """Diagonal of r cos gamma [m] (Siegwart (3.24))."""
        rolling = self.constraints.rolling
        return sympy.diag(*(expression(-dict(r.rates)[r.wheel.index, "spin"]) for r in rolling))

    @property
    def C1f(self) -> sympy.Matrix:
        """Sliding rows of fixed wheels, N x 3 (Siegwart (3.26))."""
        return _of_twist(self.constraints.sliding_fixed)

    @property
    def C1s(self) -> sympy.Matrix:
        """Sliding rows of steered wheels, N x 3 (Siegwart (3.26))."""
        return _of_twist(self.constraints.sliding_steered)

    @property
    def C1(self) -> sympy.Matrix:
        """Sliding rows of all wheels that constrain the robot: C1f above C1s (Siegwart (3.26))."""
        return sympy.Matrix.vstack(self.C1f, self.C1s)

    @property
    def pfaffian(self) -> sympy.Matrix:
        """A with A (vx, vy, omega, joint rates) = 0; joints in the order of `pfaffian_rates`.

        With ``slip: true``, e . v + slip_x = r spin in rolling rows and n . v = slip_y in sliding rows.
        """
        rows = pfaffian(self.constraints, self.robot.slip)
        return matrix(rows, len(self.pfaffian_rates))

    @property
    def pfaffian_rates(self) -> tuple[str, ...]:
        """Names of the Pfaffian matrix's columns."""
        return pfaffian_rates(self.constraints)

    @property
    def H(self) -> sympy.Matrix:
        """2N x 3: velocities of the N contact points per twist, v_c = H xi + Q steer_rate (Kelly Box 4.2, (4.62))."""
        from wmrgen.functions.motion.velocities import twist_matrix

        return twist_matrix(self.robot)

    @property
    def Q(self) -> sympy.Matrix:
        """2N x M: velocities of the N contact points per steering rate of the M wheels that turn, in wheel order."""
        from wmrgen.functions.motion.velocities import steering_matrix

        return steering_matrix(self.robot)

    @property
    def compatibility(self) -> sympy.Matrix:
        """Rows w with w . spin = 0, one column per driven wheel: left null space of J2^-1 J1 (Tzafestas (2.84))."""
        from wmrgen.functions.motion.wheel_speeds import relation_matrix

        return relation_matrix(self.robot, self.mobility)

    @property
    def null_space(self) -> sympy.Matrix:
        """3 x delta_m: the columns span the admissible twists at steering angles whose axles meet in one ICR.

        They are scaled so that the coordinates eta are speeds (`mobility.basis.scaled`).
        """
        return matrix(self.mobility.scaled_symbolic, 3).T

    # Functions, in symbols and at exact values.

    @cached_property
    def program(self) -> Program:
        """The functions of the model in symbols."""
        names = standard(self.robot) if self._functions is None else self._functions
        return Program(self.robot.name, tuple(map(self.formula, names)))

    def formula(self, name: str) -> Formula:
        """Return a function of the robot in symbols. NotDerivableError if the robot does not have it."""
        if name not in self._formulas:
            self._formulas[name] = formula(self.robot, self.mobility, name)
        return self._formulas[name]

    def system(self, name: str, symbolic: bool = False) -> System:
        """Return a model of motion q' = G(q) u.

        Args:
            name: posture, configuration, trailer, zeta or eta.
            symbolic: Keep every named parameter as a symbol, not only the tunable ones.

        Returns:
            The model.

        Raises:
            NotDerivableError: The robot has no such model.
        """
        return system_builder(name)(*driving(self.robot, self.mobility), symbolic)

    @cached_property
    def forms(self) -> dict[str, System]:
        """The forms of the model of motion that the robot has; every named parameter is a symbol."""
        from wmrgen.functions.models.state_space import forms

        return forms(self.robot, self.mobility)

    def state_space(
        self, form: str | None = None, discrete: str | None = None, dt: float | CasadiSymbol | None = None
    ) -> CasadiFunction:
        """Return a model of motion as a casadi.Function of vectors; p is nominal if a call leaves it out.

        Args:
            form: posture, twist, eta, configuration, zeta or trailer. None: the form that model.json describes under
                ``state_space``.
            discrete: rk4, exact or collocation, to return a step with constant inputs instead of rates.
            dt: Length of the step [s]. If it is left out, or is a CasADi symbol, dt is the fourth input of the step.

        Returns:
            ``(x, u, p) -> xdot``; for a step ``(x, u, p) -> (xnext, A, B, c)``, to first order xnext = A x + B u + c;
            with a free dt ``(x, u, p, dt) -> (xnext, A, B, c, by_dt)``, by_dt the derivative of xnext by dt.
            `entries` names the entries of the vectors.

        Raises:
            NotDerivableError: The robot has no such model.
            UsageError: The form or the step is unknown, or dt is not a positive number.
        """
        model = self._of_vectors("ode", form)
        if discrete is None and dt is None:
            return model
        if discrete is None:
            raise UsageError(f"dt is {dt}, but no step is requested. Write discrete='rk4' too.")
        return BACKENDS["casadi"].offers("step")(model, lower(arc()), discrete, dt)

    def rolling(self) -> CasadiFunction | None:
        """Return the sliding of steered wheels as a casadi.Function (x, u, p) -> g [m/s] of the model in twist inputs.

        g is 0 where no steered wheel slides. None for a robot without steered wheels.
        """
        return self._of_vectors("rolling", "twist")

    def entries(self, form: str | None = None) -> dict[str, object]:
        """Return names, units, bounds and nominal values of the entries of x, u and p of `state_space`.

        The results of `rolling` and `limits` are included. For the default form this is ``state_space`` of model.json.
        """
        from wmrgen.functions.models.state_space import data, state_space

        return data(state_space(self.robot, self.mobility, form))

    def limits(self, form: str | None = None) -> CasadiFunction | None:
        """Return the limited quantities that are neither in x nor in u, as a casadi.Function (x, u, p) -> h.

        Their bounds are in ``limits`` of `entries`. ``form`` as for `state_space`. None if the robot has no such limit.
        """
        return self._of_vectors("limits", form)

    def _of_vectors(self, name: str, form: str | None) -> CasadiFunction | None:
        """Return the `vector_form` called ``name`` of a form of the model, as a casadi.Function."""
        from wmrgen.functions.models.state_space import state_space

        vectors = vector_form(self.robot, state_space(self.robot, self.mobility, form), name)
        return vectors and BACKENDS["casadi"].offers("of_vectors")(vectors, self.robot.name)

    @cached_property
    def default_state_space(self) -> StateSpace | None:
        """The form of `state_space` without arguments; None if the robot has no model of motion."""
        from wmrgen.functions.models.state_space import default_state_space

        return default_state_space(self.robot, self.mobility)

    @cached_property
    def vector_forms(self) -> tuple[VectorForm, ...]:
        """`default_state_space` as functions of vectors: rates, and constraints and limits if there are any."""
        return vector_forms(self.robot, self.default_state_space)

    def evaluate(self, name: str, values: Mapping[str, Exact], digits: int | None = None) -> dict[str, Exact]:
        """Evaluate a function at exact values.

        Args:
            name: The function.
            values: Input -> value in SI units. An input that is left out is 0, a parameter has its nominal value.
            digits: An intermediate result with more than twice as many digits is rounded to this many. None: 2,000.

        Returns:
            Output -> value in SI units.

        Raises:
            UsageError: The parameters give no geometry.
        """
        self.robot.refuse(values)
        function = self._in_operations(name)
        missing = {p.name: ZERO for p in function.inputs if p.default is None}
        return evaluate(function, missing | dict(values), in_the_field(digits) if digits else EXACT)

    def _in_operations(self, name: str) -> Function:
        """Return a function in operations, not optimised."""
        if name not in self._lowered:
            self._lowered[name] = lower(self.formula(name))
        return self._lowered[name]

    @property
    def inverse(self) -> dict[str, Expr]:
        """Joint commands for a twist: output name -> expression. Named parameters are symbols, see `nominal`."""
        named = self.in_symbols
        spins = readable_spins(*driving(named.robot, named.mobility))
        return self.formula_in_symbols("inverse").closed() | spins

    @cached_property
    def forward(self) -> dict[str, Expr]:
        """Twist and slip of sensed joint rates: output name -> expression. Named parameters are symbols, see `nominal`.

        If the geometry allows it, each component of the twist is one product in lowest terms.
        """
        outputs = self.formula_in_symbols("forward").closed()
        for k, product in enumerate(self.twist_in_symbols or ()):
            outputs[TWIST_NAMES[k]] = times(expression(product.factor), expression(product.rest))
        return outputs

    @cached_property
    def twist_in_symbols(self) -> list[Product] | None:
        """The twist of `forward` in lowest terms, every named parameter a symbol; None if it has no short form."""
        return readable_twist(driving(self.in_symbols.robot, self.in_symbols.mobility)[0])

    @property
    def odometry(self) -> dict[str, Expr]:
        """Pose after a step: output name -> expression."""
        return self.formula_in_symbols("odometry").closed()

    @property
    def dynamics(self) -> dict[str, Expr]:
        """Rates of the posture model: output name -> expression. Named parameters are symbols, see `nominal`."""
        return self.formula_in_symbols("dynamics").closed()

    @property
    def symbols(self) -> dict[str, Expr]:
        """The symbol of each parameter and of each input of a function, by name."""
        inputs = {
            p.name: signal(p.name) for f in self.program.formulas for p in f.inputs if p.default is None
        }
        return {p.name: parameter(p.name) for p in self.robot.parameters} | inputs

    @property
    def nominal(self) -> dict[Expr, Expr]:
        """The nominal value of each named parameter, by symbol, for ``expression.subs(derivation.nominal)``."""
        return {parameter(p.name): number(p.nominal) for p in self.robot.parameters}

    # Code.

    @cached_property
    def raw_module(self) -> Module:
        """The functions as their formulas are written, not optimised; the exact back end evaluates them."""
        return Module(self.robot.name, tuple(self._in_operations(f.name) for f in self.program.formulas))

    @cached_property
    def _kept_whole(self) -> Module:
        """Every function, optimised, with the calls of kernels that formulas name."""
        return optimised(with_calls(self.program, self.raw_module), self.raw_module)

    @cached_property
    def module(self) -> Module:
        """The functions with all their outputs, optimised, with the operations of kernels in place of calls."""
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
        """The functions for C. They call kernels, see `wmrgen.ir.calls`.

        `forward` exists with and without the residual. `inverse` has no slip, which is a function of its own. The
        posture model is included only if the robot file requests it. Joints that are passive and not sensed are left
        out, unless this derivation is of selected functions.
        """
        wanted = asked(self.robot) if self._functions is None else self._functions
        names = self.program.in_c(wanted)
        module = for_c(self._kept_whole, self.robot, names, passive=self._functions is not None)
        return with_needs(module, self.robot)

    @cached_property
    def c_in_operations(self) -> Module:
        """`c_module` with the operations of its kernels in place of calls."""
        return inlined_calls(self.c_module)

    @cached_property
    def bounds(self) -> Bounds:
        """Proved ranges and rounding errors of the C with default options, see `bounds_of`."""
        return self.bounds_of(DEFAULT)

    def bounds_of(self, choice: Choice) -> Bounds:
        """Return proved ranges and rounding errors of the C functions in float, if the robot file has limits."""
        return bounds(self.robot, self.c_in_operations, library(choice))

    # Data and functions for other programs.

    def model(self) -> dict[str, object]:
        """Return the content of model.json."""
        space = self.default_state_space
        return model(self.robot, self.mobility, self.raw_module, self.c_in_operations, self.bounds, space)

    def casadi(self) -> dict[str, CasadiFunction]:
        """Return the functions as casadi.Function, by name; inputs and outputs have the names of the robot's joints."""
        offer = BACKENDS["casadi"].offers("functions")
        functions: dict[str, CasadiFunction] = offer(self.module, self.raw_module)
        return functions

    def numpy(self) -> SimpleNamespace:
        """Return the functions over NumPy arrays, and the state space over the last axis of arrays."""
        functions: SimpleNamespace = BACKENDS["numpy"].offers("functions")(
            self.array_module, self.vector_forms
        )
        return functions

    def __repr__(self) -> str:
        """Return ``<Derivation pioneer3dx: type (2, 0), 3 wheels>``."""
        wheels = self.robot.wheels
        try:
            kind = f"type {self.mobility.robot_type}" if self.mobility.robot_type else "degenerate"
        except NotDerivableError:
            kind = "not derivable"
        return f"<Derivation {self.robot.name}: {kind}, {len(wheels)} wheel{'s' * (len(wheels) != 1)}>"

    def compiled(self, scalar: str = "double") -> SimpleNamespace:
        """Return the functions of `numpy` as C for arrays, compiled by the C compiler of the system.

        ``scalar``: double or float. In float, the sines of several states are computed at once.
        """
        module = self.array_module
        compute = BACKENDS["c99"].offers("compiled")(module, choice(scalar, target=HOST))
        offer = BACKENDS["numpy"].offers("functions")
        functions: SimpleNamespace = offer(module, (), lambda f, inputs: compute(f.name, inputs))
        return functions

    def _repr_latex_(self) -> str:
        """Return J1, C1, N and the degrees as LaTeX, for notebooks."""
        from wmrgen.geometry import notation
        from wmrgen.geometry.printing import Latex

        m, printed = self.mobility, Latex()
        matrices = (("J_1", self.J1), ("C_1", self.C1), ("N", self.null_space))
        with notation.with_symbols(self.robot.letters):
            shown = {name: printed.doprint(value) for name, value in matrices if value.rows * value.cols}
        lines = [f"{name} &= {value}" for name, value in shown.items()]
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
        """Description and SVG text of each figure, by file name; the top view is the first."""
        return {f.file: (f.alt, f.svg) for f in BACKENDS["drawing"].offers("figures")(self)}

    def _repr_svg_(self) -> str:
        return self.figures["layout.svg"][1]


def _of_twist(rows: Iterable[ConstraintRow]) -> sympy.Matrix:
    """Return rows over (vx, vy, omega) as a matrix with three columns."""
    return matrix([r.row for r in rows], 3)
