"""Plans: courses that a robot can drive, and which of them determine its parameters."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tools.calibration.drives import derived
from tests.tools.calibration.simulated import LAYOUTS
from wmrgen.tools.calibration.plan import blind as blind_of
from wmrgen.tools.calibration.plan import courses, plan, problem_of_plan


@pytest.mark.parametrize(("name", "count"), [("differential", 5), ("three_omni", 5)])
def test_every_course_ends_where_it_began(name: str, count: int) -> None:
    """And turns as far to one side as to the other, at half of the speeds that the robot may have."""
    proposed = courses(derived(LAYOUTS[name].text))
    assert len(proposed) == count
    assert [c.seconds for c in proposed] == sorted(c.seconds for c in proposed)
    for course in proposed:
        place, heading = 0j, 0.0
        for segment in course.segments:
            vx, vy, omega = segment.twist
            assert max(abs(vx), abs(vy)) in (0, 0.5) and abs(omega) <= 1
            fine = heading + omega * segment.seconds * (np.arange(1000) + 0.5) / 1000
            place += complex(vx, vy) * segment.seconds * np.exp(1j * fine).mean()
            heading += omega * segment.seconds
        assert (abs(place), heading) == pytest.approx((0, 0), abs=1e-9), course.text


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[] if n in ("differential", "mecanum", "tricycle") else pytest.mark.slow)
        for n in LAYOUTS
    ],
)
def test_plans_determine_what_can_be_determined(name: str) -> None:
    """Courses are offered; no drive determines parameters that belong together; a finer precision takes longer."""
    layout = LAYOUTS[name]
    derivation = derived(layout.text)
    problem, choices, blind = problem_of_plan(derivation)
    assert {n for group in blind for n in group} == set(layout.together)
    chosen = plan(choices, problem, 0.05)
    assert chosen
    assert all(course in courses(derivation) for course in chosen)
    finer = plan(choices, problem, 0.01)
    assert finer is None or sum(c.seconds for c in finer) >= sum(c.seconds for c in chosen)
    assert plan(choices, problem, 1e-6) is None


def test_a_track_needs_a_course_with_turns() -> None:
    """The plan of a differential drive has a course with turns."""
    derivation = derived(LAYOUTS["differential"].text)
    problem, choices, _ = problem_of_plan(derivation)
    chosen = plan(choices, problem, 0.02)
    assert chosen is not None
    assert any(segment.twist[2] for course in chosen for segment in course.segments)
    lines = [offer for offer in choices if not any(segment.twist[2] for segment in offer.course.segments)]
    assert [set(group) for group in blind_of(lines, problem)] == [{"half_track"}]


def test_logs_that_exist_count() -> None:
    """With the shares of a whole plan, nothing is left to drive."""
    problem, choices, _ = problem_of_plan(derived(LAYOUTS["differential"].text))
    chosen = plan(choices, problem, 0.02)
    assert chosen is not None
    before = [offer.share for offer in choices if offer.course in chosen]
    assert plan(choices, problem, 0.02, before) == ()
