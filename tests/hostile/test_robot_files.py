"""Robot files that want to take long, to be read otherwise than they look, or to write where they should not."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from tests.conftest import GALLERY
from tests.hostile.attempts import LINUX, Server, everyday, harmless, refused

pytestmark = LINUX
WHEEL = "{name: a, type: fixed, x: 0, y: 0.1, heading: 0, r: 0.1}"


def robot(wheel: str = WHEEL, top: str = "", end: str = "", name: str = "bad") -> str:
    return f"wmrgen: 1\nname: {name}\n{top}wheels:\n  - {wheel}\n{end}"


def at(value: str) -> str:
    """A robot whose wheel stands at y = ``value``."""
    return robot(WHEEL.replace("y: 0.1", f"y: {value}"))


def chain(first: str, step: str, count: int) -> str:
    """Parameters of which each is made of the one before."""
    lines = "".join(f"  p{k}: {step.replace('#', f'p{k - 1}')}\n" for k in range(1, count))
    return robot(
        WHEEL.replace("y: 0.1", f"y: p{count - 1}"), f"parameters:\n  p0: {first}\n  q: {first}\n{lines}"
    )


NAMES = (
    "con", "nul", "com1", "lpt9", "aux", "prn", "CON", "Nul", "COM1", "../x", "/etc/x", "..", ".", "a/b", "a\\b", "~",
    "-rf", "--help", "a b", "a;b", "$(id)", "`id`", "*/", "<script>", "]]>", "\\input", "a\\n",
    "a.b", "int", "main", "_x", "x__y", "pair_t", "textbook", "ba\u200dd", "b\u0430d", "a" * 100_000,
)  # fmt: skip
TUNABLE = "{value: 2, tunable: true}"
BOMBS = {
    "aliases": "a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n",
    "an alias of itself": "a: &a [*a]\n",
    "a merge": robot(WHEEL.replace("x: 0", "<<: {x: 0}")),
    "a tag that runs": robot(WHEEL.replace("x: 0", "x: !!python/object/apply:os.system ['touch pwned']")),
    "local tags": "!a " * 10_000,
    "a directive": "%YAML 9.9\n---\n" + robot(),
    "brackets": "[" * 100_000,
    "braces": "{a: " * 60_000,
    "dashes": "- " * 100_000,
    "questions": "? " * 100_000,
    "indentation": "".join(f"{' ' * k}a:\n" for k in range(700)),
    "dashes below a key": robot(end="couplings:\n  " + "- " * 3000 + "x\n"),
    "a long text": robot(top=f"description: {'x' * 200_000}\n"),
    "a folded text": robot(top="description: >\n" + "  x\n" * 50_000),
    "a long key": "k" * 200_000 + ": 1\n",
    "many keys": "".join(f"k{k}: 1\n" for k in range(20_000)),
    "many wheels": robot(end="".join(f"  - {WHEEL.replace('name: a', f'name: a{k}')}\n" for k in range(1400))),
    "many parameters": robot(top="parameters:\n" + "".join(f"  p{k}: 1\n" for k in range(5000))),
    "quotes": "'" * 100_001,
    "backslashes": '"' + "\\" * 100_001,
    "documents": "---\n" * 20_000,
    "colons": ":" * 100_000,
    "a huge exponent": at("1e999999999"),
    "a tiny exponent": at("1e-999999999"),
    "a tower": at("9**9**9"),
    "powers of powers": at("(" * 9 + "9" + "**4)" * 9),
    "powers of inverses": at("(" * 9 + "0.1" + "**-4)" * 9),
    "beyond a double": at("(1e30**4)**4"),
    "a parameter beyond a double": robot(top="parameters: {p: 1e30**4}\n"),
    "digits": at("1" * 200_000),
    "a sum without end": at("+".join("1" * 100_000)),
    "a sum of roots": at("+".join(f"sqrt({k})" for k in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53))),
    "sines of sines": at("sin(" * 39 + "1" + ")" * 39),
    "tangents of tangents": at("tan(" * 38 + "1" + ")" * 38),
    "signs": at("-" * 190 + "1"),
    "brackets in brackets": at("(" * 98 + "9**9" + ")" * 98),
    "squares of squares": chain("3", "#*#", 200),
    "doubles of doubles": chain("3", "#+#", 255),
    "roots of roots": chain("3", "sqrt(#+1)", 200),
    "powers in parameters": chain(TUNABLE, "(#+q)**4", 9),
    "quotients in parameters": chain(TUNABLE, "(#+q)/(#-q/2)", 40),
}  # fmt: skip
ENCODINGS = {
    "UTF-16": robot().encode("utf-16"),
    "UTF-16 without mark": robot().encode("utf-16-le"),
    "UTF-16 from the big end": robot().encode("utf-16-be"),
    "UTF-32": robot().encode("utf-32"),
    "Latin-1": robot(top="description: é\n").encode("latin1"),
    "overlong": robot(top="description: #\n").encode().replace(b"#", b"\xc0\xaf"),
    "cut in a character": robot(end="# é").encode()[:-1],
    "surrogate": robot(top='description: "#"\n').encode().replace(b"#", b"\xed\xa0\x80"),
    "escaped surrogates": robot(top='description: "\\ud83d\\ude00"\n'),
    "escape beyond Unicode": robot(top='description: "\\UFFFFFFFF"\n'),
    "NUL": robot(top="description: a\0b\n"),
    "escaped NUL": robot(top='description: "a\\0b"\n'),
    "escape sequence": robot(top='source: "a\\x1b]0;pwned\\x07"\n'),
    "right to left": robot(top="description: a\u202eb\n"),
    "escaped right to left": robot(top='description: "a\\u202eb"\n'),
    "isolates in a comment": robot(end="# a\u2066b\n"),
    "byte order mark inside": robot(top="description: a\ufeffb\n"),
    "line separator": robot(top='description: "a\u2028b"\n'),
    "next line": robot(top='source: "a\u0085b"\n'),
    "tag characters": robot(top="description: a\U000e0041b\n"),
    "full-width digit": at("\uff11"),
    "Arabic digit": at("\u0661"),
    "superscript": at("2\u00b2"),
    "tab": robot().replace("  -", "\t-"),
    "form feeds": "\f" * 1000,
    "every byte": bytes(range(256)),
    "noise": random.Random(1).randbytes(100_000),
    "nothing": b"",
    "a byte order mark": b"\xef\xbb\xbf",
    "too large": b"#" * (256 * 1024 + 1),
}
OF_THE_FILE = {"UTF-16", "UTF-32", "too large"}  # their errors have no line


def put(place: Path, content: str | bytes) -> None:
    (place / "bad.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())


@pytest.mark.parametrize("content", everyday(BOMBS, "aliases", "brackets", "a tower", "squares of squares"))
def test_bombs(server: Server, tmp_path: Path, content: str) -> None:
    put(tmp_path, content)
    refused(server, tmp_path, "derive", "bad.yaml", "-o", "out", says=r"bad\.yaml:\d+:\d+")


@pytest.mark.parametrize("name", everyday({name: name for name in ENCODINGS}, "surrogate", "right to left"))
def test_encodings(server: Server, tmp_path: Path, name: str) -> None:
    put(tmp_path, ENCODINGS[name])
    says = r"bad\.yaml" if name in OF_THE_FILE else r"bad\.yaml:\d+:\d+"
    refused(server, tmp_path, "derive", "bad.yaml", "-o", "out", says=says)


@pytest.mark.slow
@pytest.mark.parametrize("of", ["robot", "wheel", "parameter", "trailer"])
def test_names(server: Server, tmp_path: Path, of: str) -> None:
    """Each is refused, where it stands; the rest of the names in the file are fine."""
    for name in NAMES if of == "robot" else set(NAMES) - {"textbook"}:
        quoted = "'" + name.replace("'", "''") + "'"
        put(
            tmp_path,
            {
                "robot": robot(name=quoted),
                "wheel": robot(WHEEL.replace("name: a", f"name: {quoted}")),
                "parameter": robot(top=f"parameters: {{{quoted}: 1}}\n"),
                "trailer": robot(end=f"trailers: [{{name: {quoted}, length: 1}}]\n"),
            }[of],
        )
        refused(server, tmp_path, "derive", "bad.yaml", "-o", "out", says=r"bad\.yaml:\d+:\d+")


def many(count: int, kind: str, more: str = "", tunable: bool = False) -> str:
    """As many wheels as a robot may have, at angles without a closed form."""
    parameters = "".join(
        f"  a{k}: {{value: 0.{k + 1}, tunable: true}}\n  b{k}: {{value: 0.{k + 2}1, tunable: true}}\n"
        for k in range(count)
    )
    x, y = ("a#", "b#") if tunable else ("0.#3", "0.#71")
    wheel = f"  - {{name: w#, type: {kind}, x: {x}, y: {y}, heading: 0.#7, r: 0.1{more}}}\n"
    lines = "".join(wheel.replace("#", str(k)) for k in range(count))
    return f"wmrgen: 1\nname: bad\n{f'parameters:{chr(10)}{parameters}' if tunable else ''}wheels:\n{lines}"


# Found by Atheris: the report cleared a divisor of three roots for a minute.
ROOTS = """wmrgen: 1
name: roots
parameters: {a: 0.3, b: 0.1}
wheels:
  - {name: front, type: steered, l: sqrt(a + b**2), alpha: "atan2(b, a)", heading: 0, r: 0.1}
  - {name: rear, type: steered, l: sqrt(a**3 + b**2), alpha: "atan2(b, -a)", heading: 0, r: 0.1}
