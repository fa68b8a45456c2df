"""Notebooks without a notebook server: ``python -m tests.examples.notebooks FILE`` runs the code cells in order.

What a cell shows, the value of its last line, is asked how it shows itself, as a notebook asks it.
"""

from __future__ import annotations

import ast
import json
import sys
from pathlib import Path
from typing import Any

SHOWN = ("_repr_latex_", "_repr_svg_", "_repr_html_", "__repr__")


def code_cells(path: Path) -> list[str]:
    """The code cells of a notebook, in order."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def run(path: Path) -> None:
    """Run all cells in one namespace."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for number, text in enumerate(code_cells(path), 1):
        tree = ast.parse(text, f"{path.name}, code cell {number}")
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, tree_name(path, number), "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), tree_name(path, number), "eval"), names)
            for how in SHOWN:
                shown = getattr(value, how, None)
                if shown is not None and not isinstance(value, type):
                    print(f"[{number}] {how}: {len(shown() or '')} characters")


def tree_name(path: Path, number: int) -> str:
    return f"{path.name}, code cell {number}"


if __name__ == "__main__":
    run(Path(sys.argv[1]))
