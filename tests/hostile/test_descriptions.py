"""URDF and xacro that want to read other files, to run Python, or never to end."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.hostile.attempts import LINUX, Server, everyday, harmless, refused
from tests.tools.importing.urdf import link, pair, robot

pytestmark = LINUX
HEAD = '<robot name="probe" xmlns:xacro="http://www.ros.org/wiki/xacro">'
MOST = 499  # joints that a description may have


def of(*parts: str) -> str:
    """A xacro file of a robot that is fine, and ``parts``."""
    return HEAD + link("base_link") + pair() + "".join(parts) + "</robot>"


def value(expression: str) -> str:
    """A xacro file with an expression."""
    quoted = expression.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return of(f'<a b="${{{quoted}}}"/>')


def joints(count: int, parent: str, origin: str) -> str:
    """``#`` in ``parent`` and ``origin`` stands for the number of the joint."""
    part = (
        '<link name="l@"/><joint name="j@" type="continuous"><parent link="PARENT"/><child link="l@"/>'
        'ORIGIN<axis xyz="0 1 0"/></joint>'
    ).replace("PARENT", parent).replace("ORIGIN", origin)  # fmt: skip
    each = "".join(part.replace("@", str(k + 1)).replace("#", str(k)) for k in range(count))
    return f'<robot name="many"><link name="l0"/>{each}</robot>'


