"""How certain a calibration is: random walks are found back in residuals, and what they do to the gradient."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tools.calibrating.simulated import LAYOUTS, Encoders, Layout, Tracker, csv, drive
from tests.tools.calibrating.test_calibrate import derivation_of
from wmrgen.errors import UsageError
from wmrgen.tools.calibrating.calibrate import calibrate, problem_of
from wmrgen.tools.calibrating.certainty import Fit, _jackknife, _pull, _pulls, bent, fit, student
from wmrgen.tools.calibrating.clocks import ALONE, shown
from wmrgen.tools.calibrating.drifts import Drift, _drifts
from wmrgen.tools.calibrating.fit import LEVER, Residuals, _middle, serial, start_of
from wmrgen.tools.calibrating.logs import Drive, read
from wmrgen.tools.calibrating.mistakes import near_nominal, refuse_strangers
from wmrgen.tools.calibrating.outliers import Outlier, _large, _peaks, _steps_of
from wmrgen.tools.calibrating.starts import _bearing, laid
from wmrgen.tools.calibrating.walks import spans_of, walk_of

ALONG, ACROSS, TURN = 4e-6, 1e-6, 9e-6  # m^2/s, m^2/s, rad^2/s
NOISE = np.array([2e-3, 3e-3])  # m, rad
SPEED, STEP, COUNT = 0.3, 0.1, 1200


def _drive(random: np.random.Generator, heading: float) -> Residuals:
    """Residuals of a robot that drives straight on along ``heading``: its heading error moves all that follows."""
    walk = np.cumsum(
        random.normal(size=(3, COUNT)) * np.sqrt(np.array([[ALONG], [ACROSS], [TURN]]) * STEP), axis=1
    )
    sideways = SPEED * STEP * np.cumsum(walk[2])
    place = np.exp(1j * heading) * (walk[0] + 1j * (walk[1] + sideways))
    seen = [place.real, place.imag, walk[2]] + random.normal(size=(3, COUNT)) * NOISE[[0, 0, 1], None]
    return Residuals(
        seen * np.array([[1], [1], [LEVER]]), np.zeros((3, COUNT, 1)), np.ones((3, COUNT)),
        SPEED * STEP * np.arange(COUNT) * np.exp(1j * heading), np.full(COUNT, heading),
    )  # fmt: skip


@pytest.mark.parametrize(("lasts", "tells"), [(0.49, False), (0.6, True)])
def test_a_truth_of_half_a_second_tells_nothing_of_slips(lasts: float, tells: bool) -> None:
    """Its errors have one mean, which nothing later differs from: it was a LinAlgError."""
    t = np.linspace(0.0, lasts, COUNT)
    spans = spans_of(t, _drive(np.random.default_rng(4), 0.0), np.ones((3, COUNT), dtype=bool))
    assert (spans is not None) == tells and (spans is None or np.isfinite(spans).all())


@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_random_walks_and_noise_are_found_back(heading: float) -> None:
    random, t = np.random.default_rng(4), STEP * np.arange(COUNT)
    drives = [_drive(random, heading) for _ in range(40)]
    spans = [spans_of(t, rows, rows.weights > 0) for rows in drives]
    assert all(part is not None for part in spans)
    wanted = [ALONG, ACROSS, TURN, NOISE[0] ** 2, NOISE[1] ** 2]
    assert walk_of([part for part in spans if part is not None]) == pytest.approx(wanted, rel=0.25)


def test_a_drive_that_is_hardly_measured_says_nothing() -> None:
    rows = _drive(np.random.default_rng(5), 0.0)
    assert spans_of(STEP * np.arange(COUNT), rows, np.zeros((3, COUNT), bool)) is None
    assert list(walk_of([])) == [0.0] * 5


@pytest.mark.parametrize("noisy", [0, 1])
def test_what_slips_and_noise_do_to_the_gradient(noisy: int) -> None:
    """The same, slip by slip: one along, across or about the robot moves and turns all residuals from then on. A first
    pose whose error is known is not as noisy as others."""
    random = np.random.default_rng(6)
    count, unknowns = 7, 3
    t = np.cumsum(random.uniform(0.1, 0.4, count))
    by, weights = random.normal(size=(3, count, unknowns)), random.uniform(0.5, 1, (3, count))
    place, heading = random.normal(size=count) + 1j * random.normal(size=count), random.normal(size=count)
    rows = Residuals(np.zeros((3, count)), by, weights, place, heading)
    pulls = _pulls(_pull(0.02, rows), t, rows, noisy)

    gradient = weights[..., None] / 0.02**2 * by

    def moved(k: int, step: complex, turn: float) -> np.ndarray:
        way = step + 1j * turn * (place[k:] - place[k])
        effects = np.array([way.real, way.imag, np.full(count - k, LEVER * turn)])
        return np.einsum("rn,rnu->u", effects, gradient[:, k:])

    wanted = np.zeros((5, unknowns, unknowns))
    for k, lasting in enumerate(np.diff(t, prepend=t[0])):
        ahead = np.exp(1j * heading[k])
        for kind, (step, turn) in enumerate(((ahead, 0.0), (1j * ahead, 0.0), (0j, 1.0))):
            wanted[kind] += lasting * np.outer(moved(k, step, turn), moved(k, step, turn))
        for row, kind, size in ((0, 3, 1.0), (1, 3, 1.0), (2, 4, LEVER)):
            wanted[kind] += (k >= noisy) * size**2 * np.outer(gradient[row, k], gradient[row, k])
    np.testing.assert_allclose(pulls, wanted, rtol=1e-9)


def test_drives_that_differ_by_more_than_their_own_slips_make() -> None:
    """Means of all readings but one are the jackknife's textbook case: its deviation is that of the mean. A parameter
    that one drive alone tells differs without it, and that counts for nothing."""
    readings, inside = np.array([1.0, 1.3, 0.8, 1.1, 0.9]), np.array([0.01, 0.2])
    values = np.array([(readings[np.arange(5) != k].mean(), 9.0 * (k == 0)) for k in range(5)])
    deviations = np.array([(0.01, 5.0 if k == 0 else 0.2) for k in range(5)])
    assert _jackknife(inside, values, deviations) == pytest.approx([readings.std(ddof=1) / 5**0.5, 0.2])
    assert _jackknife(inside, values[:2], deviations[:2]) is inside


@pytest.mark.parametrize(
    ("freedom", "three"),
    [(1, 235.80), (2, 19.207), (4, 6.620), (10, 3.957), (100, 3.077), (0, np.inf), (-2, np.inf)],
)
def test_few_measurements_more_than_unknowns(freedom: int, three: float) -> None:
    """99.73 % of Student's distribution lie within so many standard deviations (JCGM 100:2008, table G.2)."""
    assert 3 * student(freedom) == pytest.approx(three, rel=1e-3)


