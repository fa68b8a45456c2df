"""Statements of a language with infix operators from the nodes of a function.

A value that is used once is printed in place. The arithmetic is still that of the nodes: an expression fixes how
operations are grouped, and a compiler may only choose the order of independent operations.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import count as counting
from typing import NamedTuple

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import inlined_calls, pass_geometry_through_prepare
from wmrgen.ir.kernels import with_kernels
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Cost, Function, Module, Node, count
from wmrgen.ir.ops import Conditional, Op

_LONGEST = 44  # characters of an expression that is printed in place; a longer one gets a name
_LONGEST_ARM = 56  # the same for an arm of a choice, which a name would compute even if it is not chosen
_CHOICE, _SUM, _PRODUCT, _UNARY, _ATOM = range(5)
_BINDING = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}


class Style(NamedTuple):
    """How a language writes literals, names, and operations without an infix operator."""

    literal: Callable[[Exact], str]  # prints a constant; a negative one in parentheses
    # Format of an operation, with its arguments by position; a `Conditional` gets a statement.
    form: Callable[[Op], str]
    declare: str  # format of a statement: {0} name, {1} value, {2} type
    temporary: str  # format of the name of an unnamed value
    grouped: bool = False  # whether parentheses show which operator binds tighter (MISRA C:2012 rule 12.1)
    scalar: str = ""  # the type of numbers
    named: Callable[[str], str] = str  # returns the name of an intermediate result of the formula


def variables(function: Function, keeps: Callable[[str], bool]) -> dict[str, str]:
    """Return the variable of each input by contract name.

    ``_`` replaces the dot, and is appended if the name is taken or if the language ``keeps`` it as a reserved word.
    """
    names: dict[str, str] = {}
    # Names without a dot come first, so that a parameter keeps its name if a wheel's port would clash with it.
    for port in sorted(function.inputs, key=lambda port: "." in port.name):
        name = port.name.replace(".", "_")
        while name in names.values() or keeps(name):
            name += "_"
        names[port.name] = name
    return {port.name: names[port.name] for port in function.inputs}


def expanded(module: Module, choice: Choice) -> tuple[Module, dict[str, Cost]]:
    """Return the functions as the processor of ``choice`` computes them, and the operations of each formula.

    `prepare` also passes through those parameters that functions read directly.
    """
    module = pass_geometry_through_prepare(module)
    costs = {f.name: count(f) for f in inlined_calls(module).every}
    return with_kernels(module, choice.scalar, choice.math, choice.target), costs


class Results(NamedTuple):
    """The results of a kernel, for calls of it."""

    function: str  # name of the kernel in the language
    type: str  # of what it returns
    members: tuple[str, ...]  # of this type, if there are several


# Types of results by their members. Other results have a type that is named after the kernel.
_TYPES: dict[tuple[str, ...], str] = {("x", "y"): "vector", ("spin", "steer"): "wheel"}


def results_of(
    kernels: Iterable[Function], scalar: str, type_name: Callable[[str], str]
) -> dict[str, Results]:
    """Return the results of each kernel by its name.

    Args:
        kernels: The kernels.
        scalar: The type of numbers.
        type_name: Returns the name of a type in the language.
    """
    results = {}
    for kernel in kernels:
        members = tuple(port.name for port in kernel.outputs)
        several = type_name(_TYPES.get(members, f"{kernel.name}_result"))
        results[kernel.name] = Results(
            f"wmrgen_{kernel.name}", scalar if len(members) == 1 else several, members
        )
    return results


class Body(NamedTuple):
    """A function as text."""

    statements: tuple[str, ...]  # that name intermediate values
    results: tuple[str, ...]  # an expression for each output
    ops: frozenset[Op]  # operations that are used


class _Text(NamedTuple):
    """An expression, and how tightly its outermost operator binds."""

    text: str
    binding: int

    def within(self, binding: int) -> str:
        """Return the expression as an operand, in parentheses if it binds less than ``binding``."""
        return self.text if self.binding >= binding else f"({self.text})"


def _uses(function: Function, style: Style) -> list[int]:
    """Return how often each value is printed; a choice may print an argument twice."""
    uses = [0] * len(function.nodes)
    for index in function.results:
        uses[index] += 1
    for node in function.nodes:
        form = style.form(node.op) if node.op.exact and not node.op.infix else ""
        for position, argument in enumerate(node.args):
            times = form.count(f"{{{position}}}") if isinstance(form, Conditional) else 1
            uses[argument] += max(1, times)
    return uses


def written_out(function: Function) -> tuple[str, ...]:
    """Return each node as a formula of the inputs for comments, without the guards of divisors.

    A node gets "" if its formula is too long, or has other operations than sums, products and quotients.
    """
    style = Style(lambda value: f"{float(value):.6g}", lambda _: "", "", "")
    texts: list[_Text | None] = []
    for node in function.nodes:
        args = [shown for shown in map(texts.__getitem__, node.args) if shown]
        text = None
        if node.value is not None:
            text = _Text(style.literal(node.value), _ATOM)
        elif node.op is Op.INPUT:
            text = _Text(node.name or "", _ATOM)
        elif len(args) == len(node.args) and node.op is Op.AT_LEAST:
            text = args[0]
        elif len(args) == len(node.args) and node.op.infix:
            text = _quotient(node, args) or _expression(node, args, style)
        texts.append(text if text and len(text.text) <= 60 else None)  # so that it fits into a comment
    return tuple(text.text if text else "" for text in texts)


def _quotient(node: Node, args: list[_Text]) -> _Text | None:
    """Return a / b for a product a * (1 / b), otherwise None."""
    if node.op is not Op.MUL:
        return None
    for one, other in (args[::-1], args):
        if one.text.startswith("1 / "):
            return _Text(f"{other.within(_PRODUCT)} / {one.text.removeprefix('1 / ')}", _PRODUCT)
    return None


def _infix(op: Op, left: _Text, right: _Text, grouped: bool) -> _Text:
    sign, binding = op.infix, _BINDING[op.infix]
    if grouped and left.binding != binding:
        left = _Text(left.within(_ATOM), _ATOM)
    if grouped:
        right = _Text(right.within(_ATOM), _ATOM)
    # The right operand has parentheses if it binds equally, a - (b + c), and if it has a sign, a - (-b).
    bare = right.binding > binding and right.binding != _UNARY
    return _Text(f"{left.within(binding)} {sign} {right.text if bare else right.within(_ATOM)}", binding)


def _expression(node: Node, args: list[_Text], style: Style) -> _Text:
    if node.op.infix and len(args) == 1:
        return _Text(node.op.infix + args[0].within(_ATOM), _UNARY)
    if node.op.infix:
        return _infix(node.op, args[0], args[1], style.grouped)
    form = style.form(node.op)
    if not isinstance(form, Conditional):
        return _Text(form.format(*(argument.text for argument in args)), _ATOM)
    texts = [argument.within(_UNARY) if style.grouped else argument.text for argument in args]
    return _Text(form.format(*texts), _CHOICE)


class _Printer(NamedTuple):
    """Prints a function node by node; for most fields see `body`."""

    function: Function
    access: Callable[[str], str]
    style: Style
    notes: Mapping[int, str]
    kernels: Mapping[str, Results]
    names: Mapping[int, str]  # node -> name
    apart: Collection[int]
    reserved: Collection[str]
    numbers: Iterator[int]  # of unnamed values
    statements: list[str]  # printed so far
    texts: list[_Text]  # of the nodes so far

    def run(self) -> Body:
        """Print all nodes."""
        nodes, uses = self.function.nodes, _uses(self.function, self.style)
        choices = {a for node in nodes if node.op is Op.SELECT for a in node.args[2:]}
        for index in range(len(nodes)):
            self.texts.append(self._print(index, uses[index], index in choices))
        results = tuple(self.texts[r].text for r in self.function.results)
        return Body(tuple(self.statements), results, frozenset(node.op for node in nodes))

    def _print(self, index: int, uses: int, chosen: bool) -> _Text:
        """Return the value of a node, after adding the statements that it needs."""
        node, style = self.function.nodes[index], self.style
        if node.value is not None:
            return _Text(style.literal(node.value), _ATOM)
        if node.op is Op.INPUT:
            return _Text(self.access(node.name or ""), _ATOM)
        if node.op is Op.RESULT:
            return self._part(node)
        args, kind, apart = [self.texts[a] for a in node.args], style.scalar, index in self.apart
        if node.op is Op.CALL:
            own = self.kernels[node.name or ""]
            text = _Text(f"{own.function}({', '.join(argument.text for argument in args)})", _ATOM)
            kind, apart = own.type, apart or len(own.members) > 1
        else:
            text = _expression(node, args, style)
        longest = _LONGEST_ARM if chosen else _LONGEST
        if apart or uses > 1 or text.binding == _CHOICE or len(text.text) > longest:
            return _Text(self._named(index, text.text, kind), _ATOM)
        return text

    def _part(self, node: Node) -> _Text:
        """Return one of several results of a call."""
        call = self.function.nodes[node.args[0]]
        member = self.kernels[call.name or ""].members[int(node.name or 0)]
        return _Text(f"{self.texts[node.args[0]].text}.{member}", _ATOM)

    def _named(self, index: int, text: str, kind: str) -> str:
        """Add a statement that names a value, and return the name."""
        name, note = self.names.get(index) or self._temporary(), self.notes.get(index)
        statement = self.style.declare.format(name, text, kind)
        self.statements.append(f"{statement} {note}" if note else statement)
        return name

    def _temporary(self) -> str:
        names = map(self.style.temporary.format, self.numbers)
        return next(name for name in names if name not in self.reserved)


class _Names:
    """Names of nodes; the first name that a node gets is kept, and no two nodes have the same."""

    def __init__(self, style: Style, reserved: Collection[str]) -> None:
        self.plain: dict[int, str] = {}  # node -> name before `Style.named`
        self._style, self._used = style, set(reserved)

    def add(self, node: int, name: str) -> None:
        own = self._style.named(name)
        if node not in self.plain and own not in self._used:
            self.plain[node] = name
            self._used.add(own)

    def finished(self) -> dict[int, str]:
        return {node: self._style.named(name) for node, name in self.plain.items()}


def _names(function: Function, style: Style, reserved: Collection[str]) -> dict[int, str]:
    """Return names for nodes, in this order of preference.

    The name of the formula; for several results of a kernel, the wheel whose inputs the kernel takes; the name of an
    output; for the square of a named value, its name with ``_squared``.
    """
    nodes, names = function.nodes, _Names(style, reserved)
    for each in function.named:
        names.add(each.node, each.name)
    several = {
        node.args[0] for node in nodes if node.op is Op.RESULT
    }  # calls of kernels with several results
    for k in sorted(several):
        owners = _owners(function, k, several, names.plain)
        if len(owners) == 1:
            (wheel,) = owners
            names.add(k, wheel)
            names.add(k, f"{wheel}_{(nodes[k].name or '').removesuffix('_at')}")
    for port, k in zip(function.outputs, function.results, strict=True):
        if nodes[k].args and nodes[k].op is not Op.RESULT:
            names.add(k, port.name.replace(".", "_"))
    for k, node in enumerate(nodes):
        if node.op is Op.MUL and node.args[0] == node.args[1] and node.args[0] in names.plain:
            names.add(k, f"{names.plain[node.args[0]]}_squared")
    return names.finished()


def _owners(function: Function, call: int, several: Collection[int], names: Mapping[int, str]) -> set[str]:
    """Return the wheels whose inputs a call takes, or the names of the calls whose results it takes."""
    nodes = function.nodes
    near = {a: nodes[a] for a in nodes[call].args}
    # The present angle of a wheel with limits is an argument of an argument, which clamps it.
    near |= {b: nodes[b] for node in [*near.values()] for b in node.args}
    inputs = [(n.name or "").partition(".") for n in near.values() if n.op is Op.INPUT]
    wheels = {wheel for wheel, dot, _ in inputs if dot}
    return wheels or {names[a] for a in near if a in several and a in names}


def body(
    function: Function,
    access: Callable[[str], str],
    style: Style,
    notes: Mapping[int, str] | None = None,
    kernels: Mapping[str, Results] | None = None,
    apart: Collection[int] = (),
    reserved: Collection[str] = (),
) -> Body:
    """Return a function as statements and expressions.

    Args:
        function: The function, without nodes that no result needs.
        access: Returns the text that reads an input, by contract name.
        style: How the language writes literals, names and operations.
        notes: Node -> finished comment after the statement that names the node.
        kernels: Kernels that may be called, by name.
        apart: Nodes that get a statement even if they are used once.
        reserved: Names that must not be given to values.
    """
    names = _names(function, style, reserved)
    reserved = {*names.values(), *reserved}
    return _Printer(
        function, access, style, notes or {}, kernels or {}, names, apart, reserved, counting(), [], []
    ).run()
