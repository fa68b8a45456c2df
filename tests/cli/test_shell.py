"""Around the command line: completion in a shell, the page of its help, the hooks and the Action that run it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.cli.page import PAGE, page
from tests.conftest import DIFFERENTIAL, ROOT, Outcome
from tests.external_tools import tool

Cli = Callable[..., Outcome]


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A folder with the gallery, and a robot in a hidden folder."""
    (tmp_path / "robots").symlink_to(ROOT / "robots")
    (tmp_path / ".hidden").mkdir()
    (tmp_path / ".hidden" / "pair.yaml").write_text(DIFFERENTIAL)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("ev", ["eval"]),
        ("derive --pa", ["--package"]),
        ("eval robots/pi", ["robots/pioneer3dx.yaml"]),
        ("check rob", ["robots/"]),
        ("lint robots/unicycle.yaml robots/uni", ["robots/unicycle.yaml"]),
        ("eval robots/pioneer3dx.yaml odometry_c", ["odometry_compensated", "odometry_covariance"]),
        ("new x --from ku", ["kuka_youbot"]),
        ("model robots/bicycle.yaml --form ch", ["chained"]),
        ("derive nowhere/", []),
        ("derive .hidden/p", [".hidden/pair.yaml"]),
        ("derive .hid", [".hidden/"]),
        ("derive ''", ["robots/"]),
        ("explain WMR11", [f"WMR11{k}" for k in range(5)]),
        ("derive --package es", ["esp-idf"]),
    ],
)
def test_completion(
    wmrgen_cli: Cli, monkeypatch: pytest.MonkeyPatch, beside: Path, words: str, completed: list[str]
) -> None:
    monkeypatch.chdir(beside)
    monkeypatch.setenv("COMP_WORDS", f"wmrgen {words}")
    monkeypatch.setenv("COMP_CWORD", str(len(words.split())))
    monkeypatch.setenv("_WMRGEN_COMPLETE", "complete_bash")
    assert wmrgen_cli().out.split() == completed


# How each shell is made to say what it completes of the words $1 …; zsh types them and a tab at a terminal.
SHELLS = {
    "bash": """
source <(wmrgen --show-completion)
COMP_WORDS=(wmrgen "$@") COMP_CWORD=$#
_wmrgen_completion wmrgen
printf '%s\\n' "${COMPREPLY[@]}"
""",
    "fish": 'wmrgen --show-completion | source; complete --do-complete "wmrgen $argv"',
    "zsh": """
zmodload zsh/zpty
zpty terminal zsh -f -i
zpty -w terminal 'autoload -Uz compinit; compinit -u -D; source <(wmrgen --show-completion); PS1=; echo rea''dy'
zpty -r terminal said '*ready*'
zpty -n -w terminal "wmrgen $*"$'\\t'
zpty -r terminal said "*wmrgen*$EXPECTED*" && print -r -- $EXPECTED
""",
    "zsh, installed": """
zmodload zsh/zpty
wmrgen --install-completion > /dev/null
zpty terminal zsh -i
zpty -w terminal 'PS1=; echo rea''dy'
zpty -r terminal said '*ready*'
zpty -n -w terminal "wmrgen $*"$'\\t'
zpty -r terminal said "*wmrgen*$EXPECTED*" && print -r -- $EXPECTED
""",
}


