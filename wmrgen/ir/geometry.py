"""Values that depend on geometry alone, which are known before the other inputs.

Such a value is kept as a constant times a monomial: a product of whole powers of atoms. Atoms are nodes of the builder:
inputs, functions, and sums whose first coefficient is one. Proportional values therefore have the same monomial,
however they were written.
"""

from __future__ import annotations

from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.linear_program import Coefficient
from wmrgen.ir.nodes import Function, Op, Role, pruned, rebuilt

Monomial = tuple[tuple[int, int], ...]  # (node of the builder, power), in the order of the nodes
Form = dict[Monomial, Exact]  # a sum of monomials with non-zero coefficients


def geometry_only(function: Function) -> list[bool]:
    """Return by node whether it depends on constants, geometry and prepared inputs alone."""
    names = {port.name for port in function.inputs if port.role in (Role.GEOMETRY, Role.PREPARED)}
    early: list[bool] = []
    for node in function.nodes:
        early.append(node.name in names if node.op is Op.INPUT else all(early[arg] for arg in node.args))
    return early


def unguarded(function: Function) -> Function:
    """Return ``function`` without guards of divisors that depend on geometry alone, for geometry that is known."""
    early = geometry_only(function)
    guards = {i for i, node in enumerate(function.nodes) if node.op is Op.AT_LEAST and early[i]}
    if not guards:
        return function
    builder, built = Builder(), list[int]()
    for i, node in enumerate(function.nodes):
        args = [built[arg] for arg in node.args]
        built.append(args[0] if i in guards else builder.again(node, args))
    return pruned(rebuilt(function, builder.nodes, dict(enumerate(built))))


def times(a: Monomial, b: Monomial, power: int = 1) -> Monomial:
    """Return a * b**power.

    Args:
        a: a monomial.
        b: a monomial.
        power: a whole number, not 0.
    """
    if not b:
        return a
    powers = dict(a)
    for atom, n in b:
        powers[atom] = powers.get(atom, 0) + n * power
    return tuple(sorted((atom, n) for atom, n in powers.items() if n))


def accumulate(form: Form, monomial: Monomial, value: Exact) -> None:
    """Add value * monomial to a form, in place.

    Args:
        form: the form.
        monomial: the monomial.
        value: its coefficient, not 0.
    """
    before = form.get(monomial)
    total = value if before is None else before + value
    if total:
        form[monomial] = total
    else:
        form.pop(monomial, None)


class Scalars:
    """The geometry-only nodes of a function, as sums of monomials in a canonical form."""

    __slots__ = ("_builder", "_forms", "_function", "_singles")

    def __init__(self, function: Function, builder: Builder, early: list[bool]) -> None:
        self._function, self._builder = function, builder
        self._forms: dict[int, Form] = {}
        self._singles: dict[int, tuple[Exact, Monomial]] = {}
        for i, geometry in enumerate(early):
            if geometry:
                self._forms[i] = self._form(i)

    def _form(self, i: int) -> Form:
        node, forms, builder = self._function.nodes[i], self._forms, self._builder
        if node.value is not None:
            return {(): node.value} if node.value else {}
        args = [forms[arg] for arg in node.args]
        if node.op in (Op.ADD, Op.SUB):
            total = dict(args[0])
            for monomial, value in args[1].items():
                accumulate(total, monomial, value if node.op is Op.ADD else -value)
            return total
        if node.op is Op.NEG:
            return {monomial: -value for monomial, value in args[0].items()}
        if node.op is Op.MUL:
            for scalar, other in ((args[0], args[1]), (args[1], args[0])):
                if set(scalar) <= {()}:
                    c = scalar.get((), ZERO)
                    return {m: c * value for m, value in other.items()} if c else {}
        if node.op in (Op.MUL, Op.DIV):
            (p, a), (q, b) = map(self.factors, node.args)
            if not p:
                return {}
            power = 1 if node.op is Op.MUL else -1
            return {times(a, b, power): p * q if power > 0 else p / q}
        atom = builder.copy(node, [self.node_of(arg) for arg in args])
        constant = builder.value(atom)
        return self._atom(atom) if constant is None else ({(): constant} if constant else {})

    def _atom(self, node: int) -> Form:
        scaled = self._builder.scaled(node)
        return {((node, 1),): ONE} if scaled is None else {((scaled[1], 1),): scaled[0]}

    def form(self, i: int) -> Form:
        """Return geometry-only node ``i`` of the function as a sum of monomials."""
        return self._forms[i]

    def factors(self, i: int) -> tuple[Exact, Monomial]:
        """Return geometry-only node ``i`` of the function as a constant times a monomial."""
        if i not in self._singles:
            self._singles[i] = self.single(self._forms[i])
        return self._singles[i]

    def single(self, form: Form) -> tuple[Exact, Monomial]:
        """Return ``form`` as a constant times a monomial; a sum becomes an atom of its own."""
        if not form:
            return ZERO, ()
        if len(form) == 1:
            ((monomial, lead),) = form.items()
            return lead, monomial
        items = sorted(form.items(), key=lambda item: (not item[0], item[0]))
        lead = items[0][1]
        ratio = lead.inverse()
        total = self._builder.sum(self._scaled(value * ratio, m) for m, value in items)
        return lead, ((total, 1),)

    def coefficient(self, form: Form) -> Coefficient:
        """Return ``form`` as a coefficient of a linear map."""
        value, monomial = self.single(form)
        return Coefficient(value, monomial or None)

    def node_of(self, form: Form) -> int:
        """Return the builder's node of ``form``."""
        return self._scaled(*self.single(form))

    def scale(self, coefficient: Coefficient, node: int) -> int:
        """Return coefficient * node; the coefficient is computed before it is multiplied with the node."""
        monomial = coefficient.atom
        if not isinstance(monomial, tuple):
            return self._builder.mul(self._builder.const(coefficient.value), node)
        return self._builder.make(Op.MUL, (self._scaled(coefficient.value, monomial), node))

    def _scaled(self, value: Exact, monomial: Monomial) -> int:
        builder = self._builder
        factors = []
        for atom, power in monomial:
            base = atom if power > 0 else builder.div(builder.const(ONE), atom)
            factors += [base] * abs(power)
        return builder.mul(builder.const(value), builder.product(factors))
