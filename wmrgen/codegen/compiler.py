"""The programs of the system: find a compiler or tool, compile in a temporary folder, run a program.

Only this module starts other programs, Python included.
"""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Any

from wmrgen.errors import EnvironmentFailure

_USUAL = ("cc", "gcc", "clang")
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
# LuaTeX writes no number into the PDF that depends on the name of the folder (519: all optional information).
_WITHOUT_ID = r"\ifdefined\pdfvariable\pdfvariable suppressoptionalinfo 519\fi\input{page.tex}"
_TEX = ("lualatex", "xelatex")  # engines that print Greek letters
_FIXED_DATE = {"SOURCE_DATE_EPOCH": "946684800", "FORCE_SOURCE_DATE": "1"}  # for TeX: 1 January 2000
_HOW_TO_INSTALL = (
    "Install one (Debian, Ubuntu: apt-get install gcc; macOS: xcode-select --install) or set CC."
)
# Without contraction to fused multiply-add, results are those of the printed operations. Without optimisation, because
# the program runs once and ends sooner than a compiler would optimise it.
DEFAULT_FLAGS = ("-std=c99", "-O0", "-ffp-contract=off")
# For arrays of states: vector instructions of this processor, but no option that changes a result.
LIBRARY_FLAGS = (
    "-std=c99", "-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-shared",
    "-fPIC", "-fno-semantic-interposition",  # without the latter nothing is inlined
)  # fmt: skip
TIMEOUT = 300.0  # s: a program that runs longer hangs
_DATE = re.compile(rb"(/(?:CreationDate|ModDate) ?)\(D:[^)]*\)")
STOP_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


def find_compiler(cc: str | None = None) -> tuple[str, ...]:
    """Return the command of the C compiler: ``cc``, or $CC, or the first of cc, gcc and clang.

    A command may have arguments (``ccache gcc``) and is split as a shell does. An empty one counts as unset.

    Raises:
        EnvironmentFailure: There is no such program.
    """
    wanted = _split(cc or "") or _split(os.environ.get("CC", ""))
    names, arguments = ((wanted[0],), wanted[1:]) if wanted else (_USUAL, [])
    for name in names:
        path = shutil.which(name)
        if path:
            return (path, *arguments)
    raise EnvironmentFailure(f"no C compiler found: looked for {', '.join(names)}. {_HOW_TO_INSTALL}")


def _split(command: str) -> list[str]:
    try:
        return shlex.split(command, posix=os.name == "posix")
    except ValueError as error:
        raise EnvironmentFailure(f"the compiler command {command!r} cannot be split: {error}") from error


def _run(
    command: Sequence[str],
    what: str,
    stdin: str = "",
    env: Mapping[str, str] | None = None,
    folder: str | None = None,
    how: str = f". {_HOW_TO_INSTALL}",
    timeout: float = TIMEOUT,
) -> tuple[str, str]:
    """Run a program and return what it prints on stdout and on stderr.

    Args:
        command: The program with its arguments.
        what: What the program is, for messages.
        stdin: Its input.
        env: Variables of the environment that are added.
        folder: Its working directory.
        how: How to get the program, for messages.
        timeout: Longest duration [s].

    Raises:
        EnvironmentFailure: The program cannot be started, fails, or takes too long.
    """
    try:
        with delay_signals() as deliver, subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            errors="replace", env=None if env is None else {**os.environ, **env}, cwd=folder,
            process_group=0 if os.name == "posix" else None,
        ) as process:  # fmt: skip
            try:
                deliver()
                printed, errors = process.communicate(stdin, timeout=timeout)
            except BaseException:
                _end(process)
                raise
    except (OSError, subprocess.TimeoutExpired) as error:
        raise EnvironmentFailure(f"{what} failed: {error}{how}") from error
    if process.returncode != 0:
        message = "\n".join(errors.splitlines()[:20])
        raise EnvironmentFailure(f"{what} failed with status {process.returncode}:\n{message}")
    return printed, errors


def run_python(code: str, stdin: str, timeout: float) -> str | None:
    """Run Python code in a process of its own.

    Args:
        code: The code. The process finds modules only in the folders that the code adds to ``sys.path``.
        stdin: Its input.
        timeout: Longest duration [s].

    Returns:
        What it prints on stdout; None if it takes too long and was stopped.

    Raises:
        EnvironmentFailure: The process cannot be started, or fails.
    """
    how = ". Start wmrgen by a Python interpreter."
    command = (sys.executable, "-I", "-c", code)
    try:
        return _run(command, "a process of Python", stdin, how=how, timeout=timeout)[0]
    except EnvironmentFailure as failure:
        if isinstance(failure.__cause__, subprocess.TimeoutExpired):
            return None
        raise


