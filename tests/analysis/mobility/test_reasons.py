"""The reasons of small robots, worked out by hand: which there are, and their names and numbers."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest

from tests.analysis.mobility.test_couplings import AXLE, STEERED, wheel
from tests.laws.common import derived
from wmrgen.analysis.mobility.records import Mobility, Rank, Reason
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

# A reason as its key, the names of wheels and keys in it, and its numbers.
CASES: dict[str, tuple[list[dict[str, Any]], list[tuple[str, list[str]]], tuple[str, ...]]] = {
    "one wheel": ([A], [], (
        "fixed_axle a 1",
        "degrees 3 3 1 2 2 0 2",
    )),
    "two on an axle": ([A, B], [], (
        "shared_axle_line a b",
        "fixed_axle a b 1",
        "degrees 3 3 1 2 2 0 2",
    )),
    "three on an axle": ([A, B, C], [], (
        "shared_axle_line a b c",
        "fixed_axle a b c 1",
        "degrees 3 3 1 2 2 0 2",
    )),
    "castor": ([A, B, CASTOR], [], (
        "shared_axle_line a b",
        "fixed_axle a b 1",
        "no_sliding_constraint k",
        "degrees 3 3 1 2 2 0 2",
    )),
    "one behind the other": ([AHEAD, BEHIND], [], (
        "parallel_axles p q 2",
        "degrees 3 3 2 1 1 0 1",
        "single_motion 1 0",
    )),
    "skid-steer": (FOUR, [], (
        "shared_axle_line fl fr",
        "shared_axle_line bl br",
        "parallel_axles fl bl 2",
        "degrees 3 3 2 1 1 0 1",
        "skid_steer 1 0 effective_track",
    )),
    "nothing drives it": ([w | {"actuated": []} for w in FOUR], [], (
        "shared_axle_line fl fr",
        "shared_axle_line bl br",
        "parallel_axles fl bl 2",
        "degrees 3 3 2 1 1 0 1",
        "single_motion 1 0",
    )),
    "one is driven": ([w | {"actuated": ["spin"] if k == 2 else []} for k, w in enumerate(FOUR)], [], (
        "shared_axle_line fl fr",
        "shared_axle_line bl br",
        "parallel_axles fl bl 2",
        "degrees 3 3 2 1 1 0 1",
        "skid_steer 1 0 effective_track",
    )),
    "axles that cross": ([AHEAD, ACROSS], [], (
        "common_point p s 0.3 0.3 2",
        "degrees 3 3 2 1 1 0 1",
        "single_motion 1 0",
    )),
    "axles of three lines": ([AHEAD, BEHIND, ACROSS, OBLIQUE], [], (
        "no_common_point p q s 3",
        "degrees 3 3 3 0 0 0 0",
        "immobile 0 0",
    )),
    "car": ([A, B, FRONT], [], (
        "shared_axle_line a b",
        "fixed_axle a b 1",
        "steers_icr f 1",
        "degrees 3 3 2 1 1 1 2",
    )),
    "two steered in front": ([A, B, wheel("l", "steered", 0.5, 0.2), wheel("r", "steered", 0.5, -0.2)], [], (
        "shared_axle_line a b",
        "fixed_axle a b 1",
        "steers_icr l 1 r",
        "degrees 3 3 2 1 1 1 2",
    )),
    "one steered": ([FRONT], [], (
        "steers_axle f 1",
        "degrees 3 3 1 2 2 1 3",
    )),
    "four steered": ([*STEERED, FRONT], [], (
        "steers_icr b f 2 a c",
        "degrees 3 3 2 1 1 2 3",
    )),
    "steered to no end": ([AHEAD, BEHIND, wheel("f", "steered", 0.1, 0.5)], [], (
        "parallel_axles p q 2",
        "steering_without_effect f",
        "degrees 3 3 2 1 1 0 1",
        "single_motion 1 0",
    )),
    "synchro drive": (STEERED, [STEER, SPIN], (
        "coupled a b c",
        "coupled a b c",
        "only_translation 0",
        "steers_direction a 1 b c",
        "degrees 3 3 2 1 1 1 2",
    )),
    "two of three steer alike": (STEERED, [("steer", ["b", "c"])], (
        "coupled b c",
        "admissible_plane",
        "steers_icr a 1 b c",
        "degrees 3 3 2 1 1 1 2",
    )),
    "locked axle": ([A, B], [("spin", ["a", "b"])], (
        "shared_axle_line a b",
        "fixed_axle a b 1",
        "coupled a b",
        "coupling_constraint",
        "degrees 3 3 2 1 1 0 1",
        "no_choice 1 0 1 2 3",
    )),
    "omni": (OMNI, [], (
        "no_sliding_constraint w0 w1 w2",
        "degrees 3 3 0 3 3 0 3",
    )),
}  # fmt: skip


def summary(reason: Reason) -> str:
    parts = re.findall(r"`([^`]+)`|(?<![\w.`-])(-?\d+(?:\.\d+)?)(?![\w.]*\w)", reason.text)
    return " ".join([reason.key, *("".join(part) for part in parts)])


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
    m = mobility(wheels, couplings)
    assert tuple(map(summary, m.explanation)) == reasons
    assert m.reasons == tuple(reason.text.replace("`", "") for reason in m.explanation)
    repeats = ("coupled", "degrees", "aligned")
    assert m.argument == tuple(reason.text for reason in m.explanation if reason.key not in repeats)


@pytest.mark.parametrize(
    ("radius", "joints", "key", "named"),
    [
        (0.1, ["spin"], "admissible_plane", "spins"),
        (0.2, ["spin"], "admissible_cone", "spins"),
        (0.1, ["spin", "steer"], "only_translation", "steering"),
    ],
)
def test_what_is_coupled_is_what_admits(radius: float, joints: list[str], key: str, named: str) -> None:
    """Wheels in line that turn at one speed have their ICR midway, or on a circle where their radii differ."""
    pair = [wheel("a", "steered", 0.5, 0.0), wheel("b", "steered", -0.5, 0.0, r=radius)]
    found = {r.key: r.text for r in mobility(pair, [(joint, ["a", "b"]) for joint in joints]).explanation}
    assert named in found[key]


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


@pytest.mark.parametrize(
    ("wheels", "couplings", "balances"),
    [
        ([A, B], [], [("spin", 2, 2, 0, 0)]),
        ([A, B, C], [], [("spin", 3, 2, 0, 1)]),
        ([A | {"actuated": []}], [], [("spin", 0, 2, 2, 0)]),
        ([A], [], [("spin", 1, 2, 1, 0)]),
        (FOUR, [], [("spin", 4, 1, 0, 3)]),
        ([A, B], [("spin", ["a", "b"])], [("spin", 1, 1, 0, 0)]),
        (OMNI, [], [("spin", 3, 3, 0, 0)]),
        (OMNI[:2], [], [("spin", 2, 3, 1, 0)]),
        ([CASTOR | {"actuated": ["spin", "steer"]}], [], [("spin", 2, 3, 1, 0)]),
        (
            [CASTOR | {"actuated": ["steer"]}, CASTOR | {"name": "m", "x": 0.3, "actuated": ["spin", "steer"]}],
            [], [("spin", 3, 3, 0, 0)],
        ),
        ([A, B, FRONT], [], [("spin", 3, 1, 0, 2), ("steer", 1, 1, 0, 0)]),
        ([A, B, FRONT | {"actuated": ["spin"]}], [], [("spin", 3, 1, 0, 2), ("steer", 0, 1, 1, 0)]),
        (STEERED, [], [("spin", 3, 1, 0, 2), ("steer", 3, 2, 0, 1)]),
        (STEERED, [STEER, SPIN], [("spin", 1, 1, 0, 0), ("steer", 1, 1, 0, 0)]),
        ([AHEAD, BEHIND, wheel("f", "steered", 0.1, 0.5)], [], [("spin", 3, 1, 0, 2), ("steer", 1, 0, 0, 1)]),
    ],
)  # fmt: skip
def test_what_is_driven(
    wheels: list[dict[str, Any]],
    couplings: list[tuple[str, list[str]]],
    balances: list[tuple[str, int, int, int, int]],
) -> None:
    """Joint, motors, degrees of freedom, those without a motor, and relations between rates."""
    found = mobility(wheels, couplings).actuation
    assert [(b.joint, b.motors, b.need, b.lacking, b.surplus) for b in found] == balances


@pytest.mark.parametrize(("gap", "close"), [(2e-7, True), (2e-5, False)])
def test_a_rank_near_the_tolerance_is_a_close_call(gap: float, close: bool) -> None:
    m = mobility([A, B | {"x": gap}], extra=ALONE)
    assert m.rank_C1f.value == 2
    assert [r.key for r in m.explanation].count("rank_uncertain") == 2 * close  # of C1f and of C1
    assert not close or m.rank_C1f.margin == pytest.approx(1e9 * gap / 2, rel=0.5)


def test_the_margin_of_a_rank() -> None:
    assert Rank(0, 0, (0.0,)).margin == math.inf
    rank = Rank(2, 2, (4.0, 2e-6, 0.0))
    assert rank.margin == pytest.approx(500) and not rank.disagrees
    assert Rank(1, 2, (4.0, 2e-10)).disagrees and not Rank(1, None, (1.0,)).disagrees


def test_exact_axles_that_count_as_one_are_doubted() -> None:
    m = mobility([A, B | {"text": {"x": "1e-10"}}], extra=ALONE)
    assert m.rank_C1f.value == 1 and m.rank_C1f.exact == 2
    (doubt,) = (reason for reason in m.explanation if reason.key == "rank_differs")
    assert {"C1f", "2", "1", "1e-9"} <= {*re.findall(r"[\w.-]*\w", doubt.text)}
