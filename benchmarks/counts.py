"""Operations of each generated function, counted in the representation from which the C is printed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import wmrgen
from benchmarks.large import LARGE
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.nodes import count

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Target:
    """``flops`` additions and multiplications, ``products`` of wheel speeds with sines and cosines aside."""

    layout: str
    robot: str
    function: str
    flops: int
    products: int = 0


TARGETS = (
    Target("differential", "textbook_differential", "inverse", 4),
    Target("differential", "textbook_differential", "forward", 4),
    Target("four mecanum", "kuka_youbot", "inverse", 9),
    Target("four mecanum", "kuka_youbot", "forward", 10),
    Target("three omni at 120°", "lekiwi", "inverse", 8),
    Target("three omni at 120°", "lekiwi", "forward", 8),
    Target("three omni, positions rounded to 0.1 mm", "festo_robotino", "inverse", 9),
    Target("three omni, positions rounded to 0.1 mm", "festo_robotino", "forward", 8),
    Target("four swerve", "wpilib_swervebot", "forward", 13, 8),
    Target("eight swerve", "swerve8", "forward", 27, 16),
)


def path_of(robot: str, folder: Path) -> Path:
    """Return the file of a robot of the gallery, or of a large one."""
    if robot not in LARGE:
        return ROOT / "robots" / f"{robot}.yaml"
    path = folder / f"{robot}.yaml"
    path.write_text(LARGE[robot], encoding="utf-8")
    return path


def table() -> Iterator[str]:
    """Yield the functions with a known hand count, then every function of the gallery."""
    yield "| layout | function | additions + multiplications | target | divisions |"
    yield "|---|---|---:|---:|---:|"
    with tempfile.TemporaryDirectory() as folder:
        for t in TARGETS:
            module = inlined_calls(wmrgen.derive(wmrgen.load(path_of(t.robot, Path(folder)))).c_module)
            cost = count(module.function(t.function))
            after = f" after {t.products} products" if t.products else ""
            flops = cost.flops - t.products
            yield f"| {t.layout} ({t.robot}) | {t.function} | {flops}{after} | {t.flops} | {cost.divisions} |"
    yield ""
    yield "| robot | function | operations |"
    yield "|---|---|---|"
    for path in sorted((ROOT / "robots").glob("*.yaml")):
        module = inlined_calls(wmrgen.derive(wmrgen.load(path)).c_module)
        for function in module.functions:
            yield f"| {path.stem} | {function.name} | {count(function)} |"
