"""Texts that want to be code in what is generated: a comment that ends, a tag, a macro, a line of its own.

Every payload holds the word pwned, and stands in `description` and `source`. Readers of each language that are not
wmrgen's say whether it came out as anything but text."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import tomllib
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from tests.codegen.c.test_doxygen import SETTINGS
from tests.external_tools import tool
from tests.hostile.attempts import LINUX, Server, harmless
from tests.hostile.test_descriptions import HEAD
from tests.report.pages.test_formats import harmless_page
from tests.tools.importing.urdf import link, pair

pytestmark = LINUX
PACKAGES = ("cmake", "arduino", "platformio", "esp-idf", "zephyr", "ros2", "rust", "javascript")
PAYLOADS = {
    "end of a C comment": "*/ pwned(); /*",
    "a comment in a comment": "/* /* */ pwned */",
    "end after a line": "*\\\n/ pwned();",
    "a line that goes on": "pwned \\",
    "trigraphs": "pwned " + "??/ " * 60 + "\n*??/\n/ pwned",
    "a digraph": "%:define pwned <% %>",
    "a directive": "\n#define int pwned\n#include </etc/passwd>\n#error pwned\n",
    "Doxygen": "@endverbatim @file pwned.h \\cond pwned \\mainpage @include /etc/passwd @code",
    "a script": "</title></desc></text></style><script>alert('pwned')</script>",
    "an image": "<img src=x onerror=pwned()> ![pwned](http://127.0.0.1:9/x.png)",
    "an attribute": "\" onload=\"pwned()\" x='",
    "entities": "&lt;script&gt;pwned&lt;/script&gt; &#60;script&#62; &pwned;",
    "end of CDATA": "]]> <pwned/> <![CDATA[ --> <!-- pwned -->",
    "a document type": '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]> pwned',
    "Markdown": "\n\n# pwned\n\n- pwned\n\n***\n\n| pwned | b |\n|---|---|\n",
    "a link": "[pwned](javascript:pwned()) <javascript:pwned()> [pwned]: http://127.0.0.1:9/",
    "a fence": "```\npwned\n```\n~~~ pwned\n",
    "LaTeX": "\\input{/etc/passwd} \\write18{pwned} \\end{document} $\\href{javascript:pwned}{x}$ $$pwned$$",
    "backticks": "`touch pwned` $(touch pwned) ${pwned} $ENV{pwned} %pwned%",
    "a Python string": "''' \"\"\" + pwned + \"\"\" \\N{BULLET} \\x41 \\",
    "a template": "{{ pwned }} {% for pwned in range(999999999) %}{% endfor %} {# pwned #} {pwned} %(pwned)s %s%n",
    "a key of YAML": "pwned\ntargets: [pwned]\n? pwned: &a [*a] !!python/none\n...\n---\n",
    "a key of properties": "pwned\nincludes=pwned.h\nname=pwned\n",
    "a key of TOML": 'pwned"\n[dependencies]\npwned = "1"\n"""\n\'\'\'',
    "a key of JSON": 'pwned", "export": "pwned", "x": "\\',
    "CMake": ')\nexecute_process(COMMAND touch pwned)\nset(x "pwned"',
    "Rust": "pwned */ }} //! \n fn pwned() {} #![feature(pwned)] [`pwned`]",
    "Windows": "con pwned nul\npwned.exe:stream",
}  # fmt: skip


def robot(text: str) -> str:
    """A robot with a text, written by a library, as its description and its source."""
    words = f"description: {json.dumps(text)}\nsource: {json.dumps(text[::-1][::-1])}\n"
    wheels = "".join(
        f"  - {{name: {name}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1}}\n"
        for name, y in (("left", "0.2"), ("right", "-0.2"))
    )
    return f"wmrgen: 1\nname: bad\n{words}wheels:\n{wheels}"


