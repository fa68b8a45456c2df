"""From the node list to statements of a target language with infix operators.

An expression tree fixes every rounding: a compiler may choose the order of independent operations,
never their grouping. So a value used once is printed in place, and the arithmetic is still that of
the IR, node by node.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

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
    reader has to know which operator binds tighter (MISRA C:2012 rule 12.1). ``holder``: statement that declares the
    variable ``{1}`` for what function ``{0}`` hands back when that is several values, ``held`` its name for a function,
    ``part`` value ``{1}`` of it.
    """

    literal: Callable[[Exact], str]
    calls: Mapping[Op, str]
    choices: Mapping[Op, str]
    declare: str
    temporary: str
    grouped: bool = False
    holder: str = ""
    held: Callable[[str], str] = str
    part: str = ""


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
    """Statements, node by node."""

    def __init__(self, function: Function, style: Style, access: Callable[[str], str]) -> None:
        self.function, self.style, self.access = function, style, access
        self.uses = _uses(function, style)
        self.arms = {a for node in function.nodes if node.op is Op.SELECT for a in node.args[2:]}
        self.several: dict[int, list[int]] = {}  # a call -> the nodes that are one of its results
        for k, node in enumerate(function.nodes):
            if node.op is Op.PART:
                self.several.setdefault(node.args[0], []).append(k)
        names = dict.fromkeys(function.nodes[i].name or "" for i in self.several)
        self.statements = [style.holder.format(name, style.held(name)) for name in names]
        self.count = 0
        self.parts: dict[int, str] = {}
        self.texts: list[_Text] = []

    def print(self, index: int, note: str | None) -> _Text:
        """The value of a node, and before it the statements that it takes."""
        node, style = self.function.nodes[index], self.style
        if node.value is not None:
            return _Text(style.literal(node.value), _ATOM)
        if node.op is Op.INPUT:
            return _Text(self.access(node.name or ""), _ATOM)
        if node.op is Op.PART:
            return _Text(self.parts[index], _ATOM)
        text = _expression(node, [self.texts[a] for a in node.args], style)
        if index in self.several:
            held = style.held(node.name or "")
            self.statements.append(f"{held} = {text.text};")
            # At once: the next call of the same function takes the holder again.
            for k in self.several[index]:
                self.parts[k] = self._named(style.part.format(held, self.function.nodes[k].name), None)
        elif self.uses[index] > 1 or text.binding == _CHOICE or len(text.text) > self._longest(index):
            return _Text(self._named(text.text, note), _ATOM)
        return text

    def _longest(self, index: int) -> int:
        return _LONGEST_ARM if index in self.arms else _LONGEST

    def _named(self, text: str, note: str | None) -> str:
        name = self.style.temporary.format(self.count)
        self.count += 1
        self.statements.append(self.style.declare.format(name, text) + (f" {note}" if note else ""))
        return name


def body(
    function: Function,
    access: Callable[[str], str],
    style: Style,
    notes: Mapping[int, str] | None = None,
    stores: Sequence[str] = (),
) -> Body:
    """``function`` (pruned) in ``style``; ``access`` prints the reading of an input by contract name.

    ``notes``: node -> finished comment, printed behind the statement that names the node. ``stores``: statements that
    hand over the results ``{0}``; with them, each is handed over as soon as it is known.
    """
    printer = _Printer(function, style, access)
    waiting: dict[int, list[str]] = {}
    for result, store in zip(function.results, stores, strict=False):
        waiting.setdefault(result, []).append(store)
    for index in range(len(function.nodes)):
        text = printer.print(index, (notes or {}).get(index))
        printer.texts.append(text)
        printer.statements += [store.format(text.text) for store in waiting.get(index, ())]
    ops = frozenset(node.op for node in function.nodes)
    return Body(tuple(printer.statements), tuple(printer.texts[r].text for r in function.results), ops)
