"""CasADi: an SX function for each function of a robot, with inputs and outputs by contract name.

Names may contain dots: ``f(**{"left.spin": 1.0})["vx"]``. Tunable parameters are the last inputs and default to their
nominal values.

SX evaluates both branches of every choice. The derivative of a branch that is not taken is multiplied by 0, which gives
NaN if it is infinite. Therefore sqrt and atan2 get other arguments at points where they have no derivative; the
derivative there is 0.

Unlike in C, divisors that depend only on parameters have no guard: a radius, a wheelbase or a castor offset must not be
0. Robot files are checked for this; a caller who passes other values of p must check them.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, reduce
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from wmrgen.codegen.registry import Facts, Request, VectorForm
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.ports import Role
from wmrgen.ir.calls import complete, defaults, self_contained
from wmrgen.ir.geometry import unguarded
from wmrgen.ir.nodes import Function, Module, Op, uses_of
from wmrgen.ir.rounding import to_float64

_BLOCK = 4096  # columns that are computed at once, so that long logs need no more memory


def _apply(op: Op, args: list[ca.SX]) -> ca.SX:
    """Return the result of an operation.

    SX.binary and SX.unary are six times as fast as the operators of SX, which try several conversions first.
    """
    if callable(op.casadi):
        result: ca.SX = op.casadi(ca, *args)
    elif op.arity == 2:
        result = ca.SX.binary(getattr(ca, op.casadi), *args)
    else:
        result = ca.SX.unary(getattr(ca, op.casadi), *args)
    return result


def to_casadi(function: Function, name: str) -> ca.Function:
    """Return ``function`` (without PREPARED inputs) as the SX function ``name``."""
    symbols = {port.name: ca.SX.sym(port.name) for port in function.inputs}
    tangents, quotients = _tangents(function), _quotients(function)
    values: list[ca.SX] = []
    for i, node in enumerate(function.nodes):
        if node.value is not None:
            values.append(ca.SX(to_float64(node.value)))
        elif node.op is Op.INPUT:
            values.append(symbols[node.name or ""])
        elif i in tangents:
            angle, factors = tangents[i]
            values.append(reduce(operator.mul, (values[k] for k in factors), ca.tan(values[angle])))
        elif i in quotients:
            above, below = quotients[i]
            values.append(values[above] / values[below])
        else:
            values.append(_apply(node.op, [values[a] for a in node.args]))
    nominal = defaults(function)
    options: dict[str, Any] = {
        "allow_duplicate_io_names": True
    }  # a steering angle may be an input and an output
    if symbols:
        options["default_in"] = [nominal.get(key, 0.0) for key in symbols]
    return ca.Function(
        name,
        list(symbols.values()),
        [values[r] for r in function.results],
        list(symbols),
        [port.name for port in function.outputs],
        options,
    )


def _tangents(function: Function) -> dict[int, tuple[int, list[int]]]:
    """Return the quotients that are tangents, with the angle and the other factors of the dividend.

    The dividend is a product with a sine, the divisor is the cosine of the same angle, and no other node uses them.
    """
    nodes, uses = function.nodes, uses_of(function)
    found = {}
    for i, node in enumerate(nodes):
        below = nodes[node.args[1]] if node.op is Op.DIV and uses[node.args[1]] == 1 else None
        if below is None or below.op is not Op.COS:
            continue
        sines, rest, stack = 0, [], [node.args[0]]
        while stack:
            k = stack.pop()
            if uses[k] == 1 and nodes[k].op is Op.SIN and nodes[k].args == below.args and not sines:
                sines = 1
            elif uses[k] == 1 and nodes[k].op is Op.MUL:
                stack += nodes[k].args
            else:
                rest.append(k)
        if sines:
            found[i] = (below.args[0], rest)
    return found


def _quotients(function: Function) -> dict[int, tuple[int, int]]:
    """Return the products with a reciprocal that nothing else uses, with dividend and divisor.

    `prepare` is part of each function here, and a quotient is one instruction instead of two.
    """
    nodes, uses = function.nodes, uses_of(function)
    found = {}
    for i, node in enumerate(nodes):
        for factor, other in (node.args, node.args[::-1]) if node.op is Op.MUL else ():
            above = nodes[nodes[other].args[0]] if nodes[other].op is Op.DIV and uses[other] == 1 else None
            if above is not None and above.value == ONE:
                found[i] = factor, nodes[other].args[1]
    return found


def functions(module: Module, written: Module | None = None) -> dict[str, ca.Function]:
    """Return ``<robot>_<function>`` by function name; `prepare` is part of each function.

    Args:
        module: The optimised functions.
        written: The same functions before optimisation. For functions of tunable parameters, the shorter of the two
            is used: optimisation moves what depends only on parameters to `prepare`, which saves nothing here.
    """
    plain = {f.name: f for f in written.functions} if written else {}
    return {f.name: _function(f, plain.get(f.name), module.name) for f in self_contained(module)}


def _function(function: Function, written: Function | None, robot: str) -> ca.Function:
    """Return the shorter of an optimised function and the same function before optimisation."""
    name = ca.Function.fix_name(f"{robot}_{function.name}")
    ours = to_casadi(unguarded(function), name)
    if written is None or all(port.role is not Role.GEOMETRY for port in function.inputs):
        return ours
    plain = unguarded(written)
    if {node.name for node in plain.nodes if node.op is Op.INPUT} - {port.name for port in function.inputs}:
        return ours
    theirs = to_casadi(replace(plain, inputs=function.inputs), name)

    def size(f: ca.Function) -> tuple[int, int]:
        inputs = f.sx_in()
        return _size(inputs, ca.vertcat(*f.call(inputs)))

    return min(ours, theirs, key=size)


class OfColumns(NamedTuple):
    """A CasADi function that is called for each column of a matrix. It can be pickled."""

    function: ca.Function

    def __call__(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the results (outputs, N) for inputs (inputs, N).

        CasADi reads and writes NumPy's arrays directly. Copying to CasADi's matrices would take longer than computing.
        """
        results = np.empty((self.function.size1_out(0), columns.shape[1]))
        for first in range(0, columns.shape[1], _BLOCK):
            block = columns[:, first : first + _BLOCK].T
            size = 1 << (len(block) - 1).bit_length()  # a power of 2, so that `_mapped` caches few sizes
            inputs, outputs = np.zeros((size, len(columns))), np.empty((size, len(results)))
            inputs[: len(block)] = block
            memory: Any
            memory, evaluate = _mapped(self.function, size).buffer()
            memory.set_arg(0, inputs.data)
            memory.set_res(0, outputs.data)
            evaluate()
            results[:, first : first + _BLOCK] = outputs[: len(block)].T
        return results


