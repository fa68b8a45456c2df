"""All C files of a robot, by templates/c99: header, source, checked functions, self-test and example."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction

from wmrgen.codegen.c.batch import batch
from wmrgen.codegen.c.checked import checked, fuzz
from wmrgen.codegen.c.counters import counter_types, counting
from wmrgen.codegen.c.example import example
from wmrgen.codegen.c.functions import call, printed_kernels, shared_structs, steps_of
from wmrgen.codegen.c.selftest import selftest
from wmrgen.codegen.c.text import WIDTH, comment_lines, folded, literal, typedef
from wmrgen.codegen.expression import expanded
from wmrgen.codegen.registry import Facts
from wmrgen.codegen.render import render
from wmrgen.codegen.unit import Unit
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import JOINTS
from wmrgen.ir.kernels import rounds
from wmrgen.ir.kernels.choice import AVR, DEFAULT, INLINE, M0, Choice
from wmrgen.ir.kernels.trigonometry import worst
from wmrgen.ir.nodes import Module, Op
from wmrgen.ir.ops import integer
from wmrgen.robotfile.reserved_words import AVR_MACROS

NO_FACTS = Facts()
TEST = "test"  # a folder apart, so that a firmware that builds every *.c does not build the tests
EXAMPLE = "example/main.c"
INTEGER = {"isin", "icos", "iatan", "imul", "idiv", "isqrt"}  # see templates/c99/integer.c.j2
_NO_PAIR = "\0"  # placeholder for the digest of header and source until it is known; no text contains it
LARGEST_INPUT = {"float": "1e9", "double": "1e100"}  # squares of inputs up to this size are finite
_WAVES = {Op.SIN, Op.COS, Op.ATAN, Op.ATAN2}


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """Return all files by name.

    The options in ``facts`` are the fields of `Choice`, ``fuzz`` for a fuzzing harness and ``batch`` for functions over
    arrays of states.
    """
    choice = Choice(**{key: str(word) for key, word in facts.options.items() if key in Choice._fields})
    functions = unit(module, choice)
    header, source, pair = printed(functions, facts)
    common = _common(functions, facts, pair)
    checked_header, checked_source = checked(module, functions, facts.site, common)
    files = {".h": header, ".c": source, "_checked.h": checked_header, "_checked.c": checked_source}
    apart = {"_selftest.c": selftest(module, functions, facts.site, common)}
    if facts.options.get("fuzz"):
        apart["_fuzz.c"] = fuzz(module, functions, facts.site, common)
    if facts.options.get("batch"):
        files["_many.h"], files["_many.c"] = batch(functions, common)
    named = {module.name + ending: text for ending, text in files.items()}
    named |= {f"{TEST}/{module.name}{ending}": text for ending, text in apart.items()}
    if module.joints:
        named[EXAMPLE] = example(module, functions, facts.site, common)
    return {name: folded(text).encode("ascii") for name, text in named.items()}


def sources(module: Module, choice: Choice = DEFAULT, facts: Facts = NO_FACTS) -> tuple[str, str]:
    """Return the text of ``<robot>.h`` and ``<robot>.c``.

    Args:
        module: The functions of the robot.
        choice: Scalar type, sines and processor.
        facts: Facts for the banner and the comments.
    """
    return printed(unit(module, choice), facts)[:2]


def unit(module: Module, choice: Choice = DEFAULT) -> Unit:
    """Return the C functions of ``module``; params_default and prepare are the first, if a parameter is tunable."""
    written = frozenset(node.op for function in module.functions for node in function.nodes)
    scalar = choice.scalar
    module, costs = expanded(module, choice)
    shared = shared_structs(module)
    functions = Unit(
        module.name,
        choice,
        tuple(shared.values()),
        steps_of(module, scalar, costs, shared),
        printed_kernels(module, scalar),
        module.joints or (),
        written,
        rounds(module),
    )
    return functions._replace(counting=counting(module, functions.contract, scalar))


def printed(unit: Unit, facts: Facts = NO_FACTS) -> tuple[str, str, str]:
    """Return the text of header and source, and the digest that both contain."""
    choice, ops = unit.choice, unit.ops
    needs = {op.name for op in ops}
    includes = {
        "<float.h>": unit.rounds,
        "<stddef.h>": bool(unit.joints),
        "<math.h>": any("<math.h>" in op.includes for op in ops),
        "<stdint.h>": any("<stdint.h>" in op.includes for op in ops),
    }
    structs = [typedef(struct, choice.scalar) for struct in unit.structs.values()]
    if unit.counting is not None:
        counters = unit.counting[0]
        structs.append(typedef(counters, choice.scalar, counter_types(counters)))
    joints = []
    for name in unit.joints:
        joints.append((_macro(name), f"[{JOINTS[name.rpartition('.')[2]].unit}] {name}"))
    context: dict[str, object] = {
        "table": _table(facts),
        "notes": _notes(facts, _arithmetic_notes(unit)),
        "example": _example(unit),
        "constants": _constants(unit, facts),
        "joints": joints,
        "version": facts.wmrgen_version,
        "model_hash": "".join(c for c in facts.model_hash if c.isalnum()),
        "structs": structs,
        "macros": _macros_elsewhere(structs),
        "steps": unit.every,
        "counters": unit.counting is not None,
        "kernels": unit.kernels,
        "kernels_for": "_".join((choice.target, choice.scalar, choice.math)).upper(),
        "includes": [name for name, needed in includes.items() if needed],
        "rounds": unit.rounds,
        "integer": integer if needs & INTEGER else None,
        "needs": needs,
    }
    # Both files contain the digest of both, so that files that were not generated together do not compile.
    common = _common(unit, facts, _NO_PAIR)
    texts = [folded(render(name, **common, **context)) for name in ("c99/header.h.j2", "c99/source.c.j2")]
    pair = hashlib.sha256("".join(texts).replace(_NO_PAIR, "").encode()).hexdigest()[:16]
    header, source = (text.replace(_NO_PAIR, pair) for text in texts)
    return header, source, pair


def _common(unit: Unit, facts: Facts, pair: str) -> dict[str, object]:
    """Return the variables of every template; ``pair``: the digest of header and source."""
    return {
        "robot": unit.robot,
        "upper": unit.robot.upper(),
        "scalar": unit.choice.scalar,
        "banner": _banner(facts),
        "pair": pair,
    }


def _banner(facts: Facts) -> list[str]:
    lines = [*comment_lines(facts.description), ""] if facts.description else []
    for text in (
        f"Generated by wmrgen {facts.wmrgen_version}. Model hash: {facts.model_hash}",
        "This file is yours: use, change and sell it as you like. Licence MIT-0, no warranty.",
    ):
        lines += comment_lines(text)
    return lines


def _table(facts: Facts) -> list[str]:
    """Return the frame and the wheels, which follow the banner of a header."""
    lines = comment_lines(
        "Robot frame: origin P, x forward, y left, angles counter-clockwise (REP 103). SI units, radians."
    )
    if facts.wheel_lines:
        lines += ["", "Wheels, in the order of the robot file:"]
        for text in facts.wheel_lines:
            lines += [f"  {line}" for line in comment_lines(text, WIDTH - 5)]
    return lines


def _notes(facts: Facts, arithmetic: Sequence[str]) -> list[str]:
    """Return the end of a header: what the arithmetic requires, and which bounds are proved."""
    lines = [line for text in arithmetic for line in comment_lines(text)]
    if facts.bound_lines:
        lines.append("")
    for text in facts.bound_lines:
        lines += _indented(text)
    return lines


_STEPS = ("inverse", "forward", "odometry")
_EXAMPLE = {  # initial values; {0} is the suffix of literals
    "twist": "{{0.5{0}, 0.0{0}, 0.2{0}}}",
    "pose": "{{0.0{0}, 0.0{0}, 0.0{0}}}",
    "wheels": "{{{{0.0{0}}}}}",
}


def _example(unit: Unit) -> list[str]:
    """Return the statements of the example in a header: commands for a twist, and the pose after a step."""
    steps = [unit.contract[name] for name in _STEPS if name in unit.contract]
    before = unit.before(steps)
    ending = "f" if unit.choice.scalar == "float" else ""
    called = {"now": "wheels", "out": "wheels", "dt": f"0.01{ending}"}
    declared: dict[str, str] = {}
    for step in (*before, *steps):
        declared |= {called.get(p, p): kind for p, kind in step.variables.items() if p not in ("dt", "slip")}
    if not steps:
        return []
    lines = []
    for variable, kind in declared.items():
        value = f" = {_EXAMPLE[variable].format(ending)}" if variable in _EXAMPLE else ""
        lines.append(f"{kind} {variable}{value};")
    return [*lines, *(f"{call(step, called)};" for step in (*before, *steps))]


def _macros_elsewhere(structs: Iterable[Iterable[str]]) -> list[str]:
    """Return the names of wheels and parameters that are macros of AVR's headers, which would hide them."""
    code = " ".join(line.partition("/*")[0] for lines in structs for line in lines)
    return [word for word in dict.fromkeys(re.findall(r"\w+", code)) if AVR_MACROS.keeps(word)]


