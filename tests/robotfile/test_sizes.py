"""Limits of size: a file at the limit is accepted, a file with one more is refused."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.robotfile.files import HEAD, places, read, refused, robot, wheel
from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.reader import MAX_DEPTH, read_tree
from wmrgen.robotfile.text import quoted


def block(levels: int, key: bool) -> str:
    """Mappings or, inside ``key``, lists in block style, the scalar ``x`` on the level given."""
    if key:
        return "? " + "- " * (levels - 1) + "x\n"
    return "".join(f"{'  ' * k}a:\n" for k in range(levels - 1)) + "  " * (levels - 1) + "a: x\n"


NESTED: dict[str, Callable[[int], str]] = {
    "list in brackets": lambda n: "[" * n + "x" + "]" * n,
    "mapping in braces": lambda n: "{a: " * n + "x" + "}" * n,
    "list of dashes": lambda n: "- " * n + "x\n",
    "mapping of lines": lambda n: block(n, key=False),
}


@pytest.mark.parametrize("style", NESTED)
def test_nesting(style: str) -> None:
    assert MAX_DEPTH == 16
    read_tree(NESTED[style](MAX_DEPTH), "bot.yaml")
    with pytest.raises(RobotFileError) as caught:
        read_tree(NESTED[style](MAX_DEPTH + 1), "bot.yaml")
    assert caught.value.code == Code.NOT_YAML and "16" in caught.value.what


def test_nesting_inside_a_key() -> None:
    """A key is as deep as its value. A key that is not a word is refused after it has been read."""
    for levels in (MAX_DEPTH, MAX_DEPTH + 1):
        with pytest.raises(RobotFileError) as caught:
            read_tree(block(levels, key=True), "bot.yaml")
        assert caught.value.code == Code.NOT_YAML
        assert ("16" in caught.value.what) is (levels > MAX_DEPTH)


def many(count: int, item: str) -> str:
    return "".join(item.replace("#", str(k)) for k in range(count))


WHEELS = robot().removeprefix(HEAD)
SIZES: dict[str, tuple[int, Callable[[int], str]]] = {
    "characters of the description": (2000, lambda n: f"{HEAD}description: {'x' * n}\n{WHEELS}"),
    "characters of the source": (2000, lambda n: f"{HEAD}source: {'x' * n}\n{WHEELS}"),
    "characters of a name": (31, lambda n: f"wmrgen: 1\nname: {'n' * n}\n{WHEELS}"),
    "parameters": (256, lambda n: robot(top="parameters:\n" + many(n, "  p#: 1\n"))),
    "angles whose sum, with pi, is one": (
        8,
        lambda n: robot(
            wheel("a", heading=" + ".join(["pi", *(f"p{k}" for k in range(n))])),
            top="parameters:\n" + many(n, "  p#: 0.1\n"),
        ),
    ),
    "trailers": (16, lambda n: robot(top="trailers:\n" + many(n, "  - {name: t#, length: 1}\n"))),
    "wheels": (64, lambda n: robot(*(wheel(f"w{k}", y=str(k)) for k in range(n)))),
}


@pytest.mark.parametrize("what", SIZES)
def test_sizes(what: str) -> None:
    most, text = SIZES[what]
    read(text(most))
    with pytest.raises(RobotFileError):
        read(text(most + 1))


@pytest.mark.parametrize(
    ("inside", "enough"),
    [
        ("couplings: [{equal: [a.spin, b.spin]}]\n", True),
        ("couplings: [{equal: [a.spin]}]\n", False),
        ("couplings: []\n", True),
        ("trailers: []\n", True),
    ],
)
def test_lists_that_are_too_short(inside: str, enough: bool) -> None:
    text = robot(wheel("a"), wheel("b"), top=inside)
    if enough:
        read(text)
        return
    with pytest.raises(RobotFileError):
        read(text)


def test_keys() -> None:
    for length, code in ((100, Code.UNKNOWN_KEY), (101, Code.NOT_YAML)):
        assert places(refused(f"{HEAD}{'k' * length}: 1\n{WHEELS}")) == f"{code} 3:1"


def test_values() -> None:
    """The list and its items are counted."""
    read_tree(f"[{'1,' * 19_999}]", "bot.yaml")
    with pytest.raises(RobotFileError) as caught:
        read_tree(f"[{'1,' * 20_000}]", "bot.yaml")
    assert caught.value.code == Code.NOT_YAML and "20000" in caught.value.what


def test_quotations_in_messages() -> None:
    assert quoted("x" * 60) == f"'{'x' * 60}'"
    assert quoted("x" * 61) == f"'{'x' * 59}…'"
    assert quoted("abcd", 4) == "'abcd'"
    assert quoted("abcde", 4) == "'abc…'"
    assert quoted("a\nb\tc\x07") == "'a b c\ufffd'"
