"""A bad robot file: one clear error at its place, exit code 2, nothing written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome

WHEEL = "{name: a, type: fixed, x: 0, y: 0.1, heading: 0, r: 0.1}"
CASTOR = "{name: c, type: castor, x: -0.2, y: 0, r: 0.05, d: 0.02}"
SWEDISH = "{name: s, type: swedish, x: 0, y: 0.1, heading: 0, r: 0.1, gamma: 45 deg}"


def robot(wheel: str = WHEEL, head: str = "", tail: str = "") -> str:
    return f"wmrgen: 1\nname: bad\n{head}wheels:\n  - {wheel}\n{tail}"


BAD: dict[str, tuple[str | bytes, str]] = {  # content; the code of the first error, its line and column
    "unknown key": (robot(WHEEL.replace("heading", "headin")), "WMR102 4:42"),
    "unknown top key": (robot(head="snapp: true\n"), "WMR102 3:1"),
    "missing key": (robot(WHEEL.replace(", r: 0.1", "")), "WMR103 4:5"),
    "no wheels": ("wmrgen: 1\nname: bad\n", "WMR103 1:1"),
    "both placements": (robot(WHEEL.replace("x: 0,", "x: 0, l: 1, alpha: 0,")), "WMR106 4:34"),
    "both orientations": (robot(WHEEL.replace("heading: 0", "heading: 0, beta: 0")), "WMR106 4:54"),
    "unknown wheel type": (robot(WHEEL.replace("fixed", "fixd")), "WMR104 4:21"),
    "gamma 90": (robot(SWEDISH.replace("45 deg", "90 deg")), "WMR109 4:71"),
    "gamma -90": (robot(SWEDISH.replace("45 deg", "-pi/2")), "WMR109 4:71"),
    "r zero": (robot(WHEEL.replace("r: 0.1", "r: 0")), "WMR109 4:57"),
    "r negative": (robot(WHEEL.replace("r: 0.1", "r: -0.1")), "WMR109 4:57"),
    "d zero": (robot(CASTOR.replace("0.02", "0")), "WMR109 4:56"),
    "duplicate wheel": (robot(tail=f"  - {WHEEL}\n"), "WMR106 5:12"),
    "name no identifier": (robot().replace("name: bad", "name: 3bad"), "WMR105 2:7"),
    "name reserved": (robot().replace("name: bad", "name: int"), "WMR105 2:7"),
    "wheel name reserved": (robot(WHEEL.replace("name: a", "name: while")), "WMR105 4:12"),
    "undeclared parameter": (robot(WHEEL.replace("0.1,", "track,")), "WMR107 4:37"),
    "division by zero": (robot(WHEEL.replace("y: 0.1", "y: 1/0")), "WMR109 4:37"),
    "root of a negative": (robot(WHEEL.replace("y: 0.1", "y: sqrt(-2)")), "WMR109 4:37"),
    "nan": (robot(WHEEL.replace("y: 0.1", "y: .nan")), "WMR104 4:37"),
    "inf": (robot(WHEEL.replace("y: 0.1", "y: inf")), "WMR104 4:37"),
    "duplicate key": (robot(WHEEL.replace("x: 0,", "x: 0, x: 1,")), "WMR106 4:34"),
    "anchor": (robot(f"&w {WHEEL}"), "WMR101 4:5"),
    "alias": (robot(WHEEL.replace("x: 0,", "x: *w,")), "WMR101 4:31"),
    "tag": (robot(WHEEL.replace("x: 0", "x: !!python/object/apply:os.getcwd []")), "WMR101 4:31"),
    "tower": (robot(WHEEL.replace("y: 0.1", "y: 9**9**9")), "WMR104 4:40"),
    "huge exponent": (robot(WHEEL.replace("y: 0.1", "y: 1e999999999")), "WMR104 4:37"),
    "long": (b"#" * (300 * 1024), "WMR110"),
    "deep": ("[" * 100_000, "WMR101 1:17"),
    "surrogate": (robot(head='description: "x\ud800"\n').encode("utf-8", "surrogatepass"), "WMR101 3:16"),
    "surrogate escape": (robot(head='description: "\\ud800"\n'), "WMR101 3:14"),
    "bidi": (robot(head="description: \u202eabc\n"), "WMR101 3:14"),
    "import in a value": (robot(WHEEL.replace("y: 0.1", "y: \"__import__('os')\"")), "WMR104 4:37"),
    "import in a name": (robot(WHEEL.replace("name: a", "name: \"__import__('os')\"")), "WMR105 4:12"),
    "import in a type": (robot(WHEEL.replace("fixed", "\"__import__('os')\"")), "WMR104 4:21"),
    "65 wheels": (
        robot(tail="".join(f"  - {WHEEL.replace('name: a', f'name: a{k}')}\n" for k in range(64))),
        "WMR104 68:5",
    ),
    "coupled joint that is not": (robot(tail="couplings:\n  - {equal: [a.steer, a.spin]}\n"), "WMR104 6:14"),
    "coupled wheel that is not": (robot(tail="couplings:\n  - {equal: [a.spin, b.spin]}\n"), "WMR107 6:22"),
    "empty": ("", "WMR101 1:1"),
    "not a mapping": ("- 1\n", "WMR104 1:1"),
    "two documents": (robot() + "---\n" + robot(), "WMR101 5:1"),
    "binary": (b"\x00\x01\xff\xfe", "WMR101 1:3"),
    "wrong version": (robot().replace("wmrgen: 1", "wmrgen: 2"), "WMR104 1:9"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_robot_files(wmrgen_cli: Callable[..., Outcome], tmp_path: Path, case: str) -> None:
    content, expected = BAD[case]
    path = tmp_path / "bad.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert (done.code, done.out) == (2, ""), done
    code, *place = expected.split()
    assert f"error[{code}]" in done.err and "bad.yaml" in done.err
    assert not place or f"--> {path}:{place[0]}\n" in done.err
    assert "Traceback" not in done.err
    assert "bug" not in done.err
    assert len(done.err) < 2000
    assert [p.name for p in tmp_path.iterdir()] == ["bad.yaml"]
