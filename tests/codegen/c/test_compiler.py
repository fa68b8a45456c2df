"""Programs that are compiled and run: which compiler is used, what an error reports, what remains on the disk."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS
from wmrgen.codegen.compiler import (
    STOP_SIGNALS,
    compile_and_run,
    delay_signals,
    find_compiler,
    find_tool,
    run_tool,
)
from wmrgen.errors import EnvironmentFailure

COMPILED = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
POSIX = pytest.mark.skipif(os.name != "posix", reason="groups of processes")
ECHO = "#include <stdio.h>\nint main(void) { int c; while ((c = getchar()) != EOF) putchar(c); return 0; }\n"


def program(folder: Path, name: str) -> Path:
    path = folder / name
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    return path


@POSIX
def test_which_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("clang", "gcc", "cc", "mine", "other"):
        monkeypatch.setenv("PATH", str(tmp_path))
        monkeypatch.delenv("CC", raising=False)
        path = str(program(tmp_path, name))
        if name in ("clang", "gcc", "cc"):  # each is preferred to those before it
            assert find_compiler() == find_compiler("") == (path,)
    monkeypatch.setenv("CC", "mine")
    assert find_compiler() == (str(tmp_path / "mine"),)
    assert find_compiler("other") == (str(tmp_path / "other"),) == (find_tool("other"),)
    with pytest.raises(EnvironmentFailure, match=r"\bnone\b"):
        find_compiler("none")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path / "nowhere"))
    with pytest.raises(EnvironmentFailure, match=r"\bcc, gcc, clang\b"):
        find_compiler()


@POSIX
def test_cc_is_split_as_make_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wrapper, plain = str(program(tmp_path, "ccache")), str(program(tmp_path, "gcc"))
    monkeypatch.setenv("PATH", str(tmp_path))
    for words, command in (
        ("ccache gcc", (wrapper, "gcc")),
        (" gcc  -m32 ", (plain, "-m32")),
        (f"'{wrapper}' -x \"two words\"", (wrapper, "-x", "two words")),
        ("", (plain,)),
        ("  ", (plain,)),
    ):
        monkeypatch.setenv("CC", words)
        assert find_compiler() == command, words
    with pytest.raises(EnvironmentFailure, match="'gcc"):
        find_compiler("'gcc")


@POSIX
@COMPILED
def test_a_wrapper_of_the_compiler_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wrapper gets the compiler and all its arguments."""
    wrapper = program(tmp_path, "wrapper")
    wrapper.write_text(f'#!/bin/sh\necho "$1" > "{tmp_path}/called"\nexec "$@"\n')
    monkeypatch.setenv("CC", f"{wrapper} {COMPILERS[0]}")
    assert compile_and_run({"echo.c": ECHO}, "a line\n") == "a line\n"
    assert (tmp_path / "called").read_text().strip() == COMPILERS[0]


@COMPILED
def test_a_program_is_compiled_and_fed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    files = {"echo.c": ECHO, "unused.h": "#error this is not compiled\n"}
    assert compile_and_run(files, "a line\nand another\n") == "a line\nand another\n"
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(EnvironmentFailure, match=r"wrong\.c"):
        compile_and_run({"wrong.c": "int main(void) { return x; }\n"}, "")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(EnvironmentFailure, match=r"\b3\b"):
        compile_and_run({"three.c": "int main(void) { return 3; }\n"}, "")


def python(text: str, both: bool = False) -> str:
    return run_tool([sys.executable, "-c", text], {"in.txt": "what stands in it\n"}, both)


def test_a_tool_runs_where_its_files_are() -> None:
    assert python("print(open('in.txt').read(), end='')") == "what stands in it\n"
    assert python("import os; print(os.environ['PWD'] == os.getcwd())").strip() == "True"
    words = "import sys; print('out'); print('err', file=sys.stderr)"
    assert python(words) == "out\n" and python(words, both=True) == "out\nerr\n"


def test_an_error_has_twenty_lines_of_the_output() -> None:
    with pytest.raises(EnvironmentFailure) as error:
        python("import sys; print('\\n'.join(f'line {k}' for k in range(30)), file=sys.stderr); sys.exit(1)")
    assert str(error.value).splitlines()[1:] == [f"line {k}" for k in range(20)]
    assert "status 1:" in str(error.value).splitlines()[0]
    with pytest.raises(EnvironmentFailure, match="no-such-tool"):
        run_tool(["no-such-tool"], {})


@POSIX
def test_a_program_leads_a_group_of_its_own() -> None:
    """A program is therefore ended together with its children."""
    assert python("import os; print(os.getpgrp() == os.getpid())").strip() == "True"


@POSIX
def test_a_program_that_takes_too_long_is_ended_with_its_children(tmp_path: Path) -> None:
    number = tmp_path / "number"
    with pytest.raises(EnvironmentFailure, match=r"0\.3 seconds"):
        run_tool(["sh", "-c", f"sleep 60 & echo $! > '{number}'; wait"], {}, timeout=0.3)
    started = int(number.read_text())
    for _ in range(100):
        try:
            os.kill(started, 0)
        except ProcessLookupError:
            break
        state = Path(f"/proc/{started}/stat")
        if state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z":
            break
        threading.Event().wait(0.01)
    else:
        pytest.fail("a child of the program is still running")


@POSIX
def test_signals_are_handled_as_before_once_a_program_has_run() -> None:
    arrived: list[int] = []
    before = {n: signal.signal(n, lambda number, _: arrived.append(number)) for n in STOP_SIGNALS}
    handlers = {n: signal.getsignal(n) for n in before}
    try:
        python("pass")
        assert {n: signal.getsignal(n) for n in before} == handlers
        for number in STOP_SIGNALS:
            signal.raise_signal(number)
        assert arrived == list(STOP_SIGNALS)
        with delay_signals() as deliver:
            signal.raise_signal(signal.SIGTERM)
            assert arrived == list(STOP_SIGNALS), "the signal is delayed"
            deliver()
            assert arrived == [*STOP_SIGNALS, signal.SIGTERM]
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