@lru_cache(maxsize=64)  # all sizes for a few functions: creating one takes as long as calling it
def _mapped(function: ca.Function, columns: int) -> ca.Function:
    """Return the function of this number of columns at once."""
    return function.map(columns)


def sensitivity(
    function: Function,
    outputs: Sequence[str],
    inputs: Sequence[str],
    parameters: Sequence[str],
    scaled: Sequence[str] = (),
) -> OfColumns:
    """Return some outputs of a function with their exact derivatives with respect to parameters and scales.

    Args:
        function: A function of the robot.
        outputs: Contract names of the outputs.
        inputs: Contract names of the first rows of the argument.
        parameters: Contract names of the rows after these.
        scaled: Wheels and joints such as ``front.steer``, each for one more row: the factor of its angle and its rate.

    Returns:
        A function of columns (inputs + parameters + scaled, N). Its result has the shape (outputs * (1 + parameters +
        scaled), N): the outputs, then their derivatives with respect to the first parameter, the second, and so on.
    """
    whole = to_casadi(function, "whole")
    names = [*inputs, *parameters]
    symbols = ca.SX.sym("columns", len(names) + len(scaled))
    arguments = {name: symbols[i] for i, name in enumerate(names)}
    for k, joint in enumerate(scaled):
        for name in {joint, f"{joint}_rate"} & set(inputs):
            arguments[name] *= symbols[len(names) + k]
    results = whole(**arguments)
    values = ca.vertcat(*(results[name] for name in outputs))
    by = ca.jacobian(values, symbols[len(inputs) :])
    return OfColumns(ca.Function("sensitivity", [symbols], [ca.densify(ca.vertcat(values, ca.vec(by)))]))


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """Return ``<robot>_<function>.casadi`` for ``casadi.Function.load``, with the bytes that `Function.save` writes."""
    every = functions(module, facts.written) | {v.name: of_vectors(v, module.name) for v in facts.vectors}
    return {f"{module.name}_{name}.casadi": content(function) for name, function in every.items()}


def content(function: ca.Function) -> bytes:
    """Return the content of a file for `casadi.Function.load`."""
    serializer = ca.StringSerializer()
    serializer.pack(function)
    return bytes(serializer.encode().encode("ascii"))


