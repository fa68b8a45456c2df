"""What the analysis says of a layout: every sentence of small robots, worked out by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tests.analysis.mobility.test_couplings import AXLE, STEERED, wheel
from tests.laws.common import derived
from wmrgen.analysis.mobility.records import Mobility, Rank
from wmrgen.geometry.notation import listed

A, B = AXLE
C = wheel("c", "fixed", 0.0, 0.4)
CASTOR = wheel("k", "castor", -0.3, 0.0, d=-0.04)
FRONT = wheel("f", "steered", 0.5, 0.0)
AHEAD, BEHIND = wheel("p", "fixed", 0.3, 0.0), wheel("q", "fixed", -0.3, 0.0)
ACROSS = wheel("s", "fixed", 0.0, 0.3, heading=math.pi / 2)
OBLIQUE = wheel("t", "fixed", -0.4, 0.0, heading=math.pi / 4)
FOUR = [wheel(n, "fixed", x, y) for n, x, y in (
    ("fl", 0.3, 0.2), ("fr", 0.3, -0.2), ("bl", -0.3, 0.2), ("br", -0.3, -0.2),
)]  # fmt: skip
OMNI = [
    wheel(f"w{k}", "swedish", 0.3 * math.cos(a), 0.3 * math.sin(a), heading=a + math.pi / 2, gamma=0.0)
    for k, a in enumerate((0.0, 2 * math.pi / 3, -2 * math.pi / 3))
]
STEER, SPIN = ("steer", ["a", "b", "c"]), ("spin", ["a", "b", "c"])

SHARED = "a and b share an axle line, so the second adds no constraint."
PAIR = "The fixed wheels a and b forbid motion along the axle: rank C1f = 1."
STEERS = "a, b and c are coupled: their steering angles are equal."


def degrees(m: int, s: int) -> str:
    return f"delta_m = 3 - rank C1 = 3 - {3 - m} = {m}; delta_M = {m} + {s} = {m + s}."


def degenerate(m: int, s: int, why: str) -> str:
    return f"Degenerate: ({m}, {s}) is none of Campion's five types, because {why}."


PARALLEL = (
    "The axles of {} and {} are parallel and distinct: only straight motion along the wheels slides no wheel "
    "(rank C1f = 2)."
)
SINGLE = "its fixed axles are not one line, which leaves a single motion"
SKIDS = (
    "its fixed axles are several parallel lines: it turns only by skidding (skid-steer); kinematics are least squares "
    "and report the residual; effective_track in the robot file would say how far it turns"
)
SIDES = (
    "fl and fr share an axle line, so the second adds no constraint.",
    "bl and br share an axle line, so the second adds no constraint.",
    PARALLEL.format("fl", "bl"),
    degrees(1, 0),
)
CASES: dict[str, tuple[list[dict[str, Any]], list[tuple[str, list[str]]], tuple[str, ...]]] = {
    "one wheel": ([A], [], (
        "The fixed wheel a forbids motion along the axle: rank C1f = 1.", degrees(2, 0),
    )),
    "two on an axle": ([A, B], [], (SHARED, PAIR, degrees(2, 0))),
    "three on an axle": ([A, B, C], [], (
        "a, b and c share an axle line, so the others add no constraint.",
        "The fixed wheels a, b and c forbid motion along the axle: rank C1f = 1.", degrees(2, 0),
    )),
    "castor": ([A, B, CASTOR], [], (
        SHARED, PAIR, "k imposes no sliding constraint: a castor swivels into any motion.", degrees(2, 0),
    )),
    "one behind the other": ([AHEAD, BEHIND], [], (
        PARALLEL.format("p", "q"), degrees(1, 0), degenerate(1, 0, SINGLE),
    )),
    "skid-steer": (FOUR, [], (*SIDES, degenerate(1, 0, SKIDS))),
    "nothing drives it": (
        [w | {"actuated": []} for w in FOUR], [], (*SIDES, degenerate(1, 0, SINGLE)),
    ),
    "one is driven": (
        [w | {"actuated": ["spin"] if k == 2 else []} for k, w in enumerate(FOUR)], [],
        (*SIDES, degenerate(1, 0, SKIDS)),
    ),
    "axles that cross": ([AHEAD, ACROSS], [], (
        "The axles of p and s meet in (0.3, 0.3): only rotation about that point slides no wheel (rank C1f = 2).",
        degrees(1, 0), degenerate(1, 0, SINGLE),
    )),
    "axles of three lines": ([AHEAD, BEHIND, ACROSS, OBLIQUE], [], (
        "The axles of p, q and s meet in no common point: nothing can move (rank C1f = 3).",
        degrees(0, 0), degenerate(0, 0, "no motion is free of sliding"),
    )),
    "car": ([A, B, FRONT], [], (SHARED, PAIR, "Steering f chooses the ICR (delta_s = 1).", degrees(1, 1))),
    "two steered in front": ([A, B, wheel("l", "steered", 0.5, 0.2), wheel("r", "steered", 0.5, -0.2)], [], (
        SHARED, PAIR,
        "Steering l chooses the ICR (delta_s = 1); r must follow, its axle through the same point.", degrees(1, 1),
    )),
    "one steered": ([FRONT], [], ("Steering f turns the axle on which the ICR lies (delta_s = 1).", degrees(2, 1))),
    "four steered": ([*STEERED, FRONT], [], (
        "Steering b and f chooses the ICR (delta_s = 2); a and c must follow, their axles through the same point.",
        degrees(1, 2),
    )),
    "steered to no end": ([AHEAD, BEHIND, wheel("f", "steered", 0.1, 0.5)], [], (
        PARALLEL.format("p", "q"),
        "f can be steered, but one direction alone lets every wheel roll: no degree of freedom of steering is left.",
        degrees(1, 0), degenerate(1, 0, SINGLE),
    )),
    "synchro drive": (STEERED, [STEER, SPIN], (
        STEERS, "a, b and c are coupled: they turn at one speed.",
        "With equal steering the axles stay parallel: only translation remains, omega = 0.",
        "Steering a chooses the direction of motion (delta_s = 1); b and c must point the same way.",
        degrees(1, 1),
    )),
    "two of three steer alike": (STEERED, [("steer", ["b", "c"])], (
        "b and c are coupled: their steering angles are equal.", "The coupled steering admits a plane of twists only.",
        "Steering a chooses the ICR (delta_s = 1); b and c must follow, their axles through the same point.",
        degrees(1, 1),
    )),
    "locked axle": ([A, B], [("spin", ["a", "b"])], (
        SHARED, PAIR, "a and b are coupled: they turn at one speed.",
        "Eliminating the coupled joint rates leaves a further constraint on the body.", degrees(1, 0),
        degenerate(1, 0, "one motion is left, and steering chooses no other: delta_M = 1; each of the five has 2 or 3"),
    )),
    "omni": (OMNI, [], (
        "w0, w1 and w2 impose no sliding constraint: a Swedish wheel moves freely across the axes of its rollers.",
        degrees(3, 0),
    )),
}  # fmt: skip


ALONE = "tolerance: 0\n"


def mobility(
    wheels: list[dict[str, Any]], couplings: list[tuple[str, list[str]]] | None = None, extra: str = ""
) -> Mobility:
    m = derived({"wheels": wheels, "couplings": couplings or []}, extra=extra).derivation.mobility
    assert isinstance(m, Mobility)
    return m


@pytest.mark.parametrize("case", CASES)
def test_every_reason(case: str) -> None:
    wheels, couplings, reasons = CASES[case]
    assert mobility(wheels, couplings).reasons == reasons


@pytest.mark.parametrize(
    ("radius", "joints", "said"),
    [
        (0.1, ["spin"], "The coupled spins admit a plane of twists only."),
        (0.2, ["spin"], "The coupled spins admit a cone of twists only."),
        (
            0.1,
            ["spin", "steer"],
            "With equal steering the axles stay parallel: only translation remains, omega = 0.",
        ),
    ],
)
def test_what_is_coupled_is_what_admits(radius: float, joints: list[str], said: str) -> None:
    """Wheels in line that turn at one speed have their ICR midway, or on a circle where their radii differ."""
    pair = [wheel("a", "steered", 0.5, 0.0), wheel("b", "steered", -0.5, 0.0, r=radius)]
    assert said in mobility(pair, [(joint, ["a", "b"]) for joint in joints]).reasons


def test_lists_in_words() -> None:
    assert [listed(list("abc"[:n])) for n in (1, 2, 3)] == ["a", "a and b", "a, b and c"]


@pytest.mark.parametrize(
    ("wheels", "kind"),
    [
        ([A], (2, 0)),
        ([A, B, FRONT], (1, 1)),
        (STEERED, (1, 2)),
        ([FRONT], (2, 1)),
        (OMNI, (3, 0)),
    ],
)
def test_campions_five_types_are_not_degenerate(wheels: list[dict[str, Any]], kind: tuple[int, int]) -> None:
    m = mobility(wheels)
    assert m.robot_type == kind and not m.degenerate


EXACT = "exactly enough"
ONE, TWO, THREE = (
    f"{n} beyond need: {n} relation{'s' if n > 1 else ''} must hold between the rates" for n in (1, 2, 3)
)
ANGLES = ONE.replace("rates", "angles")


@pytest.mark.parametrize(
    ("wheels", "couplings", "sentences"),
    [
        ([A, B], [], [f"driving: 2 actuated joints for 2 degrees of freedom, {EXACT}"]),
        ([A, B, C], [], [f"driving: 3 actuated joints for 2 degrees of freedom, {ONE}"]),
        ([A | {"actuated": []}], [], ["driving: 0 actuated joints for 2 degrees of freedom, short by 2"]),
        ([A], [], ["driving: 1 actuated joint for 2 degrees of freedom, short by 1"]),
        (FOUR, [], [f"driving: 4 actuated joints for 1 degree of freedom, {THREE}"]),
        ([A, B], [("spin", ["a", "b"])], [f"driving: 1 actuated joint for 1 degree of freedom, {EXACT}"]),
        (OMNI, [], [f"driving: 3 actuated joints for 3 degrees of freedom, {EXACT}"]),
        (OMNI[:2], [], ["driving: 2 actuated joints for 3 degrees of freedom, short by 1"]),
        (
            [CASTOR | {"actuated": ["spin", "steer"]}], [],
            ["driving: 2 actuated joints for 3 degrees of freedom, short by 1"],
        ),
        (
            [CASTOR | {"actuated": ["steer"]}, CASTOR | {"name": "m", "x": 0.3, "actuated": ["spin", "steer"]}], [],
            [f"driving: 3 actuated joints for 3 degrees of freedom, {EXACT}"],
        ),
        (
            [A, B, FRONT], [],
            [f"driving: 3 actuated joints for 1 degree of freedom, {TWO}",
             f"steering: 1 actuated joint for 1 degree of freedom, {EXACT}"],
        ),
        (
            [A, B, FRONT | {"actuated": ["spin"]}], [],
            [
                f"driving: 3 actuated joints for 1 degree of freedom, {TWO}",
                "steering: 0 actuated joints for 1 degree of freedom, short by 1",
            ],
        ),
        (
            STEERED, [],
            [
                f"driving: 3 actuated joints for 1 degree of freedom, {TWO}",
                f"steering: 3 actuated joints for 2 degrees of freedom, {ANGLES}",
            ],
        ),
        (
            STEERED, [STEER, SPIN],
            [f"driving: 1 actuated joint for 1 degree of freedom, {EXACT}",
             f"steering: 1 actuated joint for 1 degree of freedom, {EXACT}"],
        ),
        (
            [AHEAD, BEHIND, wheel("f", "steered", 0.1, 0.5)], [],
            [f"driving: 3 actuated joints for 1 degree of freedom, {TWO}",
             "steering: 1 actuated joint for 0 degrees of freedom, 1 beyond need: "
             "one angle alone lets every wheel roll"],
        ),
    ],
)  # fmt: skip
def test_what_is_driven(
    wheels: list[dict[str, Any]], couplings: list[tuple[str, list[str]]], sentences: list[str]
) -> None:
    assert list(map(str, mobility(wheels, couplings).actuation)) == sentences


@pytest.mark.parametrize(("gap", "close"), [(2e-7, True), (2e-5, False)])
def test_a_rank_near_the_tolerance_is_a_close_call(gap: float, close: bool) -> None:
    m = mobility([A, B | {"x": gap}], extra=ALONE)
    assert m.rank_C1f.value == 2
    assert any("is a close call" in reason for reason in m.reasons) == close


def test_the_margin_of_a_rank() -> None:
    assert Rank(0, 0, (0.0,)).margin == math.inf
    rank = Rank(2, 2, (4.0, 2e-6, 0.0))
    assert rank.margin == pytest.approx(500) and not rank.disagrees
    assert Rank(1, 2, (4.0, 2e-10)).disagrees and not Rank(1, None, (1.0,)).disagrees


def test_exact_axles_that_count_as_one_are_doubted() -> None:
    m = mobility([A, B | {"text": {"x": "1e-10"}}], extra=ALONE)
    assert m.rank_C1f.value == 1 and m.rank_C1f.exact == 2
    (doubt,) = (reason for reason in m.reasons if reason.startswith("rank C1f is"))
    assert doubt.startswith(
        "rank C1f is 2 in exact arithmetic but 1 at the tolerance 1e-9, which rules: singular values"
    )