def _macro(name: str) -> str:
    return name.upper().replace(".", "_")


def _constants(unit: Unit, facts: Facts) -> list[tuple[str, str, str]]:
    """Return name, value and text of the numbers of the robot file that a program may need."""
    constants = []
    for name, value, text in facts.constants:
        number = str(value) if isinstance(value, int) else literal(Exact(Fraction(value)), unit.choice.scalar)
        constants.append((_macro(name), number, text))
    if "inverse" in unit.contract and "inverse_slip" not in unit.contract:
        constants.append(
            ("INVERSE_SLIP_IS_0", "1", "no twist makes wheels slide, so there is no inverse_slip")
        )
    return constants


def _indented(text: str) -> list[str]:
    """Return comment lines with the indent of ``text``."""
    bare = text.lstrip()
    indent = " " * (len(text) - len(bare))
    return [indent + line for line in comment_lines(bare, WIDTH - 3 - len(indent))]


def _arithmetic_notes(unit: Unit) -> list[str]:
    """Return the paragraphs of a header about its arithmetic."""
    choice, ops = unit.choice, unit.ops
    inline = choice.scalar == "float" and choice.math == INLINE and choice.target != AVR
    waves = inline and not unit.written.isdisjoint(_WAVES)
    notes = [_general_note(unit, waves), _flags_note(unit)]
    if waves:
        notes.append(_accuracy_note(choice.target, unit.written))
    if Op.CALL in ops:
        notes.append(
            "The kernels at the top of the C file are inlined. With -Os, -Oz or -DWMRGEN_SMALL, kernels that are "
            "used more than once are called instead. This saves flash and costs time and stack; results are the same "
            "bit for bit."
        )
    small = [f"{step.name}()" for step in unit.steps if step.small]
    if small:
        notes.append(
            f"In that case {' and '.join(small)} also call{'s' * (len(small) == 1)} the variant that computes the same "
            "results and more."
        )
    if Op.FMA in ops:
        notes.append(
            "This file is for processors with a fused multiply-add (Cortex-M4F, M7, M33 and the like), on which fmaf "
            "is one instruction; for others use --target host, m0 or avr. Other processors with an FPU compute fmaf "
            "in double, which takes longer and gives the same bits (except for subnormal numbers). The file does not "
            "compile for an AVR. For other processors without an FPU it compiles only with -DWMRGEN_SLOW_FMA, and "
            "computes fmaf in double."
        )
    if not ops.isdisjoint({Op.IMUL, Op.IDIV, Op.ISQRT}):
        notes.append(
            "This file is for processors without floating point. Products, quotients and roots are computed in "
            "integers. They are those of IEEE 754 bit for bit, and take fewer instructions than the libraries of "
            "compilers."
        )
    return notes


