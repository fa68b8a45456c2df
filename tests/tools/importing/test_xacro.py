"""Xacro files: resolved by the package xacro, with packages, arguments and doors shut."""

from __future__ import annotations

import json
import os
import re
import resource
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import link, pair, robot
from wmrgen.errors import Code, RobotFileError
from wmrgen.tools.importing.expressions import checked, counted, offered
from wmrgen.tools.importing.read import mark_of
from wmrgen.tools.importing.xacro_process import resolve

pytestmark = pytest.mark.slow

Cli = Callable[..., Outcome]
HEAD = '<robot name="probe" xmlns:xacro="http://www.ros.org/wiki/xacro">'
WHEELS = pair().replace('radius="0.1"', 'radius="${size.wheel / 2}"').replace('"0.05 ', '"$(arg ahead) ')


def write(place: Path, *parts: str) -> Path:
    path = place / "urdf" / "probe.urdf"
    path.parent.mkdir(exist_ok=True)
    path.write_text(HEAD + link("base_link") + "".join(parts) + "</robot>", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("used", "told"),
    [("$(arg ahead)", False), ("$(eval ahead)", False), ("${xacro.arg('ahead')}", False), ("0", True)],
)
def test_arguments_that_no_file_asks_for_are_noted(
    wmrgen_cli: Cli, tmp_path: Path, used: str, told: bool
) -> None:
    text = f'<xacro:arg name="side" default="l"/><gazebo><p>{used}</p></gazebo>'
    done = wmrgen_cli("import", write(tmp_path, pair(), text), "ahead:=1", "side:=r")
    assert ("the file has no argument 'ahead'; it has side" in done.err) == told and done.code == 0


@pytest.fixture
def package(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "size.yaml").write_text("wheel: 0.2\n", encoding="utf-8")
    text = f"{HEAD}<xacro:macro name='wheels'>{WHEELS}</xacro:macro></robot>"
    (tmp_path / "parts" / "wheels.xacro").write_text(text, encoding="utf-8")
    return tmp_path / "parts"


PARTS = (
    "<xacro:property name='size' value=\"${xacro.load_yaml('$(find parts)/size.yaml')}\"/>",
    "<xacro:include filename='$(find parts)/wheels.xacro'/>",
    "<xacro:wheels/>",
)


def test_packages_arguments_macros_and_yaml(wmrgen_cli: Cli, tmp_path: Path, package: Path) -> None:
    """In a file that is called .urdf; a package of which no file is read need not be known."""
    named = "<xacro:element xacro:name='gazebo'><p>$(find other)/x.yaml</p></xacro:element>"
    path = write(tmp_path, *PARTS, named)
    words = (
        "import",
        path,
        "--package",
        f"parts={package}",
        "ahead:=0.07",
    )
    done = wmrgen_cli(*words, "--json")
    assert done.code == 0, done.err
    wheels = json.loads(done.out)["wheels"]
    assert [(w["x"], w["y"], w["r"]) for w in wheels] == [(0.07, 0.25, 0.1), (0.07, -0.25, 0.1)]