LAUGHS = "".join(f'<!ENTITY l{k + 1} "{f"&l{k};" * 10}">' for k in range(9))
XML = {
    "billion laughs": f'<!DOCTYPE r [<!ENTITY l0 "lol">{LAUGHS}]><robot name="&l9;"/>',
    "quadratic": f'<!DOCTYPE r [<!ENTITY a "{"a" * 50_000}">]><robot name="{"&a;" * 5000}"/>',
    "external entity": '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&x;"/>',
    "external DTD": '<!DOCTYPE r SYSTEM "http://127.0.0.1:9/x.dtd"><robot name="a"/>',
    "parameter entity": '<!DOCTYPE r [<!ENTITY % x SYSTEM "file:///etc/passwd">%x;]><robot/>',
    "document type": '<!DOCTYPE robot><robot name="a"/>',
    "unknown entity": '<robot name="&nope;"/>',
    "NUL": '<robot name="&#0;"/>',
    "surrogate": '<robot name="&#xD800;"/>',
    "depth": "<a>" * 100_000,
    "closed depth": "<a>" * 50_000 + "</a>" * 50_000,
    "depth in a robot": '<robot name="a">' + "<a>" * 70 + "</a>" * 70 + "</robot>",
    "elements": '<robot name="a">' + "<a/>" * 200_000 + "</robot>",
    "attributes": "<robot " + " ".join(f'a{k}="1"' for k in range(100_000)) + "/>",
    "namespaces": "<robot " + " ".join(f'xmlns:n{k}="u{k}"' for k in range(50_000)) + "/>",
    "long names": f"<{'a' * 1_000_000}/>",
    "too large": "<robot>" + " " * (4 << 20) + "</robot>",
    "a codec that is none": '<?xml version="1.0" encoding="zlib"?><robot name="a"/>',
    "a codec of names": '<?xml version="1.0" encoding="punycode"?><robot name="a"/>',
    "end of CDATA": '<robot name="a">]]></robot>',
    "HTML": "<html><script>alert(1)</script></html>",
    "nothing": "",
    "a circle": joints(1, "l1", ""),
    "a long chain": joints(MOST, "l#", ""),
    "a long chain that turns": joints(MOST, "l#", '<origin xyz="0.123456789 0.2 0.3" rpy="0.12345678 0.2 0.3"/>'),
    "too many joints": joints(5000, "l0", ""),
    "a number without end": robot(pair().replace("0.25", "1e999999999")),
    "many digits": robot(pair().replace("0.25", "9" * 100_000)),
    "no number": robot(pair().replace("0.25", "nan")),
    "an infinite radius": robot(pair().replace('radius="0.1"', 'radius="inf"')),
    "a limit without end": robot(pair()).replace("<axis", '<limit lower="1e999" upper="nan"/><axis', 1),
}  # fmt: skip
# By vars and type of the namespace python: object, its subclasses, a function of os, its globals.
ESCAPE = (
    ("T", "python.vars(python.type)"),
    ("O", "T['mro'](python.int)[1]"),
    ("S", "T['__subclasses__'](O)"),
    ("W", "[c for c in S if 'wrap_close' in str(c)][0]"),
    ("F", "python.vars(W)['__init__']"),
    ("G", "python.vars(python.type(F))['__globals__']"),
    ("D", "python.vars(python.type(G))['__get__'](G, F, python.type(F))"),
    ("R", "D['system']('touch pwned')"),
)
FAN = "".join(f'<xacro:macro name="m{k + 1}">{f"<xacro:m{k}/>" * 10}</xacro:macro>' for k in range(9))
XACRO = {
    "a macro that calls itself": of(
        '<xacro:macro name="m" params="n"><xacro:m n="${n + 1}"/></xacro:macro>', '<xacro:m n="1"/>'
    ),
    "import": value("__import__('os').system('touch pwned')"),
    "all of Python": of(
        *(f'<xacro:property name="{name}" value="${{{text}}}"/>' for name, text in ESCAPE), '<a b="${R}"/>'
    ),
    "eval": of("<a b=\"$(eval open('pwned', 'w'))\"/>"),
    "a class": value("().__class__.__bases__[0].__subclasses__()"),
    "globals of a function": value("xacro.load_yaml.__globals__"),
    "self of a method": value("[].append.__self__"),
    "builtins": value("__builtins__"),
    "a function": value("(lambda: 1)()"),
    "a generator's frame": value("(x for x in [1]).gi_frame"),
    "a format": value("'{0.__class__}'.format(1)"),
    "a wide format": value("'%1000000000d' % 1"),
    "a starred format": value("'%*d' % (1000000000, 1)"),
    "a f-string": value("f'{1:1000000000}'"),
    "padding": value("'a'.ljust(999999999)"),
    "a long text": value("'a' * 10**9"),
    "a long list": value("[0] * 2000000000"),
    "lists in lists": value("len(str([[[0] * 1000] * 1000] * 1000))"),
    "a tower": value("9**9**9"),
    "powers of powers": value("((((9**64)**64)**64)**64)**64"),
    "a shift": value("1 << 9999999999"),
    "a factorial": value("factorial(99999999)"),
    "a factorial of math": value("math.factorial(99999999)"),
    "combinations": value("comb(999999999, 499999999)"),
    "permutations": value("math.perm(99999999)"),
    "a range": value("list(range(10**9))"),
    "a sum": value("python.sum(python.range(999999999))"),
    "loops in loops": value("[0 for a in range(9999) for b in range(9999) for c in range(9999)]"),
    "brackets": value("(" * 500 + "1" + ")" * 500),
    "a long expression": value("1+" * 20_000 + "1"),
    "texts of texts": of(
        '<xacro:property name="a0" value="aaaaaaaaaa"/>',
        *(f'<xacro:property name="a{k + 1}" value="{f"${{a{k}}}" * 10}"/>' for k in range(11)),
        '<b c="${a11}"/>',
    ),
    "arguments of arguments": of(
        '<xacro:arg name="a0" default="aaaaaaaaaa"/>',
        *(f'<xacro:arg name="a{k + 1}" default="{f"$(arg a{k})" * 10}"/>' for k in range(11)),
        '<b c="$(arg a11)"/>',
    ),
    "a property of itself": of('<xacro:property name="a" value="${a}"/><a b="${a}"/>'),
    "a macro of itself": of('<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>'),
    "a macro that counts": of(
        '<xacro:macro name="m" params="n"><xacro:m n="${n+1}"/></xacro:macro><xacro:m n="0"/>'
    ),
    "a macro that doubles": of(
        '<xacro:macro name="m" params="n"><xacro:if value="${n &lt; 40}"><xacro:m n="${n+1}"/><xacro:m n="${n+1}"/>'
        '</xacro:if></xacro:macro><xacro:m n="0"/>'
    ),
    "macros of macros": of(f'<xacro:macro name="m0"><b/></xacro:macro>{FAN}<xacro:m9/>'),
    "itself": of('<xacro:include filename="probe.urdf"/>'),
    "each other": of('<xacro:include filename="loop.xacro"/>'),
    "find a path": of('<xacro:include filename="$(find ../..)/x"/>'),
    "find a root": of('<xacro:include filename="$(find /etc)/passwd"/>'),
    "an absolute path": of('<xacro:include filename="/etc/passwd"/>'),
    "a path up": of('<xacro:include filename="../../../../../../../../etc/passwd"/>'),
    "what matches outside": of('<xacro:include filename="/etc/*"/>'),
    "all that there is": of('<xacro:include filename="/*/*/*/*/*/*"/>'),
    "a device": of('<xacro:include filename="/dev/zero"/>'),
    "the environment of a process": of('<xacro:include filename="/proc/self/environ"/>'),
    "an address": of('<xacro:include filename="http://127.0.0.1:9/"/>'),
    "a folder": of('<xacro:include filename="."/>'),
    "a pipe": of('<xacro:include filename="pipe.xacro"/>'),
    "a link outside": of('<xacro:include filename="link.xacro"/>'),
    "YAML that runs": value("xacro.load_yaml('tag.yaml')"),
    "YAML of aliases": value("xacro.load_yaml('bomb.yaml')"),
    "YAML of aliases as text": value("len(str(xacro.load_yaml('bomb.yaml')))"),
    "deep YAML": value("xacro.load_yaml('deep.yaml')"),
    "large YAML": value("xacro.load_yaml('large.yaml')"),
    "a degree that is a tower": value("xacro.load_yaml('degrees.yaml')"),
    "YAML elsewhere": value("load_yaml('/etc/hostname')"),
    "the environment": of('<a b="$(env HOME)"/>'),
    "an unknown macro": of('<xacro:call macro="${7}"/>'),
    "a module of a module": value("xacro.os.system('touch pwned')"),
}  # fmt: skip


