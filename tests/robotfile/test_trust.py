"""No text raises anything but RobotFileError, takes long, or loads a heavy library."""

from __future__ import annotations

import subprocess
import sys
import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.depth import DEEP, examples
from tests.robotfile.files import HEAD, read, robot, wheel
from tests.work import calls
from wmrgen.errors import RobotFileError
from wmrgen.robotfile.load import read_text
from wmrgen.robotfile.records import RobotSpec

QUICK = settings(max_examples=examples(200), suppress_health_check=[HealthCheck.too_slow], derandomize=True)
SOURCE = robot(
    wheel("a", "steered", limits="{steer: [-95 deg, 95 deg]}"),
    wheel("b", "swedish", gamma="pi/4"),
    wheel("c", "castor"),
    top="angles: deg\nparameters: {p: 0.1, q: {value: p*2, tunable: true}}\n"
    "couplings: [{equal: [a.spin, b.spin]}]\n",
)


def tried(text: str) -> RobotSpec | None:
    """The robot of a text, or None. The message of an error must be UTF-8 without unprintable characters."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return read_text(text, "fuzz.yaml")
        except RobotFileError as error:
            shown = str(error)
    shown.encode()
    assert not set(shown) & {"\x00", "\x07", "\x1b", "\u202e", "\r"}
    return None


@QUICK
@given(st.text(max_size=300))
def test_random_text(text: str) -> None:
    tried(text)


@QUICK
@given(st.text(st.characters(exclude_categories=[]), max_size=60))
def test_random_values_and_names(text: str) -> None:
    tried(f"{HEAD}description: {text}\n")
    tried(robot(wheel("a", x=text or "0")))
    tried(robot(wheel("a", x='"' + text.replace("\\", "\\\\").replace('"', "") + '"')))


@QUICK
@given(st.text("0123456789.eE+-*/() ,pqisncorta2πxm_", max_size=220))
def test_random_expressions(text: str) -> None:
    tried(robot(wheel("a", x=f'"{text}"'), top="parameters: {p: 0.1, q: 3}\n"))


@QUICK
@given(st.text("[]{}:,-?&*!|>'\"%@`#~ \n\tab1\\", max_size=200))
def test_random_yaml_punctuation(text: str) -> None:
    tried(text)
    tried(HEAD + text)


@QUICK
@given(st.data())
def test_a_damaged_robot_file(data: st.DataObject) -> None:
    text = SOURCE
    assert read(text).wheels
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text)))
        gone = data.draw(st.integers(0, 12))
        new = data.draw(
            st.sampled_from(
                ["", "[", "{", "}", ": ", "- ", "\n", "'", '"', "x", "0", "\t", "1e9", "**", "\x00", "é"]
            )
        )
        text = text[:at] + new + text[at + gone :]
    tried(text)


ATTACKS = [
    "[" * 100_000, "{" * 100_000, "[{" * 60_000, "- " * 100_000, "? " * 100_000, "a:\n " * 50_000,
    "x" * (300 * 1024), robot(wheel("a", x="9**9**9")), robot(wheel("a", x="1e999999")),
    robot(wheel("a", x="1" * 200_000)), robot(wheel("a", x="(" * 199)),
    robot(wheel("a", x="(" * 100_000)), robot(wheel("a", x="-" * 199 + "1")), "\n" * 250_000,
    "#" * 250_000, "'" * 250_000, '"' + "\\\n" * 100_000, "--- " * 60_000, "! " * 100_000,
    "".join(f"{' ' * i}a:\n" for i in range(700)), "".join("k: 1\n" for _ in range(50_000)),
    "&a " * 80_000, "{a" * 50_000, "a, " * 80_000, "|\n" + " x\n" * 80_000, ">\n" + " x\n\n" * 60_000,
    "x\n" * 120_000, "%" * 200_000,
]  # fmt: skip


def name_of(text: str) -> str:
    return ascii(text[:12] if len(text) > 400 else text[-60:])


@pytest.mark.parametrize("text", ATTACKS, ids=name_of)
def test_attacks_are_refused(text: str) -> None:
    assert tried(text) is None


@pytest.mark.parametrize("text", ATTACKS, ids=name_of)
def test_work_grows_no_faster_than_the_text(text: str) -> None:
    """The worst text takes 17 calls for each of its characters."""
    text = text[: 20_000 if DEEP else 8_000]
    calls(lambda: tried(text), 25 * len(text) + 10_000)


def test_a_robot_file_is_read_with_little_work() -> None:
    text = robot(*(wheel(f"w{i}", x=f"0.{i + 1}*pi/2") for i in range(4)))
    assert calls(lambda: read(text), 40_000) > 100


def test_reading_loads_no_heavy_library() -> None:
    heavy = "sympy numpy casadi mpmath pydantic jinja2 rich"
    code = "import sys, wmrgen.robotfile.load, wmrgen.robotfile.schema\n"
    code += f"print(set('{heavy}'.split()) & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_reading_twice_gives_equal_records() -> None:
    assert read(SOURCE) == read(SOURCE)
