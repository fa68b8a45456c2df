"""Programs for emulated boards, which compare generated C with the interpreter bit for bit."""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Sequence
from pathlib import Path

from benchmarks.emulator import gcc
from benchmarks.emulator.fleet import LIBM
from tests.codegen.processor.fleets import host, inputs
from tests.conftest import put
from tests.ir.selftest.every import files_of, place_of
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.emit import unit
from wmrgen.codegen.c.functions import call
from wmrgen.codegen.unit import Step
from wmrgen.ir.interpret import evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ir.nodes import Module

# A Cortex-M from its vector table on: FPU on, main, then the debugger's call that ends the emulator.
START = """
extern int main(void);
static void say(const char *text)
{
    register int call __asm__("r0") = 4;
    register const char *what __asm__("r1") = text;
    __asm__ volatile("bkpt 0xab" : "+r"(call) : "r"(what) : "memory");
}
static void reset(void)
{
#ifdef __ARM_FP
    *(volatile unsigned *)0xE000ED88 |= 0xF << 20;
    __asm__ volatile("dsb\\n isb");
#endif
    say(main() ? "different\\n" : "the same\\n");
    register int call __asm__("r0") = 0x18;
    register int why __asm__("r1") = 0x20026;
    __asm__ volatile("bkpt 0xab" : : "r"(call), "r"(why));
    for (;;) {
    }
}
__attribute__((section(".vectors"), used)) const void *const vectors[2] = {(void *)0x20002000, (void *)reset};
"""
# An ATmega: the answer on the serial port, then sleep without interrupts, which ends simavr.
AVR = """
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
int check(void);
int main(void)
{
    const char *text = check() ? "different\\n" : "the same\\n";
    UCSR0B = 1 << TXEN0;
    for (; *text; text++) {
        while (!(UCSR0A & (1 << UDRE0))) {
        }
        UDR0 = *text;
    }
    for (volatile int k = 0; k < 10000; k++) {
    }
    cli();
    sleep_mode();
    return 0;
}
"""


def _table(name: str, rows: Sequence[Sequence[float]]) -> str:
    """Words of float32."""
    words = ["{" + ", ".join(f"{_word(value):#010x}u" for value in row) + "}" for row in rows]
    return f"static const uint32_t {name}[{len(rows)}][{len(rows[0])}] = {{\n" + ",\n".join(words) + "\n};"


def _word(value: float) -> int:
    (word,) = struct.unpack("<I", struct.pack("<f", value))
    return int(word)


def _calls_libm(module: Module, step: Step, target: str) -> bool:
    """Return whether the interpreter would need the board's libm."""
    function = expand(module, "float", DEFAULT.math, target).function(
        step.name.removeprefix(f"{module.name}_")
    )
    return any(f"{node.op.name}f" in set(LIBM) - {"sqrtf"} for node in function.nodes)


def _check(module: Module, step: Step, target: str, count: int) -> str:
    """Return ``static int check_<function>(void)``, which counts outputs with other bits than the interpreter's."""
    name = step.name.removeprefix(f"{module.name}_")
    cases = list(inputs(module, module.function(name), count))[: 1 + count]
    computed = expand(module, "float", DEFAULT.math, target)
    wanted = [evaluate_module(computed, name, case, host().arithmetic) for case in cases]
    lines = [
        _table(f"in_{step.name}", [[case[n] for n in step.inputs] for case in cases]),
        _table(f"out_{step.name}", [[case[n] for n in step.outputs] for case in wanted]),
        f"static int check_{step.name}(void)", "{", "    int wrong = 0;",
        f"    for (int k = 0; k < {len(cases)}; k++) {{",
        *(f"        {kind} {name};" for name, kind in step.variables.items()),
    ]  # fmt: skip
    lines += [f"        {m} = number(in_{step.name}[k][{i}]);" for i, m in enumerate(step.inputs.values())]
    lines += [f"        {call(step)};"]
    lines += [
        f"        wrong += word({m}) != out_{step.name}[k][{i}];" for i, m in enumerate(step.outputs.values())
    ]
    return "\n".join([*lines, "    }", "    return wrong;", "}"])


def write(folder: Path, modules: Sequence[Module], target: str, count: int) -> list[str]:
    """Write the C files of ``int check(void)`` for all functions that call nothing and need no parameters."""
    parts = ["#include <stdint.h>", *(f'#include "{module.name}.h"' for module in modules)]
    parts += ["static float number(uint32_t u) { union { uint32_t u; float x; } v = {u}; return v.x; }"]
    parts += ["static uint32_t word(float x) { union { float x; uint32_t u; } v = {x}; return v.u; }"]
    calls, files = [], ["check.c"]
    for module in modules:
        header, source = sources(module, Choice(target=target))
        (folder / f"{module.name}.h").write_text(header)
        (folder / f"{module.name}.c").write_text(source)
        files.append(f"{module.name}.c")
        functions = {f"{module.name}_{f.name}" for f in module.functions}
        for step in unit(module).steps:
            if (
                step.name not in functions
                or "prepared" in step.variables
                or _calls_libm(module, step, target)
            ):
                continue
            parts.append(_check(module, step, target, count))
            calls.append(f"check_{step.name}()")
    assert calls
    parts.append("int check(void);\nint check(void) { return " + " + ".join(calls) + "; }\n")
    (folder / "check.c").write_text("\n".join(parts))
    return files


def cortex_m(folder: Path, files: Sequence[str], processor: str) -> Path:
    """Write the program for a board of QEMU whose memory begins with the vector table."""
    (folder / "start.c").write_text(START.replace("main", "check"))
    (folder / "board.ld").write_text(
        "SECTIONS { . = 0; .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) } . = 0x20000000; .data : { *(.data*) }"
        " .bss : { *(.bss*) *(COMMON) } }\n"
    )
    chosen = gcc.PROCESSORS[processor]
    words = (
        "-nostartfiles",
        "-Wl,-T,board.ld",
        "start.c",
        *files,
        "-o",
        f"{processor}.elf",
        "-lm",
        "-lc",
        "-lgcc",
    )
    gcc.run(folder, chosen.compiler, *chosen.flags, *gcc.FLAGS, *words)
    return folder / f"{processor}.elf"


def self_test(folder: Path, robot: str, target: str) -> list[str]:
    """Write the C files of ``int check(void)``: the self-test that ``derive --target`` writes for a robot of the
    gallery."""
    put(folder, files_of(robot, target=target))
    text = "int check(void);\nint {0}_selftest(void);\nint check(void) {{ return {0}_selftest(); }}\n"
    (folder / "check.c").write_text(text.format(robot))
    return ["check.c", f"{robot}.c", place_of(robot)]


def atmega(folder: Path, files: Sequence[str], flags: Sequence[str] = (), chip: str = "atmega328p") -> Path:
    (folder / "main.c").write_text(AVR)
    words = (gcc.PROCESSORS["avr"].compiler, f"-mmcu={chip}", *gcc.FLAGS, *flags)
    gcc.run(folder, *words, "main.c", *files, "-o", "avr.elf", "-lm")
    return folder / "avr.elf"


def said(*command: str | Path) -> str:
    """Run the emulator and return what it prints."""
    words = [str(word) for word in command]
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
    return done.stdout + done.stderr
