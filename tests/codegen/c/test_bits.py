"""Generated C equals the interpreter bit for bit, for every robot, compiler and optimisation level."""

from __future__ import annotations

import ctypes
import math
import random
from pathlib import Path

import pytest
from hypothesis import Phase, given, settings

from tests.codegen.backends.modules import MODULES
from tests.codegen.c.harness import COMPILERS, EACH, STRICT, Program, gallery, libm, ulps32
from tests.depth import everyday
from tests.laws.layouts import Layout, layouts
from tests.oracle.harness import Model, robot_text
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.errors import EnvironmentFailure
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.kernels.choice import INLINE, LIBM, M4F
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
NO_LEAKS = {"ASAN_OPTIONS": "detect_leaks=0"}
BUILDS = [(compiler, level) for compiler in COMPILERS for level in ("-O0", "-O2", "-Os")]

OTHERS = (LIBM, "m0", "avr", "host")
SMALL = "-DWMRGEN_SMALL"  # kernels are called, not inlined


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> tuple[Program, Path]:
    """All robots of the gallery, in single precision, written to a folder."""
    program, folder = Program((*MODULES, *gallery()), "float", 12), tmp_path_factory.mktemp("c")
    program.write(folder)
    return program, folder


@pytest.mark.parametrize("build", everyday(BUILDS, BUILDS[1:2]), ids=" ".join)
@pytest.mark.slow
def test_float(robots: tuple[Program, Path], build: tuple[str, str]) -> None:
    (program, folder), (compiler, level) = robots, build
    assert program.mismatches(folder, compiler, (*STRICT, level)) == []


def others(choice: str, modules: tuple[Module, ...], folder: Path) -> list[str]:
    flavour, _, small = choice.partition(" ")
    math, target = (LIBM, M4F) if flavour == LIBM else (INLINE, flavour)
    program = Program(modules, "float", 3, math, target)
    program.write(folder)
    return program.mismatches(folder, COMPILERS[0], (*STRICT, "-O2", *([SMALL] if small else [])))


@pytest.mark.slow
@pytest.mark.parametrize("choice", (*OTHERS, "m4f small", "m0 small"))
def test_other_choices_of_all(robots: tuple[Program, Path], tmp_path: Path, choice: str) -> None:
    assert others(choice, robots[0].modules, tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("choice", ["libm small", "avr small", "host small"])
def test_called_kernels_have_the_same_bits(robots: tuple[Program, Path], tmp_path: Path, choice: str) -> None:
    assert others(choice, robots[0].modules[1::3], tmp_path) == []


@pytest.mark.slow
def test_double(tmp_path: Path) -> None:
    program = Program((*MODULES, *gallery()), "double", 4)
    program.write(tmp_path)
    assert program.mismatches(tmp_path, COMPILERS[0], (*STRICT, "-O2")) == []


@pytest.mark.slow
def test_libm_is_within_two_ulp(robots: tuple[Program, Path]) -> None:
    """Each call of libm is within 2 ulp of the exact value; `test_other_choices_of_all` compares C with the
    interpreter."""
    program = Program(robots[0].modules, "float", 4, LIBM)
    assert program.cases
    seen = sorted(program.libm.seen, key=repr)
    assert seen
    of = libm("float").arithmetic.of
    worst = max(ulps32(op, args, of(op)(*args)) for op, args in seen)
    assert worst <= 2.0


@pytest.mark.slow
def test_under_sanitizers(robots: tuple[Program, Path]) -> None:
    """The C is clean with every compiler that has the sanitizers' runtime; at least one has. Optimised code could
    hide errors."""
    program, folder = robots
    kinds = "address,undefined,float-divide-by-zero,float-cast-overflow"
    flags = ("-std=c99", "-O0", "-ffp-contract=off", "-fno-sanitize-recover=all", f"-fsanitize={kinds}")
    probed = folder / "probe.c"
    probed.write_text("int main(void) { return 0; }\n")
    failures = {}
    for compiler in COMPILERS:
        try:
            run_program(compile_program(folder, [probed.name], compiler, flags), "", NO_LEAKS)
        except EnvironmentFailure as error:
            failures[compiler] = str(error)  # this compiler has no sanitizer runtime here
            continue
        assert program.mismatches(folder, compiler, flags, NO_LEAKS) == []
    if len(failures) == len(COMPILERS):
        pytest.skip(f"no compiler with sanitizers: {failures}")


@pytest.fixture(scope="module")
def random_layouts(tmp_path_factory: pytest.TempPathFactory) -> tuple[Module, ...]:
    """The C modules of twelve random layouts, the same in every run."""
    folder = tmp_path_factory.mktemp("layouts")
    found: list[Module] = []

    @settings(max_examples=12, derandomize=True, database=None, phases=[Phase.generate])
    @given(layouts())
    def collect(layout: Layout) -> None:
        name = f"random{len(found)}"
        found.append(Model.of(robot_text(layout, name), folder, name).derivation.c_module)

    collect()
    assert len(found) >= 12
    return tuple(found)


@pytest.mark.parametrize("scalar", everyday(["float", "double"], ["float"]))
def test_random_layouts(random_layouts: tuple[Module, ...], scalar: str, tmp_path: Path) -> None:
    """tests/laws/test_backends.py shows on random layouts that the interpreter agrees with the exact model."""
    program = Program(random_layouts, scalar, 6)
    program.write(tmp_path)
    assert program.mismatches(tmp_path, COMPILERS[0], (*STRICT, "-O2")) == []


def _random_function(source: random.Random, name: str) -> Function:
    """Return random nodes that no builder simplifies: negations of differences, products of quotients, any grouping."""
    inputs = tuple(Port(f"p{k}", Role.STATE, "m") for k in range(4))
    nodes = [Node(Op.INPUT, name=port.name) for port in inputs]
    nodes += [Node(Op.CONST, value=Exact(source.randint(-9, 9)) / source.randint(1, 9)) for _ in range(4)]
    ops = (Op.ADD, Op.SUB, Op.MUL, Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.NEG, Op.ABS, Op.MIN, Op.MAX, Op.SELECT)
    for _ in range(40):
        op = source.choice(ops)
        # Mostly recent nodes, so that deep expressions arise.
        pick = [
            source.randrange(max(0, len(nodes) - source.choice((3, 6, 50))), len(nodes))
            for _ in range(op.arity)
        ]
        nodes.append(Node(op, tuple(pick)))
    outputs = tuple(Port(f"q{k}", Role.STATE, "m") for k in range(6))
    return Function(name, inputs, tuple(nodes), outputs, tuple(range(len(nodes) - 6, len(nodes))))


@pytest.mark.parametrize("compiler", EACH)
def test_grouping_of_random_expressions(compiler: str, tmp_path: Path) -> None:
    source = random.Random(7)
    functions = tuple(_random_function(source, f"f{k}") for k in range(60))
    program = Program((Module("random_trees", functions),), "float", 8)
    program.write(tmp_path)
    wrong = program.mismatches(tmp_path, compiler, (*STRICT, "-O2"))
    assert [line for line in wrong if "nan" not in line] == []  # the sign of a NaN is not specified


def test_the_interpreter_reaches_the_same_libm() -> None:
    assert libm("float").arithmetic.of(Op.SIN)(0.5) == ctypes.c_float(math.sin(0.5)).value
