"""The text of generated C: literals, comments, structs, straight-line bodies without state, the digest of header and
source."""

from __future__ import annotations

import ctypes
import re
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.codegen.backends.modules import MODULES, empty, mecanum, tunable
from tests.conftest import GALLERY, ROOT
from tests.depth import examples
from tests.ir.defined import findings
from tests.robots import of_gallery
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.text import block_comment, comment_text, folded, literal, struct
from wmrgen.codegen.registry import Facts
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.exact.number import SQRT2, Exact
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module, Port, Role
from wmrgen.ir.rounding import constant, to_float32

LIBC = ctypes.CDLL(None)
LIBC.strtof.restype = ctypes.c_float
LIBC.strtof.argtypes = (ctypes.c_char_p, ctypes.c_void_p)
NAMES = [path.stem for path in GALLERY]
SMALL = {module.name: module for module in MODULES}  # by hand
LIBRARY = {"sqrt", "fabs"}
BITS = re.compile(
    r"^static inline float wmrgen_(?:negate_if_odd|with_sign_of|clamp|at_least)\(float a, float [bmn]\)\n\{\n.*?^\}\n",
    flags=re.S | re.M,
)
# The function that reads counters: integers, and a call of the function of their differences.
COUNTERS = re.compile(r"^void \w+_joints_from_counters\([^{}]*\)\n\{[^{}]*\}\n", re.MULTILINE)
STATEMENT = re.compile(
    r"((const (float|double|wmrgen_\w+) \w+|\*?[\w.>-]+) = |return )[^;{}]+|wmrgen_\w+ result"
)
# The only function with a condition, and the assertion of the memory layout on which it relies.
JOINT = re.compile(
    r"^typedef char \w+_wheels_are_joints\[\n.*?\];\n\n(?:float|double) \*\w+_joint\(.*?^\}\n",
    flags=re.S | re.M,
)
RESULT = re.compile(r"^typedef struct \{.*?^\} wmrgen_\w+;\n", flags=re.S | re.M)
FUNCTION = re.compile(
    r"^(?:void|WMRGEN_(?:KERNEL|ONCE) (?:float|double|wmrgen_\w+)) \w+\([^)]*\)\n\{\n(.*?)^\}\n",
    flags=re.S | re.M,
)


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
    assert constant(above, single=True) == 1 + 2**-23
    assert literal(SQRT2, "float") == "1.4142135f"
    assert literal(Exact(3), "float") == "3.0f"
    assert literal(Exact(Fraction(1, 10**12)), "double") == "1e-12"


@pytest.mark.parametrize("digits", ["2", "25", "1234567", "123456789"])
@pytest.mark.parametrize("sign", [1, -1])
def test_numbers_of_up_to_ten_characters_have_no_exponent(digits: str, sign: int) -> None:
    for power in range(-14, 14):
        value = sign * Fraction(digits) * Fraction(10) ** power
        plain = format(Decimal(digits).scaleb(power), "f")
        text = literal(Exact(value), "double").strip("(-)")
        assert text.removesuffix(".0") == (
            plain if len(plain) <= 10 else repr(float(plain)).removesuffix(".0")
        )


@pytest.mark.parametrize("value", [Fraction(10) ** 40, Fraction(1, 10**60)])
def test_a_constant_that_float_cannot_hold_is_an_error(value: Fraction) -> None:
    with pytest.raises(NotDerivableError, match="double"):
        literal(Exact(value), "float")
    assert literal(Exact(value), "double")


@settings(max_examples=examples(100))
@given(st.text())
def test_no_text_can_end_a_comment(text: str) -> None:
    plain = comment_text(text)
    assert all(" " <= char <= "~" for char in plain)
    for bad in ("*/", "/*", "??", "\\", "//"):
        assert bad not in plain
    body = "\n".join(block_comment([text, text]))
    assert body.count("*/") == 1 and body.endswith("*/") and body.count("/*") == 1


