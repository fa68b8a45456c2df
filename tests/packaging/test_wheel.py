"""The wheel built from the project works in an empty folder, templates included."""

from __future__ import annotations

import json
import re
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


def test_the_wheel_holds_the_packages_and_the_templates_and_nothing_else(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names}
    assert tops - {"wmrgen", "textbook"} == {f"{wheel.name.split('-py3')[0]}.dist-info"}
    library = [p for kind in ("*.py", "*.json") for p in (ROOT / "textbook").rglob(kind)]
    modules = {p.relative_to(ROOT).as_posix() for p in library}
    shipped_modules = {name for name in names if name.startswith("textbook/")}
    assert shipped_modules == {name for name in modules if not name.startswith("textbook/tests/")}
    licences = [name for name in names if ".dist-info/licenses/" in name]
    assert sorted(name.partition("/licenses/")[2] for name in licences) == [
        "LICENSE",
        "templates/html/katex/LICENSE",
    ]
    shipped = {n.removeprefix("wmrgen/templates/") for n in names if n.startswith("wmrgen/templates/")}
    templates = {p for p in (ROOT / "templates").rglob("*") if p.is_file() and p.parent.name != "__pycache__"}
    assert shipped == {p.relative_to(ROOT / "templates").as_posix() for p in templates}
    robots = {p.relative_to(ROOT / "robots").as_posix() for p in (ROOT / "robots").rglob("*.*")}
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


def test_the_textbook_library_is_there(installed: Path, tmp_path: Path) -> None:
    words = ("eval", "textbook", "polar_rates", "rho=1", "alpha=0.2", "beta=-0.1", "v=0.5")
    done = process(*words, cwd=tmp_path, python=(str(installed), "-E", "-m", "wmrgen"))
    assert done.code == 0 and done.out == process(*words, cwd=tmp_path).out, done.err


def test_the_way_from_a_text_to_a_robot_is_there(installed: Path, tmp_path: Path) -> None:
    """The robot file that a place names can be copied from the wheel, and the command then runs as printed."""
    python = (str(installed), "-E", "-m", "wmrgen")
    found = process("textbook", "--find", "2.75", "--json", cwd=tmp_path, python=python)
    assert found.code == 0, found.err
    (row,) = json.loads(found.out)["found"]
    name = Path(row["robot"]).stem
    made = process("new", name, "--from", name, "-o", row["robot"], cwd=tmp_path, python=python)
    assert made.code == 0, made.err
    done = process(*row["command"].split()[1:], "--json", cwd=tmp_path, python=python)
    assert json.loads(done.out)["w1.spin"] == pytest.approx(row["expected"]["w1.spin"])


def test_it_takes_the_files_of_a_checkout_as_fresh(installed: Path, tmp_path: Path) -> None:
    """What a checkout wrote is fresh for the wheel, which derives nothing then."""
    (tmp_path / "pair.yaml").write_text(DIFFERENTIAL)
    assert process("derive", "pair.yaml", cwd=tmp_path).code == 0
    probe = (
        "import sys; from wmrgen.__main__ import main\ntry: main()\nfinally: print('sympy' in sys.modules)"
    )
    done = process("check", "pair.yaml", cwd=tmp_path, python=(str(installed), "-E", "-c", probe))
    assert (done.code, done.out.splitlines()[-1]) == (0, "False"), done


def test_the_dependencies_that_one_command_needs_are_extras(wheel: Path) -> None:
    (name,) = (n for n in zipfile.ZipFile(wheel).namelist() if n.endswith(".dist-info/METADATA"))
    required = [
        line.removeprefix("Requires-Dist: ")
        for line in zipfile.ZipFile(wheel).read(name).decode().splitlines()
        if line.startswith("Requires-Dist: ")
    ]
    always = {re.split(r"[<>=!~\[; ]", line)[0] for line in required if "extra ==" not in line}
    assert not always & {"scipy", "xacro", "defusedxml", "distributed"} and {"sympy", "casadi"} <= always
    assert not [line for line in required if line.startswith("wmrgen-")], "no such distribution exists"


def test_the_declared_version_is_the_package_s(wheel: Path) -> None:
    import wmrgen

    assert wheel.name.startswith(f"wmrgen-{wmrgen.__version__}-")
