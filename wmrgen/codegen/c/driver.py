"""Programs of our own that call generated C.

A driver, fed through stdin, calls every function of one or many robots. Numbers cross the border as hexadecimal floats,
so nothing is rounded on the way; inputs are doubles and are rounded once, by the driver, to the target type.

An entry point for Frama-C Eva calls every function with all inputs of their ranges.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from wmrgen.codegen.c.emit import printed, unit
from wmrgen.codegen.c.records import Step, Unit
from wmrgen.codegen.compiler import DEFAULT_FLAGS, compile_and_run
from wmrgen.codegen.registry import Request
from wmrgen.codegen.render import render
from wmrgen.ir.calls import in_order, nominal
from wmrgen.ir.kernels.choice import DEFAULT, HOST, LIBM, Choice
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
PLAIN = Choice(math=LIBM, target=HOST)
# Known by their contracts in Frama-C's library: an interval, and functions whose results Eva bounds.
_KNOWN = {f"{name}{end}" for name in ("fabs", "sqrt", "sin", "cos", "atan", "atan2") for end in ("", "f")} | {
    "Frama_C_float_interval"
}


class Call(NamedTuple):
    """One wrapper of the driver: reads ``inputs`` and writes ``outputs``, contract names in this order."""

    robot: str
    function: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    lines: tuple[str, ...]


def calls(unit: Unit) -> tuple[Call, ...]:
    """One call per step function; the tunables, where there are any, are its last inputs."""
    return tuple(_call(unit, step) for step in unit.contract.values())


def _call(unit: Unit, step: Step) -> Call:
    inputs = unit.inputs(step)
    lines = [f"{kind} {name};" for name, kind in unit.variables(step).items()]
    lines += [f"{member} = ({unit.choice.scalar})x[{k}];" for k, member in enumerate(inputs.values())]
    lines += [f"{called.call()};" for called in (*unit.before([step])[-1:], step)]  # prepare: params are set
    outputs = step.outputs
    lines += [f"y[{k}] = (double){member};" for k, member in enumerate(outputs.values())]
    lines += [] if inputs else ["(void)x;"]
    return Call(unit.robot, step.name, tuple(inputs), tuple(outputs), tuple(lines))


def driver(calls: Sequence[Call]) -> str:
    """The C of a program that reads ``index inputs…`` lines and prints the outputs of each."""
    robots = list(dict.fromkeys(call.robot for call in calls))
    most_in = max([1, *(len(call.inputs) for call in calls)])
    most_out = max([1, *(len(call.outputs) for call in calls)])
    return render("c99/driver.c.j2", robots=robots, calls=calls, most_in=most_in, most_out=most_out)


def request(index: int, call: Call, values: Mapping[str, float]) -> str:
    """One line for the driver. UsageError where an input has no value."""
    return " ".join([str(index), *(x.hex() for x in in_order(call.function, call.inputs, values))])


def answer(call: Call, line: str) -> dict[str, float]:
    """Outputs by contract name from one line of the driver."""
    return dict(zip(call.outputs, map(float.fromhex, line.split()), strict=True))


def evaluate_c(
    module: Module,
    requests: Sequence[Request],
    choice: Choice = DEFAULT,
    cc: str | None = None,
    flags: Sequence[str] = DEFAULT_FLAGS,
) -> list[dict[str, float]]:
    """Outputs of each request, from the compiled C: none of a function that has none."""
    functions, default = unit(module, choice), nominal(module)
    steps = {name: functions.contract[name] for name, _ in requests if name in functions.contract}
    called = {name: (k, _call(functions, step)) for k, (name, step) in enumerate(steps.items())}
    asked = [(*called[name], case) for name, case in requests if name in called]
    lines = [request(k, call, {**default, **case}) for k, call, case in asked]
    header, source, _ = printed(functions)
    main = driver([call for _, call in called.values()])
    files = {f"{module.name}.h": header, f"{module.name}.c": source, "wmrgen-driver.c": main}
    told = iter(compile_and_run(files, "\n".join(lines) + "\n", cc, flags).splitlines())
    return [answer(called[name][1], next(told)) if name in called else {} for name, _ in requests]


# ---- Frama-C Eva


def harness(module: Module, cases: Cases, waves: bool = False) -> dict[str, str]:
    """File name -> text: header, source and an entry point. ``cases``: parts of the inputs, per function.

    ``waves``: with sines and cosines of our own, see `_waves`; `command` must know, too.
    """
    functions = unit(module, PLAIN)
    lines = [f'#include "{functions.robot}.h"', '#include "__fc_builtin.h"', ""]
    lines += _waves() if waves else []
    parts = [(name, ranges) for name in functions.contract for ranges in cases.get(name, ())]
    for k, (name, ranges) in enumerate(parts):
        # A function per case: what Eva keeps apart in one does not count in the next.
        body = (f"    {line}" for line in _case(functions, name, ranges))
        lines += [f"static void case_{k}(void)", "{", *body, "}", ""]
    lines += [
        "int main(void)",
        "{",
        *(f"    case_{k}();" for k in range(len(parts))),
        "    return 0;",
        "}",
        "",
    ]
    header, source, _ = printed(functions)
    return {f"{functions.robot}.h": header, f"{functions.robot}.c": source, HARNESS: "\n".join(lines)}


def _case(unit: Unit, called: str, ranges: Ranges) -> list[str]:
    """A call with all inputs of their ranges."""
    step = unit.contract[called]
    lines = [f"{kind} {variable};" for variable, kind in unit.variables(step).items()]
    for name, member in unit.inputs(step).items():
        low, high = (f"{float(v).hex()}f" for v in ranges[name])
        lines.append(f"{member} = Frama_C_float_interval({low}, {high});")
    lines += [f"{each.call()};" for each in (*unit.before([step])[-1:], step)]
    return lines


def _waves() -> list[str]:
    """Sines and cosines in steps of 1/8 between -pi and pi: Eva's own are [-1, 1] for angles beyond pi/4.

    The library is taken to be off by 1e-6 at most.
    """
    lines = []
    for name, wave in (("sin", math.sin), ("cos", math.cos)):
        lines += [f"float eva_{name}f(float x)", "{"]
        for k in range(-26, 26):
            low, high = k / 8, (k + 1) / 8
            ends = wave(low), wave(high)
            turn = 0.008 if 1 - max(abs(ends[0]), abs(ends[1])) < 0.008 else 1e-6
            least, most = max(-1.0, min(ends) - turn), min(1.0, max(ends) + turn)
            result = f"Frama_C_float_interval({least:.8f}f, {most:.8f}f)"
            lines.append(f"    if (x >= {low!r}f && x <= {high!r}f) return {result};")
        lines += ["    return Frama_C_float_interval(-1.0f, 1.0f);", "}", ""]
    return lines


def command(tool: str, robot: str, waves: bool = False) -> list[str]:
    """The command that analyses what `harness` wrote."""
    own = "-Dsinf=eva_sinf -Dcosf=eva_cosf"
    return [tool, *OPTIONS, *([f"-cpp-extra-args={own}"] if waves else []), HARNESS, f"{robot}.c"]


def alarms(output: str) -> tuple[str, ...]:
    """What Eva could not show, each with its place; whatever is no clean run is an alarm, too."""
    text = re.sub(r"\n +", " ", output)
    lines = text.splitlines()
    alarms = [line.removeprefix("[eva:alarm] ") for line in lines if line.startswith("[eva:alarm]")]
    if "done for function main" not in text:
        alarms.append("the analysis did not come to its end: " + " ".join(lines[-3:]))
    if "using specification for function" in text:
        named = re.findall(r"using specification for function (\w+)", text)
        alarms += [f"no code and no built-in function for {n}" for n in named if n not in _KNOWN]
    if re.search(r"NON TERMINATING|assigns clause missing|Neither code nor specification", text):
        alarms.append("a function without code")
    return tuple(alarms)
