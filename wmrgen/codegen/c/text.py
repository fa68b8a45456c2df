"""What C text is made of: comments, prototypes, constants and structs.

Comments are printable ASCII that can neither end a comment nor confuse a compiler. Constants are the shortest decimals
that read back. A struct has one member per scalar, and one nested struct per wheel."""

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

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Port
from wmrgen.ir.rounding import constant, nearest_float32, to_float32

WIDTH = 100  # columns of comments, structs and prototypes
STATEMENT = 120  # columns of a statement
NO_TYPES: Mapping[str, str] = {}


def _plain(char: str) -> str:
    """ASCII for one character: a Greek letter by its name, an accented letter without its accent."""
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
    """``text`` on one line, without comment marks, trigraphs, backslashes or letters beyond ASCII; Doxygen finds no
    command, tag or link in it."""
    plain = " ".join(text.split())
    if not (plain.isascii() and plain.isprintable()):
        plain = "".join(_plain(char) for char in plain)
    plain = plain.replace("\\", "/")
    for pair in ("*/", "/*", "??", "//"):
        while pair in plain:
            plain = plain.replace(pair, f"{pair[0]} {pair[1]}")
    return re.sub(r"(?<!\w)@(?=\S)|<(?=[a-zA-Z/!])|\](?=[(\[])", r"\g<0> ", plain).rstrip()


def comment_lines(text: str, width: int = WIDTH - 3) -> list[str]:
    """``text`` escaped and wrapped for a block comment whose lines begin with `` * ``."""
    return textwrap.wrap(comment_text(text), width, break_on_hyphens=False) or [""]


def block_comment(paragraphs: Sequence[str], indent: str = "", doxygen: bool = False) -> list[str]:
    """The finished lines of one comment, each paragraph starting on a line of its own; ``doxygen`` reads it, too."""
    begin = "/**" if doxygen else "/*"
    lines = [line for text in paragraphs for line in comment_lines(text, WIDTH - len(indent) - 6)]
    if len(lines) == 1:
        return [f"{indent}{begin} {lines[0]} */"]
    first, *middle, last = lines
    return [f"{indent}{begin} {first}", *(f"{indent} * {line}" for line in middle), f"{indent} * {last} */"]


def prototype(head: str, parameters: Sequence[str], separator: str = ",\n    ") -> str:
    """``head(parameters)``, on lines of their own where one line does not hold them."""
    line = f"{head}({', '.join(parameters)})"
    return line if len(line) < WIDTH else f"{head}(\n    {separator.join(parameters)})"


def _shortest_single(value: float) -> str:
    for digits in range(1, 9):
        text = f"{value:.{digits}g}"
        # The quick test rounds twice, by way of float64; the exact one has the last word.
        if nearest_float32(float(text)) == value and to_float32(Exact(Fraction(text))) == value:
            return text
    return f"{value:.9g}"


def _positional(text: str) -> str:
    """The decimal without an exponent where that is no longer to read: 20 for 2e+01."""
    plain = format(Decimal(text), "f")
    return plain if len(plain.lstrip("-")) <= 10 else text


@lru_cache(maxsize=4096)
def literal(value: Exact, scalar: str) -> str:
    """The shortest decimal that reads back as the correctly rounded value; negative ones in parentheses."""
    number = constant(value, single=scalar == "float")
    text = _positional(_shortest_single(number) if scalar == "float" else repr(number))
    if not set(text) & set(".e"):
        text += ".0"
    text += "f" if scalar == "float" else ""
    return f"({text})" if text.startswith("-") else text


_INDENT = "    "
_SEPARATORS = ((" ? ", " : "), (", ",), (" && ", " || "), (" + ", " - "), (" * ", " / "))
_BEHIND = {", ", " && ", " || "}  # these end a line, the others begin one


def folded(text: str) -> str:
    """``text`` of C with longer statements on several lines, a comment behind one above it."""
    return "".join(f"{line}\n" for long in text.splitlines() for line in _folded(long))


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
        # Doxygen looks for what a comment is about before it.
        return [*lines, f"{indent}{_INDENT}/*{note}"] if note[:2] == "*<" else [f"{indent}/*{note}", *lines]
    first, *rest = _pieces(bare, STATEMENT - len(indent))
    return [indent + first, *(line for piece in rest for line in _folded(indent + _INDENT + piece))]


def _pieces(code: str, width: int) -> list[str]:
    """``code`` parted where it binds least, outside brackets: a choice at its arms, sums and arguments where a line is
    full. Else within its longest brackets."""
    depths = list(accumulate((char in "([") - (char in ")]") for char in code))
    for separators in _SEPARATORS:
        cuts = [
            k + (len(mark) if mark in _BEHIND else 1)
            for mark in separators
            for k in range(len(code))
            if not depths[k] and code.startswith(mark, k)
        ]
        parts = [code[a:b].strip() for a, b in pairwise([0, *sorted(cuts), len(code)])]
        if len(parts) > 1:
            if separators[0] == " ? ":
                return [parts[0], *_filled_lines(parts[1:], width - len(_INDENT))]
            return _filled_lines(parts, width)
    opened = [k for k, char in enumerate(code) if char in "([" and depths[k] == 1]
    ends = {k: next((j for j in range(k, len(code)) if not depths[j]), len(code)) for k in opened}
    if not opened:
        return [code]
    inside = max(opened, key=lambda k: ends[k] - k) + 1
    rest, narrower = code[inside:], width - len(_INDENT)
    return [code[:inside], *([rest] if len(rest) <= narrower else _pieces(rest, narrower))]