@contextlib.contextmanager
def delay_signals() -> Iterator[Callable[[], None]]:
    """Delay signals that would end this process until the function that this context returns is called.

    A signal that arrives while a program is being started would otherwise leave that program running.
    """
    arrived: list[int] = []
    handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}

    def deliver() -> None:
        while handlers:
            signal.signal(*handlers.popitem())
        while arrived:
            signal.raise_signal(arrived.pop())

    if threading.current_thread() is threading.main_thread():
        for number in STOP_SIGNALS:
            handler = signal.getsignal(number)
            if callable(handler):
                handlers[number] = handler
                signal.signal(number, lambda number, _: arrived.append(number))
    try:
        yield deliver
    finally:
        deliver()


def _end(process: subprocess.Popen[str]) -> None:
    """Kill a process and its children: a compiler is a driver that starts other programs and waits for them."""
    if os.name == "posix":
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


@contextlib.contextmanager
def _folder_of(files: Mapping[str, str]) -> Iterator[Path]:
    """Create a temporary folder with ``files`` (name -> text). Raise EnvironmentFailure if that fails."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="wmrgen-")
    except OSError as error:
        raise EnvironmentFailure(f"cannot create a temporary folder: {error}") from error
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
    """Compile and link to ``folder/program``.

    Args:
        folder: Folder of the sources.
        sources: File names.
        cc: Command of the compiler; None for that of the system.
        flags: Flags of the compiler. With -c the result is an object file.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    compiler = find_compiler(cc)
    program = folder / "program"
    paths = [str(folder / name) for name in sources]
    libraries = () if "-c" in flags else ("-lm",)
    _run([*compiler, *flags, "-o", str(program), *paths, *libraries], f"the C compiler {' '.join(compiler)}")
    return program


