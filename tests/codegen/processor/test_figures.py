"""Claims of docs/benchmarks_laboratory.md: few instructions, the same for every input, far fewer than CasADi's."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from benchmarks import figures
from benchmarks.emulator.fleet import Fleet, answers
from benchmarks.figures import BEGIN, END, PAGE
from benchmarks.jobs import JOBS, ODOMETRY, Job, derivations
from benchmarks.processor import GENERATORS, Bench, inputs
from tests.depth import everyday
from tests.external_tools import need
from wmrgen.ir.calls import nominal
from wmrgen.ir.interpret import FLOAT32
from wmrgen.ir.kernels.choice import MATHS

RETURN = 1  # the return instruction, which the limits do not count


def test_the_page_has_every_row() -> None:
    """Both Cortex-M and the sizes have all jobs, WPILib those that it offers; each choice of mathematics has a
    column."""
    text = figures.between(PAGE.read_text(encoding="utf-8"))
    rows = Counter((row[0], row[1]) for row in figures.rows(text))
    for job in JOBS:
        assert rows[job.layout, job.function] >= 5, job
    assert all((layout, "forward") in rows for layout in ("differential", "mecanum", "swerve"))
    headings = [line for line in text.splitlines() if line.startswith("| layout")]
    assert len(headings) == 8
    for math in MATHS:
        assert all(f"wmrgen, {math}" in line for line in headings[:4])
    assert rows[ODOMETRY.layout, ODOMETRY.function] == 1
    assert all(re.search(r"\d", "".join(row[2:])) for row in figures.rows(text))


def tables(text: str) -> list[list[dict[str, str]]]:
    """Return the Markdown tables of ``text``: for each row its cells by the headings of their columns."""
    found: list[list[dict[str, str]]] = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        heading, _, *lines = [[c.strip() for c in line.strip("|").split("|")] for line in block.splitlines()]
        found.append([dict(zip(heading, cells, strict=True)) for cells in lines])
    return found


def test_the_page_for_users_has_figures_of_the_laboratory() -> None:
    """Each row about a layout is part of a row in the one table that has all its columns."""
    laboratory = tables(PAGE.read_text(encoding="utf-8"))
    short = [t for t in tables((PAGE.parent / "benchmarks.md").read_text("utf-8")) if "layout" in t[0]]
    assert len(short) == 3 and all(len(table) >= 5 for table in short)
    for table in short:
        (whole,) = [t for t in laboratory if t[0].keys() >= table[0].keys()]
        for row in table:
            assert any(row.items() <= other.items() for other in whole), row


def test_update_replaces_what_stands_between_the_markers(tmp_path: Path) -> None:
    path = tmp_path / "benchmarks.md"
    path.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    assert figures.update(["", "| a | b |", "|---|---|", "| 1 | 2 |"], path)
    assert path.read_text() == f"before\n{BEGIN}\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n{END}\nafter\n"
    assert not figures.update(["", "| a | b |", "|---|---|", "| 1 | 2 |"], path)
    assert figures.rows(figures.between(path.read_text())) == [["1", "2"]]


@pytest.mark.parametrize("text", ["none", f"{BEGIN} alone", f"{END} {BEGIN}", f"{BEGIN} {BEGIN} {END}"])
def test_missing_or_misplaced_markers_are_an_error(text: str) -> None:
    with pytest.raises(ValueError, match=BEGIN.split()[1]):
        figures.between(text)


BRANCHLESS = [j for j in JOBS if j.function == "forward" or "castor" in j.layout]


# For forward, the everyday test is the car; the castors have both functions.
@pytest.mark.parametrize(
    "job",
    everyday(BRANCHLESS, [j for j in BRANCHLESS if "castor" in j.layout or j.robot == "ackermann_car"]),
    ids=str,
)
def test_every_input_needs_the_same(job: Job, tmp_path: Path) -> None:
    """Forward kinematics, and inverse kinematics of castors: no branch."""
    module = derivations()[job.robot].c_module
    fleet = Fleet.build(tmp_path, [module], answers(FLOAT32))
    step = next(s for s in fleet.steps(job.robot) if s.name == f"{job.robot}_{job.function}")
    cases = inputs(fleet.inputs(step), nominal(module), step.name)
    assert len({fleet.call(step, case)[0].instructions for case in cases}) == 1


@pytest.fixture(scope="module")
def benches(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Bench]:
    need("arm-none-eabi-gcc")
    return {math: Bench(tmp_path_factory.mktemp(math), math, others=math == "libm") for math in MATHS}


@pytest.mark.slow
def test_no_more_instructions_than_the_limits(benches: dict[str, Bench]) -> None:
    """The cost of libm depends on its arguments, so the hand-written code is measured on the same inputs."""
    over = []
    for math, bench in benches.items():
        for job in (j for j in JOBS if j.libm):
            mean, hand = bench.count(job).mean, bench.count(job, job.reference).mean
            limit = max(job.libm + RETURN, hand) if math == "libm" else (job.inline or job.libm) + RETURN
            if mean > limit:
                over.append(f"{math} {job.layout} {job.function}: {mean:.0f} of {limit}")
    assert over == []


# Instructions and modelled cycles of each row of the table and of odometry at commit 9bb0977b, with inline kernels.
BEFORE = {
    "textbook_differential inverse": (11.0, 17.0), "textbook_differential forward": (13.0, 22.0),
    "clearpath_do100 inverse": (19.0, 29.0), "clearpath_do100 forward": (20.0, 31.0),
    "lekiwi inverse": (18.0, 31.0), "lekiwi forward": (18.0, 29.0),
    "wpilib_swervebot inverse": (217.0, 514.0), "wpilib_swervebot forward": (157.0, 278.0),
    "swerve8 inverse": (427.0, 996.0), "swerve8 forward": (302.0, 558.0),
    "nomad_xr4000 inverse": (183.0, 350.0), "nomad_xr4000 forward": (206.0, 396.0),
    "ackermann_car inverse": (95.7, 199.4), "ackermann_car forward": (139.0, 270.0),
    "textbook_differential odometry": (85.0, 174.5),
}  # fmt: skip


@pytest.mark.slow
def test_no_more_cycles_than_when_fewest_instructions_counted(benches: dict[str, Bench]) -> None:
    """A product and a sum that replace an instruction of three cycles may increase instructions, up to a factor of
    1.15."""
    counts = {job: benches["inline"].count(job) for job in (*JOBS, ODOMETRY)}
    assert {str(job) for job in counts} == set(BEFORE)
    over = [
        f"{job}: {count.beside}"
        for job, count in counts.items()
        if count.cycles > BEFORE[str(job)][1] or count.mean > 1.15 * BEFORE[str(job)][0]
    ]
    assert over == []


@pytest.mark.slow
@pytest.mark.parametrize("job", JOBS, ids=str)
def test_other_generators_compute_the_same(job: Job, benches: dict[str, Bench]) -> None:
    """Their counts are then for the same job."""
    bench = benches["libm"]
    every = inputs(bench.fleet.inputs(bench.step(job)), {}, job.robot)
    for case in list(every)[:6]:
        _, wanted = bench.call(job, "", case)
        size = max(1.0, *(abs(value) for value in wanted.values()))
        for generator in GENERATORS:
            name = f"{generator}_{job.robot}_{job.function}"
            if generator == "symforce" and name not in bench.flat:  # it has no operation for every function
                continue
            _, found = bench.call(job, name, case)
            assert all(abs(found[n] - wanted[n]) <= 1e-4 * size for n in wanted), (generator, case)


@pytest.mark.slow
@pytest.mark.parametrize("job", [job for job in JOBS if job.trigonometry], ids=str)
def test_casadi_needs_40_times_as_many(job: Job, benches: dict[str, Bench]) -> None:
    """For functions with angles, its float code calls double sines."""
    others = benches["libm"].other(job, "casadi")
    assert others is not None
    assert others.mean >= 40 * benches["inline"].count(job).mean