def evaluate(module: Module, requests: Sequence[Request]) -> list[dict[str, float]]:
    """Return the outputs of each request by contract name, in float64."""
    asked = {name for name, _ in requests}
    called = {f.name: (f, to_casadi(unguarded(f), "f")) for f in self_contained(module) if f.name in asked}
    results = []
    for name, case in requests:
        function, call = called[name]
        values = call.call([ca.DM(value) for value in complete(function, case)])
        results.append({port.name: float(v) for port, v in zip(function.outputs, values, strict=True)})
    return results


# ---- vectors, for optimisers


class OfVectors(ca.Function):
    """A CasADi function of vectors in which ``p`` is nominal if a call omits it.

    CasADi itself has one default for all entries of an input. Functions that CasADi derives from this one (``map``,
    ``factory``, files) have CasADi's default: the nominal value if it is the same for all entries, otherwise NaN.
    """

    def __init__(self, function: ca.Function, nominal: Sequence[float] | None = None) -> None:
        super().__init__(function)
        self.nominal: tuple[float, ...] = tuple(
            getattr(function, "nominal", ()) if nominal is None else nominal
        )

    def call(self, *args: Any) -> Any:
        """Call the function as `casadi.Function.call` does; ``p`` may be omitted."""
        given, *flags = args
        place = self.index_in("p")
        if isinstance(given, dict):
            given = {"p": ca.DM(self.nominal), **given}
        elif len(given) == place == self.n_in() - 1:
            given = [*given, ca.DM(self.nominal)]
        return super().call(given, *flags)

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "nominal": self.nominal}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self.__init__(ca.Function.deserialize(state["serialization"]), state["nominal"])  # type: ignore[misc]


def _of_vectors(
    name: str,
    inputs: dict[str, Any],
    outputs: dict[str, Any],
    nominal: Sequence[float],
) -> OfVectors:
    """Return the function ``name`` of x, u, p and, if it is an input, dt, which has no default."""
    same = nominal[0] if len(set(nominal)) == 1 else math.nan
    options = {"default_in": [{"p": same, "dt": math.nan}.get(key, 0.0) for key in inputs]}
    function = ca.Function(
        name, list(inputs.values()), list(outputs.values()), list(inputs), list(outputs), options
    )
    return OfVectors(function, nominal)


def of_vectors(vector: VectorForm, robot: str) -> OfVectors:
    """Return a function of vectors, such as ``(x, u, p) -> xdot``."""
    vectors: list[ca.SX] = []
    named: dict[str, ca.SX] = {}
    for name, entries in zip("xup", vector.vectors, strict=True):
        symbol = ca.SX.sym(name, len(entries))
        vectors.append(symbol)
        named |= {entry: symbol[i] for i, entry in enumerate(entries)}
    results = []
    for function in (vector.function, *vector.others):
        inputs = [named[port.name] for port in function.inputs]
        results.append(ca.densify(ca.vertcat(*to_casadi(function, function.name).call(inputs))))
    shortest = min(results, key=lambda result: _size(vectors, result))
    return _of_vectors(
        ca.Function.fix_name(f"{robot}_{vector.name}"), dict(zip("xup", vectors, strict=True)),
        {vector.result: shortest}, vector.nominal,
    )  # fmt: skip


def _size(inputs: Sequence[ca.SX], result: ca.SX) -> tuple[int, int]:
    """Return the instructions of a result with its Jacobian, which an optimiser calls in each iteration, and those of
    the Jacobian alone."""
    jacobian = ca.jacobian(result, ca.vertcat(*inputs))
    rates, derivatives = (
        ca.Function("f", list(inputs), [value]).n_instructions() for value in (result, jacobian)
    )
    return rates + derivatives, derivatives


# Integrators of CasADi with their options: steps, and the order or the points and the Newton method.
_SCHEMES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "rk4": (ca.simpleRK, (1, 4)),
    "collocation": (ca.simpleIRK, (1, 3, "radau", "fast_newton")),
}


