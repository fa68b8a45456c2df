"""The parts of C text: comments, prototypes, constants and structs.

Comments are printable ASCII, and no text can end a comment or confuse a compiler. Constants are the shortest decimals
that read back exactly. A struct has a member for each scalar, and a nested struct for each wheel.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate, pairwise
from typing import NamedTuple

from wmrgen.codegen.unit import Field, Struct
from wmrgen.codegen.unit import struct as struct_of
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Port
from wmrgen.ir.rounding import constant, nearest_float32, to_float32

WIDTH = 100  # columns of comments, structs and prototypes
STATEMENT = 120  # columns of a statement: expressions are easier to read on one line
NO_TYPES: Mapping[str, str] = {}


def _plain(char: str) -> str:
    """Return ASCII for one character: a Greek letter by its name, an accented letter without its accent."""
    if " " <= char <= "~":
        return char
    name = unicodedata.name(char, "")
    if name.startswith("GREEK "):
        word = name.rsplit(" ", 1)[-1].lower()
        return word.capitalize() if "CAPITAL" in name else word
    folded = unicodedata.normalize("NFKD", char)
    if folded == char:
        return {"–": "-", "—": "-", "−": "-", "×": "x", "·": ".", "’": "'", "°": " deg"}.get(char, "?")
    return "".join(_plain(part) for part in folded if not unicodedata.combining(part))


def comment_text(text: str) -> str:
    """Return ``text`` on one line of ASCII without comment marks, trigraphs or backslashes.

    Doxygen finds no command, tag or link in it.
    """
    plain = " ".join(text.split())
    if not (plain.isascii() and plain.isprintable()):
        plain = "".join(_plain(char) for char in plain)
    plain = plain.replace("\\", "/")
    for pair in ("*/", "/*", "??", "//"):
        while pair in plain:
            plain = plain.replace(pair, f"{pair[0]} {pair[1]}")
    return re.sub(r"(?<!\w)@(?=\S)|<(?=[a-zA-Z/!])|\](?=[(\[])", r"\g<0> ", plain).rstrip()


def comment_lines(text: str, width: int = WIDTH - 3) -> list[str]:
    """Return ``text``, escaped and wrapped for a block comment whose lines begin with `` * ``."""
    return textwrap.wrap(comment_text(text), width, break_on_hyphens=False) or [""]


def block_comment(paragraphs: Sequence[str], indent: str = "", doxygen: bool = False) -> list[str]:
    """Return the lines of a comment.

    Args:
        paragraphs: Text; each paragraph starts on a new line.
        indent: Spaces before each line.
        doxygen: Whether Doxygen reads the comment.
    """
    begin = "/**" if doxygen else "/*"
    lines = [line for text in paragraphs for line in comment_lines(text, WIDTH - len(indent) - 6)]
    if len(lines) == 1:
        return [f"{indent}{begin} {lines[0]} */"]
    first, *middle, last = lines
    return [f"{indent}{begin} {first}", *(f"{indent} * {line}" for line in middle), f"{indent} * {last} */"]


def prototype(head: str, parameters: Sequence[str], separator: str = ",\n    ") -> str:
    """Return ``head(parameters)``, with each parameter on its own line if they do not fit on one.

    Args:
        head: Return type and name.
        parameters: Declarations of the parameters.
        separator: Text between two parameters on separate lines.
    """
    line = f"{head}({', '.join(parameters)})"
    return line if len(line) < WIDTH else f"{head}(\n    {separator.join(parameters)})"


def _shortest_single(value: float) -> str:
    for digits in range(1, 9):
        text = f"{value:.{digits}g}"
        # The first test is fast, but rounds twice (to float64, then to float32); the second is exact.
        if nearest_float32(float(text)) == value and to_float32(Exact(Fraction(text))) == value:
            return text
    return f"{value:.9g}"


def _positional(text: str) -> str:
    """Return the decimal without an exponent if that has at most 10 characters: 20 for 2e+01."""
    plain = format(Decimal(text), "f")
    return plain if len(plain.lstrip("-")) <= 10 else text


@lru_cache(maxsize=4096)
def literal(value: Exact, scalar: str) -> str:
    """Return the shortest decimal that reads back as the correctly rounded value; a negative one in parentheses."""
    number = constant(value, single=scalar == "float")
    text = _positional(_shortest_single(number) if scalar == "float" else repr(number))
    if not set(text) & set(".e"):
        text += ".0"
    text += "f" if scalar == "float" else ""
    return f"({text})" if text.startswith("-") else text


_INDENT = "    "
_SEPARATORS = ((" ? ", " : "), (", ",), (" && ", " || "), (" + ", " - "), (" * ", " / "))
_ENDING = {", ", " && ", " || "}  # separators that end a line; the others begin the next line


def folded(text: str) -> str:
    """Return C text in which statements longer than `STATEMENT` are split into several lines.

    A comment after a statement that is too long moves above it.
    """
    lines = [line for long in text.splitlines() for line in _folded(long)]
    return "".join(f"{line}\n" for line in lines)


def _folded(line: str) -> list[str]:
    bare = line.lstrip()
    indent = line[: len(line) - len(bare)]
    code, mark, note = line.partition(" /*")
    if len(line) <= STATEMENT or bare[:1] in ("/", "*") or '"' in line or (bare[:1] == "#" and not mark):
        return [line]
    if bare[:1] == "#":
        return [f"/*{note.replace('<', '', 1)}", code]
    if mark:
        lines = _folded(code.rstrip())
        if note[:2] == "*<":  # for Doxygen, the declaration comes before this comment
            return [*lines, f"{indent}{_INDENT}/*{note}"]
        return [f"{indent}/*{note}", *lines]
    first, *rest = _pieces(bare, STATEMENT - len(indent))
    return [indent + first, *(line for piece in rest for line in _folded(indent + _INDENT + piece))]


def _pieces(code: str, width: int) -> list[str]:
    """Split ``code`` at the operators outside brackets that bind least; without any, inside its longest brackets.

    A conditional expression is split at its arms, other expressions where a line is full.
    """
    depths = list(accumulate((char in "([") - (char in ")]") for char in code))
    for separators in _SEPARATORS:
        cuts = []
        for mark in separators:
            places = [k for k in range(len(code)) if not depths[k] and code.startswith(mark, k)]
            cuts += [k + (len(mark) if mark in _ENDING else 1) for k in places]
        parts = [code[a:b].strip() for a, b in pairwise([0, *sorted(cuts), len(code)])]
        if len(parts) > 1:
            if separators[0] == " ? ":
                return [parts[0], *_filled_lines(parts[1:], width - len(_INDENT))]
            return _filled_lines(parts, width)
    opened = [k for k, char in enumerate(code) if char in "([" and depths[k] == 1]
    if not opened:
        return [code]
    ends = {}
    for k in opened:
        ends[k] = next((j for j in range(k, len(code)) if not depths[j]), len(code))
    inside = max(opened, key=lambda k: ends[k] - k) + 1
    rest, narrower = code[inside:], width - len(_INDENT)
    return [code[:inside], *([rest] if len(rest) <= narrower else _pieces(rest, narrower))]


def _filled_lines(parts: Sequence[str], width: int) -> list[str]:
    """Put as many parts on each line as fit; the first line has no indent."""
    lines = [parts[0]]
    for part in parts[1:]:
        if len(lines[-1]) + 1 + len(part) <= width - len(_INDENT) * (len(lines) > 1):
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return lines


class _Row(NamedTuple):
    indent: str
    declaration: str
    comment: str


def _identifier(name: str) -> str:
    """Return a C identifier that resembles ``name``."""
    text = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return text if text[:1].isalpha() else f"k{text}"


def struct(name: str, ports: Sequence[Port], text: str) -> Struct:
    """Return the C struct ``name`` of ``ports``, at least one (C99 has no empty struct).

    Args:
        name: Name of the type.
        ports: The members.
        text: What the struct is.
    """
    return struct_of(name, ports, text, _identifier)


def typedef(struct: Struct, scalar: str, types: Mapping[str, str] = NO_TYPES) -> list[str]:
    """Return the lines that declare ``struct``.

    Args:
        struct: The type.
        scalar: Type of the members.
        types: Contract name -> type of the members that have another type.
    """
    shared = _shared_texts(struct.ports)
    rows: list[_Row] = []
    for field in sorted(struct.fields, key=lambda field: bool(field.inner)):  # scalars first, then wheels
        rows += _rows(field, scalar, shared.keys(), types)
    column = max(len(row.indent + row.declaration) for row in rows)
    paragraphs = [struct.text, *(f"{joint}: {text}." for joint, text in shared.items())]
    lines = [*block_comment(paragraphs, doxygen=True), "typedef struct {"]
    for row in rows:
        lines += _commented(row, column)
    return [*lines, f"}} {struct.name};"]


def _rows(field: Field, scalar: str, shared: Collection[str], types: Mapping[str, str]) -> list[_Row]:
    """Return the declarations of a member. The struct of a wheel with one joint is on one line."""
    if field.port is not None:
        kind = types.get(field.port.name, scalar)
        return [_Row("    ", f"{kind} {field.name};", _note(field.port, shared))]
    inner = [row for each in field.inner for row in _rows(each, scalar, shared, types)]
    if len(inner) == 1:
        comment = inner[0].comment or f"of {field.name}"
        return [_Row("    ", f"struct {{ {inner[0].declaration} }} {field.name};", comment)]
    deeper = [row._replace(indent="        ") for row in inner]
    end = _Row("    ", f"}} {field.name};", f"joints of {field.name}")
    return [_Row("    ", "struct {", ""), *deeper, end]


def _note(port: Port, shared: Collection[str]) -> str:
    """Return unit, text and nominal value of ``port``, without a text that the comment of the struct has."""
    text = "" if port.name.partition(".")[2] in shared else port.text
    nominal = "" if port.default is None else f"(nominal {float(port.default):.6g})"
    unit = f"[{port.unit}]" if port.unit else ""
    return comment_text(" ".join(part for part in (unit, text, nominal) if part))


def _shared_texts(ports: Sequence[Port]) -> dict[str, str]:
    """Return the text of each joint (``spin``) that several wheels have with the same text."""
    texts: dict[str, list[str]] = {}
    for port in ports:
        joint = port.name.partition(".")[2]
        if joint and port.text:
            texts.setdefault(joint, []).append(port.text)
    return {joint: same[0] for joint, same in texts.items() if len(same) > 1 and len(set(same)) == 1}


def _commented(row: _Row, column: int) -> list[str]:
    """Return a declaration with its comment, after it if that fits on the line, otherwise above it."""
    if not row.comment:
        return [row.indent + row.declaration]
    line = (row.indent + row.declaration).ljust(column) + f" /**< {row.comment} */"
    if len(line) <= WIDTH:
        return [line]
    return [*block_comment([row.comment], row.indent, doxygen=True), row.indent + row.declaration]
