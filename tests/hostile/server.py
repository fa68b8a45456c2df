"""A process that has wmrgen loaded and a robot derived, and forks for each attempt: every one runs in a process and
under limits of its own, and costs no start.

It reads an order, a line of JSON, from stdin and answers with one; `tests.hostile.attempts` writes and reads them."""

from __future__ import annotations

import contextlib
import gc
import json
import os
import resource
import signal
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import wmrgen
from tests.watched import watch
from wmrgen.derivation.emit import artifacts
from wmrgen.tools.importing import xacro_process

ADDRESSES = 1 << 30  # bytes
SECONDS = 10  # of the processor, and twice that by the clock
ROBOT = Path(__file__).parents[2] / "robots" / "turtlebot3_burger.yaml"
LOADED = (
    *(f"wmrgen.{name}" for name in "derivation.facade tools.lint codegen.packages".split()),
    *(f"wmrgen.cli.{name}" for name in "commands generate evaluate importing lint".split()),
    *"defusedxml.ElementTree xacro casadi".split(),
)


def serve() -> None:
    for module in LOADED:
        import_module(module)
    artifacts(wmrgen.derive(wmrgen.load(ROBOT)))  # loads templates, and numbers that sympy keeps
    gc.collect()
    gc.freeze()  # shared by all, never written to
    # Resolve xacro in the process that is watched, so that nothing which an expression does goes unseen.
    vars(xacro_process)["run_python"] = lambda _, asked, __: xacro_process.answer(asked)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    answers.write(json.dumps("ready") + "\n")
    for line in sys.stdin:
        order = json.loads(line)
        started = [_started(order, number) for number in range(order["runs"])]
        if order["killed_after"] is not None:
            time.sleep(order["killed_after"])
            for process in started:
                os.kill(process, signal.SIGKILL)
        answers.write(json.dumps([_ended(process) for process in started]) + "\n")


def _started(order: dict[str, Any], number: int) -> int:
    process = os.fork()
    if not process:
        _become_wmrgen(order, number)
    return process


def _ended(process: int) -> tuple[int, float]:
    """The exit code, and how long the processor worked."""
    _, status, usage = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime


def _become_wmrgen(order: dict[str, Any], number: int) -> NoReturn:
    os.dup2(os.open(order["stdin"], os.O_RDONLY), 0)
    changes = os.open(f"{order['log']}.{number}.changes", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    for handle, name in ((1, "out"), (2, "err")):
        os.dup2(
            os.open(f"{order['log']}.{number}.{name}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), handle
        )
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    os.chdir(order["place"])
    os.environ |= {"TMPDIR": order["place"], "HOME": order["place"]}
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    signal.alarm(2 * SECONDS)
    if order["largest_file"] is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (order["largest_file"], order["largest_file"]))

    def tell(*change: object) -> None:
        with contextlib.suppress(OSError):  # no file may grow
            os.write(changes, (json.dumps(change) + "\n").encode())

    watch(order["allowed"], tell)
    sys.argv = ["wmrgen", *order["words"]]
    code = 99  # what ends otherwise
    try:
        import_module("wmrgen.__main__").main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0
    except BaseException:
        sys.excepthook(*sys.exc_info())
    with contextlib.suppress(BaseException):
        sys.stdout.flush()
    os._exit(code)


if __name__ == "__main__":
    serve()