def _near(tmp_path: Path, layout: Layout, seed: int) -> Fit:
    """The fit of drives of wheels that slip, where what runs off is held nominal."""
    problem, drives = problem_of(derivation_of(tmp_path, layout)), list[Drive]()
    for index, twist in enumerate(layout.drives, seed):
        tracker, encoders = Tracker(0.03 - 0.02j, noise=(0.002, 0.003)), Encoders(2 * np.pi / 400, slip=0.01)
        recorded = drive(layout, twist, rate=10, tracker=tracker, encoders=encoders, seed=index)
        log, truth = tmp_path / f"{index}.csv", tmp_path / f"{index}.truth.csv"
        log.write_text(csv(recorded.log), encoding="utf-8")
        truth.write_text(csv(recorded.truth), encoding="utf-8")
        drives.append(read(log, truth, problem.increments.joints, {}))
    ready = laid(replace(problem, drives=tuple(drives)))
    return near_nominal(fit(ready, serial, start_of(ready)), lambda problem: problem, serial)


def test_parameters_that_are_held_nominal_move_the_others(tmp_path: Path) -> None:
    """What three omni wheels do not tell in circles lies along a curve: the third radius was told ten times as sure."""
    circles = (lambda t: (0.3 + 0 * t, 0 * t, 0.4 + 0 * t), lambda t: (0.3 + 0 * t, 0 * t, -0.4 + 0 * t))
    layout = replace(LAYOUTS["three_omni"], drives=circles)
    near = _near(tmp_path, layout, seed=10)
    assert near.problem.held is not None and near.problem.held.shape[1] == 1
    off = np.abs(np.subtract(near.values, [layout.true[p] for p in near.problem.increments.parameters]))
    assert np.any(off > 2 * near.deviations)
    after = bent(near, near.problem, serial)
    assert np.all(off < after.deviations) and np.all(after.deviations < 0.12 * np.array(near.values))
    assert after.deviations[0] == pytest.approx(near.deviations[0], rel=0.1)  # nearly the direction's own


