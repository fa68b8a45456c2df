"""`inverse_together`: one branch for all modules, limits kept."""

from __future__ import annotations

import itertools
import math
import random

import pytest

from tests.depth import everyday
from tests.functions.control.corners import (
    CORNERS,
    FLOAT32,
    SWERVE,
    call,
    derived,
    robot_text,
    steers,
    twists,
)
from tests.functions.refusals import refused
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason
from wmrgen.ir.interpret import evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS, Choice
from wmrgen.ir.rounding import nearest_float32


@pytest.fixture(scope="module")
def free() -> Derivation:
    return derived(robot_text(SWERVE), "inverse_together")


def presents(count: int, span: float) -> list[dict[str, float]]:
    source = random.Random(5)
    return [steers([source.uniform(-span, span) for _ in CORNERS]) for _ in range(count)]


def test_forward_gives_the_twist_back(free: Derivation) -> None:
    for twist, present in zip(twists(80), presents(80, 9.0), strict=True):
        driven = call(free, "forward", call(free, "inverse_together", twist | present))
        assert all(driven[n] == pytest.approx(v, abs=1e-12) for n, v in twist.items())


def test_all_drive_the_same_way(free: Derivation) -> None:
    seen = set()
    for twist, present in zip(twists(80), presents(80, 9.0), strict=True):
        spins = [call(free, "inverse_together", twist | present)[f"{n}.spin"] for n in CORNERS]
        assert all(s > 0 for s in spins) or all(s < 0 for s in spins)
        seen.add(spins[0] > 0)
    assert seen == {True, False}


def test_nobody_swings_to_the_other_side(free: Derivation) -> None:
    """Near 90 degrees of swing `inverse` sends neighbours to opposite sides; together they stay within 15 degrees."""
    apart = 0
    for k in range(-20, 21):
        twist = {"vx": 0.01 * k, "vy": 1.0, "omega": 0.2}
        alone, together = (
            [call(free, name, {**twist, **steers([0.0] * 4)})[f"{n}.steer"] for n in CORNERS]
            for name in ("inverse", "inverse_together")
        )
        apart += max(alone) - min(alone) > 3.0
        assert max(together) - min(together) < math.radians(15)
        assert max(map(abs, together)) < math.radians(105)
    assert apart > 3


def test_like_inverse_where_inverse_agrees_with_itself(free: Derivation) -> None:
    same = 0
    for twist, present in zip(twists(200, 2), presents(200, 0.6), strict=True):
        alone = call(free, "inverse", twist | present)
        if len({alone[f"{n}.spin"] > 0 for n in CORNERS}) == 1:
            same += 1
            together = call(free, "inverse_together", twist | present)
            assert all(together[k] == pytest.approx(v, abs=1e-12) for k, v in alone.items())
    assert same > 20


def test_standstill_holds(free: Derivation) -> None:
    present = steers([0.1, -2.0, 7.0, 3.1])
    commands = call(free, "inverse_together", {"vx": 0.0, "vy": 0.0, "omega": 0.0, **present})
    assert {k: v for k, v in commands.items() if k.endswith("steer")} == present
    assert all(commands[f"{n}.spin"] == 0 for n in CORNERS)


def test_a_wheel_at_the_icr_holds(free: Derivation) -> None:
    """The ICR in one pivot; the others, turned backwards, do not turn that wheel."""
    present = steers([0.3, 2.0, 2.0, 2.0])
    commands = call(free, "inverse_together", {"vx": 0.25, "vy": -0.3, "omega": 1.0, **present})
    assert commands["fl.steer"] == 0.3 and commands["fl.spin"] == 0


@pytest.mark.parametrize("limit", [95, 120, 170, 200])
def test_steering_limits(limit: int) -> None:
    """Never outside; nothing slides where one of the two choices is inside for every wheel."""
    d = derived(robot_text(SWERVE, f"limits: {{steer: {limit} deg}}"), "inverse_together")
    top = math.radians(limit)
    slid = 0
    for twist, present in zip(twists(150), presents(150, top), strict=True):
        commands = call(d, "inverse_together", twist | present)
        assert all(abs(commands[f"{n}.steer"]) <= top + 1e-12 for n in CORNERS)
        slid += commands["slip"] > 1e-9
        assert (commands["slip"] > 1e-9) <= (not _reachable(twist, top))
        if commands["slip"] < 1e-9:
            spins = [commands[f"{n}.spin"] for n in CORNERS]
            assert all(s > 0 for s in spins) or all(s < 0 for s in spins)
    assert slid > 0 if limit < 130 else slid < 5


@pytest.mark.parametrize("limit", everyday([60, 75, 80, 85], [80]))
def test_both_ways_as_far_outside(limit: int) -> None:
    """Straight to the side: no rounding sends modules that stand at one limit to the other."""
    d = derived(robot_text(SWERVE, f"limits: {{steer: {limit} deg}}"), "inverse_together")
    top, source = math.radians(limit), random.Random(7)
    cases = []
    for _ in range(60):
        standing = [top + source.uniform(-0.02, 0.02) for _ in CORNERS]
        cases.append({"vx": 0.0, "vy": source.uniform(0.2, 2), "omega": 0.0, **steers(standing)})
    requests = [("inverse_together", case) for case in cases]
    for scalar in ("double", "float"):
        for commands in evaluate_c(d.c_module, requests, Choice(scalar)):
            assert all(commands[f"{n}.steer"] == pytest.approx(top, abs=1e-6) for n in CORNERS)
    for case in cases[:10]:
        assert all(call(d, "inverse_together", case)[f"{n}.steer"] == pytest.approx(top) for n in CORNERS)


