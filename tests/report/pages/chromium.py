"""A page in headless Chromium: what a script finds there, and what the console says."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import subprocess
from html import unescape
from pathlib import Path
from typing import Any

from tests.external_tools import missing
from wmrgen.codegen.compiler import _BROWSERS, find_tool

_CONSOLE = re.compile(r"CONSOLE.*")


def seen(page: str, script: str, folder: Path, size: tuple[int, int] = (1200, 900)) -> tuple[Any, list[str]]:
    """What the function body ``script`` returns in ``page``, and the lines of the console. The page's policy stays: the
    script is let in by its digest."""
    digest = base64.b64encode(hashlib.sha256(_told(script).encode()).digest()).decode()
    assert page.count("default-src 'none';") == 1
    own, none = f"script-src 'sha256-{digest}'", "default-src 'none';"
    page = (
        page.replace("script-src", own, 1) if "script-src" in page else page.replace(none, f"{none} {own};")
    )
    return opened(page, script, folder, size)


def _told(script: str) -> str:
    """The script of which the title tells the result."""
    return f"document.title = JSON.stringify((() => {{ {script} }})());"


def opened(
    page: str, script: str, folder: Path, size: tuple[int, int] = (1200, 900), flags: tuple[str, ...] = ()
) -> tuple[Any, list[str]]:
    """As `seen`, of a page without a policy. ``flags``: more options of Chromium."""
    browser = next((path for name in _BROWSERS if (path := find_tool(name))), None) or missing("no Chromium")
    path = folder / "page.html"
    path.write_text(page.replace("</body>", f"<script>{_told(script)}</script></body>"), encoding="utf-8")
    root = ["--no-sandbox"] if os.geteuid() == 0 else []
    command = [
        str(browser), "--headless", "--disable-gpu", "--enable-logging=stderr", *root, *flags,
        f"--user-data-dir={folder}/profile", f"--window-size={size[0]},{size[1]}", "--dump-dom", path.as_uri(),
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    title = re.search(r"<title>(.*?)</title>", done.stdout, re.DOTALL)
    assert title
    return json.loads(unescape(title[1])), _CONSOLE.findall(done.stderr)
