"""`wmrgen view`: a page that follows its robot files."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.report.pages.chromium import seen

Cli = Callable[..., Outcome]


def test_json_says_where_the_page_is(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    """Also of two robots of one name."""
    other = shutil.copy(robot_file, tmp_path / "other.yaml")
    done = wmrgen_cli("view", robot_file, other, "-o", tmp_path / "out", "--json")
    assert done.code == 0, done.err
    text = Path(json.loads(done.out)["page"]).read_text(encoding="utf-8")
    ids = re.findall(r'<(?:section|h\d) id="([^"]*)"', text)
    assert len(ids) == len(set(ids)) and {"pair-report.md", "pair-report.md-1"} <= set(ids)
    assert text.count('"name": "pair"') == 2 and "wmrgenVersion" not in text
    robot_file.write_text("wmrgen: 1\n")
    failed = wmrgen_cli("view", robot_file, "--json")
    assert (failed.code, json.loads(failed.out)["exit_code"]) == (2, 2)


def test_a_file_that_is_not_there_is_not_waited_for(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path
) -> None:
    done = wmrgen_cli("view", robot_file, tmp_path / "nowhere.yaml", "--no-open", "-o", tmp_path / "out")
    assert (done.code, done.out) == (2, "") and done.err.startswith("error[WMR110]")
    assert not (tmp_path / "out").exists()


def test_every_change_is_shown_once(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Contents that are the same have one version, also when another one was between them."""
    texts = ["b", "b", "a", "c", "", None, "b", "b"]
    versions: list[str] = []

    def sleep(seconds: float) -> None:
        """Edit the file before the page is looked at again."""
        versions.append((tmp_path / "version.js").read_text())
        if not texts:
            raise KeyboardInterrupt
        text = texts.pop(0)
        robot_file.unlink(missing_ok=True) if text is None else robot_file.write_text(text)

    monkeypatch.setattr(time, "sleep", sleep)
    done = wmrgen_cli("view", robot_file, "--no-open", "-o", tmp_path)
    assert done.code == 0
    assert [versions.index(version) for version in versions] == [0, 1, 1, 3, 4, 5, 6, 1, 1]
    assert len(re.findall(r"^error\[", done.err, re.MULTILINE)) == 6, "each change once"


def test_a_path_that_is_no_file_is_refused(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """A device without an end, a pipe that nobody writes to, a folder."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (Path("/dev/zero"), pipe, tmp_path):
        done = wmrgen_cli("view", path, "--no-open", "-o", tmp_path / "out")
        assert (done.code, done.out) == (2, "")
        assert done.err.startswith(f"error[WMR110]: {path}: ") and not (tmp_path / "out").exists()


@pytest.fixture
def watching(robot_file: Path, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    words = ["view", str(robot_file), "--no-open", "-o", str(tmp_path / "out")]
    command = [sys.executable, "-m", "wmrgen", *words]
    # Shells start what runs in the background with interrupts ignored, the tests and their children among them.
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    ) as process:  # fmt: skip
        yield process
        process.kill()


def _until(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + 120
    while not holds():
        assert time.monotonic() < end, "it did not happen within 120 s"
        time.sleep(0.05)


@pytest.mark.slow
def test_the_page_follows_the_file(watching: subprocess.Popen[str], robot_file: Path, tmp_path: Path) -> None:
    page, version = tmp_path / "out" / "view.html", tmp_path / "out" / "version.js"
    good = robot_file.read_text()
    _until(version.exists)
    first = version.read_text()
    assert "0.1655" in page.read_text(encoding="utf-8") and first.split('"')[1] in page.read_text(
        encoding="utf-8"
    )
    robot_file.write_text(good.replace("type: fixed", "type: <b>fixd</b>", 1))
    _until(lambda: version.read_text() != first)
    broken = page.read_text(encoding="utf-8")
    assert "error[WMR104]" in broken and "&lt;b&gt;fixd" in broken and "<b>" not in broken
    robot_file.unlink()
    _until(lambda: "error[WMR110]" in page.read_text(encoding="utf-8"))
    robot_file.write_text(good.replace("0.1655", "0.1777"))
    _until(lambda: "0.1777" in page.read_text(encoding="utf-8"))
    robot_file.write_text(good)
    _until(lambda: version.read_text() == first)
    watching.send_signal(signal.SIGINT)
    out, err = watching.communicate(timeout=20)
    assert watching.returncode == 0, err
    assert str(page) in out and "fixd" in err


@pytest.mark.slow
def test_the_page_loads_itself_again(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """The policy lets the script of the version in, and nothing is wrong on the console."""
    from wmrgen.report.pages.document import broken

    (tmp_path / "version.js").write_text('window.wmrgenVersion = "1";')
    script = """const s = document.createElement("script"); s.src = "version.js?1"; s.onload = () => {
      document.title = JSON.stringify(window.wmrgenVersion); }; document.head.append(s); return 0;"""
    result, console = seen(broken("x", "1"), script, tmp_path)
    assert (result, console) == ("1", [])
