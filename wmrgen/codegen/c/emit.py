"""All C files of a robot, through templates/c99: header and source, and what an integrator needs beside them."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction

from wmrgen.codegen.c.checked import checked
from wmrgen.codegen.c.counters import counting
from wmrgen.codegen.c.example import example
from wmrgen.codegen.c.functions import printed_kernels, shared_structs, steps_of
from wmrgen.codegen.c.records import Unit
from wmrgen.codegen.c.selftest import selftest
from wmrgen.codegen.c.text import comment_lines, folded, literal
from wmrgen.codegen.expression import expanded
from wmrgen.codegen.registry import Facts
from wmrgen.codegen.render import render
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import JOINTS
from wmrgen.ir.kernels import rounds
from wmrgen.ir.kernels.choice import AVR, DEFAULT, INLINE, M0, Choice
from wmrgen.ir.kernels.trigonometry import worst
from wmrgen.ir.nodes import Module, Op
from wmrgen.ir.ops import integer
from wmrgen.robotfile.reserved_words import AVR_MACROS

NO_FACTS = Facts()
TEST = "test"  # the folder of what is no part of a firmware: a build that takes every *.c does not find it
EXAMPLE = "example/main.c"
INTEGER = {"isin", "icos", "iatan", "imul", "idiv", "isqrt"}  # see templates/c99/integer.c.j2
_NO_PAIR = "\0"  # stands for the digest of two files until it is known; no text has it
LARGEST_INPUT = {"float": "1e9", "double": "1e100"}
_WAVES = {Op.SIN, Op.COS, Op.ATAN, Op.ATAN2}


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """File name -> content. Options are those of `Choice`; ``fuzz``: a fuzzing harness too; ``batch``: the functions
    over arrays of states too."""
    choice = Choice(**{key: str(word) for key, word in facts.options.items() if key in Choice._fields})
    functions = unit(module, choice)
    header, source, pair = printed(functions, facts)
    common = _common(functions, facts, pair)
    checked_header, checked_source = checked(module, functions, facts.site, common)
    files = {".h": header, ".c": source, "_checked.h": checked_header, "_checked.c": checked_source}
    apart = {"_selftest.c": selftest(module, functions, facts.site, common)}
    if facts.options.get("fuzz"):
        from wmrgen.codegen.c.fuzz import fuzz

        apart["_fuzz.c"] = fuzz(module, functions, facts.site, common)
    if facts.options.get("batch"):
        from wmrgen.codegen.c.batch import batch

        files["_many.h"], files["_many.c"] = batch(functions, common)
    named = {module.name + ending: text for ending, text in files.items()}
    named |= {f"{TEST}/{module.name}{ending}": text for ending, text in apart.items()}
    if module.joints:
        named[EXAMPLE] = example(module, functions, facts.site, common)
    return {name: folded(text).encode("ascii") for name, text in named.items()}


def sources(module: Module, choice: Choice = DEFAULT, facts: Facts = NO_FACTS) -> tuple[str, str]:
    """The text of ``<robot>.h`` and ``<robot>.c``."""
    return printed(unit(module, choice), facts)[:2]


def unit(module: Module, choice: Choice = DEFAULT) -> Unit:
    """The C functions of ``module``: params_default and prepare first when a parameter is tunable."""
    written = frozenset(node.op for function in module.functions for node in function.nodes)
    scalar = choice.scalar
    module, costs = expanded(module, choice)
    shared = shared_structs(module, scalar)
    steps, kernels = steps_of(module, scalar, costs, shared), printed_kernels(module, scalar)
    joints = module.joints or ()
    plain_unit = Unit(
        module.name, choice, tuple(shared.values()), joints, steps, kernels, rounds(module), written
    )
    return plain_unit._replace(counting=counting(module, plain_unit.contract, scalar))


def printed(unit: Unit, facts: Facts = NO_FACTS) -> tuple[str, str, str]:
    """Header, source, and the digest that stands in both."""
    choice, ops = unit.choice, unit.ops
    counters = () if unit.counting is None else unit.counting[:1]
    needs = {op.name for op in ops}
    includes = {
        "<float.h>": unit.rounds,
        "<stddef.h>": bool(unit.joints),
        "<math.h>": any("<math.h>" in op.includes for op in ops),
        "<stdint.h>": any("<stdint.h>" in op.includes for op in ops),
    }
    structs = [struct.lines for struct in (*unit.structs.values(), *counters)]
    context: dict[str, object] = {
        "table": _table(facts),
        "notes": _notes(facts, _arithmetic_notes(unit)),
        "example": _example(unit),
        "constants": _constants(unit, facts),
        "joints": [
            (_macro(name), f"[{JOINTS[name.rpartition('.')[2]].unit}] {name}") for name in unit.joints
        ],
        "version": facts.wmrgen_version,
        "model_hash": "".join(c for c in facts.model_hash if c.isalnum()),
        "structs": structs,
        "macros": _macros_elsewhere(structs),
        "steps": unit.every,
        "counters": bool(counters),
        "kernels": unit.kernels,
        "kernels_for": "_".join((choice.target, choice.scalar, choice.math)).upper(),
        "includes": [name for name, needed in includes.items() if needed],
        "rounds": unit.rounds,
        "integer": integer if needs & INTEGER else None,
        "needs": needs,
    }
    # The digest of both files stands in both: any two that were not written together refuse to compile.
    common = _common(unit, facts, _NO_PAIR)
    texts = [folded(render(name, **common, **context)) for name in ("c99/header.h.j2", "c99/source.c.j2")]
    pair = hashlib.sha256("".join(texts).replace(_NO_PAIR, "").encode()).hexdigest()[:16]
    header, source = (text.replace(_NO_PAIR, pair) for text in texts)
    return header, source, pair


def _common(unit: Unit, facts: Facts, pair: str) -> dict[str, object]:
    """What every template is told; ``pair``: the digest of header and source."""
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
        f"Generated by wmrgen {facts.wmrgen_version} (sympy {facts.sympy_version}). "
        f"Model hash: {facts.model_hash}",
        "This file is yours: use, change and sell it as you like. Licence MIT-0, no warranty.",
    ):
        lines += comment_lines(text)
    return lines


def _table(facts: Facts) -> list[str]:
    """What stands below the banner of a header: frame and wheels."""
    lines = comment_lines(
        "Robot frame: origin P, x forward, y left, angles counter-clockwise (REP 103). SI units, radians."
    )
    if facts.wheel_lines:
        lines += ["", "Wheels, in the order of the robot file:"]
        lines += [f"  {line}" for text in facts.wheel_lines for line in comment_lines(text, 95)]
    return lines


def _notes(facts: Facts, arithmetic: Sequence[str]) -> list[str]:
    """What stands at the end of a header: what its arithmetic needs and what is proved of it."""
    lines = [line for text in arithmetic for line in comment_lines(text)]
    if facts.bound_lines:
        lines += ["", *(line for text in facts.bound_lines for line in _indented(text))]
    return lines


_STEPS = ("inverse", "forward", "odometry")
_EXAMPLE = {
    "twist": "{{0.5{0}, 0.0{0}, 0.2{0}}}",
    "pose": "{{0.0{0}, 0.0{0}, 0.0{0}}}",
    "wheels": "{{{{0.0{0}}}}}",
}


def _example(unit: Unit) -> list[str]:
    """Statements that drive a robot for a step: commands of a twist, and what the wheels say of it."""
    steps = [unit.contract[name] for name in _STEPS if name in unit.contract]
    before = unit.before(steps)
    ending = "f" if unit.choice.scalar == "float" else ""
    called = {"now": "wheels", "out": "wheels", "dt": f"0.01{ending}"}
    declared: dict[str, str] = {}
    for step in (*before, *steps):
        declared |= {called.get(p, p): kind for p, kind in step.variables.items() if p not in ("dt", "slip")}
    lines = []
    for variable, kind in declared.items():
        value = f" = {_EXAMPLE[variable].format(ending)}" if variable in _EXAMPLE else ""
        lines.append(f"{kind} {variable}{value};")
    return [*lines, *(f"{step.call(called)};" for step in (*before, *steps))] if steps else []


def _macros_elsewhere(structs: Iterable[Iterable[str]]) -> list[str]:
    """Members, as wheels and parameters are called, that would not be read where a macro has their name."""
    code = " ".join(line.partition("/*")[0] for lines in structs for line in lines)
    return [word for word in dict.fromkeys(re.findall(r"\w+", code)) if AVR_MACROS.keeps(word)]


def _macro(name: str) -> str:
    return name.upper().replace(".", "_")


def _constants(unit: Unit, facts: Facts) -> list[tuple[str, str, str]]:
    """Name, value and what it is, of every number of the robot file that a program may want."""
    scalar = unit.choice.scalar
    constants = [
        (
            _macro(name),
            str(value) if isinstance(value, int) else literal(Exact(Fraction(value)), scalar),
            text,
        )
        for name, value, text in facts.constants
    ]
    names = {step.name.removeprefix(f"{unit.robot}_") for step in unit.steps}
    if "inverse" in names and "inverse_slip" not in names:
        constants.append(("INVERSE_SLIP_IS_0", "1", "no twist makes wheels slide: there is no inverse_slip"))
    return constants


def _indented(text: str) -> list[str]:
    """Comment lines that keep the indent of ``text``."""
    bare = text.lstrip()
    indent = " " * (len(text) - len(bare))
    return [indent + line for line in comment_lines(bare, 97 - len(indent))]


def _arithmetic_notes(unit: Unit) -> list[str]:
    """What a header says about its arithmetic, in paragraphs."""
    choice, ops = unit.choice, unit.ops
    inline = choice.scalar == "float" and choice.math == INLINE and choice.target != AVR
    waves = inline and not unit.written.isdisjoint(_WAVES)
    angles = " and angles (and omega dt) up to 12000 rad" if waves else ""
    if choice.scalar == "double" and "odometry_covariance" in unit.contract:
        angles += " (of odometry_covariance dt up to 1 s)"
    notes = [
        f"Scalars are {choice.scalar}. No loops, recursion, heap or globals: every function may be called from "
        "anywhere. Results are bit for bit those of the printed operations where the compiler contracts "
        "nothing (-ffp-contract=off) and evaluates in the declared type (FLT_EVAL_METHOD 0 or 16). Inputs up to "
        f"{LARGEST_INPUT[choice.scalar]} in magnitude{angles} give finite results; beyond, squares may overflow. NaN "
        "is not caught: some outputs may come out as numbers all the same, a steering angle at its limit for one. "
        "Check inputs, or take the functions of the _checked files.",
        "Compile without -ffast-math and -funsafe-math-optimizations, which regroup sums: the C file refuses them "
        "where the compiler tells of them, else it forbids regrouping where it can. Run the self-test with your "
        f"compiler and flags: test/{unit.robot}_selftest.c.",
    ]
    if waves:
        notes.append(_accuracy_note(choice.target, unit.written))
    if Op.CALL in ops:
        notes.append(
            "The kernels at the top of the C file are inlined. Compiled with -Os, -Oz or -DWMRGEN_SMALL those with "
            "several calls are called: the least flash, the same results to the bit; calls cost time and stack."
        )
    calls = [f"{step.name}()" for step in unit.steps if step.small]
    if calls:
        notes.append(
            f"Then {' and '.join(calls)} also call{'s' * (len(calls) == 1)} the function that gives the "
            "same results and more, instead of computing them again."
        )
    if Op.FMA in ops:
        notes.append(
            "Written for processors with a fused multiply-add (Cortex-M4F, M7, M33 and the like), where fmaf is one "
            "instruction; for others there are --target host, m0 and avr. Another processor with an FPU goes by way of "
            "double, to the same bits (of numbers that are not subnormal) and in more time. An AVR and processors "
            "without an FPU are refused at compile time; -DWMRGEN_SLOW_FMA lets the latter go by way of double, too."
        )
    if not ops.isdisjoint({Op.IMUL, Op.IDIV, Op.ISQRT}):
        notes.append(
            "Written for processors without floating point: products, quotients and roots are formed in integers, to "
            "the last bit what IEEE 754 says, from fewer instructions than compilers' libraries take."
        )
    return notes


def _accuracy_note(target: str, used: frozenset[Op]) -> str:
    errors = worst(target)
    parts = []
    if used & {Op.SIN, Op.COS}:
        parts.append(
            f"a sine of up to pi/2 is within {errors.sine} ulp, sines and cosines of angles up to 100 rad within "
            f"{errors.circle} * 2**-24"
        )
    if used & {Op.ATAN, Op.ATAN2}:
        parts.append(f"an arctangent of up to 1 within {errors.arctangent} ulp")
    how = "in integers, without tables" if target == M0 else "without branches or tables"
    tried = f"Every float of these ranges was tried: {'; '.join(parts)} of the true value."
    return f"Sines and arctangents are polynomials {how}. {tried}"
