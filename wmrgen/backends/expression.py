"""From the node list to statements of a target language with infix operators.

An expression tree fixes every rounding: a compiler may choose the order of independent operations,
never their grouping. So a value used once is printed in place, and the arithmetic is still that of
the IR, node by node.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op

_LONGEST = 44  # characters of an expression printed in place
_LONGEST_ARM = 56  # the same where it is computed only if it is chosen
_CHOICE, _SUM, _PRODUCT, _UNARY, _ATOM = range(5)
_INFIX = {Op.ADD: ("+", _SUM), Op.SUB: ("-", _SUM), Op.MUL: ("*", _PRODUCT), Op.DIV: ("/", _PRODUCT)}


@dataclass(frozen=True, slots=True)
class Style:
    """How a language writes what is not infix arithmetic.

    ``literal`` prints a constant as an atom (negative ones in parentheses). ``calls`` and ``choices`` are
    formats over the arguments by position; a choice always gets a statement of its own.
    ``declare`` is the statement that names value ``{0}`` to be ``{1}``, ``temporary`` that name. ``grouped``: no
    reader has to know which operator binds tighter (MISRA C:2012 rule 12.1). ``local``: statement that declares the
    variable ``{0}``, for a result that a function writes and nothing else has a place for.
    """

    literal: Callable[[Exact], str]
    calls: Mapping[Op, str]
    choices: Mapping[Op, str]
    declare: str
    temporary: str
    grouped: bool = False
    local: str = ""


@dataclass(frozen=True, slots=True)
class Body:
    """Statements that name temporaries, one expression per output, and which operations are used."""

    statements: tuple[str, ...]
    results: tuple[str, ...]
    ops: frozenset[Op]


@dataclass(frozen=True, slots=True)
class _Text:
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
        form = style.choices.get(node.op, "")
        for position, argument in enumerate(node.args):
            uses[argument] += max(1, form.count(f"{{{position}}}"))
    return uses


def _infix(op: Op, left: _Text, right: _Text, grouped: bool) -> _Text:
    sign, binding = _INFIX[op]
    if grouped and left.binding != binding:
        left = _Text(left.within(_ATOM), _ATOM)
    if grouped:
        right = _Text(right.within(_ATOM), _ATOM)
    # The right operand keeps its parentheses at equal binding, a - (b + c), and round a sign, a - (-b).
    bare = right.binding > binding and right.binding != _UNARY
    return _Text(f"{left.within(binding)} {sign} {right.text if bare else right.within(_ATOM)}", binding)


def _expression(node: Node, args: list[_Text], style: Style) -> _Text:
    if node.op in _INFIX:
        return _infix(node.op, args[0], args[1], style.grouped)
    if node.op is Op.NEG:
        return _Text("-" + args[0].within(_ATOM), _UNARY)
    texts = [argument.text for argument in args]
    if node.op in style.choices:
        if style.grouped:
            texts = [argument.within(_UNARY) for argument in args]
        return _Text(style.choices[node.op].format(*texts), _CHOICE)
    if node.op is Op.CALL:
        return _Text(f"{node.name}({', '.join(texts)})", _ATOM)
    return _Text(style.calls[node.op].format(*texts), _ATOM)


class _Printer:
    """Statements, node by node. Results with a place in ``stores`` are written there as soon as they are known."""

    def __init__(
        self,
        function: Function,
        access: Callable[[str], str],
        style: Style,
        notes: Mapping[int, str],
        stores: Sequence[str],
        several: Mapping[str, int],
    ) -> None:
        self.function, self.access, self.style, self.notes = function, access, style, notes
        self.uses = _uses(function, style)
        self.arms = {a for node in function.nodes if node.op is Op.SELECT for a in node.args[2:]}
        self.several = several
        # a place -> the result that will be written there
        self.waiting = dict(zip(stores, function.results, strict=False))
        self.taken: dict[int, dict[int, int]] = {}  # a call -> number of a result -> the node that takes it
        for k, node in enumerate(function.nodes):
            if node.op is Op.PART:
                self.taken.setdefault(node.args[0], {})[int(node.name or 0)] = k
        self.locals: list[str] = []
        self.statements: list[str] = []
        self.count = 0
        self.parts: dict[int, str] = {}
        self.texts: list[_Text] = []

    def run(self) -> None:
        """All nodes."""
        for index in range(len(self.function.nodes)):
            text = self._print(index)
            self.texts.append(text)
            for place in [place for place, result in self.waiting.items() if result == index]:
                del self.waiting[place]
                self.statements.append(f"{place} = {text.text};")

    def _print(self, index: int) -> _Text:
        """The value of a node, and before it the statements that it takes."""
        node, style = self.function.nodes[index], self.style
        if node.value is not None:
            return _Text(style.literal(node.value), _ATOM)
        if node.op is Op.INPUT:
            return _Text(self.access(node.name or ""), _ATOM)
        if node.op is Op.PART:
            return _Text(self.parts[index], _ATOM)
        args = [self.texts[a] for a in node.args]
        if index in self.taken:
            self._call(index, [argument.text for argument in args])
            return _Text("", _ATOM)  # its results have nodes of their own
        text = _expression(node, args, style)
        if self.uses[index] > 1 or text.binding == _CHOICE or len(text.text) > self._longest(index):
            return _Text(self._named(text.text, self.notes.get(index)), _ATOM)
        return text

    def _call(self, index: int, given: list[str]) -> None:
        """A call that writes several results: each where it belongs, or where another will be written later.

        So no call needs memory of its own for them.
        """
        name = self.function.nodes[index].name or ""
        nodes = [self.taken[index].get(n) for n in range(self.several[name])]
        own = {k: place for place, k in self.waiting.items() if k in nodes}
        spare = (place for place in chain(list(self.waiting), self._locals()) if place not in own.values())
        places = [own[k] if k in own else next(spare) for k in nodes]
        self.statements.append(f"{name}({', '.join([*given, *map(_address, places)])});")
        for k, place in zip(nodes, places, strict=True):
            if k is None:
                continue  # needed at other calls only
            if k in own:
                del self.waiting[place]
            used_here = self.uses[k] > (k in own)
            self.parts[k] = (
                self._named(place, None) if used_here else place
            )  # at once: the next call writes there

    def _locals(self) -> Iterator[str]:
        """Variables for what a call writes; the same for every call."""
        for n in count():
            if n == len(self.locals):
                self.locals.append(f"y{n}")
            yield self.locals[n]

    def _longest(self, index: int) -> int:
        return _LONGEST_ARM if index in self.arms else _LONGEST

    def _named(self, text: str, note: str | None) -> str:
        name = self.style.temporary.format(self.count)
        self.count += 1
        self.statements.append(self.style.declare.format(name, text) + (f" {note}" if note else ""))
        return name


def _address(place: str) -> str:
    return place[1:] if place.startswith("*") else f"&{place}"


def body(
    function: Function,
    access: Callable[[str], str],
    style: Style,
    notes: Mapping[int, str] | None = None,
    stores: Sequence[str] = (),
    several: Mapping[str, int] | None = None,
) -> Body:
    """``function`` (pruned) in ``style``; ``access`` prints the reading of an input by contract name.

    ``notes``: node -> finished comment, printed behind the statement that names the node. ``stores``: where each
    result is written as soon as it is known. ``several``: functions that write so many results through pointers.
    """
    printer = _Printer(function, access, style, notes or {}, stores, several or {})
    printer.run()
    ops = frozenset(node.op for node in function.nodes)
    statements = [style.local.format(name) for name in printer.locals] + printer.statements
    return Body(tuple(statements), tuple(printer.texts[r].text for r in function.results), ops)