def put(place: Path, content: str) -> None:
    place.mkdir()
    (place / "probe.urdf").write_text(content, encoding="utf-8")
    (place / "loop.xacro").write_text(f'{HEAD}<xacro:include filename="pool.xacro"/></robot>')
    (place / "pool.xacro").write_text(f'{HEAD}<xacro:include filename="loop.xacro"/></robot>')
    (place / "tag.yaml").write_text("a: !!python/object/apply:os.system ['touch pwned']\n")
    aliases = "".join(f"a{k + 1}: &a{k + 1} [{', '.join([f'*a{k}'] * 9)}]\n" for k in range(9))
    (place / "bomb.yaml").write_text("a0: &a0 [x]\n" + aliases)
    (place / "deep.yaml").write_text("[" * 5000)
    (place / "large.yaml").write_text(f"[{'1,' * 100_000}]")
    (place / "degrees.yaml").write_text("a: !degrees 9**9**9\n")
    os.mkfifo(place / "pipe.xacro")
    (place / "link.xacro").symlink_to("/etc/passwd")


@pytest.mark.parametrize("content", everyday(XML, "billion laughs", "external entity"))
def test_xml(server: Server, tmp_path: Path, content: str) -> None:
    (tmp_path / "probe.urdf").write_text(content, encoding="utf-8")
    refused(server, tmp_path, "import", "probe.urdf", "-o", "out.yaml", says=r"probe\.urdf")


@pytest.mark.parametrize("content", everyday(XACRO, "import", "all of Python"))
def test_xacro(server: Server, tmp_path: Path, content: str) -> None:
    put(tmp_path / "in", content)
    refused(server, tmp_path, "import", "in/probe.urdf", "-o", "out.yaml", says=r"probe\.urdf")


COMPUTES = {
    "sizes": ("2**3 + 7 % 4 * 1.5", "12.5"),
    "texts": ("'ab' * 2 + '%03d' % 7", "abab007"),
    "lists": ("[2 * x for x in range(3)]", "[0, 2, 4]"),
    "roots": ("sqrt(4)**-1 + 2**0.5 * 0", "0.5"),
    "the longest power": ("(2**64)**0.5", "4294967296.0"),
    "precedence": ("-2**2 * (3 - 1) % 5", "2"),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", COMPUTES)
def test_what_computes_is_computed(server: Server, tmp_path: Path, case: str) -> None:
    """As Python does, in the message about what has no number."""
    expression, result = COMPUTES[case]
    content = HEAD + link("base_link") + pair().replace("0.25", f"${{{expression}}}x") + "</robot>"
    (tmp_path / "probe.urdf").write_text(content)
    attempt = server.run(tmp_path, "import", "probe.urdf")
    harmless(attempt)
    assert f"{result}x" in attempt.err


@pytest.mark.slow
def test_the_largest_description(server: Server, tmp_path: Path) -> None:
    """As many wheels as there may be joints: accepted, within 1 GiB and 10 s."""
    shape = '<collision><geometry><cylinder radius="0.1" length="1"/></geometry></collision>'
    content = joints(MOST, "l0", '<origin xyz="0.# 0.2 0" rpy="0 0 0.#"/>').replace(
        '"/><joint', f'">{shape}</link><joint'
    )
    (tmp_path / "probe.urdf").write_text(content)
    attempt = server.run(tmp_path, "import", "probe.urdf", "-o", "out/robot.yaml")
    assert attempt.code == 0 and not attempt.outside
