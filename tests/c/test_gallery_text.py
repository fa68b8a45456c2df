"""The generated C of every gallery robot: straight lines, no state, no undefined quotient or root."""

from __future__ import annotations

import re

import pytest

from tests.c.harness import robot_module
from tests.conftest import GALLERY
from wmrgen import derive, load
from wmrgen.backends.c99 import sources
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.passes.guards import findings

NAMES = [path.stem for path in GALLERY]
LIBRARY = {"sqrt", "fabs"}
BITS = re.compile(
    r"^static inline float wmrgen_(?:negate_if_odd|with_sign_of|clamp|at_least)\(float a, float [bmn]\)\n\{\n.*?^\}\n",
    flags=re.S | re.M,
)
STATEMENT = re.compile(
    r"((const (float|double|wmrgen_\w+) \w+|[\w.>-]+) = |return )[^;{}]+|wmrgen_\w+ result"
)
RESULT = re.compile(r"^typedef struct \{.*?^\} wmrgen_\w+;\n", flags=re.S | re.M)
FUNCTION = re.compile(
    r"^(?:void|WMRGEN_KERNEL (?:float|double|wmrgen_\w+)) \w+\([^)]*\)\n\{\n(.*?)^\}\n", flags=re.S | re.M
)


def code_of(text: str) -> str:
    """Without comments and preprocessor lines."""
    return re.sub(r"^#.*\n", "", re.sub(r"/\*.*?\*/", "", text, flags=re.S), flags=re.M)


@pytest.mark.parametrize("scalar", ["float", "double"])
@pytest.mark.parametrize("name", NAMES)
def test_straight_lines_only(name: str, scalar: str) -> None:
    """Bodies are assignments of expressions; outside them nothing is defined, so there is no state."""
    module = robot_module(name)
    header, source = sources(module, Choice(scalar=scalar))
    code = RESULT.sub("", BITS.sub("", code_of(source)))
    kernels = re.findall(r"^WMRGEN_KERNEL \w+ (\w+)\(", code, flags=re.M)
    bodies = FUNCTION.findall(code)
    assert len(bodies) >= len([f for f in module.functions if f.outputs])
    assert not FUNCTION.sub("", code).strip()
    suffix = "f" if scalar == "float" else ""
    library = {*LIBRARY, *(("fma",) if scalar == "float" else ("sin", "cos", "atan", "atan2"))}
    for body in bodies:
        for statement in (s.strip() for s in body.split(";")):
            assert (
                not statement or re.fullmatch(r"\(void\)\s?\w+", statement) or STATEMENT.fullmatch(statement)
            )
        assert set(re.findall(r"(\w+)\s*\(", body)) - {"void"} <= {
            *("wmrgen_negate_if_odd", "wmrgen_with_sign_of", "wmrgen_clamp", "wmrgen_at_least", *kernels),
            *(name + suffix for name in library),
        }
    declared = re.sub(r"typedef struct \{.*?^\} \w+;\n", "", code_of(header), flags=re.S | re.M)
    declared = re.sub(r"^typedef \w+ \w+;$", "", declared, flags=re.M)
    declared = declared.replace('extern "C" {', "").replace("}", "")
    assert all(s.strip().startswith("void ") for s in declared.split(";") if s.strip())


@pytest.mark.parametrize("path", GALLERY, ids=NAMES)
def test_every_quotient_and_root_is_guarded(path: object) -> None:
    derivation = derive(load(str(path)))
    for module in (inlined_calls(derivation.c_module), derivation.module):
        prepare = () if module.prepare is None else (module.prepare,)
        for function in (*module.functions, *prepare):
            assert findings(function) == ()
