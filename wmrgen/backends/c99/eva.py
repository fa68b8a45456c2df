"""An entry point for Frama-C Eva: every function of the generated C, called with all inputs of their ranges."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from wmrgen.backends.c99.emit import Meta, sources, unit
from wmrgen.backends.c99.functions import Step
from wmrgen.backends.c99.text import Struct
from wmrgen.ir.kernels.choice import HOST, LIBM
from wmrgen.ir.nodes import Module

Ranges = Mapping[str, tuple[float, float]]
Cases = Mapping[str, Sequence[Ranges]]

# Any result that is no finite number is an alarm, beside what C leaves undefined.
OPTIONS = (
    "-eva", "-warn-special-float", "non-finite", "-eva-subdivide-non-linear", "20", "-eva-slevel", "16",
    "-eva-msg-key=-summary", "-kernel-warn-key", "parser:decimal-float=inactive",
)  # fmt: skip
HARNESS = "eva_main.c"
# Eva knows the C library's sines; it knows neither fmaf nor what the bits of a float mean.
PLAIN = Meta(math=LIBM, target=HOST)
_SHOW = "Frama_C_show_each_"


def harness(module: Module, cases: Cases, meta: Meta = PLAIN, waves: bool = False) -> dict[str, str]:
    """File name -> text: header, source and an entry point. ``cases``: parts of the inputs, per function.

    ``waves``: with sines and cosines of our own, see `_waves`; `command` must know, too.
    """
    made = unit(module, meta.scalar, meta.math, meta.target)
    prepare = next((s for s in made.steps if s.name == f"{made.robot}_prepare"), None)
    lines = [
        f'#include "{made.robot}.h"',
        '#include "__fc_builtin.h"',
        "",
        *(_waves(made.scalar) if waves else []),
    ]
    count = 0
    for step in made.steps:
        name = step.name.removeprefix(f"{made.robot}_")
        if step is not prepare:
            for ranges in cases.get(name, ()):
                # A function per case: what Eva keeps apart in one does not count in the next.
                lines += [
                    f"static void case_{count}(void)",
                    *_call(step, name, prepare, ranges, made.scalar),
                    "",
                ]
                count += 1
    lines += ["int main(void)", "{", *(f"    case_{k}();" for k in range(count)), "    return 0;", "}", ""]
    header, source = sources(module, meta)
    return {f"{made.robot}.h": header, f"{made.robot}.c": source, HARNESS: "\n".join(lines)}


def _waves(scalar: str) -> list[str]:
    """Sines and cosines in steps of 1/8 between -pi and pi: Eva's own are [-1, 1] for angles beyond pi/4.

    The library is taken to be off by 1e-6 at most.
    """
    end = "f" if scalar == "float" else ""
    lines = []
    for name, wave in (("sin", math.sin), ("cos", math.cos)):
        lines += [f"{scalar} eva_{name}{end}({scalar} x)", "{"]
        for k in range(-26, 26):
            low, high = k / 8, (k + 1) / 8
            ends = wave(low), wave(high)
            turn = 0.008 if 1 - max(abs(ends[0]), abs(ends[1])) < 0.008 else 1e-6
            least, most = max(-1.0, min(ends) - turn), min(1.0, max(ends) + turn)
            given = f"Frama_C_{scalar}_interval({least:.8f}{end}, {most:.8f}{end})"
            lines.append(f"    if (x >= {low!r}{end} && x <= {high!r}{end}) return {given};")
        lines += [f"    return Frama_C_{scalar}_interval(-1.0{end}, 1.0{end});", "}", ""]
    return lines


def _call(step: Step, name: str, prepare: Step | None, ranges: Ranges, scalar: str) -> list[str]:
    body: list[str] = []
    for struct, parameter in step.arguments[:-1]:
        body.append(f"{struct.name} {parameter};")
    if prepare is not None and any(parameter == "prepared" for _, parameter in step.arguments):
        for struct, parameter in prepare.arguments[:-1]:
            body += [f"{struct.name} {parameter};", *_fill(struct, parameter, ranges, scalar)]
        body.append(f"{prepare.name}({', '.join(f'&{parameter}' for _, parameter in prepare.arguments)});")
    for struct, parameter in step.arguments[:-1]:
        if parameter == "in":
            body += _fill(struct, "in", ranges, scalar)
    out = step.arguments[-1][0]
    body.append(f"{out.name} out;")
    body.append(f"{step.name}({', '.join(f'&{parameter}' for _, parameter in step.arguments)});")
    body.append(f"{_SHOW}{name}({', '.join(f'out.{m}' for m in out.members.values())});")
    return ["{", *(f"    {line}" for line in body), "}"]


def _fill(struct: Struct, variable: str, ranges: Ranges, scalar: str) -> list[str]:
    end = "f" if scalar == "float" else ""
    lines = []
    for key, member in struct.members.items():
        low, high = (f"{float(v).hex()}{end}" for v in ranges[key])
        lines.append(f"{variable}.{member} = Frama_C_{scalar}_interval({low}, {high});")
    return lines


def command(tool: str, robot: str, waves: bool = False) -> list[str]:
    """The command that analyses what `harness` wrote."""
    own = "-Dsinf=eva_sinf -Dcosf=eva_cosf"
    return [tool, *OPTIONS, *([f"-cpp-extra-args={own}"] if waves else []), HARNESS, f"{robot}.c"]


def alarms(output: str) -> tuple[str, ...]:
    """What Eva could not show, each with its place; whatever is no clean run is an alarm, too."""
    text = re.sub(r"\n +", " ", output)
    found = [
        line.removeprefix("[eva:alarm] ") for line in text.splitlines() if line.startswith("[eva:alarm]")
    ]
    if "done for function main" not in text:
        found.append("the analysis did not come to its end: " + " ".join(text.splitlines()[-3:]))
    if "using specification for function" in text:
        named = re.findall(r"using specification for function (\w+)", text)
        found += [f"no code and no built-in function for {n}" for n in named if n not in _KNOWN]
    if re.search(r"NON TERMINATING|assigns clause missing|Neither code nor specification", text):
        found.append("a function without code")
    return tuple(found)


# Known by their contracts in Frama-C's library: an interval, and functions whose results Eva bounds.
_KNOWN = {f"{name}{end}" for name in ("fabs", "sqrt", "sin", "cos", "atan", "atan2") for end in ("", "f")} | {
    "Frama_C_float_interval",
    "Frama_C_double_interval",
}


def shown(output: str) -> dict[str, tuple[tuple[float, float], ...]]:
    """Function -> range of every output over all cases, in the order of the struct."""
    text = re.sub(r"\n +", " ", output)
    found: dict[str, tuple[tuple[float, float], ...]] = {}
    for name, rest in re.findall(rf"{_SHOW}(\w+): *(.*)", text):
        parts = re.findall(r"\[(\S+) \.\. (\S+?)\]|\{(.*?)\}", rest)
        values = []
        for low, high, single in parts:
            numbers = [float(v) for v in (single.split(";") if single else (low, high))]
            values.append((min(numbers), max(numbers)))
        known = found.get(name, tuple(values))
        pairs = zip(known, values, strict=True)
        found[name] = tuple((min(a[0], b[0]), max(a[1], b[1])) for a, b in pairs)
    return found