def step(model: OfVectors, odometry: Function, kind: str, dt: Any = None) -> OfVectors:
    """Return the state after a step of constant inputs, with its derivatives.

    Args:
        model: ``(x, u, p) -> xdot``.
        odometry: The robot's odometry, which is exact for a constant twist.
        kind: rk4, collocation, or exact (by odometry).
        dt: Length of the step [s]. None or a CasADi symbol: dt is the fourth input.

    Returns:
        ``(x, u, p) -> (xnext, A, B, c)`` with xnext = A x + B u + c to first order. With a free dt
        ``(x, u, p, dt) -> (xnext, A, B, c, by_dt)``: by_dt is the derivative of xnext by dt [1/s].

    Raises:
        UsageError: Another kind, a dt that is not a positive number or symbol, or an exact step of a model whose twist
            changes with the state.
    """
    if kind not in ("exact", *_SCHEMES):
        raise UsageError(f"there is no step of kind {kind}: write exact, {' or '.join(_SCHEMES)}")
    free = dt is None or (isinstance(dt, (ca.SX, ca.MX)) and dt.is_symbolic() and dt.is_scalar())
    if not free and not _is_time(dt):
        raise UsageError(
            f"dt is {dt}: a step takes time. Write dt in seconds, such as 0.05, or omit it: dt is then an input."
        )
    # A function that solves equations has no SX form.
    symbol: Any = ca.MX.sym if kind == "collocation" else ca.SX.sym
    x, u, p = vectors = [symbol(name, model.size1_in(i)) for i, name in enumerate("xup")]
    time = symbol("dt") if free else float(dt)
    if kind == "exact":
        after = _exact(model, to_casadi(odometry, "odometry"), vectors, time)
    else:
        scheme, options = _SCHEMES[kind]
        after = x + scheme(_changes(model), *options)(ca.DM.zeros(x.shape), ca.vertcat(x, u, p), time)
    a, b = ca.jacobian(after, x), ca.jacobian(after, u)
    affine = after - ca.mtimes(a, x) - ca.mtimes(b, u)
    inputs = dict(zip("xup", vectors, strict=True))
    outputs = {"xnext": after, "A": ca.densify(a), "B": ca.densify(b), "c": affine}
    if free:
        inputs["dt"] = time
        outputs["by_dt"] = ca.densify(ca.jacobian(after, time))
    return _of_vectors(f"{model.name()}_{kind}", inputs, outputs, model.nominal)


def _is_time(dt: Any) -> bool:
    """Return whether ``dt`` is a positive number."""
    try:
        return 0 < float(dt) < math.inf
    except (TypeError, ValueError, RuntimeError, NotImplementedError):
        return False


def _changes(model: ca.Function) -> ca.Function:
    """Return a model for CasADi's integrators, whose state is the change since the beginning of the step.

    With the state itself, Newton's method would not converge far from the origin. Its parameters are the state at the
    beginning of the step, the inputs and the parameters of the model, as one vector.
    """
    x, u, p = (ca.SX.sym(name, model.size1_in(i)) for i, name in enumerate("xup"))
    change = ca.SX.sym("change", model.size1_in(0))
    return ca.Function("ode", [change, ca.vertcat(x, u, p)], [model(x + change, u, p)], ["x", "p"], ["ode"])


def _exact(model: ca.Function, odometry: ca.Function, vectors: Sequence[ca.SX], dt: Any) -> ca.SX:
    """Return the exact state after a step.

    Odometry gives x, y and theta, because the twist is constant. All other entries have a constant rate, or decay with
    first order.

    Args:
        model: ``(x, u, p) -> xdot``.
        odometry: The robot's odometry.
        vectors: x, u and p.
        dt: Length of the step [s].

    Raises:
        UsageError: The twist depends on the state, or another entry has other dynamics.
    """
    x, u, p = vectors
    rest = x[3:]
    body = model(ca.vertcat(x[:2], 0, rest), u, p)  # at heading 0, the axes of world and robot are parallel
    decay = ca.jacobian(body[3:], rest)
    coupled = decay.nnz() != ca.diag(ca.diag(decay)).nnz() or ca.symvar(decay)
    if coupled or any(ca.which_depends(body[:3], rest, 1, True)):
        raise UsageError(_NOT_EXACT)
    if any(ca.which_depends(ca.vertcat(model(x, u, p)[3:], ca.diag(decay)), x[:3], 1, True)):
        raise UsageError(_NOT_EXACT)
    pose = odometry(x[0], x[1], x[2], body[0], body[1], body[2], dt)
    per_rate = [dt if k == 0 else ca.expm1(k * dt) / k for k in ca.evalf(ca.diag(decay)).full().ravel()]
    result: ca.SX = ca.vertcat(*pose, rest + ca.vertcat(*per_rate) * body[3:])
    return result


_NOT_EXACT = (
    "the exact step needs a twist that the inputs alone decide, and no angles that follow the motion. Use the form "
    "twist, or a step of kind rk4 or collocation."
)
