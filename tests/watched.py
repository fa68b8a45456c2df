"""What a process of wmrgen changes on disk or starts, as Python's audit hook sees it."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_TRUNC
ONE = frozenset(
    "os.mkdir os.remove os.rmdir os.truncate os.chmod os.chown os.utime shutil.rmtree tempfile.mkdtemp "
    "tempfile.mkstemp os.setxattr os.removexattr".split()
)
TWO = frozenset("os.rename os.link os.symlink shutil.move shutil.copyfile shutil.copytree".split())
NEVER = (
    "socket.", "subprocess.", "os.system", "os.exec", "os.fork", "os.posix_spawn", "os.spawn", "pty.",
    "ftplib.", "urllib.", "http.", "smtplib.", "webbrowser.",
)  # fmt: skip


def watch(out: str, tell: Callable[[bool, str, str], None]) -> None:
    """From now on ``tell`` of every change: (outside the folder ``out`` or a new process?, audit event, arguments)."""
    out = os.path.realpath(out)

    def inside(path: Any, folder: Any) -> bool:
        if isinstance(path, int):  # an open handle, which an earlier event let through
            return True
        at = isinstance(folder, int) and folder >= 0
        base = Path(f"/proc/self/fd/{folder}").readlink() if at else Path.cwd()
        path = os.path.realpath(base / os.fsdecode(path))
        return path == out or path.startswith(out.rstrip(os.sep) + os.sep) or "__pycache__" in path

    def hook(event: str, args: tuple[Any, ...]) -> None:
        bad, seen = event.startswith(NEVER), False
        if event == "open":
            path, mode, flags = args
            seen = bool(flags & WRITES) or (mode is not None and bool(set(mode) & set("wax+")))
            bad = seen and path != os.devnull and not inside(path, -1)
        elif event in ONE:
            folder = (
                args[-1] if event in ("os.mkdir", "os.remove", "os.rmdir", "os.chmod", "os.chown") else -1
            )
            seen, bad = True, not inside(args[0], folder)
        elif event in TWO:
            folders = args[2:4] if len(args) >= 4 else (-1, -1)
            seen, bad = True, not all(map(inside, args[:2], folders))
        if bad or seen:
            tell(bad, event, repr(args))

    sys.addaudithook(hook)


def main() -> None:
    """``python -m tests.watched OUT LOG WORD…``: the command line; every change is a line of JSON in LOG."""
    import json

    out, log, words = sys.argv[1], sys.argv[2], sys.argv[3:]
    handle = os.open(log, os.O_WRONLY | os.O_CREAT)
    watch(out, lambda *change: os.write(handle, (json.dumps(change) + "\n").encode()) and None)
    sys.argv = ["wmrgen", *words]
    from wmrgen.__main__ import main

    main()


if __name__ == "__main__":
    main()
