"""The command as a module: importing it runs nothing, running it ends with the exit code of the verb."""

from __future__ import annotations

import subprocess
import sys

import pytest

import wmrgen.__main__ as module


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)


def test_importing_it_runs_nothing() -> None:
    assert callable(module.main)
    done = run("-c", "import wmrgen.__main__ as m; print(m.__name__)")
    assert (done.returncode, done.stdout, done.stderr) == (0, "wmrgen.__main__\n", "")


@pytest.mark.parametrize(
    ("words", "code"), [(("--version",), 0), (("check", "x.yaml", "-o", "y"), 2), (("--none",), 2)]
)
def test_running_it_ends_with_the_code_of_the_verb(words: tuple[str, ...], code: int) -> None:
    done = run("-m", "wmrgen", *words)
    assert done.returncode == code
    assert bool(done.stdout) == (code == 0) and bool(done.stderr) == (code != 0)


def test_it_collects_seldom_and_spares_the_last_search() -> None:
    told = "print(gc.get_threshold()[0] > 100_000, gc.get_freeze_count() > 1000, file=sys.stderr)"
    text = f"import gc, sys, wmrgen.__main__ as m; sys.argv[1:] = ['--version']\ntry: m.main()\nfinally: {told}\n"
    assert run("-c", text).stderr == "True True\n"