def test_letters_keep_their_sense() -> None:
    assert comment_text("Campion, d'Andréa-Novel: ω in m·s²") == "Campion, d'Andrea-Novel: omega in m.s2"


def test_members_with_the_same_name_get_different_identifiers() -> None:
    ports = tuple(Port(name, Role.STATE, "") for name in ("vx", "vx.spin", "vx.steer"))
    assert struct("s", ports, "n").members == {
        "vx": "vx",
        "vx.spin": "vx_.spin",
        "vx.steer": "vx_.steer",
    }


def code_of(text: str) -> str:
    """Without comments and preprocessor lines."""
    return re.sub(r"^#.*\n", "", re.sub(r"/\*.*?\*/", "", text, flags=re.S), flags=re.M)


FUSED = re.compile(r"^static inline float wmrgen_fused\(.*?^\}\n", re.MULTILINE | re.DOTALL)


def assert_plain(text: str, scalar: str) -> None:
    """ASCII without a date, in numbers of one type."""
    assert text.isascii()
    assert not re.search(r"\b20\d\d\b", text)
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    code = FUSED.sub(
        "", code.replace("((float)(double)fmaf((a), (b), (c)))", "")
    )  # they round to float at once
    assert ("double" in code) == (scalar == "double")
    if scalar == "float":
        assert not re.search(r"\d\.\d+(e-?\d+)?(?![\df.e])", code_of(FUSED.sub("", text)))


# The body of a function for least flash, and its normal body.
WHERE_SMALL = re.compile(
    r"^#if defined\(WMRGEN_SMALL\)\n(.*?)^#else\n(.*?)^#endif\n", re.MULTILINE | re.DOTALL
)


@pytest.mark.parametrize("scalar", ["float", "double"])
@pytest.mark.parametrize("name", [*SMALL, *NAMES])
def test_straight_lines_only(name: str, scalar: str) -> None:
    """Bodies are assignments of expressions. Nothing is defined outside of functions, so there is no state."""
    module = SMALL.get(name) or of_gallery(name).c_module
    header, source = sources(module, Choice(scalar=scalar))
    for least in (small for small, _ in WHERE_SMALL.findall(source)):
        assert re.fullmatch(rf"(    \w+ \w+;\n)+    {module.name}_\w+\([\w&, ]+\);\n", least)
    source = WHERE_SMALL.sub(r"\2", source)
    assert_plain(header, scalar)
    assert_plain(source, scalar)
    assert max(map(len, [*header.splitlines(), *source.splitlines()])) <= 120
    code = FUSED.sub("", COUNTERS.sub("", RESULT.sub("", JOINT.sub("", BITS.sub("", code_of(source))))))
    kernels = re.findall(r"^WMRGEN_(?:KERNEL|ONCE) \w+ (\w+)\(", code, flags=re.M)
    bodies = FUNCTION.findall(code)
    assert len(bodies) >= len([f for f in module.functions if f.outputs])
    assert not FUNCTION.sub("", code).strip()
    suffix = "f" if scalar == "float" else ""
    library = {*LIBRARY, *(() if scalar == "float" else ("sin", "cos", "atan", "atan2"))}
    for body in bodies:
        for statement in (s.strip() for s in body.split(";")):
            assert (
                not statement or re.fullmatch(r"\(void\)\s?\w+", statement) or STATEMENT.fullmatch(statement)
            )
        assert set(re.findall(r"(\w+)\s*\(", body)) - {"void"} <= {
            *(
                "wmr_fma",
                "wmrgen_negate_if_odd",
                "wmrgen_with_sign_of",
                "wmrgen_clamp",
                "wmrgen_at_least",
                *kernels,
            ),
            *(name + suffix for name in library),
        }
    declared = re.sub(r"typedef struct \{.*?^\} \w+;\n", "", code_of(header), flags=re.S | re.M)
    declared = re.sub(r"^enum \w+ \{.*?^\};\n", "", declared, flags=re.S | re.M)
    declared = re.sub(r"^\w+ \*\w+_joint\(\w+ \*wheels, int joint\);$", "", declared, flags=re.M)
    declared = declared.replace('extern "C" {', "").replace("}", "")
    assert all(s.strip().startswith("void ") for s in declared.split(";") if s.strip())


