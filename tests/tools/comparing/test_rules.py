"""Codes of differences: each finds its mistake between the files of its example, none between those mended."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.robotfile.files import robot, wheel
from wmrgen.tools.comparing.commands import RELEASE
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.differences import CODES
from wmrgen.tools.comparing.record import Comparison
from wmrgen.tools.comparing.rules import BETWEEN
from wmrgen.tools.comparing.sources import layouts
from wmrgen.tools.lint import RULES, Rule

EACH = pytest.mark.parametrize("rule", BETWEEN.values(), ids=BETWEEN)


def files(folder: Path, example: str, ignore: str = "") -> tuple[Path, Path]:
    """The two files of an example; ``ignore``: a comment on every line of the second."""
    paths = []
    for name, text in zip(("first", "second"), example.split("---\n"), strict=True):
        head = "wmrgen: 1\nname: tried\n" if text.startswith(("wheels:", "limits:")) else ""
        lines = (head + text).rstrip("\n").split("\n")
        if ignore and name == "second":
            lines = [f"{line}   {ignore}" for line in lines]
        paths.append(folder / f"{name}.yaml")
        paths[-1].write_text("\n".join(lines) + "\n", encoding="utf-8")
    return paths[0], paths[1]


def compared(paths: tuple[Path, Path], rule: Rule | None = None) -> Comparison:
    """The comparison of two files; the rule of other releases is that of rolling."""
    (a,), (b,) = (
        layouts(paths[0]),
        layouts(paths[1], distro="rolling" if rule and rule.code == RELEASE else None),
    )
    return compare(a, b)


@EACH
def test_the_wrong_example_has_the_difference_and_the_right_one_none(rule: Rule, tmp_path: Path) -> None:
    assert {d.code for d in compared(files(tmp_path, rule.wrong), rule).differences} == {rule.code}
    assert compared(files(tmp_path, rule.right), rule).differences == ()


@EACH
def test_a_comment_beside_the_line_ignores_that_difference_alone(rule: Rule, tmp_path: Path) -> None:
    if compared(files(tmp_path, rule.wrong), rule).differences[0].marks:
        assert compared(files(tmp_path, rule.wrong, f"# wmrgen: ignore {rule.code}"), rule).differences == ()
    assert compared(files(tmp_path, rule.wrong, "# wmrgen: ignore WMR999"), rule).differences != ()


def test_another_wheelbase_stands_at_the_wheel_that_moved(tmp_path: Path) -> None:
    """P on the rear axle has not moved: the middle of the wheels has."""
    car = "wheels:\n"
    for n, x in (("rear", "0"), ("front", "0.5")):
        car += f"  - {{name: {n}, type: steered, x: {x}, y: 0, heading: 0, r: 0.1}}\n"
    (difference,) = compared(files(tmp_path, f"{car}---\n{car.replace('0.5', '0.55')}")).differences
    assert (difference.quantity, difference.marks[0].line, difference.marks[0].column) == ("wheelbase", 5, 37)


def test_every_code_has_a_rule_and_none_is_of_one_robot() -> None:
    assert set(CODES.values()) <= set(BETWEEN)
    assert not set(BETWEEN) & set(RULES)


def test_as_many_wheels_as_a_robot_may_have_are_compared(tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_text(robot(*(wheel(f"w{k}", y=str(k)) for k in range(64))))
    assert [len(layout.wheels) for layout in layouts(path)] == [64]
