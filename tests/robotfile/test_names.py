"""Names that are refused: the name that the message offers is accepted."""

from __future__ import annotations

import re

import pytest

from wmrgen.errors import RobotFileError
from wmrgen.robotfile import names
from wmrgen.robotfile import reserved_words as words
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.text import Scalar

WORDS = sorted(
    {
        *words.DEVICES, *words.FILE_NAMES, *words.NAMES_OF_LIBRARIES, *words.EXPRESSION_WORDS, *words.MODEL_WORDS,
        *"textbook PI Pi Sin double Float NAN int while fn let F0 PORTB eta7 CON lpt1 None r2 left".split(),
        *"wheel_t a__b T_t size_t __init__ x__t 1st vorne-links größe σ a.b _x".split(), "front left", 40 * "long",
    }
)  # fmt: skip


def offered_for(kind: str, word: str) -> str:
    """What to write in place of ``word`` as the name of a robot, wheel or parameter; "" if it is accepted."""
    node = read_tree(f'"{word}"', "robot.yaml")
    assert isinstance(node, Scalar)
    try:
        assert getattr(names, f"{kind}_name")(node) == word
    except RobotFileError as error:
        return error.instead
    return ""


@pytest.mark.parametrize("kind", ["robot", "wheel", "parameter"])
def test_what_is_offered_is_accepted(kind: str) -> None:
    every = [*WORDS, *(f"_{word}" for word in WORDS)]
    refused = {word: instead for word in every if (instead := offered_for(kind, word))}
    assert len(refused) > len(WORDS) and not offered_for(kind, "front_left")
    assert {
        *words.DEVICES,
        "while",
        "PORTB" if kind == "robot" else "double",
        "size_t",
        "a__b",
    } <= refused.keys()
    for word, instead in refused.items():
        if kind == "parameter" and word.lower() == "pi":
            assert instead == "Write pi as it is.", word
            continue
        offered = re.match(r"Write (?:a name such as )?(\w+)", instead)
        assert offered and not offered_for(kind, offered[1]), (word, instead)
