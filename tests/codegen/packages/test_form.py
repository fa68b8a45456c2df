"""The content of every package: the C as `derive` writes it, no ``main`` among the sources, valid metadata."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from tests.codegen.packages.made import KINDS, files_of, of_gallery, run
from tests.conftest import DIFFERENTIAL, ROOT, Outcome, put, tree
from tests.depth import everyday
from tests.external_tools import need
from wmrgen.codegen.packages import PACKAGES, SOURCES
from wmrgen.codegen.registry import BACKENDS

SAID = "5\" wheels & 'casters' <50 % off; $HOME \\n #1: {x} é"


@pytest.fixture
def quoted_robot(tmp_path: Path) -> Path:
    """Write a robot file whose description has characters that languages must quote."""
    path = tmp_path / "pair.yaml"
    path.write_text(DIFFERENTIAL.replace("parameters:", f"description: {json.dumps(SAID)}\nparameters:"))
    return path


@pytest.mark.slow
def test_the_c_is_that_of_derive(wmrgen_cli: Callable[..., Outcome], robot_file: Path) -> None:
    out = robot_file.parent / "out"
    kinds = [word for kind in KINDS for word in ("--package", kind)]
    assert wmrgen_cli("derive", robot_file, "-o", out, *kinds, "--target", "avr").code == 0
    derived = tree(out / "pair")
    for kind in KINDS:
        made = tree(out / f"package-{kind}" / "pair")
        for name in ("pair.c", "pair.h", "pair_checked.c", "pair_checked.h", "test/pair_selftest.c"):
            assert made[f"{SOURCES}/{name}"] == derived[name]
        assert {"manifest.json", "README.md"} < set(made)
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    for kind in KINDS:
        (out / f"package-{kind}" / "pair" / "README.md").write_text("mine")
    stale = wmrgen_cli("check", robot_file, "-o", out)
    assert stale.code == 1 and all(f"package-{kind}/pair/README.md" in stale.out for kind in KINDS)


def test_a_package_is_made_only_on_request(wmrgen_cli: Callable[..., Outcome], robot_file: Path) -> None:
    out = robot_file.parent / "out"
    done = wmrgen_cli("derive", robot_file, "-o", out, "--package", "cmake")
    assert done.code == 0 and sorted(p.name for p in out.iterdir()) == ["package-cmake", "pair"]
    assert set(re.search("package-cmake/pair/: (.*)", done.out)[1].split()) < set(
        tree(out / "package-cmake" / "pair")
    )


def test_the_backends_that_wait_for_a_package_are_those_that_are_one() -> None:
    waiting = {entry.name for entry in BACKENDS.values() if entry.package}
    assert waiting == {package.backend for package in PACKAGES.values() if package.backend}


def test_an_unknown_kind_is_refused_before_anything_is_written(
    wmrgen_cli: Callable[..., Outcome], robot_file: Path
) -> None:
    done = wmrgen_cli("derive", robot_file, "-o", robot_file.parent / "out", "--package", "conan")
    assert done.code == 2 and "'conan'" in done.err and all(kind in done.err for kind in KINDS)
    assert not (robot_file.parent / "out").exists()


@pytest.mark.parametrize("kind", ["arduino", "ros2"])
def test_a_robot_without_motors_and_sensors_has_no_loop(
    kind: str, wmrgen_cli: Callable[..., Outcome], robot_file: Path
) -> None:
    robot_file.write_text(DIFFERENTIAL.replace("r: 0.0975", "r: 0.0975, actuated: []"))
    out = robot_file.parent / "out"
    done = wmrgen_cli("derive", robot_file, "-o", out, "--package", kind)
    assert done.code == 3 and "no loop" in done.err and not out.exists()
    assert wmrgen_cli("derive", robot_file, "-o", out, "--package", "cmake").code == 0
    header = (out / "package-cmake" / "pair" / "src" / "pair.hpp").read_text()
    assert "namespace pair {" in header and "inline void odometry(" in header


def test_an_unknown_file_among_packages_is_found(
    wmrgen_cli: Callable[..., Outcome], robot_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(robot_file.parent)
    (robot_file.parent / "robots").mkdir()
    robot_file.rename(robot_file.parent / "robots" / "pair.yaml")
    assert wmrgen_cli("derive", "robots/pair.yaml", "--package", "cmake").code == 0
    assert wmrgen_cli("check").code == 0
    put(robot_file.parent / "generated" / "package-cmake", {"old/README.md": b""})
    done = wmrgen_cli("check")
    assert done.code == 1 and done.out.splitlines()[0].startswith("generated/package-cmake/old: ")


def test_help_names_every_kind(wmrgen_cli: Callable[..., Outcome]) -> None:
    shown = wmrgen_cli("derive", "--help").out
    assert all(re.search(rf"\b{kind}\b", shown) for kind in KINDS)


def test_every_template_is_a_file_of_its_kind() -> None:
    folder = ROOT / "templates" / "package"
    named = {file.template(kind) for kind, package in PACKAGES.items() for file in package.files}
    assert {f"package/{p.relative_to(folder).as_posix()}" for p in folder.glob("*/*.j2")} == named


@pytest.mark.parametrize("kind", everyday(KINDS, ["arduino"]))
def test_sources_define_no_main(kind: str, tmp_path: Path) -> None:
    """Arduino and PlatformIO compile every file below ``src``, so there is no example in it."""
    need("gcc", "nm")
    files = of_gallery("pioneer3dx", kind)
    put(tmp_path, files)
    sources = [name for name in files if name.startswith(f"{SOURCES}/")]
    assert {Path(name).suffix for name in sources} == {".c", ".h", ".hpp"}
    examples = [name for name in sources if name.startswith(f"{SOURCES}/example/")]
    assert bool(examples) == (kind != "arduino")
    swept = [name for name in sources if name.endswith(".c") and name not in examples]
    run(tmp_path, "gcc", "-O0", "-c", *swept)
    symbols = run(tmp_path, "nm", *(path.name for path in sorted(tmp_path.glob("*.o"))))
    assert "T pioneer3dx_selftest" in symbols
    assert not re.search(r"\bT (main|setup|loop|app_main)\b", symbols)


CPP = """
#include "{0}.hpp"
namespace robot = {0};
int main()
{{
    robot::Twist twist{{0.5F, 0.0F, 0.25F}};
    robot::Wheels wheels{{}};
    robot::Pose pose{{}};
    *robot::view(twist)[2] = 0.125F;
    {1}
    if (robot::odometry_checked(pose, twist, 0.25F) != {2}_OK) {{
        return 1;
    }}
    const auto &constant = pose;
    const auto members = robot::view(wheels);
    for (std::size_t i = 0; i < members.size(); ++i) {{
        if (members[i] != {0}_joint(&wheels, static_cast<int>(i))) {{
            return 2;
        }}
    }}
    if ({0}_joint(&wheels, -1) != nullptr || {0}_joint(&wheels, {2}_JOINTS) != nullptr) {{
        return 5;
    }}
    static_assert(robot::view(wheels).size() == {2}_JOINTS);
    return *robot::view(constant)[0] > 0.124F && twist.omega > 0.1249F ? 0 : 3;
}}
"""
TUNABLE = "robot::Params params; robot::params_default(params); robot::Prepared prepared;"
CALLS = {
    "pioneer3dx": f"{TUNABLE} if (robot::prepare_checked(params, prepared)) return 4;"
    "robot::inverse(prepared, twist, wheels); robot::forward(prepared, wheels, twist);",
    "wpilib_swervebot": "robot::inverse(twist, wheels, wheels); robot::forward(wheels, twist);",
}


@pytest.mark.parametrize("robot", CALLS)
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.slow
def test_the_header_for_cpp(robot: str, compiler: str, tmp_path: Path) -> None:
    """The header is strict C++17; views point to the variables, in the order of the joints."""
    need("gcc", compiler)
    put(tmp_path, of_gallery(robot, "cmake"))
    (tmp_path / "main.cpp").write_text(CPP.format(robot, CALLS[robot], robot.upper()))
    run(tmp_path, "gcc", "-O0", "-c", *(f"src/{robot}{ending}.c" for ending in ("", "_checked")))
    strict = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-Isrc")
    run(tmp_path, compiler, *strict, "main.cpp", f"{robot}.o", f"{robot}_checked.o", "-lm", "-o", "main")
    run(tmp_path, tmp_path / "main")


def test_the_header_for_cpp_has_every_function(tmp_path: Path) -> None:
    """This includes functions with their own structs, with covariances, and with scalar outputs."""
    need("g++")
    robot = tmp_path / "pair.yaml"
    robot.write_text(
        DIFFERENTIAL
        + "noise: {spin: {proportional: 0.02}}\nlimits: {vx: 1, vx_rate: 1, omega: 2, spin: 9}\nfunctions:"
        " [forward_covariance, odometry_covariance, limit_acceleration, desaturate, circle, odometry_compensated]\n"
    )
    files = files_of(robot, "cmake")
    put(tmp_path, files)
    strict = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", "-fsyntax-only")
    run(tmp_path, "g++", *strict, "-xc++", "-include", "src/pair.hpp", "/dev/null")
    header, text = (files[f"src/pair.{ending}"].decode() for ending in ("h", "hpp"))
    declared = re.findall(r"^void pair_(\w+)\(", header, re.MULTILINE)
    assert {"odometry_covariance", "circle", "desaturate"} <= set(declared)
    assert declared == re.findall(r"^inline void (\w+)\(", text, re.MULTILINE)


def test_a_description_is_quoted_in_every_language(quoted_robot: Path) -> None:
    library = json.loads(files_of(quoted_robot, "platformio")["library.json"])
    assert library["description"] == SAID
    component = yaml.safe_load(files_of(quoted_robot, "esp-idf")["idf_component.yml"])
    assert component["description"] == SAID
    lines = files_of(quoted_robot, "arduino")["library.properties"].decode().splitlines()
    assert f"sentence={SAID}" in lines
    for kind in KINDS:
        assert f"\n\n    {SAID}\n\n" in files_of(quoted_robot, kind)["README.md"].decode()
    if "ros2" in PACKAGES:
        package = xml.etree.ElementTree.fromstring(files_of(quoted_robot, "ros2")["package.xml"])
        assert package.findtext("description") == SAID


def test_arduino_s_properties() -> None:
    """Arduino library specification, revision 2.2: the fields that are required, and their form."""
    files = of_gallery("pioneer3dx", "arduino")
    fields = dict(line.split("=", 1) for line in files["library.properties"].decode().splitlines())
    required = {
        "name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures",
    }  # fmt: skip
    assert required <= fields.keys() and all(fields.values())
    assert re.fullmatch(r"\d+\.\d+\.\d+", fields["version"])
    assert re.fullmatch(r"[A-Za-z0-9][\w .-]{0,62}", fields["name"])
    assert f"{SOURCES}/{fields['includes']}" in files
    for name in files:
        if name.startswith("examples/"):  # a sketch has the name of its folder
            _, folder, file = name.split("/")
            assert file == f"{folder}.ino"
    words = [line.split("\t") for line in files["keywords.txt"].decode().splitlines()]
    header = files[f"{SOURCES}/pioneer3dx.h"].decode()
    assert {"pioneer3dx_inverse", "pioneer3dx_odometry"} <= {word for word, _ in words}
    assert all(
        re.search(rf"\b{word}\b", header) and re.fullmatch("KEYWORD[12]", kind) for word, kind in words
    )


def test_platformio_s_library() -> None:
    """Fields of library.json, and that its filter names files that are there."""
    files = of_gallery("pioneer3dx", "platformio")
    library = json.loads(files["library.json"])
    assert {"name", "version", "description", "keywords", "license"} <= library.keys()
    assert library["headers"] == ["pioneer3dx.h"]
    for rule in library["build"]["srcFilter"]:
        pattern = rule.removeprefix("+<").removesuffix(">")
        assert any(Path(name).match(f"{SOURCES}/{pattern}") for name in files)


def test_an_esp_idf_component() -> None:
    """``idf_component_register`` names sources that are there; the manifest has its required key."""
    files = of_gallery("pioneer3dx", "esp-idf")
    text = files["CMakeLists.txt"].decode()
    assert text.count("idf_component_register(") == 1
    sources = re.findall(r'"(src/[^"]+\.c)"', text)
    assert len(sources) == 3 and set(sources) <= files.keys()
    manifest = yaml.safe_load(files["idf_component.yml"])
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"]) and manifest["license"] == "MIT-0"


def test_a_zephyr_module() -> None:
    """``zephyr/module.yml`` names folders that are there, and each option that CMake asks for is in Kconfig."""
    files = of_gallery("pioneer3dx", "zephyr")
    module = yaml.safe_load(files["zephyr/module.yml"])
    assert module["name"] == "pioneer3dx"
    assert f"{module['build']['cmake']}/CMakeLists.txt" in files and module["build"]["kconfig"] in files
    cmake, options = files["zephyr/CMakeLists.txt"].decode(), files["zephyr/Kconfig"].decode()
    asked = set(re.findall(r"CONFIG_(\w+)", cmake))
    assert asked == set(re.findall(r"^config (\w+)$", options, re.MULTILINE))
    sources = re.findall(r"\.\./(src/\S+\.c)", cmake)
    assert len(sources) == 3 and set(sources) <= files.keys()