def test_what_drives_do_not_tell_is_about_nominal(tmp_path: Path) -> None:
    """On straight lines slips took the tilt of rollers from 0.7 to 1.5 rad, told as certain to 0.05 rad."""
    lines = (
        lambda t: (0.3 + 0.1 * np.sin(t / 2), 0 * t, 0 * t),
        lambda t: (0.1 * np.sin(t / 2) - 0.3, 0 * t, 0 * t),
    )
    near = _near(tmp_path, replace(LAYOUTS["mecanum"], drives=lines), seed=0)
    assert near.values == pytest.approx(near.problem.nominal, rel=0.03)


@pytest.mark.parametrize("late", [(0.0, 0.0, 0.0), (-0.3, 0.2, 0.05)])
def test_clocks_that_agree_and_clocks_that_differ(tmp_path: Path, late: tuple[float, ...]) -> None:
    """Wheels that slip move offsets of clocks: where clocks agree, that is taken from them; where they differ by far
    more than that, the offsets stay what each drive says."""
    layout, paths = LAYOUTS["mecanum"], list[Path]()
    for index, (twist, seconds) in enumerate(zip(layout.drives, late, strict=True)):
        tracker = Tracker(late=seconds, noise=(0.002, 0.003))
        recorded = drive(layout, twist, tracker=tracker, encoders=Encoders(slip=0.05), seed=index)
        paths.append(tmp_path / f"{index}.csv")
        paths[-1].write_text(csv(recorded.log), encoding="utf-8")
        paths[-1].with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
    best = calibrate(derivation_of(tmp_path, layout), paths, []).fit
    alone = fit(replace(best.problem, clocks=ALONE), serial, start_of(best.problem))
    errors, of_each = (np.abs(np.subtract(which.offsets, late)) for which in (best, alone))
    assert np.all(of_each > 0.005) and np.all(of_each < 3 * 0.1 * np.sqrt(alone.spread[0]))
    if any(late):
        assert best.offsets == pytest.approx(alone.offsets, abs=0.001)
    else:
        assert np.all(errors < 0.5 * of_each)


@pytest.mark.parametrize(
    ("mean", "apart", "error"), [(0.0, 0.0, 1.0), (-3.0, 0.0, 1.0), (2.0, 4.0, 0.5), (0.0, 3.0, 2.0)]
)
def test_mean_and_variance_of_clocks_are_found_back(mean: float, apart: float, error: float) -> None:
    """Of 2000 drives, whose errors are unequal; a single drive's offset is less by its own chance alone."""
    random = np.random.default_rng(7)
    errors = error * random.uniform(0.5, 2, 2000)
    offsets = random.normal(mean, apart, 2000) + errors * random.normal(size=2000)
    clocks = shown(offsets, errors**2, errors**2 / 9)
    assert clocks.counted == pytest.approx(9)
    assert abs(clocks.late - mean) < 3 * clocks.error < 0.5
    assert clocks.apart == pytest.approx(apart, abs=0.2)
    one = shown(np.array([4.0]), np.array([1.0]), np.array([1.0]))
    assert one.late == pytest.approx(4 - 1 / 4, abs=1e-3) and one.apart < 0.02


def test_slips_are_at_the_peaks_of_what_is_unusual() -> None:
    """Above 1, and above 0.6 of the largest of eight steps before and after."""
    unusual = np.array([0.9, 0, 2.9, 5, 3.1, *[0] * 8, 1.1, 0.9, *[0] * 20, 1.5])
    assert unusual[_peaks(unusual)].tolist() == [5, 3.1, 1.1, 1.5]
    assert not len(_peaks(np.array([])))


def test_a_slip_that_a_larger_one_may_make_is_left_for_later() -> None:
    """All that joints tell are taken at once."""
    slips = [
        Outlier("run", t, t + 1, moved, turned)
        for t, moved, turned in [(1, 0.1, 1), (9, 0.05, 0), (20, 0, 0.6)]
    ]
    assert [slip.start for slip in _large(slips)] == [1, 20]
    assert len(_large([replace(slip, moved=np.nan, turned=np.nan) for slip in slips])) == 3
    assert _large([]) == []


@pytest.mark.parametrize("ahead", [1, 1j])
def test_a_slip_along_either_axis_is_a_step_of_the_path(ahead: complex) -> None:
    """Ten centimetres at once, and no turn."""
    t = STEP * np.arange(300)
    off = 0.1 * ahead * (t > 15)
    values, place = np.array([off.real, off.imag, 0 * t]), SPEED * t * ahead + off
    rows = Residuals(values, np.zeros((3, 300, 1)), np.ones((3, 300)), place, np.zeros(300))
    at, (moved, turned) = _steps_of(rows, t)
    assert moved.max() == pytest.approx(0.1) and 13 <= at[np.argmax(moved)] <= 15
    assert not turned.any()


