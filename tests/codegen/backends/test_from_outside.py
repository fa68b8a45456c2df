"""A backend for another language needs one module and one entry, and no change to the package."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

import pytest

from tests.codegen.backends.lua import ENTRY, FORMS, RESERVED
from tests.conftest import ROOT, Outcome, tree
from tests.robots import of_gallery
from wmrgen.codegen.registry import BACKENDS, Entry, register
from wmrgen.ir.ops import OPERATIONS
from wmrgen.robotfile.reserved_words import LANGUAGES

Cli = Callable[..., Outcome]
ROBOTS = ("pioneer3dx", "ackermann_car", "wpilib_swervebot", "kuka_youbot")


@pytest.fixture
def lua() -> Iterator[None]:
    """Register the backend."""
    register(ENTRY)
    yield
    del BACKENDS[ENTRY.name]


@pytest.mark.usefixtures("lua")
def test_derive_writes_its_files(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    before = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--scalar", "double")
    assert before.code == 0, before.err
    assert " pair.lua " in before.out
    files = tree(tmp_path / "out" / "pair")
    text = files["pair.lua"].decode()
    assert text.startswith("-- wmrgen ") and ", double, " in text.splitlines()[0]
    assert "function robot.inverse(in_vx, in_vy, in_omega)\n" in text
    assert "pair.lua" in json.loads(files["manifest.json"])["files"]
    assert wmrgen_cli("check", robot_file, "-o", tmp_path / "out").code == 0
    report = files["report.md"].decode()
    assert "[numerics.md](numerics.md)" in report
    numerics = files["numerics.md"].decode()
    assert "* [`pair.lua`](pair.lua): the functions for Lua" in numerics
    assert "Lines of `pair.lua`" in numerics and "Lines of `pair.c`" in numerics
    (tmp_path / "out" / "pair" / "pair.lua").write_text("")
    assert wmrgen_cli("check", robot_file, "-o", tmp_path / "out").code == 1


def test_it_needs_the_operations_that_have_a_text_for_arrays() -> None:
    """As docs/ARCHITECTURE.md says."""
    assert set(FORMS) == {op for op in OPERATIONS.values() if op.arrays and not op.infix}


@pytest.mark.usefixtures("lua")
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("function", ["inverse", "forward", "odometry"])
def test_eval_computes_with_it(wmrgen_cli: Cli, tmp_path: Path, name: str, function: str) -> None:
    robot = ROOT / "robots" / f"{name}.yaml"
    ports = of_gallery(name).raw_module.function(function).inputs
    inputs = [p.name for p in ports if p.default is None]
    assert inputs
    cases = [{k: (-1) ** n * (n + seed + 1) / 17 for n, k in enumerate(inputs)} for seed in range(3)]
    (tmp_path / "cases.json").write_text(json.dumps(cases))
    exact, lua = (
        json.loads(
            wmrgen_cli("eval", robot, function, "--cases", tmp_path / "cases.json", "--backend", word).out
        )
        for word in ("exact", "lua")
    )
    assert len(lua) == len(cases)
    for right, mine in zip(exact, lua, strict=True):
        assert mine == pytest.approx(right, rel=1e-12, abs=1e-12)


def test_its_words_are_reserved_while_it_is_registered(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot_file.write_text(robot_file.read_text().replace("name: left", "name: end"))
    words = ("derive", robot_file, "-o", tmp_path / "out")
    assert wmrgen_cli(*words).code == 0
    with monkeypatch.context() as patch:
        patch.setitem(LANGUAGES, ENTRY.name, (RESERVED,))
        done = wmrgen_cli(*words)
    assert done.code == 2
    assert "'end'" in done.err and "Lua" in done.err
    assert wmrgen_cli(*words).code == 0


def test_an_unknown_word_lists_the_backends(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "--backend", "lua")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[WMR112]: ") and "'lua'" in done.err
    assert done.err.rstrip(".\n").endswith(" exact c numpy casadi rust javascript")


@pytest.mark.parametrize(
    "entry",
    [
        Entry("c99", "other", "module", "other"),
        Entry("other", "other", "module", "c"),
        Entry("other", "other", "module", "exact"),
        Entry("other", "other", "module", "other", files=ENTRY.files + BACKENDS["numpy"].files),
    ],
)
def test_a_name_or_file_that_is_taken_is_rejected(entry: Entry) -> None:
    with pytest.raises(ValueError, match=r"\b(c99|numpy|exact)\b"):
        register(entry)
    assert "other" not in BACKENDS and BACKENDS["c99"].word == "c"


@pytest.mark.parametrize("name", ["wpilib_swervebot", "pioneer3dx"])
def test_entries_list_the_files_of_their_backends(name: str) -> None:
    folder = ROOT / "generated" / name
    files = [p for p in folder.rglob("*") if p.is_file() and p.parent.name != "__pycache__"]  # of an import
    written = {p.relative_to(folder).as_posix() for p in files}
    patterns = [n for entry in BACKENDS.values() for own in entry.files for n in own.names]
    said = {p for p in written if any(PurePosixPath(p).match(n.format(robot=name)) for n in patterns)}
    assert written - said <= {"model.json", "manifest.json", "budget.json"}
