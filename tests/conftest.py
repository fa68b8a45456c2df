"""Shared by all tests: where things are, and the command line in-process and as a process."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import settings
from typer.testing import CliRunner

from tests.depth import DEEP, mark_slow
from wmrgen.codegen import compiler

# Fifteen thousand tests are a large heap: looking through it for garbage every 700 objects takes a tenth of the time.
gc.set_threshold(100_000)

# No test fails for its time. The other settings stay those of hypothesis, which differ in CI.
settings.register_profile("untimed", parent=settings.default, deadline=None)
settings.load_profile("untimed")

ROOT = Path(__file__).resolve().parent.parent
GALLERY = tuple(sorted((ROOT / "robots").glob("*.yaml")))

DIFFERENTIAL = """\
wmrgen: 1
name: pair
parameters:
  half_track: 0.1655
wheels:
  - {name: left,  type: fixed, l: half_track, alpha: pi/2,  beta: 0,  r: 0.0975}
  - {name: right, type: fixed, l: half_track, alpha: -pi/2, beta: pi, r: 0.0975}
"""


@dataclass(frozen=True)
class Outcome:
    code: int
    out: str
    err: str


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    """A differential drive, in a folder of its own."""
    path = tmp_path / "pair.yaml"
    path.write_text(DIFFERENTIAL)
    return path


def command_line(*words: object, stdin: str | None = None) -> Outcome:
    """The command line in this process."""
    from wmrgen.cli.commands import app

    args = [str(word) for word in words]
    done = CliRunner().invoke(app, args, input=stdin, prog_name="wmrgen")
    assert done.exception is None or isinstance(done.exception, SystemExit), repr(done.exception)
    return Outcome(done.exit_code, done.stdout, done.stderr)


@pytest.fixture
def wmrgen_cli() -> Callable[..., Outcome]:
    """The command line in this process."""
    return command_line


@pytest.fixture(autouse=True, scope="session")
def compiled_once() -> Iterator[None]:
    """What `compile_and_run` compiles again, the same files by the same command, is the program that it was."""
    compiled, really = dict[tuple[object, ...], bytes](), compiler.compile_program

    def once(folder: Path, sources: Sequence[str], cc: str | None, flags: Sequence[str]) -> Path:
        key = (compiler.find_compiler(cc), *sources, *flags, *tree(folder).items())
        program = folder / "program"
        if key in compiled:
            program.write_bytes(compiled[key])
            program.chmod(0o755)
        else:
            really(folder, sources, cc, flags)
            compiled[key] = program.read_bytes()
        return program

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "compile_program", once)
        yield


def process(
    *words: object, cwd: Path | None = None, env: dict[str, str] | None = None, python: Sequence[str] = ()
) -> Outcome:
    """The command line as a process of its own."""
    command = [*(python or (sys.executable, "-m", "wmrgen")), *map(str, words)]
    done = subprocess.run(
        command, cwd=cwd, env={**os.environ, **(env or {})}, stdin=subprocess.DEVNULL, capture_output=True
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def put(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write ``files`` (name -> content), as they stand in the folder of a robot."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def tree(folder: Path) -> dict[str, bytes]:
    """Every file under ``folder``, by relative name."""
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
    }


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """`make check` runs everything, `make test` the everyday robots of the gallery."""
    if not DEEP:
        mark_slow(items)


def pytest_collection_finish() -> None:
    """The tests stay until the end: none of them is garbage."""
    gc.freeze()


def pytest_sessionfinish() -> None:
    """The process ends: it need not look for garbage any more."""
    gc.freeze()
