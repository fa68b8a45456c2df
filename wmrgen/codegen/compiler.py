"""The compilers of the system, in one place: find one, compile in a temporary folder, run the program."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Any

from wmrgen.errors import EnvironmentFailure

_USUAL = ("cc", "gcc", "clang")
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
_TEX = ("lualatex", "xelatex")  # those that print Greek letters
_THEN = {"SOURCE_DATE_EPOCH": "946684800", "FORCE_SOURCE_DATE": "1"}  # the date of a TeX
_HOW = "Install one (Debian, Ubuntu: apt-get install gcc; macOS: xcode-select --install) or set CC."
# Contraction to fused multiply-add is off so that results are those of the printed operations. Not optimised: a program
# is run once, and ends before a compiler has improved it.
DEFAULT_FLAGS = ("-std=c99", "-O0", "-ffp-contract=off")
# Of arrays of states: vectors of the processor, without what would change a result.
LIBRARY_FLAGS = (
    "-std=c99", "-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-shared",
    "-fPIC", "-fno-semantic-interposition",  # without the latter nothing is inlined
)  # fmt: skip
_TIMEOUT = 300
_DATE = re.compile(rb"(/(?:CreationDate|ModDate) ?)\(D:[^)]*\)")
_STOPS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def find_compiler(cc: str | None = None) -> str:
    """Path of ``cc``, else of $CC, else of the first of cc, gcc and clang. EnvironmentFailure without one."""
    wanted = cc or os.environ.get("CC", "")
    names = (wanted,) if wanted else _USUAL
    for name in names:
        path = shutil.which(name)
        if path:
            return path
    raise EnvironmentFailure(f"no C compiler found: looked for {', '.join(names)}. {_HOW}")


def _run(
    command: Sequence[str],
    what: str,
    stdin: str = "",
    env: Mapping[str, str] | None = None,
    folder: str | None = None,
    how: str = f". {_HOW}",
    both: bool = False,
) -> str:
    try:
        with _held() as deliver, subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            errors="replace", env=None if env is None else {**os.environ, **env}, cwd=folder,
            process_group=0 if os.name == "posix" else None,
        ) as process:  # fmt: skip
            try:
                deliver()
                printed, errors = process.communicate(stdin, timeout=_TIMEOUT)
            except BaseException:
                _end(process)
                raise
    except (OSError, subprocess.TimeoutExpired) as error:
        raise EnvironmentFailure(f"{what} failed: {error}{how}") from error
    if process.returncode != 0:
        message = "\n".join(errors.splitlines()[:20])
        raise EnvironmentFailure(f"{what} failed with status {process.returncode}:\n{message}")
    return printed + errors if both else printed


@contextlib.contextmanager
def _held() -> Iterator[Callable[[], None]]:
    """Signals that would end this process wait until the function that it gives is called: one that comes while a
    program is being started would leave a program that nobody knows of."""
    arrived: list[int] = []
    handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}

    def deliver() -> None:
        while handlers:
            signal.signal(*handlers.popitem())
        while arrived:
            signal.raise_signal(arrived.pop())

    if threading.current_thread() is threading.main_thread():
        for number in _STOPS:
            handler = signal.getsignal(number)
            if callable(handler):
                handlers[number] = handler
                signal.signal(number, lambda number, _: arrived.append(number))
    try:
        yield deliver
    finally:
        deliver()


def _end(process: subprocess.Popen[str]) -> None:
    """Kill a process and those it started: a compiler is a driver that waits for others."""
    if os.name == "posix":
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


@contextlib.contextmanager
def _folder_of(files: Mapping[str, str]) -> Iterator[Path]:
    """A temporary folder that holds ``files`` (name -> text). EnvironmentFailure where it cannot be made."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="wmrgen-")
    except OSError as error:
        raise EnvironmentFailure(f"no temporary folder can be made: {error}") from error
    with folder as name:
        try:
            for file, text in files.items():
                (Path(name) / file).write_text(text, encoding="utf-8", newline="\n")
        except OSError as error:
            raise EnvironmentFailure(
                f"cannot write to the temporary folder {name}: {error.strerror}"
            ) from error
        yield Path(name)


def compile_program(
    folder: Path, sources: Sequence[str], cc: str | None = None, flags: Sequence[str] = DEFAULT_FLAGS
) -> Path:
    """Compile and link ``sources`` (file names in ``folder``) to ``folder/program``; with -c an object."""
    compiler = find_compiler(cc)
    program = folder / "program"
    paths = [str(folder / name) for name in sources]
    libraries = () if "-c" in flags else ("-lm",)
    _run([compiler, *flags, "-o", str(program), *paths, *libraries], f"the C compiler {compiler}")
    return program


