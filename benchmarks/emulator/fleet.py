"""The generated C of many robots in one image, called by the names of inputs and outputs."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path

from benchmarks.emulator.image import Image
from benchmarks.emulator.machine import Machine, Run, Trap
from benchmarks.emulator.zig import DATA, FLAGS, M4F, Target, compile_objects, link
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.emit import unit
from wmrgen.codegen.unit import Parameter, Step, Struct, Unit
from wmrgen.ir.interpret import Arithmetic
from wmrgen.ir.nodes import Module
from wmrgen.ir.ops import OPERATIONS

EVERY, LAYOUTS, STUBS = "every.c", "layouts.c", "stubs.c"
# What the float build may take from <math.h>, and how many arguments each has.
LIBM = {"sinf": 1, "cosf": 1, "atanf": 1, "atan2f": 2, "sqrtf": 1}
_PLACES = tuple(DATA + 0x2000 * k for k in range(1, 10))
_KEPT = {"params": _PLACES[0], "prepared": _PLACES[1]}  # from one call to the next
_POISON = b"\xff\xff\xff\xff"  # a NaN: an output that was not written is seen
Libm = Mapping[str, Callable[..., float]]
Sources = Callable[[Module], tuple[str, str]]


def answers(arithmetic: Arithmetic) -> Libm:
    """Return libm's functions, computed by ``arithmetic``."""
    return {name: arithmetic.of(OPERATIONS[name.removesuffix("f")]) for name in LIBM}


_usual = lru_cache(maxsize=64)(unit)  # structs and functions, which are those of every choice


def default_sources(module: Module) -> tuple[str, str]:
    """Return header and source as ``wmrgen derive`` writes them, without the banner."""
    return sources(module)


def write_sources(folder: Path, modules: Sequence[Module], made: Sources = default_sources) -> None:
    """Write the files of all modules, the `LAYOUTS` of their structs, and `EVERY`, which includes all of them."""
    layouts = ["#include <stddef.h>", *(f'#include "{module.name}.h"' for module in modules)]
    for module in modules:
        header, source = made(module)
        (folder / f"{module.name}.h").write_text(header)
        (folder / f"{module.name}.c").write_text(source)
        layouts += [_layout(s) for s in _usual(module).structs.values()]
    (folder / LAYOUTS).write_text("\n".join(dict.fromkeys(layouts)) + "\n")
    every = [*(f"{module.name}.c" for module in modules), LAYOUTS]
    (folder / EVERY).write_text("".join(f'#include "{name}"\n' for name in every))


def _layout(s: Struct) -> str:
    words = [f"sizeof({s.name}) / 4", *(f"offsetof({s.name}, {m}) / 4" for m in s.members.values())]
    declared = f"const unsigned short layout_{s.name}[]"
    return f"extern {declared};\n{declared} = {{{', '.join(words)}}};"


def _stubs(names: Sequence[str]) -> str:
    return "".join(
        f"float {name}({', '.join(f'float x{k}' for k in range(LIBM[name]))});\n"
        f"float {name}({', '.join(f'float x{k}' for k in range(LIBM[name]))}) "
        f"{{ {' '.join(f'(void)x{k};' for k in range(1, LIBM[name]))} return x0; }}\n"
        for name in names
    )


