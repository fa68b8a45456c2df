"""Whatever generated files depend on is noticed: only a run that would change nothing is skipped."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, ROOT, Outcome, process, tree
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import differences, write_tree
from wmrgen.derivation.manifest import BUDGET, MANIFEST, intact, recorded_inputs, unlisted

FILES = {"a.c": b"int a;", "test/b.c": b"int b;"}
OPTIONS = {"scalar": "float"}
INPUTS = {"wmrgen": "0.1.0", "robot_file": "00"}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder with FILES, made from INPUTS."""
    place = tmp_path / "out" / "pair"
    write_tree(place, FILES, OPTIONS, INPUTS)
    return place


def rewritten(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_a_folder_is_fresh_as_it_was_written(place: Path) -> None:
    manifest = freshness.fresh(place, INPUTS, OPTIONS)
    assert manifest and set(manifest.files) == set(FILES)
    assert freshness.fresh(place, INPUTS) == manifest
    assert recorded_inputs(place) == INPUTS


@pytest.mark.parametrize(
    ("inputs", "options"),
    [
        ({**INPUTS, "wmrgen": "0.1.1"}, OPTIONS),
        ({**INPUTS, "robot_file": "01"}, OPTIONS),
        ({**INPUTS, "more": "1"}, OPTIONS),
        ({"wmrgen": "0.1.0"}, OPTIONS),
        ({}, OPTIONS),
        (INPUTS, {"scalar": "double"}),
        (INPUTS, {**OPTIONS, "fuzz": "yes"}),
        (INPUTS, {}),
    ],
)
def test_other_inputs_and_options_are_not_fresh(
    place: Path, inputs: dict[str, str], options: dict[str, str]
) -> None:
    assert freshness.fresh(place, inputs, options) is None


DAMAGE: dict[str, Callable[[Path], object]] = {
    "an edited file": lambda p: (p / "a.c").write_bytes(b"int c;"),
    "a missing file": lambda p: (p / "test" / "b.c").unlink(),
    "a file that is a link": lambda p: (
        (p / "a.c").rename(p.parent / "a.c"),
        (p / "a.c").symlink_to("../a.c"),
    ),
    "a folder that is a link": lambda p: (
        (p / "test").rename(p.parent / "t"),
        (p / "test").symlink_to("../t"),
    ),
    "a file that is a folder": lambda p: ((p / "a.c").unlink(), (p / "a.c").mkdir()),
    "an edited option": lambda p: rewritten(p / MANIFEST, '"float"', '"double"'),
    "an edited input": lambda p: rewritten(p / MANIFEST, '"robot_file": "00"', '"robot_file": "01"'),
    "an edited layout": lambda p: rewritten(p / MANIFEST, "\n  ", "\n   "),
    "a file less": lambda p: rewritten(p / MANIFEST, '"a.c"', '"b.c"'),
    "no key": lambda p: (p / MANIFEST).write_text(re.sub(r',\n  "key".*', "", (p / MANIFEST).read_text())),
    "no manifest": lambda p: (p / MANIFEST).unlink(),
    "no JSON": lambda p: (p / MANIFEST).write_text("{"),
    "a manifest that is a link": lambda p: (
        (p / MANIFEST).rename(p.parent / "m"),
        (p / MANIFEST).symlink_to("../m"),
    ),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_folder_is_not_intact(place: Path, damage: str) -> None:
    assert intact(place)
    DAMAGE[damage](place)
    assert intact(place) is None
    for inputs in (INPUTS, {**INPUTS, "robot_file": "01"}):
        assert freshness.fresh(place, inputs) is None


def test_a_forged_manifest_reads_nothing_outside(place: Path) -> None:
    """Its key is right, but a name leaves the folder."""
    (place.parent / "x").write_bytes(b"")
    manifest = intact(place)
    assert manifest
    (place / MANIFEST).write_bytes(manifest._replace(files={"../x": freshness.sha256(b"")}).encoded())
    assert intact(place) is None


def test_a_folder_behind_a_link_is_not_fresh(place: Path, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(place.parent)
    assert freshness.fresh(tmp_path / "link" / "pair", INPUTS) is None


def test_unlisted_files_are_found(place: Path) -> None:
    (place / BUDGET).write_bytes(b"{}")
    (place / "test" / "__pycache__").mkdir()
    (place / "test" / "__pycache__" / "x.pyc").write_bytes(b"")
    assert unlisted(place, list(FILES)) == []
    (place / "test" / "mine.c").write_bytes(b"")
    assert unlisted(place, list(FILES)) == [place / "test" / "mine.c"]


def test_inputs_do_not_make_files_stale(place: Path) -> None:
    """Another version of a library that gives the same files is no difference; `derive` records it."""
    assert differences(place, FILES, OPTIONS) == []
    assert write_tree(place, FILES, OPTIONS, {**INPUTS, "wmrgen": "0.2.0"}).changed == (MANIFEST,)
    assert differences(place, FILES, OPTIONS) == []
    assert [d.path.name for d in differences(place, FILES, {})] == [MANIFEST]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("wmrgen: 1\nname: pair\n", "pair"),
        ("name: 'pair'  # two wheels\r\n", "pair"),
        ("# name: no\nparameters:\n  name: no\nname: pair", "pair"),
        ("name: pair\nname: again\n", None),
        ("name: ../pair\n", None),
        ("{name: pair}", None),
        ("", None),
    ],
)
def test_the_name_that_a_file_probably_has(text: str, name: str | None) -> None:
    assert freshness.name_in(text.encode()) == name


def test_inputs_are_versions_and_hashes_without_places() -> None:
    inputs = freshness.inputs(b"name: pair")
    assert {*freshness.LIBRARIES, "wmrgen", "python", "own_files", "robot_file"} == set(inputs)
    assert not [value for value in inputs.values() if str(ROOT) in value]
    other = freshness.inputs(b"name: pair2")
    assert {key for key in inputs if inputs[key] != other[key]} == {"robot_file"}


def test_versions_are_those_of_the_installed_metadata() -> None:
    from importlib.metadata import version

    assert freshness.library_versions() == {name: version(name) for name in freshness.LIBRARIES}


# ---- the command line, in processes of their own: tests have loaded what the fast way must not find loaded

HEAVY = {"sympy", "numpy", "casadi", "yaml", "jinja2", "mpmath"}
PROBE = """
import sys
from wmrgen.__main__ import main
try:
    main()
finally:
    print("LOADED", *sorted({heavy} & sys.modules.keys()), file=sys.stderr)
"""


def run(
    *words: object, cwd: Path, env: dict[str, str] | None = None, code: str = PROBE
) -> tuple[Outcome, bool]:
    """The command line, and whether it derived something."""
    probe = code.replace("{heavy}", repr(HEAVY))
    done = process(*words, cwd=cwd, env=env, python=(sys.executable, "-c", probe))
    said = done.err.splitlines()
    assert said and said[-1].startswith("LOADED"), done.err
    return Outcome(done.code, done.out, "\n".join(said[:-1])), said[-1] != "LOADED"


@pytest.fixture(scope="module")
def derived_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project with a robot, its files, a package, and the pages."""
    home = tmp_path_factory.mktemp("project")
    (home / "robots").mkdir()
    (home / "robots" / "pair.yaml").write_text(DIFFERENTIAL)
    done, derived = run("derive", "robots/pair.yaml", "--package", "cmake", cwd=home)
    assert done.code == 0 and derived, done.err
    assert run("gallery", cwd=home)[0].code == 0
    return home


@pytest.fixture
def project(derived_once: Path, tmp_path: Path) -> Path:
    """A copy of the project, in another folder."""
    shutil.copytree(derived_once, tmp_path / "copy", symlinks=True)
    return tmp_path / "copy"


def test_nothing_is_loaded_when_nothing_changed(project: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in project.rglob("*")}
    for words in (
        ["check"],
        ["check", "robots/pair.yaml"],
        ["derive", "robots/pair.yaml"],
        ["derive", "robots/pair.yaml", "--package", "cmake"],
        ["derive", "robots/pair.yaml", "--json"],
    ):
        done, derived = run(*words, cwd=project)
        assert (done.code, derived, done.err) == (0, False, ""), (words, done)
        assert done.out
    assert {path: path.stat().st_mtime_ns for path in project.rglob("*")} == before


def test_what_a_skipped_run_prints(project: Path) -> None:
    full = process("derive", "robots/pair.yaml", "-o", "again", cwd=project)
    done, derived = run("derive", "robots/pair.yaml", "--package", "cmake", cwd=project)
    assert not derived
    assert done.out.splitlines()[0] == full.out.splitlines()[0]
    assert "all up to date" in done.out and "package-cmake/pair/: " in done.out
    model, derived = run("derive", "robots/pair.yaml", "--json", cwd=project)
    assert not derived and model.out == (project / "generated" / "pair" / "model.json").read_text()


CHANGES: dict[str, tuple[list[str], int, Callable[[Path], object]]] = {
    "the robot file": (["check"], 1, lambda p: rewritten(p / "robots/pair.yaml", "0.0975", "0.098")),
    "a comment in it": (
        ["check"],
        0,
        lambda p: rewritten(p / "robots/pair.yaml", "name: pair", "name: pair # 1"),
    ),
    "a generated file": (["check"], 1, lambda p: rewritten(p / "generated/pair/pair.c", "pair", "pear")),
    "a file more": (["check"], 1, lambda p: (p / "generated/pair/mine.c").write_text("")),
    "a file less": (["check"], 1, lambda p: (p / "generated/pair/pair.h").unlink()),
    "a file of a package": (
        ["check"],
        1,
        lambda p: (p / "generated/package-cmake/pair/CMakeLists.txt").write_text(""),
    ),
    "a package of no kind": (
        ["check"],
        1,
        lambda p: shutil.copytree(p / "generated/package-cmake", p / "generated/package-make"),
    ),
    "a page": (["check"], 1, lambda p: (p / "generated/README.md").write_text("")),
    "a page less": (["check"], 1, lambda p: (p / "generated/index.html").unlink()),
    "another scalar type": (["derive", "robots/pair.yaml", "--scalar", "double"], 0, lambda p: None),
    "another processor": (["derive", "robots/pair.yaml", "--target", "m0"], 0, lambda p: None),
    "functions over arrays": (["derive", "robots/pair.yaml", "--batch"], 0, lambda p: None),
    "a page for the browser": (["derive", "robots/pair.yaml", "--html"], 0, lambda p: None),
    "another package": (["derive", "robots/pair.yaml", "--package", "rust"], 0, lambda p: None),
    "another folder": (["derive", "robots/pair.yaml", "-o", "other"], 0, lambda p: None),
    "a full check": (["check", "--full"], 0, lambda p: None),
}


EVERYDAY = {"the robot file", "a generated file", "another scalar type", "a full check"}


@pytest.mark.parametrize(
    "change", [pytest.param(name, marks=() if name in EVERYDAY else pytest.mark.slow) for name in CHANGES]
)
def test_what_changes_is_derived(project: Path, change: str) -> None:
    words, code, put = CHANGES[change]
    put(project)
    done, derived = run(*words, cwd=project)
    assert derived and done.code == code, done


def test_a_stranger_is_found_without_deriving(project: Path) -> None:
    (project / "generated" / "gone").mkdir()
    done, derived = run("check", cwd=project)
    assert not derived and done.code == 1 and "generated/gone" in done.out


def test_check_says_that_manifests_record_other_inputs(project: Path) -> None:
    rewritten(project / "robots/pair.yaml", "name: pair", "name: pair # another comment")
    assert run("check", cwd=project)[0].err
    assert run("derive", "robots/pair.yaml", "--package", "cmake", cwd=project)[0].code == 0
    done, derived = run("check", "robots/pair.yaml", cwd=project)
    assert (done.code, done.err, derived) == (0, "", False)


def test_a_robot_with_remarks_is_derived_again_and_they_are_repeated(tmp_path: Path) -> None:
    (tmp_path / "pair.yaml").write_text(DIFFERENTIAL.replace("alpha: pi/2", "alpha: 1.5707"))
    first, _ = run("derive", "pair.yaml", cwd=tmp_path)
    again, derived = run("derive", "pair.yaml", cwd=tmp_path)
    assert derived and again.err == first.err and "note: pair" in again.err
    checked, derived = run("check", "pair.yaml", cwd=tmp_path)
    assert checked.code == 0 and not derived


def copied(home: Path) -> dict[str, str]:
    """wmrgen copied to ``home``; the surroundings in which it is imported from there."""
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "wmrgen", home / "wmrgen", ignore=ignored)
    shutil.copytree(ROOT / "templates", home / "templates", ignore=ignored)
    return {"PYTHONPATH": str(home), "PYTHONDONTWRITEBYTECODE": "1"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        lambda home: rewritten(
            home / "wmrgen/errors.py", "import annotations\n", "import annotations  # changed\n"
        ),
        lambda home: (home / "wmrgen/derivation/more.py").write_text(""),
        lambda home: (home / "wmrgen/tools/exporting/wpilib.py").unlink(),
        lambda home: rewritten(home / "templates/c99/header.h.j2", "{{", "{{ "),
        lambda home: (home / "templates/c99/more.j2").write_text(""),
        lambda home: rewritten(home / "wmrgen/derivation/version.py", "0.1.0", "0.1.1"),
    ],
    ids=["a module", "a module more", "a module less", "a template", "a template more", "the version"],
)
def test_own_files_count(project: Path, tmp_path: Path, change: Callable[[Path], object]) -> None:
    """A copy of wmrgen elsewhere agrees with what this one wrote; a changed copy derives."""
    home = tmp_path / "elsewhere"
    env = copied(home)
    done, derived = run("check", cwd=project, env=env)
    assert (done.code, derived) == (0, False), done
    change(home)
    assert run("check", cwd=project, env=env)[1]


def test_a_wheel_has_the_same_hash(tmp_path: Path) -> None:
    """In a wheel the templates and the robots are inside the package."""
    site = tmp_path / "site-packages"
    env = copied(site)
    (site / "templates").rename(site / "wmrgen" / "templates")
    shutil.copytree(ROOT / "robots", site / "wmrgen" / "robots")
    code = "from wmrgen.derivation import freshness as f; print(f._PACKAGE); print(f.hash_of_own_files())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={**os.environ, **env},
        capture_output=True,
        text=True,
        check=True,
    )
    where, found = done.stdout.split()
    assert where == str(site / "wmrgen")
    assert found == freshness.hash_of_own_files()


OUTSIDE = (
    """
from wmrgen.functions.registry import function
"""
    + PROBE
)


def test_a_script_that_may_extend_wmrgen_always_derives(project: Path) -> None:
    done, derived = run("check", cwd=project, code=OUTSIDE)
    assert done.code == 0 and derived
    done, derived = run("derive", "robots/pair.yaml", "-o", "other", cwd=project, code=OUTSIDE)
    assert done.code == 0 and derived
    assert recorded_inputs(project / "other" / "pair") == {}


@pytest.mark.slow
def test_several_processes_write_the_same_and_say_the_same(tmp_path: Path) -> None:
    robots = [ROOT / "robots" / f"{name}.yaml" for name in ("unicycle", "festo_robotino", "bicycle")]
    said = {}
    for jobs in (1, 3):
        done = process("derive", *robots, "-o", "out", "--jobs", jobs, cwd=tmp_path)
        assert done.code == 0, done.err
        said[jobs] = (done.out, done.err, tree(tmp_path / "out"))
        shutil.rmtree(tmp_path / "out")
    assert said[1] == said[3] and "note: festo_robotino" in said[1][1]


@pytest.mark.slow
def test_errors_of_several_processes(tmp_path: Path) -> None:
    """The first error in the order of the files ends the command, and nothing is written."""
    for name in ("one", "two", "three"):
        text = DIFFERENTIAL.replace("pair", name) + (
            "" if name == "one" else "functions: [icr, desaturate]\n"
        )
        (tmp_path / f"{name}.yaml").write_text(text)
    files = ["one.yaml", "two.yaml", "three.yaml"]
    outcomes = [process("derive", *files, "--jobs", jobs, "--json", cwd=tmp_path) for jobs in (1, 2)]
    assert outcomes[0] == outcomes[1] and outcomes[0].code == 3
    (error,) = json.loads(outcomes[0].out)["errors"]
    assert error["file"] == "two.yaml" and error["line"] == DIFFERENTIAL.count("\n") + 1
    assert not (tmp_path / "generated").exists()
    checks = [process("check", *files, "--full", "--jobs", jobs, "--json", cwd=tmp_path) for jobs in (1, 2)]
    assert checks[0] == checks[1]
    (tmp_path / "three.yaml").write_text("wmrgen: 1\nname: three\nwheels: []\nwheelz: 3\n")
    refused = process("check", *files, "--full", "--jobs", 2, "--json", cwd=tmp_path)
    assert {e["file"] for e in json.loads(refused.out)["errors"]} >= {"three.yaml"}