def load_library(files: Mapping[str, str], source: str, cc: str | None = None) -> Any:
    """Compile ``source`` of ``files`` (name -> text) to a shared library; return it as a ctypes.CDLL.

    EnvironmentFailure if there is no compiler, or if it fails.
    """
    import ctypes

    compiler = find_compiler(cc)
    with _folder_of(files) as folder:
        library = folder / "library.so"
        command = [compiler, *LIBRARY_FLAGS, "-o", str(library), str(folder / source), "-lm"]
        _run(command, f"the C compiler {compiler}")
        try:
            return ctypes.CDLL(str(library))
        except OSError as error:
            raise EnvironmentFailure(f"the compiled library cannot be loaded: {error}") from error


def run_program(program: Path, stdin: str, env: Mapping[str, str] | None = None) -> str:
    """Standard output of ``program``. EnvironmentFailure when it fails."""
    return _run([str(program)], f"the compiled program {program.name}", stdin, env)


def compile_and_run(
    files: Mapping[str, str],
    stdin: str,
    cc: str | None = None,
    flags: Sequence[str] = DEFAULT_FLAGS,
) -> str:
    """Compile every ``.c`` among ``files`` (name -> text) in a temporary folder and run it."""
    with _folder_of(files) as folder:
        program = compile_program(folder, [file for file in files if file.endswith(".c")], cc, flags)
        return run_program(program, stdin)


def run_rust(crate: str, library: str, program: str, stdin: str, flags: Sequence[str]) -> str:
    """Compile a crate and a program that uses it, both text, and run that."""
    compiler = find_tool("rustc")
    if compiler is None:
        how = "Install one (Debian, Ubuntu: apt-get install rustc)."
        raise EnvironmentFailure(f"no Rust compiler found. {how}")
    with _folder_of({"lib.rs": library, "main.rs": program}) as folder:
        command = [compiler, "--edition=2021", *flags, f"-L{folder}", f"--out-dir={folder}"]
        what = f"the Rust compiler {compiler}"
        _run([*command, "--crate-type=rlib", f"--crate-name={crate}", str(folder / "lib.rs")], what)
        _run([*command, f"--extern={crate}", "--crate-name=program", str(folder / "main.rs")], what)
        return run_program(folder / "program", stdin)


def run_node(files: Mapping[str, str]) -> str:
    """What Node prints when it runs ``main.mjs`` of ``files`` (name -> text)."""
    node = find_tool("node")
    if node is None:
        raise EnvironmentFailure("no Node found. Install it (Debian, Ubuntu: apt-get install nodejs).")
    return run_tool([node, "main.mjs"], files)


def print_pages(page: str, files: Mapping[str, str], markdown: Sequence[str]) -> bytes:
    """The PDF of an HTML page, by Chromium or a browser that is made of it; where there is none, of the pages
    ``markdown`` among ``files``, which hold their figures and ``paper.lua``, by pandoc and a TeX. EnvironmentFailure
    without either.

    What says when it was printed is taken out, so that the same bytes come again.
    """
    browser, tex = (
        next((path for n in names if (path := find_tool(n))), None) for names in (_BROWSERS, _TEX)
    )
    with _folder_of({**files, "page.html": page}) as folder:
        if browser:
            # Chromium refuses to run in its sandbox as root.
            root = ["--no-sandbox"] if os.name == "posix" and os.geteuid() == 0 else []
            options = [
                "--headless",
                "--disable-gpu",
                "--no-pdf-header-footer",
                "--user-data-dir=profile",
                *root,
            ]
            command = [browser, *options, "--print-to-pdf=page.pdf", (folder / "page.html").as_uri()]
        elif tex and find_tool("rsvg-convert") and (pandoc := find_tool("pandoc")):
            options = ["--from=gfm", "--lua-filter=paper.lua", f"--pdf-engine={tex}"]
            command = [pandoc, *options, "--output=page.pdf", *markdown]
        else:
            raise EnvironmentFailure(
                f"nothing found that prints a PDF: looked for {', '.join(_BROWSERS)}, and for pandoc, rsvg-convert and "
                f"{' or '.join(_TEX)}. Install a browser (Debian, Ubuntu: apt-get install chromium), or print "
                "report.html (--html) yourself."
            )
        _run(command, Path(command[0]).name, folder=str(folder), env=_THEN, how="")
        try:
            printed = (folder / "page.pdf").read_bytes()
        except OSError as error:
            raise EnvironmentFailure(f"{command[0]} printed nothing") from error
    # Of the length that a browser's date has, for a PDF says at which byte each part begins.
    return _DATE.sub(rb"\1(D:20000101000000+00'00')", printed) if browser else printed


def find_tool(name: str) -> str | None:
    """Path of an analyser on the PATH, None when there is none."""
    return shutil.which(name)


def run_tool(command: Sequence[str], files: Mapping[str, str], both: bool = False) -> str:
    """What ``command`` prints, run in a temporary folder that holds ``files`` (name -> text).

    ``both``: on stderr, too.
    """
    with _folder_of(files) as folder:
        # Frama-C looks for its files in $PWD, whatever its working directory is.
        name = str(folder)
        return _run(command, Path(command[0]).name, env={"PWD": name}, folder=name, how="", both=both)
