"""``wmrgen view``: a page about robots in the browser, written again whenever a robot file is saved."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Robots, flag, output, verb
from wmrgen.errors import WmrgenError
from wmrgen.robotfile.text import MAX_BYTES, bytes_of

PAGE, VERSION = "view.html", "version.js"


@verb("view")
def view(
    robots: Robots,
    no_open: Annotated[bool, flag("--no-open", "Write the page, open no browser.")] = False,
    out: Annotated[
        Path | None, output("DIR", "The folder of the page; without it a temporary folder.")
    ] = None,
    as_json: Annotated[bool, flag("--json", "Print where the page is, and end.")] = False,
) -> int:
    """Example:  wmrgen view robots/pioneer3dx.yaml robots/kuka_youbot.yaml

    Show the reports in the browser, with the robots side by side at the top, ready to drive. The page is updated when a
    robot file is saved. If the file has an error, the page shows the error until it is corrected. Ctrl-C ends it.
    """
    import shutil
    import tempfile

    for path in robots:
        bytes_of(path, MAX_BYTES + 1)  # RobotFileError for a path that is no file: it will not become one
    folder = out or Path(tempfile.mkdtemp(prefix="wmrgen-"))
    if as_json:
        _write(folder, _page(robots, ""), "")
        console.data({"page": str(folder / PAGE)})
        return 0
    try:
        _watch(robots, folder, no_open)
    except (KeyboardInterrupt, console.Stopped) as end:
        if isinstance(end, console.Stopped) and end.name != "SIGINT":
            raise
    finally:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
    return 0  # Ctrl-C is the normal end


def _watch(robots: Sequence[Path], folder: Path, no_open: bool) -> None:
    """Write the page, open it, and write it again after every change of a robot file, until Ctrl-C."""
    import hashlib
    import webbrowser

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
        time.sleep(0.3)  # s: quick for a person who saves a file, and rare enough to cost nothing


def _content(path: Path) -> bytes | None:
    """Return the content of a robot file; None if it cannot be read: some editors delete a file while they save it."""
    try:
        return bytes_of(path, MAX_BYTES + 1)
    except WmrgenError:
        return None


def _show(robots: Sequence[Path], folder: Path, version: str) -> None:
    """Write the page; if a robot cannot be derived, write a page with the error, and print the error."""
    from wmrgen.report.pages.document import broken

    try:
        text = _page(robots, version)
        console.note("the page shows the robot files as they are now")
    except WmrgenError as error:
        text = broken(str(error), version)
        console.failure(str(error))
    _write(folder, text, version)


def _page(robots: Sequence[Path], version: str) -> str:
    """Return the page of all robots. It reloads when the file of the version has another ``version``, "" for never."""
    from wmrgen.cli.generate import derived
    from wmrgen.derivation.emit import artifacts
    from wmrgen.report.pages.document import page
    from wmrgen.report.pages.formats import report

    reports = []
    for path in robots:
        derivation = derived(*wmrgen.read(path))
        reports.append(report(derivation, artifacts(derivation)))
    return page(reports, version)


def _write(folder: Path, text: str, version: str) -> None:
    """Write the page, then the file of its version: a browser that sees the new version reloads the page."""
    from wmrgen.derivation.artifacts import write_file

    write_file(folder / PAGE, text.encode())
    write_file(folder / VERSION, f'window.wmrgenVersion = "{version}";\n'.encode())