@dataclass(frozen=True)
class Fleet:
    """``modules`` in ``image``; libm's functions are stubs in it, which ``libm`` answers."""

    modules: tuple[Module, ...]
    image: Image
    libm: Libm
    target: Target = M4F
    counts: bool = True
    stack: bool = False
    objects: Mapping[str, Path] = field(default_factory=dict)

    @classmethod
    def build(
        cls,
        folder: Path,
        modules: Sequence[Module],
        libm: Libm,
        made: Sources = default_sources,
        target: Target = M4F,
        flags: Sequence[str] = FLAGS,
        counts: bool = True,
        separate: bool = False,
        stack: bool = False,
        extra: Sequence[str] = (),
    ) -> Fleet:
        """Compile and link ``modules`` in ``folder``: in one go, or ``separate``, an object for each.

        ``extra``: C files that stand in ``folder``, for the same image.
        """
        write_sources(folder, modules, made)
        (folder / STUBS).write_text(_stubs(sorted(LIBM)))
        units = [f"{module.name}.c" for module in modules] + [LAYOUTS] if separate else [EVERY]
        objects = compile_objects(folder, (*units, STUBS, *extra), target, flags)
        image = Image(link(folder, objects, f"every.{target.name}.elf", target))
        made_of = dict(zip(units, objects, strict=False))
        return cls(tuple(modules), image, libm, target, counts, stack, made_of)

    @cached_property
    def machine(self) -> Machine:
        traps: dict[str, Trap] = {name: (LIBM[name], function) for name, function in self.libm.items()}
        return Machine(self.image, traps, self.target.fpu, self.counts, self.stack)

    @cached_property
    def units(self) -> dict[str, Unit]:
        return {module.name: _usual(module) for module in self.modules}

    def steps(self, robot: str) -> tuple[Step, ...]:
        """Return the functions of a robot, without params_default and prepare."""
        return tuple(self.units[robot].contract.values())

    def text(self, robot: str) -> int:
        """Return the flash of all functions of ``robot`` [bytes], for a fleet that is built separately."""
        sizes = Image(self.objects[f"{robot}.c"]).sizes()
        return sum(size for name, size in sizes.items() if name.startswith((".text", ".rodata")))

    def inputs(self, step: Step) -> tuple[str, ...]:
        """Return the names of the inputs of ``step``; the tunable parameters are last."""
        own = self._prepare(step).inputs if "prepared" in step.variables else {}
        return tuple(dict.fromkeys((*step.inputs, *own)))

    def _prepare(self, step: Step) -> Step:
        return next(u.before([step])[-1] for u in self.units.values() if step in u.steps)

    def call(self, step: Step, values: Mapping[str, float], name: str = "") -> tuple[Run, dict[str, float]]:
        """Run ``step``, after prepare where it takes its result. The run is of the step alone.

        ``name``: of another function with the same arguments, to run in its place.
        """
        if "prepared" in step.variables:
            self._enter(self._prepare(step), values)
        run = self._enter(step, values, name)
        results = {}
        for address, p in zip(_places(step), step.parameters, strict=True):
            for port, member in p.writes.items():
                (results[port],) = struct.unpack(
                    "<f", self.machine.read(address + self._offset(p, member), 4)
                )
        return run, results

    def _offset(self, p: Parameter, member: str) -> int:
        """Return the offset of a member in the struct that ``p`` points to [bytes]."""
        return 4 * self._layouts[p.type][1][member] if member else 0

    def call_flat(self, name: str, inputs: Sequence[float], outputs: int) -> tuple[Run, tuple[float, ...]]:
        """Call ``void name(const float *x, float *y)``, or a function of CasADi's signature."""
        params, arguments, results, *_ = _PLACES
        self.machine.write(arguments, struct.pack(f"<{len(inputs)}f", *inputs))
        self.machine.write(results, _POISON * outputs)
        places = [arguments, results]
        if name.startswith("casadi_"):  # arrays of pointers to the vectors
            self.machine.write(params, struct.pack("<2I", *places))
            places = [params, params + 4, 0, 0]
        run = self.machine.call(name, *places)
        return run, struct.unpack(f"<{outputs}f", self.machine.read(results, 4 * outputs))

    def _enter(self, step: Step, values: Mapping[str, float], name: str = "") -> Run:
        passed: list[int | float] = []
        for address, p in zip(_places(step), step.parameters, strict=True):
            passed.append(next(values[port] for port in p.reads) if p.by_value else address)
            if p.name != "prepared" or p.writes:
                size = self._layouts[p.type][0] if p.type in self._layouts else 1
                self.machine.write(address, _POISON * size)
            for port, member in p.reads.items() if p.name != "prepared" and not p.by_value else ():
                self.machine.write(address + self._offset(p, member), struct.pack("<f", values[port]))
        return self.machine.call(name or step.name, *passed)

    @cached_property
    def _layouts(self) -> dict[str, tuple[int, dict[str, int]]]:
        """Return size and offsets of the members of each struct, in words."""
        layouts = {}
        for s in (s for u in self.units.values() for s in u.structs.values()):
            content = self.image.content(f"layout_{s.name}")
            size, *places = struct.unpack(f"<{len(content) // 2}H", content)
            layouts[s.name] = size, dict(zip(s.members.values(), places, strict=True))
        return layouts


def _places(step: Step) -> list[int]:
    """Return the addresses that the parameters of ``step`` point to."""
    free = iter(_PLACES[len(_KEPT) :])
    return [_KEPT[p.name] if p.name in _KEPT else next(free) for p in step.parameters]