"""

LARGE = {
    "steered": (0, many(64, "steered")),
    "castors": (0, many(64, "castor", ", d: 0.0#1, actuated: [spin, steer]")),
    "fixed": (3, many(64, "fixed")),
    "tunable Swedish": (0, many(64, "swedish", ", gamma: 0.7", tunable=True)),
    "Swedish": (0, many(32, "swedish", ", gamma: 0.7")),
    "tunable steered": (0, many(64, "steered", tunable=True)),
    "roots": (0, ROOTS),
    "trailers": (0, robot(end="  - {name: f, type: steered, x: 1, y: 0, heading: 0, r: 0.1}\ntrailers:\n"
                          + "".join(f"  - {{name: t{k}, length: 1.{k}, hitch: 0.{k}1}}\n" for k in range(16)))),
    "all limits": (0, many(8, "steered", ", limits: {spin: 1e-30, steer: [-1e-9, 1e-9]}")
                   + "limits: {vx: 1e30, vy: 1e-30, omega: 1e30}\n"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("case", LARGE)
def test_the_largest_robots(server: Server, tmp_path: Path, case: str) -> None:
    """They are accepted: within 1 GiB and 10 s."""
    code, content = LARGE[case]
    put(tmp_path, content)
    attempt = server.run(tmp_path, "derive", "bad.yaml", "-o", "out")
    assert attempt.code == code, attempt.err
    assert not attempt.outside and "bug in wmrgen" not in attempt.err


CUTS = {path.stem: path for path in GALLERY}


@pytest.mark.slow
@pytest.mark.parametrize("name", CUTS)
def test_truncated_files(server: Server, tmp_path: Path, name: str) -> None:
    """A robot of the gallery cut at random bytes: refused at a place, or a robot of its own that is derived."""
    content = CUTS[name].read_bytes()
    for length in sorted(random.Random(name).sample(range(len(content)), 4)):
        put(tmp_path, content[:length])
        attempt = server.run(tmp_path, "derive", "bad.yaml", "-o", f"out/{length}")
        harmless(attempt)
        assert attempt.code in (0, 2, 3), attempt
        assert attempt.code == 0 or re.search(r"bad\.yaml:\d+:\d+", attempt.err), attempt.err
        assert attempt.code != 2 or not (tmp_path / "out" / str(length)).exists()