def _filled_lines(parts: Sequence[str], width: int) -> list[str]:
    """As many parts on each line as it holds; further lines have their indent."""
    lines = [parts[0]]
    for part in parts[1:]:
        if len(lines[-1]) + 1 + len(part) <= width - len(_INDENT) * (len(lines) > 1):
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return lines


_Row = tuple[str, str, str]  # indent, declaration, comment


class Struct(NamedTuple):
    """``lines`` of the typedef; ``members``: contract name -> member path (``left.spin``)."""

    name: str
    lines: tuple[str, ...]
    members: Mapping[str, str]


def _identifier(name: str, used: set[str]) -> str:
    """A C identifier like ``name``, which is added to those ``used``."""
    result = re.sub(r"[^A-Za-z0-9_]", "_", name)
    if not result[:1].isalpha():
        result = "k" + result
    while result in used:
        result += "_"
    used.add(result)
    return result


def _paths(ports: tuple[Port, ...]) -> dict[str, tuple[str, str]]:
    """Contract name -> (wheel or "", member), in C identifiers free of clashes at each level."""
    paths: dict[str, tuple[str, str]] = {}
    wheels = {"": ""}
    used: dict[str, set[str]] = {"": set()}
    for port in sorted(ports, key=lambda port: "." in port.name):  # a name without a dot keeps its own
        wheel, _, member = port.name.rpartition(".")
        if wheel not in wheels:
            wheels[wheel] = _identifier(wheel, used[""])
            used[wheel] = set()
        paths[port.name] = wheels[wheel], _identifier(member, used[wheel])
    return paths


def _note(port: Port, shared: Collection[str]) -> str:
    """Unit, text and nominal value of ``port``; the text not where the comment of the struct has it."""
    text = "" if port.name.partition(".")[2] in shared else port.text
    nominal = "" if port.default is None else f"(nominal {float(port.default):.6g})"
    unit = f"[{port.unit}]" if port.unit else ""
    return comment_text(" ".join(part for part in (unit, text, nominal) if part))


def _shared_texts(ports: tuple[Port, ...]) -> dict[str, str]:
    """Joint (``spin``) -> text, where several wheels have that joint and all say the same about it."""
    texts: dict[str, list[str]] = {}
    for port in ports:
        joint = port.name.partition(".")[2]
        if joint and port.text:
            texts.setdefault(joint, []).append(port.text)
    return {joint: same[0] for joint, same in texts.items() if len(same) > 1 and len(set(same)) == 1}


def _commented(declaration: str, indent: str, column: int, note: str) -> list[str]:
    """``declaration`` with ``note`` behind it where that fits, else above."""
    if not note:
        return [indent + declaration]
    line = (indent + declaration).ljust(column) + f" /**< {note} */"
    if len(line) <= WIDTH:
        return [line]
    return [*block_comment([note], indent, doxygen=True), indent + declaration]


def _group(wheel: str, members: list[_Row]) -> list[_Row]:
    """The nested struct of a wheel: on one line when it has one member."""
    if len(members) == 1:
        return [("    ", f"struct {{ {members[0][1]} }} {wheel};", members[0][2] or f"of {wheel}")]
    inner: list[_Row] = [("        ", declaration, note) for _, declaration, note in members]
    return [("    ", "struct {", ""), *inner, ("    ", f"}} {wheel};", f"joints of {wheel}")]


def struct(
    name: str, ports: tuple[Port, ...], scalar: str, note: str, types: Mapping[str, str] = NO_TYPES
) -> Struct:
    """The typedef ``name`` for ``ports``, which must not be empty (C99 has no empty struct).

    ``types``: of ports that are no ``scalar``.
    """
    paths = _paths(ports)
    shared = _shared_texts(ports)
    groups: dict[str, list[_Row]] = {"": []}
    for port in ports:
        wheel, member = paths[port.name]
        row = "    ", f"{types.get(port.name, scalar)} {member};", _note(port, shared.keys())
        groups.setdefault(wheel, []).append(row)
    rows = groups.pop("")
    for wheel, members in groups.items():
        rows += _group(wheel, members)
    column = max(len(indent + declaration) for indent, declaration, _ in rows)
    lines = block_comment([note, *(f"{joint}: {text}." for joint, text in shared.items())], doxygen=True)
    lines.append("typedef struct {")
    for indent, declaration, commented in rows:
        lines += _commented(declaration, indent, column, commented)
    named = {port.name: ".".join(filter(None, paths[port.name])) for port in ports}
    return Struct(name, (*lines, f"}} {name};"), named)
