"""Parse the expressions of robot files with Python's grammar. They are never evaluated.

Each token is checked before Python's parser sees the text. The parser gets at most 200 characters of numbers, known
names, operators and parentheses.
"""

from __future__ import annotations

import ast
import contextlib
import re
from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction

from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.names import parameter_name
from wmrgen.robotfile.numbers import NUMBER, UNITS, number
from wmrgen.robotfile.records import Binary, Call, Expr, Neg, Num, Param, Pi
from wmrgen.robotfile.text import Scalar, nearest, quoted, suggestion

MAX_CHARACTERS = 200  # of an expression; longer ones belong in parameters
MAX_NODES = 128  # of the tree; bounds the recursion over it
MAX_POWER = 4  # of **; higher powers do not occur in kinematics, and the exact result would grow
ARITY = {"sqrt": 1, "sin": 1, "cos": 1, "tan": 1, "atan2": 2}

_TOKEN = re.compile(
    rf"(?P<number>{NUMBER})|(?P<name>[A-Za-z_πΠ][A-Za-z0-9_π]*)"
    r"|(?P<operator>\*\*|[-+*/(),])|(?P<space>[ \t]+)"
)
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}
_GRAMMAR = "An expression has numbers, parameters, pi, + - * / ** ( ) sqrt sin cos tan atan2."
_BOTH_ENDS = "Write both ends, such as [-35 deg, 35 deg]."
_FUNCTION_ALIASES = {
    **dict.fromkeys(("atan", "arctan", "arctan2"), "Write atan2(y, x)."),
    **dict.fromkeys(("asin", "acos", "arcsin", "arccos"), "Write the angle with atan2(y, x)."),
    **dict.fromkeys(("radians", "deg2rad", "degreestoradians"), "Write 45 deg, or a*pi/180."),
    **dict.fromkeys(("inches", "inchestometers"), "Write a number and its unit: 2 in."),
}


class UndeclaredParameter(RobotFileError):
    """A name in an expression that is not declared under ``parameters``."""


def parse_expression(node: Scalar, names: Collection[str], instead: str = "") -> Expr:
    """Return the tree of an expression.

    Args:
        node: The expression.
        names: The parameters that it may use.
        instead: What to write in place of a name that is no parameter; by default, to declare it.

    Raises:
        RobotFileError: The expression is invalid.
    """
    if len(node.text) > MAX_CHARACTERS:
        raise node.error(
            f"an expression of {len(node.text)} characters",
            f"At most {MAX_CHARACTERS} are allowed.",
            "Split it over several parameters.",
        )
    return _Parser(node, names, instead).tree()