@pytest.mark.parametrize(
    ("off", "turned", "words"),
    [
        (0.2, 0.51, "headings of b stay 0.51 rad"),
        (0.2, 0.49, "positions of b stay 0.2 m"),
        (0.0, 3.0, "headings of b stay 3 rad"),
    ],
)
def test_what_keeps_log_and_truth_apart_is_said(
    off: float, turned: float, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("strange", True), ("_unlikely", ""), ("_hint_of_some", "look"), ("_extent", 1.0)):
        monkeypatch.setattr(f"wmrgen.tools.calibrating.mistakes.{name}", lambda *_, value=value: value)
    with pytest.raises(UsageError, match=f"{words} from the truth.*: look"):
        best: Any = SimpleNamespace(
            rms_by_drive=np.array([(0.0, 0.0), (off, turned)]), offsets=(0.0, 0.0),
            problem=SimpleNamespace(drives=[SimpleNamespace(name=name) for name in "ab"]),
        )  # fmt: skip
        refuse_strangers(best, best.problem.drives, lambda _: best)


@pytest.mark.parametrize(("count", "size"), [(0, 0.0), (11, 3 / 11**0.5), (12, 0.0)])
def test_few_residuals_count_by_their_squares(count: int, size: float) -> None:
    """A drive of so few that its own unknowns take most up has a median of nearly nothing; one of none has none."""
    assert _middle(np.array([3.0, *[0.0] * count])[:count]) == pytest.approx(size)


PIECES = np.linspace(2.0, 42.0, 11)


@pytest.mark.parametrize(
    ("clock", "heading", "told"),
    [
        (0.1 + 0 * PIECES[:10], 0 * PIECES[:10], []),
        (0.7 * (np.arange(10) > 3), 0 * PIECES[:10], [Drift("a", 14.0, 18.0, 0.7, 0.0, True)]),
        (0.7 * (np.arange(10) > 8), 0 * PIECES[:10], []),  # one piece tells nothing
        (0.2 * (np.arange(10) > 3), 0 * PIECES[:10], []),
        (0.01 * PIECES[:10], 0 * PIECES[:10], [Drift("a", 2.0, 42.0, 0.4, 0.0)]),
        (0.004 * PIECES[:10], 0 * PIECES[:10], []),
        (0 * PIECES[:10], -0.002 * PIECES[:10], [Drift("a", 2.0, 42.0, 0.0, -0.08)]),
        (0 * PIECES[:10], -0.001 * PIECES[:10], []),
        (0.4 * (-1.0) ** np.arange(10), 0.3 * np.sin(np.arange(10)), []),  # neither a line nor a jump
    ],
)
def test_drifts_and_jumps_are_told_from_what_differs(
    clock: np.ndarray, heading: np.ndarray, told: list[Drift]
) -> None:
    """By pieces of a drive, where a line or a jump explains it, and from 0.2 s, 0.05 rad and 0.3 s on."""
    noise = 0.005 * np.random.default_rng(2).standard_normal((2, 10))
    result = _drifts("a", PIECES, clock + noise[0], heading + noise[1])
    assert [(d.drive, d.start, d.end, d.at_once) for d in result] == [
        (d.drive, d.start, d.end, d.at_once) for d in told
    ]
    for one, expected in zip(result, told, strict=True):
        assert (one.late, one.turned) == pytest.approx((expected.late, expected.turned), abs=0.02)


@pytest.mark.parametrize("bearing", [-2.0, 0.3, 3.0])
def test_places_alone_tell_where_a_robot_looked_first(bearing: float) -> None:
    """z = z0 + exp(i s) (p + exp(i phi) m), with s the bearing; of three places by the way alone; of one not."""
    phi = np.sin(0.1 * np.arange(100))
    p = np.cumsum(0.1 * np.exp(1j * phi))
    z = 3 - 1j + np.exp(1j * bearing) * (p + np.exp(1j * phi) * (0.2 + 0.1j))
    assert _bearing(z, p, phi) == pytest.approx(bearing, abs=1e-3)
    ahead = 3 - 1j + np.exp(1j * bearing) * p
    assert _bearing(ahead[:3], p[:3], phi[:3]) == pytest.approx(bearing, abs=1e-3)
    assert _bearing(z[:1], p[:1], phi[:1]) == 0