def _reachable(twist: dict[str, float], top: float) -> bool:
    """All pivots' headings inside the limits, driving all forwards or all backwards."""
    headings = []
    for a, b in CORNERS.values():
        x = twist["vx"] - 0.25 * b * twist["omega"]
        y = twist["vy"] + 0.3 * a * twist["omega"]
        headings.append(math.atan2(y, x))
    return any(
        all(any(abs(h + shift + turn) < top for turn in (-math.tau, 0, math.tau)) for h in headings)
        for shift in (0, math.pi)
    )


@pytest.mark.parametrize("limit", everyday([50, 60, 75, 80, 88, 90, 92, 100, 120], [80, 90]))
def test_modules_that_stand_alike_keep_the_heading_that_inverse_keeps(limit: int) -> None:
    """To both sides of every line at which a wheel swings over."""
    d = derived(robot_text(SWERVE, f"limits: {{steer: {limit} deg}}"), "inverse_together")
    beyond = 0
    for line, beside, k in itertools.product((limit, limit + 5, 90, 92.5, 95, 40), (-0.02, 0.02), range(7)):
        angle, standing = math.radians(line + beside), math.radians(limit) * (k - 3) / 3
        twist = {"vx": math.cos(angle), "vy": math.sin(angle), "omega": 0.0} | steers([standing] * 4)
        alone, together = (call(d, name, twist) for name in ("inverse", "inverse_together"))
        assert all(together[key] == pytest.approx(value, abs=1e-9) for key, value in alone.items()), twist
        beyond += together["slip"] > 1e-9
    assert (beyond > 0) == (limit < 95)


@pytest.mark.parametrize("limit", everyday([50, 75, 90, 92, 120, 170, 180, 182], [90, 180]))
def test_noise_swings_no_module_to_and_fro(limit: int) -> None:
    """1 mm/s of noise, modules at their stops and elsewhere: once at most they all turn round."""
    d = derived(robot_text(SWERVE, f"limits: {{steer: {limit} deg}}"), "inverse_together")
    inverse, source = d.numpy().inverse_together, random.Random(limit)
    sideways = [{"vx": 0.0, "vy": 0.3, "omega": w} for w in (0.0, 0.2)]
    for base in [*sideways, {"vx": -0.3, "vy": 0.0, "omega": 0.0}, *twists(5, limit)]:
        for stop in (-limit, 0, limit):
            standing = steers([math.radians(stop)] * 4)
            swings = -1  # the first is to where it goes
            for _ in range(60):
                noisy = {name: value + source.uniform(-1e-3, 1e-3) for name, value in base.items()}
                commands = inverse(**noisy, **standing)
                swings += any(abs(commands[name] - value) > 0.1 for name, value in standing.items())
                standing = {name: commands[name] for name in standing}
            assert swings <= 1, (base, stop)


def test_coupled_pairs_are_one_module() -> None:
    text = robot_text(SWERVE, "couplings: [{equal: [fl.steer, fr.steer]}, {equal: [bl.steer, br.steer]}]")
    d = derived(text, "inverse_together")
    for twist, present in zip(twists(60), presents(60, 3.0), strict=True):
        now = {**present, "fr.steer": present["fl.steer"], "br.steer": present["bl.steer"]}
        commands = call(d, "inverse_together", {**twist, "omega": 0.0, **now})
        assert commands["fl.steer"] == commands["fr.steer"] and commands["bl.steer"] == commands["br.steer"]
        spins = [commands[f"{n}.spin"] for n in CORNERS]
        assert all(s > 0 for s in spins) or all(s < 0 for s in spins)
        assert commands["slip"] < 1e-9


def test_one_motor_needs_no_agreement() -> None:
    text = robot_text(SWERVE, "couplings: [{equal: [fl.steer, fr.steer, bl.steer, br.steer]}]")
    with refused(Reason.SHARED_MOTOR, "inverse"):
        _ = derived(text, "inverse_together").program


QUARTER = nearest_float32(math.pi / 2)
ZEROS = [
    dict(zip(("vx", "vy", "omega"), twist, strict=True)) | steers([angle] * 4)
    for twist in itertools.product((0.0, -0.0, 1.0, -1.0), repeat=3)
    for angle in (0.0, -0.0, QUARTER, -QUARTER, 2 * QUARTER)
]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("limits", ["", "limits: {steer: 170 deg}"])
def test_zeros_of_both_signs_and_exact_quarter_turns(target: str, limits: str) -> None:
    """All wheels drive the twist, on one branch, whichever sign a zero has (`{-0.0f, -1, 0}` did not)."""
    d = derived(robot_text(SWERVE, limits), "inverse_together")
    code = expand(d.c_module, "float", "inline", target)
    for case in ZEROS:
        commands = evaluate(code.function("inverse_together"), case, FLOAT32)
        back = call(d, "forward", commands)
        assert all(back[n] == pytest.approx(case[n], abs=2e-6) for n in ("vx", "vy", "omega")), case
        spins = [commands[f"{n}.spin"] for n in CORNERS]
        assert all(s >= 0 for s in spins) or all(s <= 0 for s in spins), case


def test_c_takes_the_branch_that_the_interpreter_predicts_beside_minus_zero(free: Derivation) -> None:
    code = expand(free.c_module, "float", "inline", "m4f").function("inverse_together")
    answers = evaluate_c(free.c_module, [("inverse_together", case) for case in ZEROS])
    for case, answer in zip(ZEROS, answers, strict=True):
        predicted = evaluate(code, case, FLOAT32)
        assert all(answer[k] == v for k, v in predicted.items() if k in answer), case
