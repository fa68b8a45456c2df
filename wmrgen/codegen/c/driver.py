"""Programs that call generated C: to compute its values, and to analyse it.

The driver reads requests from stdin and calls the functions of one or several robots. It exchanges numbers as
hexadecimal floats, which are exact. Inputs are doubles; the driver rounds them once, to the scalar type of the C.

The functions for arrays are compiled to a library and loaded.

The entry point for Frama-C Eva calls every function with all inputs within their ranges.
"""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from wmrgen.codegen.c.batch import batch, batch_functions
from wmrgen.codegen.c.emit import printed, unit
from wmrgen.codegen.c.functions import call as call_of
from wmrgen.codegen.compiler import DEFAULT_FLAGS, compile_and_run, load_library
from wmrgen.codegen.registry import Request
from wmrgen.codegen.render import render
from wmrgen.codegen.unit import Step, Unit
from wmrgen.ir.calls import in_order, nominal
from wmrgen.ir.kernels.choice import DEFAULT, HOST, LIBM, Choice
from wmrgen.ir.nodes import Module

Ranges = Mapping[str, tuple[float, float]]  # contract name of an input -> least and largest value
Cases = Mapping[str, Sequence[Ranges]]  # function -> parts of the range of its inputs

# Eva reports every result that is not finite, in addition to undefined behaviour.
OPTIONS = (
    "-eva", "-warn-special-float", "non-finite", "-eva-subdivide-non-linear", "20", "-eva-slevel", "16",
    "-eva-msg-key=-summary", "-kernel-warn-key", "parser:decimal-float=inactive",
)  # fmt: skip
HARNESS = "eva_main.c"
# Eva can analyse sines of the C library, but neither fmaf nor operations on the bits of a float.
PLAIN = Choice(math=LIBM, target=HOST)
# Functions without code whose results Eva bounds: an interval, and functions of the C library.
_KNOWN = {f"{name}{end}" for name in ("fabs", "sqrt", "sin", "cos", "atan", "atan2") for end in ("", "f")} | {
    "Frama_C_float_interval"
}


class Call(NamedTuple):
    """A function of the driver that calls one C function."""

    robot: str
    function: str  # name of the C function
    inputs: tuple[str, ...]  # contract names, in the order of the driver
    outputs: tuple[str, ...]
    lines: tuple[str, ...]  # statements


def calls(unit: Unit) -> tuple[Call, ...]:
    """Return a call for each function of the robot; tunable parameters are its last inputs."""
    return tuple(_call(unit, step) for step in unit.contract.values())


def _call(unit: Unit, step: Step) -> Call:
    inputs = unit.inputs(step)
    prepare = unit.before([step])[-1:]  # without params_default: the parameters are inputs
    lines = [f"{kind} {name};" for name, kind in unit.variables(step).items()]
    lines += [f"{member} = ({unit.choice.scalar})x[{k}];" for k, member in enumerate(inputs.values())]
    lines += [f"{call_of(each)};" for each in (*prepare, step)]
    outputs = step.outputs
    lines += [f"y[{k}] = (double){member};" for k, member in enumerate(outputs.values())]
    lines += [] if inputs else ["(void)x;"]
    return Call(unit.robot, step.name, tuple(inputs), tuple(outputs), tuple(lines))


def driver(calls: Sequence[Call]) -> str:
    """Return a C program that reads lines ``index inputs…`` and prints the outputs of each."""
    robots = list(dict.fromkeys(call.robot for call in calls))
    most_in = max([1, *(len(call.inputs) for call in calls)])
    most_out = max([1, *(len(call.outputs) for call in calls)])
    return render("c99/driver.c.j2", robots=robots, calls=calls, most_in=most_in, most_out=most_out)


def request(index: int, call: Call, values: Mapping[str, float]) -> str:
    """Return one line for the driver.

    Args:
        index: Number of the call in the driver.
        call: The call.
        values: Contract name -> value of each input.

    Raises:
        UsageError: An input has no value.
    """
    return " ".join([str(index), *(x.hex() for x in in_order(call.function, call.inputs, values))])


def answer(call: Call, line: str) -> dict[str, float]:
    """Return the outputs by contract name from one line that the driver printed."""
    return dict(zip(call.outputs, map(float.fromhex, line.split()), strict=True))


def evaluate_c(
    module: Module,
    requests: Sequence[Request],
    choice: Choice = DEFAULT,
    cc: str | None = None,
    flags: Sequence[str] = DEFAULT_FLAGS,
) -> list[dict[str, float]]:
    """Compile the C and return the outputs of each request; they are empty for a function without outputs.

    Args:
        module: The functions of the robot.
        requests: Names of functions with their inputs by contract name; tunable parameters may be left out.
        choice: Scalar type, sines and processor of the C.
        cc: Command of the compiler; None for that of the system.
        flags: Flags of the compiler.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
        UsageError: A request lacks an input.
    """
    functions, default = unit(module, choice), nominal(module)
    steps = {name: functions.contract[name] for name, _ in requests if name in functions.contract}
    called = {name: (k, _call(functions, step)) for k, (name, step) in enumerate(steps.items())}
    lines = []
    for name, case in requests:
        if name in called:
            lines.append(request(*called[name], {**default, **case}))
    header, source, _ = printed(functions)
    main = driver([call for _, call in called.values()])
    files = {f"{module.name}.h": header, f"{module.name}.c": source, "wmrgen-driver.c": main}
    printed_lines = iter(compile_and_run(files, "\n".join(lines) + "\n", cc, flags).splitlines())
    return [answer(called[name][1], next(printed_lines)) if name in called else {} for name, _ in requests]


