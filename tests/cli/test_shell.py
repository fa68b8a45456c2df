"""Around the command line: completion in a shell, the page of its help, the hooks and the Action that run it."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.cli.page import PAGE, page
from tests.conftest import DIFFERENTIAL, ROOT, Outcome

Cli = Callable[..., Outcome]


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
    ],
)
def test_completion(
    wmrgen_cli: Cli, monkeypatch: pytest.MonkeyPatch, words: str, completed: list[str]
) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("COMP_WORDS", f"wmrgen {words}")
    monkeypatch.setenv("COMP_CWORD", str(len(words.split())))
    monkeypatch.setenv("_WMRGEN_COMPLETE", "complete_bash")
    assert wmrgen_cli().out.split() == completed


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
    assert words == ["check", *(["robots/pair.yaml"] if robots else []), "--out", "generated"]
    assert wmrgen_cli(*words).code == 0
    (project / "generated" / "pair" / "pair.h").write_text("stale")
    assert wmrgen_cli(*words).code == 1