def _general_note(unit: Unit, waves: bool) -> str:
    """Return what holds for every function; ``waves``: whether sines and arctangents are own kernels."""
    angles = " and angles (and omega dt) up to 12000 rad" if waves else ""
    if unit.choice.scalar == "double" and "odometry_covariance" in unit.contract:
        angles += " (for odometry_covariance, dt up to 1 s)"
    return (
        f"Scalars are {unit.choice.scalar}. There are no loops, recursion, heap or globals: every function may be "
        "called from any context. Results are those of the printed operations bit for bit, if the compiler does not "
        "contract operations (-ffp-contract=off) and evaluates them in the declared type (FLT_EVAL_METHOD 0 or 16). "
        f"Inputs up to {LARGEST_INPUT[unit.choice.scalar]} in magnitude{angles} give finite results; squares of "
        "larger inputs may overflow. NaN is not detected, and some outputs may be finite all the same, for example "
        "a steering angle at its limit. Check inputs, or use the functions of the _checked files."
    )


def _flags_note(unit: Unit) -> str:
    return (
        "Do not compile with -ffast-math or -funsafe-math-optimizations, which regroup sums. The C file rejects these "
        "options if the compiler announces them; otherwise it forbids regrouping where it can. Run the self-test with "
        f"your compiler and flags: test/{unit.robot}_selftest.c."
    )


def _accuracy_note(target: str, used: frozenset[Op]) -> str:
    """Return the errors of sines and arctangents; ``used``: operations of the functions."""
    errors = worst(target)
    parts = []
    if used & {Op.SIN, Op.COS}:
        parts.append(
            f"{errors.sine} ulp for the sine of an angle up to pi/2, {errors.circle} * 2**-24 for sines and cosines of "
            "angles up to 100 rad"
        )
    if used & {Op.ATAN, Op.ATAN2}:
        parts.append(f"{errors.arctangent} ulp for the arctangent of a number up to 1")
    how = "in integers, without tables" if target == M0 else "without branches or tables"
    return (
        f"Sines and arctangents are polynomials {how}. Their largest errors, found by testing every float of these "
        f"ranges, are {'; '.join(parts)}."
    )
