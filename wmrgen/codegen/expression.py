"""From the node list to statements of a target language with infix operators.

An expression tree fixes every rounding: a compiler may choose the order of independent operations,
never their grouping. So a value used once is printed in place, and the arithmetic is still that of
the IR, node by node.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import count as counting
from typing import NamedTuple

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import hand_through, inlined_calls
from wmrgen.ir.kernels import with_kernels
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Cost, Function, Module, Node, count
from wmrgen.ir.ops import Conditional, Op

_LONGEST = 44  # characters of an expression printed in place
_LONGEST_ARM = 56  # the same where it is computed only if it is chosen
_FORMULA = 60  # characters of what a prepared number is, for readers
_CHOICE, _SUM, _PRODUCT, _UNARY, _ATOM = range(5)
_BINDING = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}


class Style(NamedTuple):
    """How a language writes what is not infix arithmetic.

    ``literal`` prints a constant as an atom (negative ones in parentheses). ``form`` is the format of an operation
    over the arguments by position; a `Conditional` always gets a statement of its own.
    ``declare`` is the statement that names value ``{0}`` to be ``{1}``, ``temporary`` that name. ``grouped``: no
    reader has to know which operator binds tighter (MISRA C:2012 rule 12.1). ``declare`` has the type as ``{2}``.
    ``named``: what an intermediate result of the formula is called.
    """

    literal: Callable[[Exact], str]
    form: Callable[[Op], str]
    declare: str
    temporary: str
    grouped: bool = False
    scalar: str = ""
    named: Callable[[str], str] = str


def variables(function: Function, keeps: Callable[[str], bool]) -> dict[str, str]:
    """Contract name -> variable of each input: ``_`` for the dot, and appended where the name is taken or the language
    ``keeps`` it."""
    names: dict[str, str] = {}
    # Names without a dot come first: a parameter keeps its own where a wheel's port would clash with it.
    for port in sorted(function.inputs, key=lambda port: "." in port.name):
        name = port.name.replace(".", "_")
        while name in names.values() or keeps(name):
            name += "_"
        names[port.name] = name
    return {port.name: names[port.name] for port in function.inputs}


def expanded(module: Module, choice: Choice) -> tuple[Module, dict[str, Cost]]:
    """``module`` as the processor of ``choice`` computes it, with a `prepare` that hands raw values through; and how
    many operations the formula of each function takes."""
    module = hand_through(module)
    costs = {f.name: count(f) for f in inlined_calls(module).every}
    return with_kernels(module, choice.scalar, choice.math, choice.target), costs


class Results(NamedTuple):
    """What the calls of a kernel look like: its ``function``, the ``type`` of what that returns, and its members."""

    function: str
    type: str
    members: tuple[str, ...]


# Types of results; a kernel with others has one that is called as it is.
_TYPES: dict[tuple[str, ...], str] = {("x", "y"): "vector", ("spin", "steer"): "wheel"}


def results_of(
    kernels: Iterable[Function], scalar: str, type_name: Callable[[str], str]
) -> dict[str, Results]:
    """How the results of each kernel are called; ``type_name``: of a type, as the language has it."""
    results = {}
    for kernel in kernels:
        members = tuple(port.name for port in kernel.outputs)
        several = type_name(_TYPES.get(members, f"{kernel.name}_result"))
        results[kernel.name] = Results(
            f"wmrgen_{kernel.name}", scalar if len(members) == 1 else several, members
        )
    return results


class Body(NamedTuple):
    """Statements that name temporaries, one expression per output, and which operations are used."""

    statements: tuple[str, ...]
    results: tuple[str, ...]
    ops: frozenset[Op]


class _Text(NamedTuple):
    text: str
    binding: int

    def within(self, binding: int) -> str:
        return self.text if self.binding >= binding else f"({self.text})"


def _uses(function: Function, style: Style) -> list[int]:
    """How often each value is printed; a choice may print an argument twice."""
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
    """Each node as one sum or product of the inputs, for readers: without what keeps divisors off zero. "" for what
    is longer and for what is none."""
    style = Style(lambda value: f"{float(value):.6g}", lambda _: "", "", "")
    texts: list[_Text | None] = []
    for node in function.nodes:
        args, text = [shown for a in node.args if (shown := texts[a])], None
        if node.value is not None:
            text = _Text(style.literal(node.value), _ATOM)
        elif node.op is Op.INPUT:
            text = _Text(node.name or "", _ATOM)
        elif len(args) == len(node.args) and node.op is Op.AT_LEAST:
            text = args[0]
        elif len(args) == len(node.args) and node.op.infix:
            text = _quotient(node, args) or _expression(node, args, style)
        texts.append(text if text and len(text.text) <= _FORMULA else None)
    return tuple(text.text if text else "" for text in texts)


def _quotient(node: Node, args: list[_Text]) -> _Text | None:
    """a / b for a * (1 / b)."""
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
    # The right operand keeps its parentheses at equal binding, a - (b + c), and round a sign, a - (-b).
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
    """Statements, node by node; see `body`."""

    function: Function
    access: Callable[[str], str]
    style: Style
    notes: Mapping[int, str]
    kernels: Mapping[str, Results]
    names: Mapping[int, str]
    apart: Collection[int]
    reserved: Collection[str]
    numbers: Iterator[int]  # of temporaries
    statements: list[str]
    texts: list[_Text]

    def run(self) -> Body:
        """All nodes."""
        nodes, uses = self.function.nodes, _uses(self.function, self.style)
        choices = {a for node in nodes if node.op is Op.SELECT for a in node.args[2:]}
        for index in range(len(nodes)):
            self.texts.append(self._print(index, uses[index], index in choices))
        results = tuple(self.texts[r].text for r in self.function.results)
        return Body(tuple(self.statements), results, frozenset(node.op for node in nodes))

    def _print(self, index: int, uses: int, chosen: bool) -> _Text:
        """The value of a node, and before it the statements that it takes."""
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
        call = self.function.nodes[node.args[0]]
        member = self.kernels[call.name or ""].members[int(node.name or 0)]
        return _Text(f"{self.texts[node.args[0]].text}.{member}", _ATOM)

    def _named(self, index: int, text: str, kind: str) -> str:
        name, note = self.names.get(index) or self._temporary(), self.notes.get(index)
        statement = self.style.declare.format(name, text, kind)
        self.statements.append(f"{statement} {note}" if note else statement)
        return name

    def _temporary(self) -> str:
        names = map(self.style.temporary.format, self.numbers)
        return next(name for name in names if name not in self.reserved)


def _names(function: Function, style: Style, reserved: Collection[str]) -> dict[int, str]:
    """What nodes are called: as the formula calls them; what a kernel gives for one wheel, as the wheel; an output as
    its port, and the square of what has a name as that."""
    nodes, plain, used = function.nodes, dict[int, str](), set(reserved)

    def call(k: int, name: str) -> None:
        own = style.named(name)
        if k not in plain and own not in used:
            plain[k] = name
            used.add(own)

    for each in function.named:
        call(each.node, each.name)
    several = {node.args[0] for node in nodes if node.op is Op.RESULT}
    for k in sorted(several):
        near = {a: nodes[a] for a in nodes[k].args}
        # The present angle of a wheel with limits is kept within them before.
        near |= {b: nodes[b] for node in [*near.values()] for b in node.args}
        inputs = [(n.name or "").partition(".") for n in near.values() if n.op is Op.INPUT]
        owners = {owner for owner, dot, _ in inputs if dot}
        owners = owners or {plain[a] for a in near if a in several and a in plain}
        if len(owners) == 1:
            (wheel,) = owners
            call(k, wheel)
            call(k, f"{wheel}_{(nodes[k].name or '').removesuffix('_at')}")
    for port, k in zip(function.outputs, function.results, strict=True):
        if nodes[k].args and nodes[k].op is not Op.RESULT:
            call(k, port.name.replace(".", "_"))
    for k, node in enumerate(nodes):
        if node.op is Op.MUL and node.args[0] == node.args[1] and node.args[0] in plain:
            call(k, f"{plain[node.args[0]]}_squared")
    return {k: style.named(name) for k, name in plain.items()}


def body(
    function: Function,
    access: Callable[[str], str],
    style: Style,
    notes: Mapping[int, str] | None = None,
    kernels: Mapping[str, Results] | None = None,
    apart: Collection[int] = (),
    reserved: Collection[str] = (),
) -> Body:
    """``function`` (pruned) in ``style``; ``access`` prints the reading of an input by contract name.

    ``notes``: node -> finished comment, printed behind the statement that names the node. ``kernels``: what may be
    called, by name. ``apart``: nodes that have a statement of their own, also where they are needed once.
    ``reserved``: names that none of its own may have.
    """
    names = _names(function, style, reserved)
    reserved = {*names.values(), *reserved}
    return _Printer(
        function, access, style, notes or {}, kernels or {}, names, apart, reserved, counting(), [], []
    ).run()
