"""The text of generated C: literals, comments, structs, the guard of the pair."""

from __future__ import annotations

import ctypes
import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.backends.modules import MODULES, empty, mecanum, tunable
from wmrgen.backends.c99 import sources
from wmrgen.backends.c99.text import block_comment, comment_text, literal, rounded, struct
from wmrgen.backends.registry import Facts
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import SQRT2, Exact
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module, Port, Role
from wmrgen.ir.rounding import to_float32

LIBC = ctypes.CDLL(None)
LIBC.strtof.restype = ctypes.c_float
LIBC.strtof.argtypes = (ctypes.c_char_p, ctypes.c_void_p)


@given(st.fractions(min_value=-1000, max_value=1000, max_denominator=10**12))
def test_a_float_literal_reads_back(value: Fraction) -> None:
    text = literal(Exact(value), "float")
    assert text.endswith(("f", "f)"))
    bare = text.strip("()")[:-1]
    assert set(bare) & set(".e")
    assert LIBC.strtof(bare.encode(), None) == to_float32(Exact(value))
    assert text.startswith("(") == (value < 0)


@given(st.fractions(min_value=-1000, max_value=1000, max_denominator=10**12))
def test_a_double_literal_reads_back(value: Fraction) -> None:
    assert float(literal(Exact(value), "double").strip("()")) == value.numerator / value.denominator


def test_rounding_goes_once() -> None:
    # 1 + 2**-24 + 2**-60: float64 rounds it to the tie 1 + 2**-24, and the tie to 1.
    above = Exact(1 + Fraction(1, 2**24) + Fraction(1, 2**60))
    assert rounded(above, "float") == 1 + 2**-23
    assert literal(SQRT2, "float") == "1.4142135f"
    assert literal(Exact(3), "float") == "3.0f"
    assert literal(Exact(Fraction(1, 10**12)), "double") == "1e-12"


@pytest.mark.parametrize("value", [Fraction(10) ** 40, Fraction(1, 10**60)])
def test_a_constant_that_float_cannot_hold_is_an_error(value: Fraction) -> None:
    with pytest.raises(NotDerivableError, match="double"):
        literal(Exact(value), "float")
    assert literal(Exact(value), "double")


@given(st.text())
def test_no_text_gets_out_of_a_comment(text: str) -> None:
    plain = comment_text(text)
    assert all(" " <= char <= "~" for char in plain)
    for bad in ("*/", "/*", "??", "\\", "//"):
        assert bad not in plain
    body = "\n".join(block_comment([text, text]))
    assert body.count("*/") == 1 and body.endswith("*/") and body.count("/*") == 1


def test_letters_keep_their_sense() -> None:
    assert comment_text("Campion, d'Andréa-Novel: ω in m·s²") == "Campion, d'Andrea-Novel: omega in m.s2"


def test_members_that_clash_are_told_apart() -> None:
    ports = tuple(Port(name, Role.STATE, "") for name in ("vx", "vx.spin", "vx.steer"))
    assert struct("s", ports, "float", "n").members == {
        "vx": "vx",
        "vx.spin": "vx_.spin",
        "vx.steer": "vx_.steer",
    }


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.name)
@pytest.mark.parametrize("scalar", ["float", "double"])
def test_straight_lines_only(module: Module, scalar: str) -> None:
    header, source = sources(module, Choice(scalar=scalar))
    for text in (header, source):
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        assert not re.search(r"\b(for|while|do|goto|pow|powf|malloc|static|if)\s*[({]", code)
        assert text.isascii() and max(map(len, text.splitlines())) <= 110
        assert ("double" in code) == (scalar == "double")
        if scalar == "float":
            assert not re.search(r"\d\.\d+(e-?\d+)?(?![\df.e])", code)
    assert not re.search(r"\b20\d\d\b", header + source)  # no date


def test_what_a_header_states() -> None:
    facts = Facts("Ridgeback", ("front_left: swedish",), "00ff" * 8, "0.1.0", "1.14.0")
    header, source = sources(mecanum(), facts=facts)
    for fact in (
        "Ridgeback",
        "front_left: swedish",
        "00ff" * 8,
        "wmrgen 0.1.0",
        "sympy 1.14.0",
        "MIT-0",
        "Operations of the formula:",
    ):
        assert fact in header
    assert "00ff" * 8 in source


def test_only_what_is_tunable_gets_a_prepare() -> None:
    assert "_prepare" not in sources(mecanum())[0]
    header, source = sources(tunable())
    assert "void tuned_params_default(tuned_params *params);" in header
    assert "void tuned_prepare(const tuned_params *params, tuned_prepared *prepared);" in header
    step = source[source.index("void tuned_inverse") :]
    assert " / " not in step


def test_a_function_without_outputs_is_left_out() -> None:
    header, _ = sources(Module("none", (empty(),)))
    assert "none_forward" not in header


def test_pairs_differ() -> None:
    def pair(text: str) -> str:
        found = re.search(r"PAIR_([0-9a-f]{16})", text)
        assert found
        return found[1]

    header, source = sources(mecanum())
    assert pair(header) == pair(source)
    assert pair(header) != pair(sources(mecanum(), Choice(scalar="double"))[0])