class _Parser:
    """Parses one expression: checks its tokens, builds a Python text of them, and converts Python's tree."""

    def __init__(self, node: Scalar, names: Collection[str], instead: str) -> None:
        self._node = node
        self._names = names
        self._instead = instead
        self._numbers: dict[int, str] = {}  # column in the Python text -> number as written
        self._columns: dict[int, int] = {}  # column in the Python text -> offset in the node
        self._text = ""
        self._scan()

    def _error(self, what: str, why: str = "", instead: str = "", offset: int = 0) -> RobotFileError:
        return self._node.error(what, why, instead, offset)

    def _scan(self) -> None:
        """Check the tokens and write them to the Python text."""
        text = self._node.text
        position = len(text) - len(text.lstrip())
        end, before = len(text.rstrip()), ""
        while position < end:
            token = _TOKEN.match(text, position, end)
            if not token:
                raise self._stray(position)
            if token.lastgroup != "space":
                word = token.group()
                after = text[token.end() : end].lstrip(" \t")[:1]
                self._columns[len(self._text)] = position
                self._text += self._checked(word, str(token.lastgroup), before, after, position)
                before = word
            position = token.end()

    def _stray(self, position: int) -> RobotFileError:
        """Return the error for a character that no expression has."""
        character = self._node.text[position]
        what = f"{quoted(character)} is not allowed in an expression"
        special = {
            "^": "Write ** for powers.",
            "%": "Write the number itself.",
            "°": "Write deg after a plain number.",
            "#": "Write a space before # for a comment.",
            "'": "Write ft for feet.",
            "±": _BOTH_ENDS,
            "=": "Write the value alone.",
            "√": "Write sqrt(…).",
            ";": "Delete it.",
            **dict.fromkeys("−–—", "Write the hyphen-minus '-' of the keyboard."),
            **dict.fromkeys("·×", "Write *."),
            "\n": "Keep the expression on one line.",
            "²": "Write **2.",
            "³": "Write **3.",
        }
        return self._error(what, _GRAMMAR, special.get(character, ""), position)

    def _checked(self, word: str, kind: str, before: str, after: str, at: int) -> str:
        """Return a token as Python text.

        Args:
            word: The token.
            kind: Its group in _TOKEN.
            before: The token before it.
            after: The character after it.
            at: Its offset in the node.

        Raises:
            RobotFileError: The token is not allowed here.
        """
        if before and kind != "operator" and (before[-1].isalnum() or before[-1] in "._)"):
            raise self._juxtaposed(before, word, at)
        if kind == "number":
            number(word, self._node, at)
            self._numbers[len(self._text)] = word
            return word
        if kind == "name":
            return self._name("pi" if word in ("π", "Π") else word, after == "(", at)
        if word == before == "/":
            raise self._error("'//' is not allowed in an expression", _GRAMMAR, "Write / for a quotient.", at)
        if word == "(" and before and (before[-1] == ")" or before[0] in "0123456789."):
            raise self._juxtaposed(before, word, at)
        return word

    def _juxtaposed(self, before: str, word: str, at: int) -> RobotFileError:
        """Return the error for two values without an operator between them."""
        text, why = self._node.text, ""
        rest = text[at + len(word) :].strip()
        if word in UNITS and rest[:1].isalpha():
            at = text.rindex(rest)
            what = f"{quoted(rest.split()[0])} after the unit {quoted(word)}"
            instead = "Write only the number and its unit; a comment begins with #."
        elif word in UNITS:
            both = text.lstrip().startswith(("+-", "+/-"))
            what = f"the unit {quoted(word)} after an expression"
            why = "A unit can only follow a number."
            instead = "Declare each number with its unit as a parameter, and use the parameters here."
            if both:
                instead = _BOTH_ENDS
        else:
            what = f"missing operator between {quoted(before)} and {quoted(word)}"
            instead = "Write *."
            if word[0] == ".":
                instead = "Write one decimal point; a range is [low, high]."
        return self._error(what, why, instead, at)

    def _name(self, word: str, called: bool, at: int) -> str:
        """Return a name if it is a parameter, pi or, if it is ``called``, a function; raise RobotFileError if not."""
        if self._node.text[at + len(word) :].startswith("."):
            instead = "Write only the part after the dot, such as pi or sqrt(2)."
            raise self._error(f"{quoted(word + '.')} is not allowed in an expression", _GRAMMAR, instead, at)
        if called:
            if word in ARITY:
                return word
            instead = suggestion(word, ARITY, _FUNCTION_ALIASES)
            if word in self._names or word == "pi":
                raise self._error(f"{quoted(word)} is a value, not a function", "", f"Write {word}*(…).", at)
            raise self._error(f"{quoted(word)} is not a function", _GRAMMAR, instead, at)
        if word == "pi" or word in self._names:
            return word
        if word in ARITY:
            raise self._error(f"the function {word} needs its argument", "", f"Write {word}(…).", at)
        near, instead = nearest(word, [*self._names, "pi"]), "Write the number."
        with contextlib.suppress(RobotFileError):
            parameter_name(replace(self._node, text=word))
            instead = (
                f"Write the number, or declare the name with its value, such as parameters: {{{word}: 0.1}}."
            )
        raise UndeclaredParameter(
            f"{quoted(word)} is not a declared parameter",
            self._node.mark_at(at),
            "A name in an expression is pi, or is declared under parameters:.",
            f"Did you mean {near}?" if near else self._instead or instead,
            Code.UNDECLARED,
        )

    def tree(self) -> Expr:
        """Return the tree of the expression."""
        try:
            body = ast.parse(self._text, mode="eval").body
        except SyntaxError as error:
            column = min(max((error.offset or 1) - 1, 0), len(self._text))
            opened = self._text.count("(") - self._text.count(")")
            last = re.search(r"[-+*/]+$", self._text)
            hint = f"Write the value after {last[0]}, or delete it." if last else ""
            hint = f"Write the missing '{')' if opened > 0 else '('}'." if opened else hint
            what = f"{quoted(self._node.text)} is not a complete expression"
            raise self._error(what, _GRAMMAR, hint, self._offset(column)) from None
        except (ValueError, MemoryError, RecursionError):
            what = f"{quoted(self._node.text)} is nested too deeply"
            raise self._error(what, "", "Split it over several parameters.") from None
        if sum(isinstance(n, ast.expr) for n in ast.walk(body)) > MAX_NODES:
            what = f"an expression of more than {MAX_NODES} parts"
            raise self._error(what, "", "Split it over several parameters.")
        return self._convert(body)

    def _offset(self, column: int) -> int:
        """Return the offset in the node of a column of the Python text."""
        starts = [start for start in self._columns if start <= column]
        return self._columns[max(starts)] if starts else 0

    def _convert(self, node: ast.expr) -> Expr:
        """Return the tree of a node of Python's tree."""
        match node:
            case ast.Constant():
                return Num(number(self._numbers[node.col_offset], self._node))
            case ast.Name(id=name):
                return Pi() if name == "pi" else Param(name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return Neg(self._convert(operand))
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self._convert(operand)
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                return Binary("**", self._convert(left), self._power(right))
            case ast.BinOp(op=op, left=left, right=right) if type(op) in _OPERATORS:
                return Binary(_OPERATORS[type(op)], self._convert(left), self._convert(right))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self._call(node, name, args)
        if isinstance(node, ast.Tuple) and node.elts:
            what = f"{quoted(self._node.text)} is {len(node.elts)} values in place of one"
            raise self._error(what, "", "Delete the comma and the other value.")
        raise self._error("not an expression", _GRAMMAR, "", self._offset(node.col_offset))

    def _power(self, node: ast.expr) -> Num:
        """Return an exponent; raise RobotFileError if it is not a whole number from -MAX_POWER to MAX_POWER."""
        value: Fraction | None = None
        match node:
            case ast.Constant():
                value = number(self._numbers[node.col_offset], self._node)
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant() as operand):
                value = -number(self._numbers[operand.col_offset], self._node)
        if value is None or value.denominator != 1 or abs(value) > MAX_POWER:
            raise self._error(
                "the exponent is not a whole number from -4 to 4",
                "Larger powers would take too long to compute exactly.",
                "Write sqrt(…) for a root, or multiply out.",
                self._offset(node.col_offset),
            )
        return Num(value)

    def _call(self, node: ast.expr, name: str, args: list[ast.expr]) -> Expr:
        """Return a call; raise RobotFileError for a wrong number of arguments."""
        if len(args) != ARITY[name]:
            form = "atan2(y, x)" if name == "atan2" else f"{name}(…)"
            what = f"{name} takes {ARITY[name]} argument{'s' * (ARITY[name] > 1)}, not {len(args)}"
            raise self._error(what, "", f"Write {form}.", self._offset(node.col_offset))
        return Call(name, tuple(self._convert(a) for a in args))
