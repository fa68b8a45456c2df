"""JavaScript, run by Node: the test vectors of the C, every operation at extreme numbers, and the package."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from itertools import product
from pathlib import Path

import pytest

from tests.conftest import GALLERY, Outcome
from tests.depth import EVERYDAY
from tests.external_tools import need, tool
from tests.robots import of_gallery
from wmrgen.codegen.registry import BACKENDS, Facts
from wmrgen.derivation.emit import site
from wmrgen.errors import EnvironmentFailure
from wmrgen.ir.interpret import FLOAT64
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role
from wmrgen.ir.ops import OPERATIONS
from wmrgen.ir.selftest.vectors import tables

Cli = Callable[..., Outcome]
JAVASCRIPT = BACKENDS["javascript"]
VECTORS = ("locked_bicycle",)  # everyday; the others are slow
ENDS = (
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.5,
    -2.5,
    3.5,
    1.0,
    -7.25,
    1e-300,
    4503599627370497.5,
    math.inf,
    -math.inf,
    math.nan,
)


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, marks=[] if p.stem in VECTORS else [pytest.mark.slow])
        for p in GALLERY
        if p.stem in EVERYDAY
    ],
    ids=lambda p: p.stem,
)
def test_it_replays_the_vectors_of_c(path: Path) -> None:
    need("node")
    derivation = of_gallery(path.stem)
    bases = {f.name: f.variant_of or f.name for f in derivation.c_module.functions}
    idle = {p.name: 0.0 for f in derivation.module.functions for p in f.inputs if p.default is None}
    played = tables(derivation.c_module, "double", site(derivation))
    assert {"inverse", "odometry"} <= {table.functions[0] for table in played}
    for table in played:
        rows = [{**idle, **dict(zip(table.inputs, vector.inputs, strict=True))} for vector in table.vectors]
        answers = rows
        for functions in [table.functions] if not table.law else [[name] for name in table.functions]:
            given, answers = answers, [dict(row) for row in answers]
            names = dict.fromkeys(bases[f] for f in functions)
            requests = [(name, case) for case in given for name in names]
            results = iter(JAVASCRIPT.evaluate(derivation.module, requests, {}))
            for answer in answers:
                for _ in names:
                    answer.update(next(results))
        for vector, answer in zip(table.vectors, answers, strict=True):
            for name, wanted, tolerance in zip(table.outputs, vector.expected, vector.tolerance, strict=True):
                assert abs(answer[name] - wanted) <= tolerance, (table.functions, vector.text, name)


@pytest.mark.slow
def test_every_operation_at_the_ends_of_numbers() -> None:
    """Results have the exact bits, also the signs of zeros.

    Sines and arctangents differ between libraries by rounding.
    """
    need("node")
    for op in {*OPERATIONS.values()}:
        if not (op.exact and op.float64 and op.arity) or op in (Op.SQUARE, Op.FMA):
            continue
        names = "abcd"[: op.arity]
        nodes = (*(Node(Op.INPUT, name=name) for name in names), Node(op, tuple(range(op.arity))))
        ports = tuple(Port(name, Role.COMMAND, "1") for name in names)
        function = Function("f", ports, nodes, (Port("y", Role.COMMAND, "1"),), (op.arity,))
        points = [
            point
            for point in product(ENDS, repeat=min(op.arity, 2))
            if not (op in (Op.CLAMP, Op.AT_LEAST) and not point[1] > 0)
            and not (op is Op.FLIP and point[1] % 1)
        ]
        rows = [(*point, 2.0, -3.0)[: op.arity] for point in points]
        cases = [dict(zip(names, row, strict=True)) for row in rows]
        answers = JAVASCRIPT.evaluate(Module("one", (function,)), [("f", case) for case in cases], {})
        for row, answer in zip(rows, answers, strict=True):
            wanted, value = FLOAT64.of(op)(*row), answer["y"]
            if op is Op.RINT:  # Python's round gives no negative zero
                value += 0.0
            if op.opaque and math.isfinite(wanted):
                assert value == pytest.approx(wanted, rel=1e-15, abs=1e-300), (op, row)
            else:
                assert (str(value), value) == (str(wanted), wanted) or (
                    value != value and wanted != wanted
                ), (
                    op,
                    row,
                )


@pytest.mark.slow
def test_the_package(wmrgen_cli: Cli, robot_file: Path) -> None:
    need("node")
    text = robot_file.read_text()
    hostile = 'description: "*/ </script><script>pwned()</script> `${pwned}` pwned()"'
    robot_file.write_text(text.replace("wheels:", f"{hostile}\nwheels:", 1))
    out = robot_file.parent / "out"
    assert wmrgen_cli("derive", robot_file, "-o", out, "--package", "javascript").code == 0
    folder = out / "package-javascript" / "pair"
    assert {p.name for p in folder.iterdir()} == {"pair.js", "package.json", "manifest.json"}
    assert json.loads((folder / "package.json").read_text())["exports"] == "./pair.js"
    assert "</script" not in (folder / "pair.js").read_text()
    main = 'import * as pair from "pair-kinematics"; console.log(JSON.stringify(pair.inverse({vx: 0.0975, omega: 0})))'
    done = subprocess.run(
        [tool("node"), "--input-type=module", "-e", main],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["left.spin"] == pytest.approx(1.0, rel=1e-15)
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0


@pytest.mark.slow
def test_words_of_javascript(wmrgen_cli: Cli, robot_file: Path) -> None:
    """Keywords may be names. A tunable parameter may not be a property of every object, which would hide its nominal
    value."""
    need("node")
    text = robot_file.read_text()
    for word in ("function", "eval", "Math"):
        tunable = f"parameters:\n  {word}: {{value: 0.0975, tunable: true}}"
        robot_file.write_text(text.replace("parameters:", tunable, 1).replace("r: 0.0975", f"r: {word}", 1))
        words = ("eval", robot_file, "inverse", "vx=0.0975", "omega=0", "--backend", "javascript", "--json")
        done = wmrgen_cli(*words)
        assert (done.code, json.loads(done.out)["left.spin"]) == (0, 1.0), done.err
    robot_file.write_text(text.replace("name: left", "name: toString"))
    done = wmrgen_cli(*words)
    assert done.code == 2 and "'toString'" in done.err and "JavaScript" in done.err


def test_without_node_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    module = Module("one", (Function("f", (), (Node(Op.CONST, value=None),), (), ()),))
    with pytest.raises(EnvironmentFailure, match="node"):
        JAVASCRIPT.load().evaluate(module, [("f", {})])
    assert b"export function f()" in JAVASCRIPT.load().emit(module, Facts())["one.js"]
