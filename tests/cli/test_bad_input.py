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


BAD: dict[str, tuple[str | bytes, str]] = {
    "unknown key": (robot(WHEEL.replace("heading", "headin")), "heading"),
    "unknown top key": (robot(head="snapp: true\n"), "snap"),
    "missing key": (robot(WHEEL.replace(", r: 0.1", "")), "r"),
    "no wheels": ("wmrgen: 1\nname: bad\n", "wheels"),
    "both placements": (robot(WHEEL.replace("x: 0,", "x: 0, l: 1, alpha: 0,")), "alpha"),
    "both orientations": (robot(WHEEL.replace("heading: 0", "heading: 0, beta: 0")), "beta"),
    "unknown wheel type": (robot(WHEEL.replace("fixed", "fixd")), "fixed"),
    "gamma 90": (robot(SWEDISH.replace("45 deg", "90 deg")), "gamma"),
    "gamma -90": (robot(SWEDISH.replace("45 deg", "-pi/2")), "gamma"),
    "r zero": (robot(WHEEL.replace("r: 0.1", "r: 0")), "r"),
    "r negative": (robot(WHEEL.replace("r: 0.1", "r: -0.1")), "r"),
    "d zero": (robot(CASTOR.replace("0.02", "0")), "steered"),
    "duplicate wheel": (robot(tail=f"  - {WHEEL}\n"), "a"),
    "name no identifier": (robot().replace("name: bad", "name: 3bad"), "name"),
    "name reserved": (robot().replace("name: bad", "name: int"), "int"),
    "wheel name reserved": (robot(WHEEL.replace("name: a", "name: while")), "while"),
    "undeclared parameter": (robot(WHEEL.replace("0.1,", "track,")), "track"),
    "division by zero": (robot(WHEEL.replace("y: 0.1", "y: 1/0")), "The divisor is zero at the nominal"),
    "root of a negative": (robot(WHEEL.replace("y: 0.1", "y: sqrt(-2)")), "under the root is negative"),
    "nan": (robot(WHEEL.replace("y: 0.1", "y: .nan")), "nan"),
    "inf": (robot(WHEEL.replace("y: 0.1", "y: inf")), "inf"),
    "duplicate key": (robot(WHEEL.replace("x: 0,", "x: 0, x: 1,")), "x"),
    "anchor": (robot(f"&w {WHEEL}"), "anchor"),
    "alias": (robot(WHEEL.replace("x: 0,", "x: *w,")), ""),
    "tag": (robot(WHEEL.replace("x: 0", "x: !!python/object/apply:os.getcwd []")), "tag"),
    "tower": (robot(WHEEL.replace("y: 0.1", "y: 9**9**9")), ""),
    "huge exponent": (robot(WHEEL.replace("y: 0.1", "y: 1e999999999")), ""),
    "long": (b"#" * (300 * 1024), "256 KiB"),
    "deep": ("[" * 100_000, ""),
    "surrogate": (robot(head='description: "x\ud800"\n').encode("utf-8", "surrogatepass"), ""),
    "surrogate escape": (robot(head='description: "\\ud800"\n'), ""),
    "bidi": (robot(head="description: \u202eabc\n"), ""),
    "import in a value": (robot(WHEEL.replace("y: 0.1", "y: \"__import__('os')\"")), ""),
    "import in a name": (robot(WHEEL.replace("name: a", "name: \"__import__('os')\"")), ""),
    "import in a type": (robot(WHEEL.replace("fixed", "\"__import__('os')\"")), ""),
    "65 wheels": (
        robot(tail="".join(f"  - {WHEEL.replace('name: a', f'name: a{k}')}\n" for k in range(64))),
        "64",
    ),
    "coupled joint that is not": (robot(tail="couplings:\n  - {equal: [a.steer, a.spin]}\n"), "a.steer"),
    "coupled wheel that is not": (robot(tail="couplings:\n  - {equal: [a.spin, b.spin]}\n"), "b"),
    "empty": ("", ""),
    "not a mapping": ("- 1\n", ""),
    "two documents": (robot() + "---\n" + robot(), ""),
    "binary": (b"\x00\x01\xff\xfe", ""),
    "wrong version": (robot().replace("wmrgen: 1", "wmrgen: 2"), "wmrgen"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_robot_files(wmrgen_cli: Callable[..., Outcome], tmp_path: Path, case: str) -> None:
    content, says = BAD[case]
    path = tmp_path / "bad.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert (done.code, done.out) == (2, ""), done
    assert says in done.err
    assert "bad.yaml" in done.err
    assert "Traceback" not in done.err
    assert "bug" not in done.err
    assert len(done.err) < 2000
    assert [p.name for p in tmp_path.iterdir()] == ["bad.yaml"]