def load_library(files: Mapping[str, str], source: str, cc: str | None = None) -> Any:
    """Compile a shared library and return it as a ctypes.CDLL.

    Args:
        files: File name -> text.
        source: The file that is compiled.
        cc: Command of the compiler; None for that of the system.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    import ctypes

    compiler = find_compiler(cc)
    with _folder_of(files) as folder:
        library = folder / "library.so"
        command = [*compiler, *LIBRARY_FLAGS, "-o", str(library), str(folder / source), "-lm"]
        _run(command, f"the C compiler {' '.join(compiler)}")
        try:
            return ctypes.CDLL(str(library))
        except OSError as error:
            raise EnvironmentFailure(f"the compiled library cannot be loaded: {error}") from error


def run_program(program: Path, stdin: str, env: Mapping[str, str] | None = None) -> str:
    """Run ``program`` and return its standard output.

    Args:
        program: Path of the program.
        stdin: Its input.
        env: Variables of the environment that are added.

    Raises:
        EnvironmentFailure: The program fails.
    """
    return _run([str(program)], f"the compiled program {program.name}", stdin, env)[0]


def compile_and_run(
    files: Mapping[str, str],
    stdin: str,
    cc: str | None = None,
    flags: Sequence[str] = DEFAULT_FLAGS,
) -> str:
    """Compile C in a temporary folder, run the program and return its standard output.

    Args:
        files: File name -> text. Every ``.c`` file is compiled.
        stdin: Input of the program.
        cc: Command of the compiler; None for that of the system.
        flags: Flags of the compiler.

    Raises:
        EnvironmentFailure: There is no C compiler, or it or the program fails.
    """
    with _folder_of(files) as folder:
        program = compile_program(folder, [file for file in files if file.endswith(".c")], cc, flags)
        return run_program(program, stdin)


def run_rust(crate: str, library: str, program: str, stdin: str, flags: Sequence[str]) -> str:
    """Compile a crate and a program that uses it, run the program and return its standard output.

    Args:
        crate: Name of the crate.
        library: Text of the crate.
        program: Text of the program.
        stdin: Input of the program.
        flags: Flags of the compiler.

    Raises:
        EnvironmentFailure: There is no Rust compiler, or it or the program fails.
    """
    compiler = find_tool("rustc")
    if compiler is None:
        raise EnvironmentFailure(
            "no Rust compiler found: looked for rustc. Install one (Debian, Ubuntu: apt-get install rustc)."
        )
    with _folder_of({"lib.rs": library, "main.rs": program}) as folder:
        command = [compiler, "--edition=2021", *flags, f"-L{folder}", f"--out-dir={folder}"]
        what = f"the Rust compiler {compiler}"
        _run([*command, "--crate-type=rlib", f"--crate-name={crate}", str(folder / "lib.rs")], what)
        _run([*command, f"--extern={crate}", "--crate-name=program", str(folder / "main.rs")], what)
        return run_program(folder / "program", stdin)


def run_node(files: Mapping[str, str]) -> str:
    """Run ``main.mjs`` of ``files`` (name -> text) with Node and return its standard output."""
    node = find_tool("node")
    if node is None:
        raise EnvironmentFailure(
            "no Node found: looked for node. Install it (Debian, Ubuntu: apt-get install nodejs)."
        )
    return run_tool([node, "main.mjs"], files)


def print_pages(document: str, page: str, figures: Mapping[str, str]) -> bytes:
    """Print a report as PDF: the LaTeX document with TeX, or the HTML page with Chromium or a browser based on it.

    TeX is used if it is installed. The dates in the PDF are fixed, so that the same report gives the same bytes.

    Args:
        document: The LaTeX document.
        page: The HTML page, which has the same content.
        figures: File name -> SVG of the figures of the document.

    Raises:
        EnvironmentFailure: There is neither TeX with rsvg-convert nor a browser, or they fail.
    """
    browser, tex, converter = _first_tool(_BROWSERS), _first_tool(_TEX), find_tool("rsvg-convert")
    if tex and converter:
        return _compile_document(tex, converter, document, figures)
    if browser:
        return _print_in_browser(browser, page)
    raise EnvironmentFailure(
        f"no program found that prints a PDF: looked for {' or '.join(_TEX)} with rsvg-convert, and for "
        f"{', '.join(_BROWSERS)}. Install a browser (Debian, Ubuntu: apt-get install chromium), or print report.html "
        "(--html) yourself."
    )


def _compile_document(tex: str, converter: str, document: str, figures: Mapping[str, str]) -> bytes:
    """Return the PDF of a LaTeX document; ``converter`` makes a PDF of each of its figures."""
    with _folder_of({**figures, "page.tex": document}) as folder:
        for name in figures:
            _program([converter, "--format=pdf", f"--output={Path(name).stem}.pdf", name], folder)
        for _ in ("measure the columns of tables over several pages", "print"):
            _program(
                [tex, "-interaction=nonstopmode", "-halt-on-error", "-jobname=page", _WITHOUT_ID], folder
            )
        return _printed_by(tex, folder)


def _print_in_browser(browser: str, page: str) -> bytes:
    """Return the PDF of an HTML page."""
    # As root, Chromium does not start with its sandbox.
    root = ["--no-sandbox"] if os.name == "posix" and os.geteuid() == 0 else []
    options = ["--headless", "--disable-gpu", "--no-pdf-header-footer", "--user-data-dir=profile", *root]
    with _folder_of({"page.html": page}) as folder:
        _program([browser, *options, "--print-to-pdf=page.pdf", (folder / "page.html").as_uri()], folder)
        printed = _printed_by(browser, folder)
    # The fixed date has the length of a browser's date, because a PDF contains the byte offset of each of its parts.
    return _DATE.sub(rb"\1(D:20000101000000+00'00')", printed)


def _program(command: Sequence[str], folder: Path) -> None:
    """Run a program in a folder, at a fixed date."""
    _run(command, Path(command[0]).name, folder=str(folder), env=_FIXED_DATE, how="")


def _printed_by(program: str, folder: Path) -> bytes:
    """Return the PDF that a program has written."""
    try:
        return (folder / "page.pdf").read_bytes()
    except OSError as error:
        raise EnvironmentFailure(f"{program} printed nothing") from error


def find_tool(name: str) -> str | None:
    """Return the path of a program on the PATH, or None if there is none."""
    return shutil.which(name)


def _first_tool(names: Sequence[str]) -> str | None:
    """Return the path of the first of several programs that exists."""
    return next(filter(None, map(find_tool, names)), None)


def run_tool(
    command: Sequence[str], files: Mapping[str, str], both: bool = False, timeout: float = TIMEOUT
) -> str:
    """Run ``command`` in a temporary folder and return its standard output.

    Args:
        command: The program with its arguments.
        files: File name -> text of the files in the folder.
        both: Whether to append what it prints on stderr.
        timeout: Longest duration [s].

    Raises:
        EnvironmentFailure: The program cannot be started, fails, or takes too long.
    """
    with _folder_of(files) as folder:
        # Frama-C looks for files in $PWD, not in its working directory.
        env = {"PWD": str(folder)}
        name = Path(command[0]).name
        printed, errors = _run(command, name, env=env, folder=str(folder), how="", timeout=timeout)
        return printed + errors if both else printed
