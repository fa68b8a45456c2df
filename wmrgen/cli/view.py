"""``wmrgen view``: the page of robots in a browser, made again whenever a robot file is saved."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
import time
import webbrowser
from collections.abc import Sequence
from pathlib import Path

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.generate import derived
from wmrgen.derivation.artifacts import write_file
from wmrgen.derivation.emit import artifacts
from wmrgen.errors import WmrgenError
from wmrgen.report.pages.document import broken, page
from wmrgen.report.pages.formats import report

PAGE, VERSION = "view.html", "version.js"
_PAUSE = 0.3  # s between two looks at the robot files


def view(robots: Sequence[Path], no_open: bool, out: Path | None, as_json: bool) -> int:
    """Write the page, open it, and write it again after every change, until it is interrupted; as JSON say where the
    page is, and end. RobotFileError where a file is not there to begin with."""
    for path in robots:
        if not path.exists():
            wmrgen.read(path)  # says so
    folder = out or Path(tempfile.mkdtemp(prefix="wmrgen-"))
    if as_json:
        _write(folder, _page(robots, ""), "")
        console.data({"page": str(folder / PAGE)})
        return 0
    try:
        return _watch(robots, folder, no_open)
    except (KeyboardInterrupt, console.Stopped) as end:
        if isinstance(end, console.Stopped) and end.name != "SIGINT":
            raise
        return 0  # which is how one ends it
    finally:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)


def _watch(robots: Sequence[Path], folder: Path, no_open: bool) -> int:
    before: list[bytes | None] = []
    while True:
        now = [_content(path) for path in robots]
        if now != before:
            _show(robots, folder, hashlib.sha256(repr(now).encode()).hexdigest()[:16])
            if not before:
                console.result(f"{folder / PAGE} follows {' '.join(map(str, robots))}. Ctrl-C ends it.")
                if not no_open:
                    webbrowser.open((folder / PAGE).absolute().as_uri())
            before = now
        time.sleep(_PAUSE)


def _content(path: Path) -> bytes | None:
    """Nothing of a file that is not there: editors take one away when they save it."""
    try:
        return path.read_bytes()
    except OSError:
        return None


def _show(robots: Sequence[Path], folder: Path, version: str) -> None:
    """Write the page; of robots that cannot be derived one that says why, as the terminal does."""
    try:
        text = _page(robots, version)
        console.note("the page is that of the robot files")
    except WmrgenError as error:
        text = broken(str(error), version)
        console.failure(str(error))
    _write(folder, text, version)


def _page(robots: Sequence[Path], version: str) -> str:
    reports = []
    for path in robots:
        derivation = derived(*wmrgen.read(path))
        reports.append(report(derivation, artifacts(derivation)))
    return page(reports, version)


def _write(folder: Path, text: str, version: str) -> None:
    """The page first: who sees the new version loads it."""
    write_file(folder / PAGE, text.encode())
    write_file(folder / VERSION, f'window.wmrgenVersion = "{version}";\n'.encode())
