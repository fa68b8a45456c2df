"""What is known of the nodes of a function before its inputs are: what depends on geometry alone, and ranges.

A geometry-only value is a constant times a monomial: a product of whole powers of atoms. Atoms are nodes of the
builder: inputs, functions, and sums whose first coefficient is one. So proportional values meet in one monomial,
whatever way they were written.

Ranges prove that no quotient has a zero divisor and no square root a negative argument. Every node gets an enclosing
interval, a bound away from zero, and whether it can be zero at all. What a `select` has compared is used for the branch
that it chooses between the values compared.
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.linear_program import Coefficient
from wmrgen.ir.nodes import Function, Node, Op, Role
from wmrgen.ir.ops.analysis import Fact

Monomial = tuple[tuple[int, int], ...]  # ((builder's node, power), ...) by node
Form = dict[Monomial, Exact]  # a sum of monomials with non-zero coefficients


# ---- geometry


def geometry_only(function: Function) -> list[bool]:
    """For every node whether it depends on constants, geometry and prepared inputs alone."""
    names = {port.name for port in function.inputs if port.role in (Role.GEOMETRY, Role.PREPARED)}
    early: list[bool] = []
    for node in function.nodes:
        early.append(node.name in names if node.op is Op.INPUT else all(early[arg] for arg in node.args))
    return early


def times(a: Monomial, b: Monomial, power: int = 1) -> Monomial:
    """a * b**power."""
    if not b:
        return a
    powers = dict(a)
    for atom, n in b:
        powers[atom] = powers.get(atom, 0) + n * power
    return tuple(sorted((atom, n) for atom, n in powers.items() if n))


def accumulate(form: Form, monomial: Monomial, value: Exact) -> None:
    """form += value * monomial."""
    total = form.get(monomial, ZERO) + value
    if total:
        form[monomial] = total
    else:
        form.pop(monomial, None)


class Scalars:
    """The geometry-only nodes of a function as canonical sums of monomials."""

    __slots__ = ("_builder", "_forms", "_function")

    def __init__(self, function: Function, builder: Builder, early: list[bool]) -> None:
        self._function, self._builder = function, builder
        self._forms: dict[int, Form] = {}
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
            (p, a), (q, b) = self.single(args[0]), self.single(args[1])
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
        """Node ``i`` of the function, geometry-only, as a sum of monomials."""
        return self._forms[i]

    def single(self, form: Form) -> tuple[Exact, Monomial]:
        """``form`` as one constant times one monomial; a sum becomes an atom of its own."""
        if not form:
            return ZERO, ()
        items = sorted(form.items(), key=lambda item: (not item[0], item[0]))
        monomial, lead = items[0]
        if len(items) == 1:
            return lead, monomial
        ratio = lead.inverse()
        total = self._builder.sum(self._scaled(value * ratio, m) for m, value in items)
        return lead, ((total, 1),)

    def coefficient(self, form: Form) -> Coefficient:
        """``form`` as a coefficient of a linear map."""
        value, monomial = self.single(form)
        return Coefficient(value, monomial or None)

    def node_of(self, form: Form) -> int:
        """The builder's node of ``form``."""
        return self._scaled(*self.single(form))

    def scale(self, coefficient: Coefficient, node: int) -> int:
        """coefficient * node, the coefficient computed apart from the node."""
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


# ---- ranges


@dataclass(frozen=True, slots=True)
class Finding:
    """An operation that is not shown to be defined. ``geometry``: it depends on the parameters alone."""

    function: str
    node: int
    what: str
    geometry: bool

    def __str__(self) -> str:
        return f"{self.function}, node {self.node}: {self.what}"


def findings(function: Function) -> tuple[Finding, ...]:
    """Every operation of ``function`` that is not shown to be defined: divisions and square roots, say."""
    early, ranges = geometry_only(function), facts(function)
    undefined: list[Finding] = []
    for i, node in enumerate(function.nodes):
        if node.op.needs is not None:
            position, needed, what = node.op.needs
            argument = node.args[position]
            if not getattr(ranges[argument], needed):
                undefined.append(Finding(function.name, i, what, early[argument]))
    return tuple(undefined)


def facts(function: Function) -> list[Fact]:
    """A fact for every node, in list order."""
    before: list[Fact] = []
    for node in function.nodes:
        if node.value is not None:
            before.append(Fact.between(node.value, node.value))
            continue
        op, args = node.meaning
        below = [before[arg] for arg in args]
        if op is Op.SELECT:
            below[2:] = (_chosen(before, node, branch) for branch in (2, 3))
        before.append(op.fact(*below))
    return before


def _chosen(before: list[Fact], node: Node, branch: int) -> Fact:
    """The fact of a branch of a select, knowing how the comparison went there."""
    small, large = (node.args[0], node.args[1]) if branch == 2 else (node.args[1], node.args[0])
    value, strict = node.args[branch], branch == 2
    fact, below, above = before[value], before[small], before[large]
    if value == large and below.lo is not None:  # value > small or value >= small
        lo = below.lo if fact.lo is None else max(fact.lo, below.lo)
        return Fact.between(lo, fact.hi, fact.away, fact.nonzero or (strict and below.lo >= 0))
    if value == small and above.hi is not None:
        hi = above.hi if fact.hi is None else min(fact.hi, above.hi)
        return Fact.between(fact.lo, hi, fact.away, fact.nonzero or (strict and above.hi <= 0))
    return fact