@pytest.mark.slow
@pytest.mark.parametrize("shell", SHELLS)
def test_shells_complete(shell: str, beside: Path, tmp_path: Path) -> None:
    """The script that --show-completion prints, in the shell that reads it; in zsh what is installed, too, at the first
    tab."""
    program = tmp_path / "bin" / "wmrgen"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nfrom wmrgen.__main__ import main\nmain()\n")
    program.chmod(0o755)
    environment = {"PATH": f"{program.parent}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT), "TERM": "dumb"}
    for words, completed in (
        ("ev", "eval"), ("derive robots/pio", "robots/pioneer3dx.yaml"),
        ("eval robots/unicycle.yaml odometry_cov", "odometry_covariance"),
    ):  # fmt: skip
        done = subprocess.run(
            [tool(shell.split(",")[0]), "-c", SHELLS[shell], *([shell] if shell != "fish" else []), *words.split()],
            cwd=beside, env=environment | {"EXPECTED": completed, "HOME": str(tmp_path)},
            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60,
        )  # fmt: skip
        assert [line.split("\t")[0] for line in done.stdout.splitlines()] == [completed], done.stderr


def test_the_page_is_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: python -m tests.cli.page"


@pytest.fixture
def project(tmp_path: Path, wmrgen_cli: Cli, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a robot and its generated files, both as they should be."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "pair.yaml").write_text(DIFFERENTIAL)
    assert wmrgen_cli("fmt", "robots/pair.yaml").code == wmrgen_cli("derive", "robots/pair.yaml").code == 0
    return tmp_path


def test_hooks_are_what_pre_commit_reads(wmrgen_cli: Cli, project: Path) -> None:
    hooks = {hook["id"]: hook for hook in yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())}
    assert list(hooks) == ["wmrgen-check", "wmrgen-lint", "wmrgen-fmt"]
    for hook in hooks.values():
        assert {"id", "name", "entry", "language", "files"} <= hook.keys() and hook["language"] == "python"
        files = ["robots/pair.yaml"] if hook.get("pass_filenames", True) else []
        program, *words = hook["entry"].split()
        assert (program, wmrgen_cli(*words, *files).code) == ("wmrgen", 0)
    (project / "generated" / "pair" / "pair.h").write_text("stale")
    assert wmrgen_cli(*hooks["wmrgen-check"]["entry"].split()[1:]).code == 1


READERS = {
    ".pre-commit-hooks.yaml": ("pre-commit", "validate-manifest"),
    "action.yml": ("check-jsonschema", "--builtin-schema", "vendor.github-actions"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_others_take_them(name: str, tmp_path: Path) -> None:
    """pre-commit reads the hooks, the Action is what GitHub's schema says; without its name either is refused."""
    program, *words = READERS[name]
    text = (ROOT / name).read_text(encoding="utf-8")
    for content, code in ((text, 0), (text.replace("name:", "title:"), 1)):
        (tmp_path / name).write_text(content, encoding="utf-8")
        done = subprocess.run([tool(program), *words, tmp_path / name], capture_output=True, text=True)
        assert done.returncode == code, done.stdout + done.stderr


@pytest.mark.skipif(not shutil.which("bash"), reason="the Action's shell")
@pytest.mark.parametrize("robots", ["", "robots/*.yaml"])
def test_the_action_runs_what_it_says(wmrgen_cli: Cli, project: Path, robots: str) -> None:
    action: dict[str, Any] = yaml.safe_load((ROOT / "action.yml").read_text())
    assert action["name"] and action["description"] and action["runs"]["using"] == "composite"
    assert all(entry["description"] and "default" in entry for entry in action["inputs"].values())
    python, install, check = action["runs"]["steps"]
    assert python["uses"].startswith("actions/setup-python@") and "$GITHUB_ACTION_PATH" in install["run"]
    assert (ROOT / "constraints.txt").is_file() and "$GITHUB_ACTION_PATH/constraints.txt" in install["run"]
    assert "${{" not in install["run"] + check["run"], "what a caller writes is no part of a script"
    inputs = {name: entry["default"] for name, entry in action["inputs"].items()} | {"robots": robots}
    values = {key: inputs[text.strip("${ }").removeprefix("inputs.")] for key, text in check["env"].items()}
    program = project / "bin" / "wmrgen"
    program.parent.mkdir()
    program.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    program.chmod(0o755)
    environment = {"PATH": f"{program.parent}:/usr/bin:/bin", **values}
    done = subprocess.run(["bash", "-e", "-c", check["run"]], env=environment, capture_output=True, text=True)
    words = done.stdout.splitlines()
    assert words == ["check", *(["robots/pair.yaml"] if robots else []), "--out", "generated", "--full"]
    assert wmrgen_cli(*words).code == 0
    (project / "generated" / "pair" / "pair.h").write_text("stale")
    assert wmrgen_cli(*words).code == 1