@pytest.mark.parametrize("name", NAMES)
def test_every_quotient_and_root_is_guarded(name: str) -> None:
    derivation = of_gallery(name)
    for module in (inlined_calls(derivation.c_module), derivation.module):
        prepare = () if module.prepare is None else (module.prepare,)
        for function in (*module.functions, *prepare):
            assert findings(function) == ()


def test_what_a_header_states() -> None:
    facts = Facts("Ridgeback", ("front_left: swedish",), "00ff" * 8, "0.1.0")
    header, source = sources(mecanum(), facts=facts)
    for fact in (
        "Ridgeback",
        "front_left: swedish",
        "00ff" * 8,
        "wmrgen 0.1.0",
        "MIT-0",
        "Operations of the formula:",
    ):
        assert fact in header
    assert "00ff" * 8 in source
    assert not re.search("sympy|casadi", header + source)  # their patches do not change generated files


def test_only_tunable_robots_have_a_prepare() -> None:
    assert "_prepare" not in sources(mecanum())[0]
    header, source = sources(tunable())
    assert "void tuned_params_default(tuned_params *params);" in header
    assert "void tuned_prepare(const tuned_params *params, tuned_prepared *prepared);" in header
    step = source[source.index("void tuned_inverse") :]
    assert " / " not in step


def test_for_least_flash_a_function_calls_its_variant() -> None:
    source = sources(of_gallery("ackermann_car").c_module)[1]
    (least,) = (small for small, full in WHERE_SMALL.findall(source) if "twist->vx = " in full)
    assert "ackermann_car_forward_slip(wheels, twist, &slip);" in least


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


def test_lines_have_at_most_120_columns() -> None:
    """Of every robot and the textbook, with a comment on what stands before or behind it; the same text else."""
    arms = ("? wmrgen_clamp(now->front.steer, 0.69f)", ": wmrgen_atan(steering_of_front)")
    long = f"    const float t3 = (fabsf(first_direction) < 2e-20f) {' '.join(arms)};"
    assert folded(long).splitlines() == [
        "    const float t3 = (fabsf(first_direction) < 2e-20f)",
        f"        {arms[0]} {arms[1]};",
    ]
    longer = long.replace("front", "f" * 60)
    assert folded(longer).splitlines()[1:] == [
        f"        {arm}".replace("front", "f" * 60) for arm in (arms[0], f"{arms[1]};")
    ]
    noted = f"    const float t = {'a' * 70};"
    assert folded(f"{noted} /* {'b' * 40} */") == f"    /* {'b' * 40} */\n{noted}\n"
    assert folded(f"    {'A' * 70}, /**< {'b' * 60} */") == f"    {'A' * 70},\n        /**< {'b' * 60} */\n"
    assert (
        folded(f"#define {'A' * 70} 1.0 /**< {'b' * 60} */") == f"/** {'b' * 60} */\n#define {'A' * 70} 1.0\n"
    )
    call = f"    f({', '.join(f'argument_{k}' for k in range(30))});"
    sums = f"    const float a = {' + '.join(f'(in->front.spin * {k}.25f)' for k in range(9))};"
    for statement in (long, longer, call, sums):
        lines = folded(statement).splitlines()
        assert len(lines) <= 6 and max(map(len, lines)) <= 120
        assert "".join(" ".join(lines).split()) == "".join(statement.split())
    for path in (ROOT / "generated").glob("**/*.[ch]"):
        assert max(map(len, path.read_text(encoding="ascii").splitlines())) <= 120, path
