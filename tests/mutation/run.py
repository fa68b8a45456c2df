"""Which mutants of a robot's C its own self-test lets pass."""

from __future__ import annotations

from pathlib import Path

from tests.conftest import put
from tests.mutation.mutants import Mutant, mutate
from wmrgen.codegen.compiler import compile_program, run_program

_DRIVER = """
#include <stdio.h>
int {0}_selftest(void);
extern int mutant;
int main(void)
{{
    for (mutant = 0; mutant <= {1}; ++mutant) {{
        printf("%d\\n", {0}_selftest());
    }}
    return 0;
}}
"""


def survivors(robot: str, files: dict[str, bytes], folder: Path, every: int = 1) -> tuple[int, list[Mutant]]:
    """How many mutants were tried (each ``every``-th), and those for which the self-test passes."""
    put(folder, {name: content for name, content in files.items() if name.endswith((".c", ".h"))})
    text, mutants = mutate(files[f"{robot}.c"].decode())
    (folder / f"{robot}.c").write_text(text)
    (folder / "mutants-driver.c").write_text(_DRIVER.format(robot, len(mutants)))
    sources = [f"{robot}.c", f"test/{robot}_selftest.c", "mutants-driver.c"]
    program = compile_program(folder, sources, None, ("-std=c99", "-O0", "-w", "-ffp-contract=off"))
    results = [int(line) for line in run_program(program, "").split()]
    assert results[0] == 0, f"the self-test of {robot} fails in row {results[0]} of the file as it is"
    tried = mutants[::every]
    return len(tried), [m for m in tried if results[m.number] == 0]