def in_c(path: Path) -> None:
    """gcc, which knows what a comment is, leaves the comments out; and the whole compiles where it can alone."""
    plus = path.suffix in (".hpp", ".cpp", ".ino")
    gcc = [tool("gcc"), "-x", "c++" if plus else "c", f"-std={'c++17' if plus else 'c99'}", "-trigraphs"]
    words = [*gcc, "-w", "-fpreprocessed", "-E", "-P", str(path)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "bad" in done.stdout and "pwned" not in done.stdout
    if path.suffix == ".c" and path.parent.name == "bad":
        subprocess.run([*gcc, "-Wall", "-Werror", "-fsyntax-only", str(path)], check=True)


def in_python(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert isinstance(tree.body[0], ast.Expr)
    tree.body.pop(0)  # the docstring
    assert "pwned" not in ast.unparse(tree)


def in_xml(path: Path) -> None:
    for element in ElementTree.parse(path).iter():
        assert element.tag.rpartition("}")[2] not in ("script", "image", "pwned")
        assert "pwned" not in str(element.attrib)


def in_html(path: Path) -> None:
    harmless_page(path.read_text(encoding="utf-8"))


def in_markdown(path: Path) -> None:
    """As HTML it is one paragraph or block of code."""
    from markdown_it import MarkdownIt

    tokens = MarkdownIt("commonmark", {"html": True}).enable("table").parse(path.read_text(encoding="utf-8"))
    flat = [*tokens, *(child for token in tokens for child in token.children or ())]
    for token in flat:
        assert token.type not in ("html_block", "html_inline", "fence") or "pwned" not in token.content
        assert "pwned" not in str(token.attrs)
    for before, token in pairwise(tokens):
        if token.type == "inline" and "pwned" in token.content:
            assert before.type == "paragraph_open" and before.level == 0


def keys_of(data: object) -> list[str]:
    """Every key of a document."""
    if isinstance(data, dict):
        return [key for name, value in data.items() for key in (str(name), *keys_of(value))]
    return [key for value in data for key in keys_of(value)] if isinstance(data, list) else []


def in_data(read: Callable[[str], object]) -> Callable[[Path], None]:
    def check(path: Path) -> None:
        assert not [
            key
            for key in keys_of(read(path.read_text(encoding="utf-8")))
            if "pwned" in key or key == "targets"
        ]

    return check


def in_properties(path: Path) -> None:
    keys = [line.partition("=")[0] for line in path.read_text(encoding="utf-8").splitlines()]
    assert len(keys) == len(set(keys)) and keys == [key for key in keys if re.fullmatch("[a-z_]+", key)]


def in_comments(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    assert all(line.lstrip().startswith("//") for line in lines if "pwned" in line)


def absent(path: Path) -> None:
    assert b"pwned" not in path.read_bytes()


READERS: Mapping[str, Callable[[Path], None]] = {
    **dict.fromkeys((".c", ".h", ".hpp", ".cpp", ".ino"), in_c),
    ".py": in_python,
    **dict.fromkeys((".svg", ".xml"), in_xml),
    ".html": in_html,
    ".md": in_markdown,
    ".json": in_data(json.loads),
    ".yml": in_data(yaml.safe_load),
    ".toml": in_data(tomllib.loads),
    ".properties": in_properties,
    **dict.fromkeys((".rs", ".js"), in_comments),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", PAYLOADS)
def test_what_is_generated_has_it_as_text(server: Server, tmp_path: Path, case: str) -> None:
    (tmp_path / "bad.yaml").write_text(robot(PAYLOADS[case]), encoding="utf-8")
    packages = [word for kind in PACKAGES for word in ("--package", kind)]
    attempt = server.run(tmp_path, "derive", "bad.yaml", "-o", "out", "--fuzz", "--html", *packages)
    assert attempt.code == 0 and not attempt.outside, attempt.err
    files = [path for path in sorted((tmp_path / "out").rglob("*")) if path.is_file()]
    assert {".c", ".py", ".md", ".html", ".svg", ".json", ".xml", ".toml", ".properties", ".rs", ".js"} <= {
        p.suffix for p in files
    }
    for path in {path.read_bytes(): path for path in files}.values():  # packages hold the same C
        READERS.get(path.suffix, absent)(path)


DOXYGEN = (
    "@htmlonly<script>pwned</script>@endhtmlonly @file pwned.h @include /etc/passwd @verbatim pwned @endverbatim "
    "<img src=x onerror=pwned()> [p](javascript:pwned()) ![p](http://127.0.0.1:9/pwned.png) ＠image html pwned.png"
)


@pytest.mark.slow
def test_doxygen_has_it_as_text(server: Server, tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(robot(DOXYGEN), encoding="utf-8")
    assert server.run(tmp_path, "derive", "bad.yaml", "-o", "out").code == 0
    folder = tmp_path / "out" / "bad"
    (folder / "Doxyfile").write_text(SETTINGS + "FILE_PATTERNS = bad.h\n")
    subprocess.run([tool("doxygen")], cwd=folder, check=True, capture_output=True)
    page = next((folder / "xml").glob("*_8h.xml"))
    elements = list(ElementTree.parse(page).iter())
    assert any("pwned" in str(element.text) for element in elements)
    assert not [e for e in elements if e.tag in ("htmlonly", "image", "verbatim") or "pwned" in str(e.attrib)]


NAMES = {
    "a line of YAML": "pwned&#10;wheels: []",
    "a comment": "pwned # pwned: 1",
    "end of a comment": "*/ pwned /*",
    "a script": "&lt;script&gt;pwned&lt;/script&gt;",
    "a path": "../../pwned",
    "a device": "con",
    "a keyword": "int",
    "right to left": "pwned &#x202e;",
    "an anchor": "&amp;pwned *pwned !!pwned",
    "quotes": "pwned&quot;: {&apos;a&apos;: 1",
    "LaTeX": "\\input{pwned}",
    "long": "pwned" * 10_000,
    "other letters": "р\u0301wned колесо 車輪",
    "lines": "pwned&#10;&#13;&#9;&#x85;&#x2028;pwned",
}


@pytest.mark.slow
@pytest.mark.parametrize("of", ["robot", "joint", "link", "mesh"])
@pytest.mark.parametrize("case", NAMES)
def test_names_of_descriptions(server: Server, tmp_path: Path, case: str, of: str) -> None:
    """The robot file has two wheels and the keys that it has for harmless names."""
    name, description = NAMES[case], HEAD + link("base_link") + pair() + "</robot>"
    description = {
        "robot": description.replace("probe", name),
        "joint": description.replace("left_joint", f"left{name}").replace("right_joint", f"right{name}"),
        "link": description.replace("left_link", f"left{name}").replace("base_link", name),
        "mesh": description.replace("<cylinder", f'<mesh filename="{name}"/><cylinder'),
    }[of]
    (tmp_path / "in.urdf").write_text(description, encoding="utf-8")
    attempt = server.run(tmp_path, "import", "in.urdf", "-o", "out/robot.yaml")
    assert attempt.code == 0, attempt
    harmless(attempt)
    text = (tmp_path / "out" / "robot.yaml").read_text(encoding="utf-8")
    assert all(c.isprintable() or c == "\n" for c in text)
    content = yaml.safe_load(text)
    assert [key for key in content if key != "frame"] == ["wmrgen", "name", "wheels"]
    assert len(content["wheels"]) == 2
    for each in (content["name"], *(wheel["name"] for wheel in content["wheels"])):
        assert re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,30}", each)
    keys = {key for wheel in content["wheels"] for key in wheel} - {"joints"}
    assert keys == {"name", "type", "x", "y", "heading", "r"}
    outer = [wheel.get("joints", {}) for wheel in content["wheels"]]
    assert all(set(joints) <= {"spin"} for joints in outer)
    for each in (content.get("frame", "a"), *(joint for joints in outer for joint in joints.values())):
        assert isinstance(each, str) and re.fullmatch("[A-Za-z0-9_][A-Za-z0-9_ ./:-]{0,199}", each), each
    assert server.run(tmp_path, "derive", "out/robot.yaml", "-o", "out").code == 0


ARGUMENTS = {
    "a tag": 'x"/><evil a="',
    "an entity": "&lt;evil/&gt;",
    "an expression": "${__import__('os').system('touch pwned')}",
    "eval": "$(eval open('pwned', 'w'))",
    "find": "$(find ../..)",
    "lines": "1\n2\n3",
    "a control": "\x1b[31m",
}


@pytest.mark.slow
@pytest.mark.parametrize("value", ARGUMENTS.values(), ids=ARGUMENTS)
def test_arguments_of_xacro(server: Server, tmp_path: Path, value: str) -> None:
    """A place is a number: whatever the argument holds, it is none."""
    text = HEAD + link("base_link") + pair().replace('"0.05 ', '"$(arg ahead) ') + "</robot>"
    (tmp_path / "in.urdf").write_text(text, encoding="utf-8")
    attempt = server.run(tmp_path, "import", "in.urdf", f"ahead:={value}", "-o", "out/robot.yaml")
    assert (attempt.code, attempt.changes) == (2, ())
    harmless(attempt)
    assert not (tmp_path / "pwned").exists() and "in.urdf" in attempt.err