def test_eval_computes_with_arguments(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """By their names, as numbers, truths or texts. The package ends it at the first parenthesis."""
    computed = "$(eval size * 0.5 if wide and kind == 'a' else 9)"
    arguments = "".join(
        f'<xacro:arg name="{n}" default="{v}"/>'
        for n, v in (("size", "0.3"), ("wide", "true"), ("kind", "a"))
    )
    done = wmrgen_cli(
        "import", write(tmp_path, arguments, pair().replace('"0.1"', f'"{computed}"')), "size:=0.25", "--json"
    )
    assert done.code == 0, done.err
    assert [w["r"] for w in json.loads(done.out)["wheels"]] == [0.125, 0.125]


def test_missing_arguments_are_all_named(wmrgen_cli: Cli, tmp_path: Path) -> None:
    path = write(tmp_path, pair().replace('"0.05 0.25', '"$(arg ahead) $(arg side)'))
    done = wmrgen_cli("import", path)
    assert done.code == 2 and "ahead:=VALUE side:=VALUE" in done.err


def test_elements_without_the_prefix_are_named(wmrgen_cli: Cli, tmp_path: Path) -> None:
    wheels = pair().replace('radius="0.1"', 'radius="${size}"')
    done = wmrgen_cli("import", write(tmp_path, '<property name="size" value="0.1"/>', wheels))
    assert done.code == 2 and "'size' is not defined" in done.err and "probe.urdf <property>" in done.err
    assert "Write xacro: before such names" in done.err


def test_calls_of_macros_without_the_prefix_are_noted(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Xacro hands them through, and nothing of URDF reads them; a prefix of another kind is somebody's own."""
    wheels = f"<xacro:macro name='wheels'>{WHEELS.replace('$(arg ahead)', '0')}</xacro:macro>"
    wheels = wheels.replace("${size.wheel / 2}", "0.1")
    done = wmrgen_cli("import", write(tmp_path, wheels, "<wheels/>"))
    assert done.code == 2 and "0 joints are wheels" in done.err
    assert "<wheels> is passed over: write xacro: before it" in done.err
    done = wmrgen_cli("import", write(tmp_path, wheels, "<xacro:wheels/><gazebo/><transmission/>"))
    assert done.code == 0 and "passed over" not in done.err


def test_a_file_that_is_included_and_not_there(wmrgen_cli: Cli, tmp_path: Path) -> None:
    done = wmrgen_cli("import", write(tmp_path, '<xacro:include filename="parts.xacro"/>'))
    assert done.code == 2 and "it includes 'parts.xacro', which is not there" in done.err
    assert str(tmp_path) not in done.err.splitlines()[0]


MACRO = '<xacro:macro name="m" params="a">\n<link name="${a}"/>\n<xacro:if value="${a}"/></xacro:macro>\n'


@pytest.mark.parametrize(
    ("parts", "words", "place"),
    [
        ('<link name="${n}"/>', "name 'n' is not defined", "<link"),
        ('<link name="a"><visual/>\n<inertial mass="${1/0}"/></link>', "division by zero", "<inertial"),
        ('<xacro:if value="${n}"/>', "name 'n' is not defined", "<xacro:if"),
        (MACRO + '<xacro:m b="1"/>', 'Invalid parameter "b"', "<xacro:m b"),
        (MACRO + '<xacro:m a="${n}"/>', "name 'n' is not defined", "<xacro:m a"),
        (MACRO + '<xacro:m a="x"/>', "which is not a boolean", "<xacro:if"),
        (MACRO.replace("${a}", "${b}", 1) + '<xacro:m a="1"/>', "name 'b' is not defined", "<link"),
        ('<xacro:include filename="no.xacro"/>', "it includes 'no.xacro', which is not there", "<xacro:include"),
        ('<xacro:include filename="$(find none)/x"/>', "Give --package none=DIR", "<xacro:include"),
        ('<link name="${xacro.load_yaml(\'$(find none)/x\')}"/>', "Give --package none=DIR", "<link"),
        ('<xacro:include filename="$(find none)/*"/>', "Give --package none=DIR", "<xacro:include"),
        ('<xacro:arg name="a"/> <!-- a -- b -->', "not XML", " b -->"),
    ],
)  # fmt: skip
def test_errors_have_the_place_of_their_element(
    wmrgen_cli: Cli, tmp_path: Path, parts: str, words: str, place: str
) -> None:
    path = write(tmp_path, f"\n{parts}\n")
    done = wmrgen_cli("import", path)
    assert done.code == 2 and words in done.err
    line, column = map(int, re.findall(rf"--> {re.escape(str(path))}:(\d+):(\d+)", done.err)[0])
    assert path.read_text().splitlines()[line - 1][column - 1 :].startswith(place), done.err


def test_a_prefix_that_is_not_declared_has_its_declaration(wmrgen_cli: Cli, tmp_path: Path) -> None:
    path = write(tmp_path, "\n<xacro:property/>")
    path.write_text(path.read_text().replace(HEAD, '<robot name="probe">'))
    done = wmrgen_cli("import", path)
    assert done.code == 2 and f"--> {path}:2:1\n" in done.err
    assert 'Write <robot xmlns:xacro="http://www.ros.org/wiki/xacro">.' in done.err


def test_a_package_that_was_not_given_is_named(wmrgen_cli: Cli, tmp_path: Path) -> None:
    done = wmrgen_cli("import", write(tmp_path, *PARTS), "ahead:=1")
    assert done.code == 2 and "--package parts=DIR" in done.err


def test_the_package_of_the_file_is_known(wmrgen_cli: Cli, package: Path) -> None:
    (package / "package.xml").write_text("<package/>", encoding="utf-8")
    assert wmrgen_cli("import", write(package, *PARTS), "ahead:=0").code == 0


def test_macros_alone_are_no_robot(wmrgen_cli: Cli, package: Path) -> None:
    done = wmrgen_cli("import", package / "wheels.xacro")
    assert done.code == 2 and "only defines macros (wheels)" in done.err


def test_macros_called_without_the_prefix_are_told(wmrgen_cli: Cli, package: Path) -> None:
    """As xacro took them until 2014."""
    path = write(package, *PARTS[:2], "<wheels/>")
    path.write_text(path.read_text(encoding="utf-8").replace(link("base_link"), ""), encoding="utf-8")
    done = wmrgen_cli("import", path, "--package", f"parts={package}")
    assert done.code == 2 and "<wheels> has no prefix, and is passed over" in done.err
    block = "<xacro:macro name='held' params='*where'>" + pair().replace(
        '<origin xyz="0.05 0.25 0.1" rpy="0 0 0"/>', "<insert_block name='where'/>"
    )
    call = "</xacro:macro><xacro:held><origin xyz='0 0.3 0.1'/></xacro:held>"
    done = wmrgen_cli("import", write(package, block, call))
    assert done.code == 2 and "<insert_block> in 'left_joint' has no prefix, and is not read" in done.err
    assert wmrgen_cli("import", write(package, block.replace("<ins", "<xacro:ins"), call)).code == 0


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("$(eval open('PLACE/evil', 'w').write('x'))", "not an expression"),
        ("$(eval [].__class__)", "refused"),
        ("$(eval 9**9**9)", "power"),
        ("$(eval unknown + 1)", "unknown"),
        ("${(lambda: ().__class__)()}", "refused"),
        ("${[x.__class__ for x in [1]]}", "refused"),
        ("${(x for x in [1]).gi_frame}", "refused"),
        ("${'x'.format_map(1)}", "refused"),
        ("${9**9**9}", "more than 4096 bits"),
        ("${__import__('os')}", "refused"),
        ("${open('PLACE/evil', 'w')}", "open"),
        ("$(env HOME)", "environment"),
        ("${xacro.load_yaml('/etc/hostname')}", "outside the packages"),
        ("${xacro.load_yaml('../../secret.yaml')}", "outside the packages"),
        ("${xacro.load_yaml('link.yaml')}", "outside the packages"),
    ],
)
def test_a_hostile_file_does_nothing(wmrgen_cli: Cli, tmp_path: Path, value: str, words: str) -> None:
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "secret.yaml").write_text("a: 1\n", encoding="utf-8")
    path = write(
        inside,
        pair(),
        f'<xacro:property name="p" value="{value.replace("PLACE", str(tmp_path))}"/><a b="${{p}}"/>',
    )
    (path.parent / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    done = wmrgen_cli("import", path, "-o", tmp_path / "out.yaml")
    assert done.code == 2 and words in done.err, done.err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["inside", "secret.yaml"]


def computed(text: str) -> Any:
    """The value of an expression as xacro gets it."""
    names = offered({"range": range, "len": len, "d": dict.fromkeys(range(200)), "type": type})
    return eval(checked(text), {"__builtins__": {}, **names})


@pytest.mark.parametrize(
    "text",
    [
        "7 * 3", "2 ** 10", "2.5 ** -2", "-7 % 3", "7.5 % 2", "'%d of %s' % (3, 'four')", "[1, 'a'] * 3", "2 * 'ab'",
        "'ab' * -1", "'a%' * 2", "len([x * 2 for x in range(3)])",
    ],
)  # fmt: skip
def test_guarded_expressions_have_the_value_of_python(text: str) -> None:
    assert computed(text) == eval(text)


@pytest.mark.parametrize(
    ("most", "more", "told"),
    [
        (f"[{'1,' * 999}]", f"[{'1,' * 999} ]", "an expression of 2001 characters"),
        ("2 ** 2048", "2 ** 2049", "a power of more than 4096 bits"),
        ("2.0 ** -1 ** 3", "3 ** -2049", "a power of more than 4096 bits"),
        ("2 ** 2047 * 2 ** 2048", "2 ** 2048 * 2 ** 2048", "or a number of 4096 bits"),
        ("[0] * 12499", "[0] * 12500", "a value of more than 50000 parts"),
        ("12499 * (0,)", "12500 * (0,)", "a value of more than 50000 parts"),
        ("'abcdefgh' * 4999", "'abcdefgh' * 5000", "a value of more than 50000 parts"),
        ("[[0] * 100] * 245", "[[0] * 100] * 246", "a value of more than 50000 parts"),
        ("[d] * 82", "[d] * 83", "a value of more than 50000 parts"),
        ("range(50000)", "range(1, 50002)", "a range of more than 50000 numbers"),
        ("'%999d' % 1", "'%1000d' % 1", "the format '%1000d' is refused"),
        ("'%d' % 1", "'%*d' % (2, 1)", "the format '%*d' is refused"),
        (f"0{' + 1' * 20}", f"0{'+1' * 999}", "is nested too deeply"),
        ("[x for x in [1]]", "[x for x in [1] for y in [2]]", "it may do more than compute"),
        ("len", "type", "'type' is not defined"),
    ],
)
def test_expressions_have_limits(most: str, more: str, told: str) -> None:
    """Of length, of bits, of parts, of loops: the largest that is computed, and the least that is refused."""
    computed(most)
    with pytest.raises((RobotFileError, NameError), match=re.escape(told)):
        computed(more)


def test_functions_of_the_package_are_called_20_000_times_at_most() -> None:
    """The descriptions of a PR2, an Axebot and a TurtleBot 4 take 16,258, 11,941 and 10,704."""
    call = counted(lambda: 1, count(19_999))
    assert [call(), call()] == [1, 1]
    with pytest.raises(RobotFileError, match="more than 20000 elements and texts"):
        call()


def test_includes_stay_inside_and_have_no_entities(wmrgen_cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "outside.xacro").write_text(robot(pair()), encoding="utf-8")
    done = wmrgen_cli("import", write(tmp_path, '<xacro:include filename="../outside.xacro"/>'))
    assert done.code == 2 and "outside the packages" in done.err
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaa">]><robot name="&a;"/>'
    path = write(tmp_path, '<xacro:include filename="bomb.xacro"/>')
    (path.parent / "bomb.xacro").write_text(bomb, encoding="utf-8")
    done = wmrgen_cli("import", path)
    assert done.code == 2 and "document type" in done.err


def test_the_package_is_as_it_was_afterwards(wmrgen_cli: Cli, tmp_path: Path) -> None:
    import xacro
    from xacro import substitution_args

    before = {**vars(xacro)}, {**vars(substitution_args)}
    wmrgen_cli("import", write(tmp_path, pair(), "<a b='${1}'/>"))
    after = vars(xacro), vars(substitution_args)
    for now, then in zip(after, before, strict=True):
        assert {k: v for k, v in now.items() if callable(v)} == {k: v for k, v in then.items() if callable(v)}
    assert "open" not in vars(xacro) and os.environ


def test_a_macro_of_mecanum_wheels_says_rollers(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """The text that it makes says nothing of them; one that is not called says as little."""
    wheels = pair() + pair().replace("left", "tail").replace("right", "third").replace('"0.05 ', '"-0.4 ')
    macro = f"<xacro:macro name='mecanum_wheels'>{wheels}</xacro:macro>"
    for call, kind in (("<xacro:mecanum_wheels/>", "swedish"), (wheels, "fixed")):
        done = wmrgen_cli("import", write(tmp_path, macro, call), "--json")
        assert {w["type"] for w in json.loads(done.out)["wheels"]} == {kind}


@pytest.mark.parametrize(
    "value",
    [
        "${('a' * 4999).replace('a', 'b' * 4999).replace('b', 'c' * 4999)}",
        "${','.join(['x' * 24000] * 12499).replace(',', 'y' * 24000).replace('y', 'zz')}",
    ],
)
def test_an_expression_that_takes_all_memory_is_refused(wmrgen_cli: Cli, tmp_path: Path, value: str) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # [KiB] on Linux
    done = wmrgen_cli("import", write(tmp_path, pair(), f'<a b="{value}"/>'))
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert done.code == 2 and grown < 200_000, done.err


def test_a_file_that_takes_too_long_is_stopped(tmp_path: Path) -> None:
    with pytest.raises(RobotFileError) as caught:
        resolve(write(tmp_path, pair()), {}, {}, longest=0.01)
    assert caught.value.code == Code.DESCRIPTION


def test_elements_of_the_process_have_their_places(tmp_path: Path) -> None:
    path = write(
        tmp_path, "\n<xacro:macro name='m'><link name='a'/></xacro:macro>\n<xacro:m/><link name='b'/>"
    )
    root, called, notes = resolve(path, {"absent": "1"}, {})
    places = {link.get("name"): mark_of(link) for link in root if link.tag == "link"}
    text = path.read_text(encoding="utf-8")
    for name in ("a", "b"):
        mark = places[name]
        assert mark is not None and mark.file == str(path)
        assert text.splitlines()[mark.line - 1][mark.column - 1 :].startswith(f"<link name='{name}'")
    assert called == ["m"] and len(notes) == 1


def test_packages_of_a_workspace_are_found_by_their_manifests(wmrgen_cli: Cli, tmp_path: Path) -> None:
    folder = tmp_path / "src" / "repository" / "folder"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>parts</name></package>", encoding="utf-8")
    (folder / "wheels.xacro").write_text(f"{HEAD}{pair()}</robot>", encoding="utf-8")
    path = write(tmp_path, '<xacro:include filename="$(find parts)/wheels.xacro"/>')
    assert wmrgen_cli("import", path).code == 2
    assert wmrgen_cli("import", path, "--workspace", tmp_path / "src").code == 0