# ---- functions for arrays, compiled and loaded for NumPy

Columns = dict[str, Any]  # contract name -> array


def compiled(module: Module, choice: Choice) -> Callable[[str, Mapping[str, Any]], Columns]:
    """Compile the functions of ``module`` for arrays with the compiler of the system, and load them.

    Args:
        module: The functions.
        choice: Scalar type of the C, its sines, and the processor.

    Returns:
        A function that takes the name of a function and its inputs (contract name -> array; tunable parameters that are
        left out are nominal) and returns the outputs by contract name, in the shape to which the inputs broadcast.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    functions = unit(module, choice)
    header, source, pair = printed(functions)
    scalar = choice.scalar
    common = {"robot": module.name, "upper": module.name.upper(), "scalar": scalar, "pair": pair}
    files = {f"{module.name}.h": header, f"{module.name}.c": source}
    files[f"{module.name}_many.h"], files[f"{module.name}_many.c"] = batch(functions, common)
    library = load_library(files, f"{module.name}_many.c")
    kind: Any = np.float64 if scalar == "double" else np.float32
    defaults, forms = nominal(module), batch_functions(functions)

    def call_compiled(name: str, inputs: Mapping[str, Any]) -> Columns:
        form = forms[name]
        given = {**defaults, **inputs}
        arrays = np.broadcast_arrays(*(np.asarray(given[port], dtype=kind) for port in form.inputs))
        shape = arrays[0].shape if arrays else ()
        flat = [np.ascontiguousarray(array).reshape(-1) for array in arrays]
        results = {port: np.empty(shape, kind) for port in form.outputs}
        function = getattr(library, form.name)
        function.restype = None
        function(ctypes.c_size_t(int(np.prod(shape))), _pointers(flat), _pointers(results.values()))
        return {port: array[()] for port, array in results.items()}

    return call_compiled


def _pointers(arrays: Any) -> Any:
    """Return a C struct whose members point to the arrays."""
    addresses = [array.ctypes.data for array in arrays]
    return (ctypes.c_void_p * max(1, len(addresses)))(*addresses)


# ---- Frama-C Eva


def harness(module: Module, cases: Cases, waves: bool = False) -> dict[str, str]:
    """Return the files for Eva by name: header, source and entry point.

    Args:
        module: The functions of the robot.
        cases: Parts of the inputs of each function.
        waves: Whether `_waves` replaces the sines and cosines; `command` needs the same value.
    """
    functions = unit(module, PLAIN)
    lines = [f'#include "{functions.robot}.h"', '#include "__fc_builtin.h"', ""]
    lines += _waves() if waves else []
    parts = [(name, ranges) for name in functions.contract for ranges in cases.get(name, ())]
    for k, (name, ranges) in enumerate(parts):
        # Each case is a function, because Eva limits the number of states that it distinguishes in a function.
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
    """Return the statements that call a function with all inputs within their ranges."""
    step = unit.contract[called]
    lines = [f"{kind} {variable};" for variable, kind in unit.variables(step).items()]
    for name, member in unit.inputs(step).items():
        low, high = (f"{float(v).hex()}f" for v in ranges[name])
        lines.append(f"{member} = Frama_C_float_interval({low}, {high});")
    prepare = unit.before([step])[-1:]  # without params_default: the parameters are inputs
    return [*lines, *(f"{call_of(each)};" for each in (*prepare, step))]


def _waves() -> list[str]:
    """Return C functions that bound sines and cosines in steps of 1/8 between -pi and pi.

    Eva itself bounds them by [-1, 1] for angles beyond pi/4. The error of the library is assumed to be at most 1e-6.
    """
    lines = []
    for name, wave in (("sin", math.sin), ("cos", math.cos)):
        lines += [f"float eva_{name}f(float x)", "{"]
        for k in range(-26, 26):
            low, high = k / 8, (k + 1) / 8
            ends = wave(low), wave(high)
            # Near an extremum, the wave exceeds its ends by at most 1 - cos(1/8) = 0.008.
            turn = 0.008 if 1 - max(abs(ends[0]), abs(ends[1])) < 0.008 else 1e-6
            least, most = max(-1.0, min(ends) - turn), min(1.0, max(ends) + turn)
            result = f"Frama_C_float_interval({least:.8f}f, {most:.8f}f)"
            lines.append(f"    if (x >= {low!r}f && x <= {high!r}f) return {result};")
        lines += ["    return Frama_C_float_interval(-1.0f, 1.0f);", "}", ""]
    return lines


def command(tool: str, robot: str, waves: bool = False) -> list[str]:
    """Return the command that analyses the files of `harness`.

    Args:
        tool: Path of Frama-C.
        robot: Name of the robot.
        waves: As in `harness`.
    """
    own = "-Dsinf=eva_sinf -Dcosf=eva_cosf"
    return [tool, *OPTIONS, *([f"-cpp-extra-args={own}"] if waves else []), HARNESS, f"{robot}.c"]


def alarms(output: str) -> tuple[str, ...]:
    """Return what Eva could not prove, each with its place; a run that did not complete is an alarm, too."""
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
