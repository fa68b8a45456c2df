"""The wheel built from the project works in an empty folder, templates included."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, ROOT, process, tree

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(out), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    (found,) = out.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of a fresh environment with the wheel in it; dependencies come from this one."""
    home = tmp_path_factory.mktemp("fresh") / "env"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(home)], check=True)
    python = home / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    site = next(home.rglob("site-packages"))
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)  # what an installer does with a pure wheel, less the script
    # Appended, so that the wheel's own package comes first; the .pth of the editable install is not read.
    (site / "borrowed.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    return python


def test_the_wheel_holds_the_package_and_the_templates_and_nothing_else(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names}
    assert len(tops) == 2
    assert "wmrgen" in tops
    shipped = {n.removeprefix("wmrgen/templates/") for n in names if n.startswith("wmrgen/templates/")}
    templates = {p for p in (ROOT / "templates").rglob("*") if p.is_file() and p.parent.name != "__pycache__"}
    assert shipped == {p.relative_to(ROOT / "templates").as_posix() for p in templates}
    robots = {p.name for p in (ROOT / "robots").iterdir()}
    assert {n.removeprefix("wmrgen/robots/") for n in names if n.startswith("wmrgen/robots/")} == robots
    assert "wmrgen/py.typed" in names


def test_it_derives_in_an_empty_folder(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "pair.yaml").write_text(DIFFERENTIAL)
    python = (str(installed), "-E", "-m", "wmrgen")
    where = [str(installed), "-E", "-c", "import wmrgen; print(wmrgen.__file__)"]
    home = subprocess.run(where, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert str(installed.parent.parent) in home, "the wheel is what runs, not the checkout"
    done = process("derive", "pair.yaml", cwd=tmp_path, python=python)
    assert done.code == 0, done.err
    here = process("derive", "pair.yaml", "-o", "here", cwd=tmp_path)
    assert here.code == 0, here.err
    assert tree(tmp_path / "generated") == tree(tmp_path / "here"), "same bytes as from the checkout"


def test_it_begins_a_robot_as_one_of_the_gallery(installed: Path, tmp_path: Path) -> None:
    python = (str(installed), "-E", "-m", "wmrgen")
    assert "kuka_youbot" in process("list", cwd=tmp_path, python=python).out
    assert process("new", "mine", "--from", "kuka_youbot", cwd=tmp_path, python=python).code == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine.yaml", "robot.schema.json"]
    assert process("derive", "mine.yaml", cwd=tmp_path, python=python).code == 0


def test_without_the_textbook_library_it_says_so(installed: Path, tmp_path: Path) -> None:
    for words in (("eval", "textbook", "pursuit"), ("textbook",)):
        done = process(*words, cwd=tmp_path, python=(str(installed), "-E", "-m", "wmrgen"))
        assert done.code == 4 and "wmrgen[textbook]" in done.err and done.out == ""
    assert not list(tmp_path.iterdir())


def test_the_declared_version_is_the_package_s(wheel: Path) -> None:
    import wmrgen

    assert wheel.name.startswith(f"wmrgen-{wmrgen.__version__}-")
