"""JavaScript: an ES module for browsers and Node, and the manifest of an npm package.

A function takes an object and returns an object, whose members have contract names. Numbers are doubles.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

from wmrgen.codegen.compiler import run_node
from wmrgen.codegen.expression import Style, body, variables
from wmrgen.codegen.registry import Facts, Request
from wmrgen.codegen.render import render
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import complete, self_contained
from wmrgen.ir.nodes import Function, Module
from wmrgen.ir.ops import Conditional, Op
from wmrgen.ir.rounding import to_float64

_KEYWORDS = frozenset(
    """
arguments await break case catch class const continue debugger default delete do else enum eval export extends false
finally for function if implements import in instanceof interface let Math new null Object package private protected
public return static super switch this throw true try typeof undefined var void while with yield
""".split()
)
# Helpers that the text of an operation calls in addition.
_NEEDED = {Op.AT_LEAST: "_is_negative", Op.WITH_SIGN_OF: "_is_negative"}


def number(value: float) -> str:
    """Return a number as source text."""
    return {"inf": "Infinity", "-inf": "-Infinity", "nan": "NaN"}.get(repr(value), repr(value))


def _literal(value: Exact) -> str:
    text = number(to_float64(value))
    return f"({text})" if text.startswith("-") else text


def _form(op: Op) -> str:
    """Return the text of an operation: JavaScript's own, or that of C with C's functions as members of Math."""
    text = op.c.replace("{f}", "")
    return op.javascript or (Conditional(text) if isinstance(op.c, Conditional) else f"Math.{text}")


# Names of ports and parameters never begin with an underscore.
_STYLE = Style(_literal, _form, "const {0} = {1};", "_t{0}", named="_{}".format)


def _plain(text: str) -> str:
    """Return ``text`` on one line for a comment; inside a page, no browser takes part of it for a tag."""
    return re.sub(r"<(?=[!/?a-zA-Z])", "< ", " ".join(text.split()))


def _printed(function: Function) -> dict[str, Any]:
    """Return a function of the module, as finished lines."""
    names = variables(function, _KEYWORDS.__contains__)
    code = body(function, names.__getitem__, _STYLE)
    members = [
        (p.name if names[p.name] == p.name else f'"{p.name}": {names[p.name]}')
        + ("" if p.default is None else f" = {_literal(p.default)}")
        for p in function.inputs
    ]
    returned = [f'"{p.name}": {text}' for p, text in zip(function.outputs, code.results, strict=True)]
    return {
        "name": function.name,
        "document": _document(function),
        "signature": _object(members, "") + " = {}" if members else "",
        "lines": code.statements,
        "results": _object(returned, "  "),
        "ops": code.ops,
    }


def _object(members: Sequence[str], indent: str) -> str:
    """Return an object literal, on one line if it is short."""
    line = f"{{ {', '.join(members)} }}"
    if len(line) <= 84:  # columns
        return line
    lines = "".join(f"{indent}  {member},\n" for member in members)
    return f"{{\n{lines}{indent}}}"


def _document(function: Function) -> list[str]:
    """Return the comment of a function: what it does, takes and returns."""
    lines = [_plain(function.text) or f"{function.name}."]
    for title, ports in (("Takes:", function.inputs), ("Returns:", function.outputs)):
        if ports:
            lines += [title, *(f"  {_plain(f'{p.name} [{p.unit}] {p.text}')}" for p in ports)]
    return lines


def text(module: Module, facts: Facts) -> str:
    """Return the source text of the ES module."""
    functions = [_printed(function) for function in self_contained(module)]
    ops = frozenset[Op]().union(*(function["ops"] for function in functions))
    needs = {_NEEDED[op] for op in ops & _NEEDED.keys()} | {_form(op).partition("(")[0] for op in ops}
    return render(
        "javascript/module.js.j2",
        robot=module.name,
        description=_plain(facts.description),
        wheels=[_plain(line) for line in facts.wheel_lines],
        meta=facts,
        functions=functions,
        needs=needs,
    )


def expression(module: Module) -> str:
    """Return an expression for an object with all functions, for scripts that cannot import a module."""
    lines = (line for line in text(module, Facts()).splitlines(keepends=True) if not line.startswith("//"))
    script = "".join(line.removeprefix("export ") for line in lines)
    return f"(() => {{\n{script}return {_object([f.name for f in module.functions], '')};\n}})()"


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """Return ``<robot>.js`` and ``package.json``."""
    manifest = render(
        "javascript/package.json.j2",
        robot=module.name,
        package=f"{module.name.lower()}-kinematics",
        version=facts.wmrgen_version,
        description=json.dumps(_plain(f"Kinematics of {facts.description or module.name}")),
    )
    return {f"{module.name}.js": text(module, facts).encode(), "package.json": manifest.encode()}


def evaluate(module: Module, requests: Sequence[Request]) -> list[dict[str, float]]:
    """Return the outputs of each request by contract name, computed by Node. Raise EnvironmentFailure without Node."""
    functions = {function.name: function for function in self_contained(module)}
    calls = []
    for name, case in requests:
        row = zip(functions[name].inputs, complete(functions[name], case), strict=True)
        calls.append((name, ", ".join(f'"{port.name}": {number(value)}' for port, value in row)))
    program = render("javascript/driver.js.j2", calls=calls)
    printed = run_node({"robot.mjs": text(module, Facts()), "main.mjs": program})
    return [{name: float(value) for name, value in json.loads(line)} for line in printed.splitlines()]
