"""A program that calls the checked functions of a robot."""

from __future__ import annotations

from pathlib import Path

from tests.codegen.c.harness import STRICT
from tests.conftest import put
from wmrgen import derive, load
from wmrgen.codegen.c import emit
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.emit import site

HEAD = """
#include "{0}_checked.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
static int wrong = 0;
#define EXPECT(what) do {{ if (!(what)) {{ fprintf(stderr, "%d: %s\\n", __LINE__, #what); wrong = 1; }} }} while (0)
static const float bad[3] = {{NAN, INFINITY, -INFINITY}};
int main(void)
{{
    int k;
"""
TAIL = "    return wrong;\n}\n"


def printed(folder: Path, robot: str, body: str, scalar: str = "float", compiler: str | None = None) -> str:
    """Run ``body`` as the body of main for the robot file ``probed`` and return what it prints."""
    (folder / "probed.yaml").write_text(robot)
    derivation = derive(load(folder / "probed.yaml"))
    put(folder, emit(derivation.c_module, Facts(site=site(derivation), options={"scalar": scalar})))
    (folder / "edges.c").write_text(HEAD.format("probed") + body + TAIL)
    sources = ["edges.c", "probed_checked.c", "probed.c"]
    return run_program(compile_program(folder, sources, compiler, (*STRICT[:2], "-O2")), "")
