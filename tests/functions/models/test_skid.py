"""`effective_track`: robots that turn by skidding, against wheels that drag over the ground.

The oracle pushes contacts: each wheel's force is against the velocity at which its contact slides (viscous friction),
and at constant speeds forces and moment balance. Its motion is that of a differential drive with some track, which is
then written into the robot file.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.functions.motion.common import run_cli
from tests.functions.refusals import mistaken
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower


@dataclass(frozen=True)
class Base:
    """Wheels (x, y, turned by) in a frame that stands at ``at``, turned by ``heading`` [rad], in the robot's."""

    wheels: tuple[tuple[float, float, float], ...]
    at: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0
    radius: float = 0.165

    @property
    def contacts(self) -> list[tuple[np.ndarray, float]]:
        c, s = cos(self.heading), sin(self.heading)
        turn = np.array([[c, -s], [s, c]])
        return [(turn @ (x, y) + self.at, self.heading + own) for x, y, own in self.wheels]

    def spins(self, left: float, right: float) -> list[float]:
        """Rates [rad/s] for speeds [m/s] of both sides along the base."""
        return [(left if y > 0 else right) * cos(own) / self.radius for _, y, own in self.wheels]

    def dragged(self, spins: list[float]) -> np.ndarray:
        """The twist at which forces and moment of viscous friction balance."""
        rows, speeds = [], []
        for ((x, y), heading), spin in zip(self.contacts, spins, strict=True):
            rows += [(1, 0, -y), (0, 1, x)]
            speeds += [self.radius * spin * cos(heading), self.radius * spin * sin(heading)]
        return np.linalg.solve(np.array(rows).T @ rows, np.array(rows).T @ speeds)

    @property
    def track(self) -> float:
        """Of the differential drive that turns as it does, measured by turning on the spot."""
        return 2.0 / float(self.dragged(self.spins(-1.0, 1.0))[2])

    def text(self, track: str, more: str = "") -> str:
        wheels = "".join(
            f"  - {{name: w{k}, type: fixed, x: {float(x)!r}, y: {float(y)!r}, heading: {heading!r}, r: radius}}\n"
            for k, ((x, y), heading) in enumerate(self.contacts)
        )
        return (
            f"wmrgen: 1\nname: skid\nparameters: {{radius: {self.radius}, wide: {{value: {track}, tunable: true}}}}\n"
            f"effective_track: wide\n{more}wheels:\n{wheels}"
        )


HUSKY = Base(((0.256, 0.2775, 0), (0.256, -0.2775, 0), (-0.256, 0.2775, 0), (-0.256, -0.2775, 0)))
BASES = {
    "husky": HUSKY,
    "off the origin": Base(HUSKY.wheels, (0.31, -0.07)),
    "along y": Base(HUSKY.wheels, (0.1, 0.2), pi / 2),
    "at an angle": Base(HUSKY.wheels, (-0.1, 0.05), 0.4),
    "six, wide in the middle": Base(
        ((0.4, 0.3, 0), (0.4, -0.3, 0), (0.05, 0.4, 0), (0.05, -0.4, 0), (-0.5, 0.3, 0), (-0.5, -0.3, 0))
    ),
    "right side mounted the other way round": Base(
        tuple((x, y, 0 if y > 0 else pi) for x, y, _ in HUSKY.wheels), (0.0, 0.03)
    ),
}


@pytest.mark.parametrize("name", BASES)
def test_it_moves_as_wheels_that_drag(name: str) -> None:
    """forward of speeds is the twist of the oracle; inverse gives the speeds back; the models turn as they say."""
    base = BASES[name]
    derivation = of_text(base.text(repr(base.track)))
    module = derivation.numpy()
    for left, right in ((-1.0, 1.0), (0.7, 0.9), (-0.0, -0.4), (0.5, 0.5)):
        spins = base.spins(left, right)
        vx, vy, omega = base.dragged(spins)
        names = {f"w{k}_spin": spin for k, spin in enumerate(spins)}
        found = module.forward(**names)
        assert [found[k] for k in ("vx", "vy", "omega", "slip")] == pytest.approx(
            [vx, vy, omega, 0], abs=1e-9
        )
        back = module.inverse(vx=vx, vy=vy, omega=omega)
        assert [back[f"w{k}.spin"] for k in range(len(spins))] == pytest.approx(spins, abs=1e-9)
        assert back["slip"] == pytest.approx(0, abs=1e-9)
        f = derivation.state_space("posture")
        by_side = {
            port.name: names[port.name.replace(".", "_")] for port in derivation.system("posture").inputs
        }
        rates = f([0, 0, 0], list(by_side.values()), derivation.vector_forms[0].nominal).full().ravel()
        assert rates == pytest.approx([vx, vy, omega], abs=1e-9)


def test_the_commanded_twist_is_what_it_does() -> None:
    """Inputs vx and omega by default; `dynamics` turns; twice the track is half the yaw rate, in every form."""
    base = BASES["off the origin"]
    derivation = of_text(base.text("1.1"))
    space = derivation.model()["state_space"]
    assert (space["form"], [e["name"] for e in space["u"]]) == ("twist", ["vx", "omega"])
    rates = derivation.state_space()([0, 0, 0.3], [0.4, 0.9], [1.1]).full().ravel()
    vx, vy = 0.4, -0.31 * 0.9
    assert rates == pytest.approx([vx * cos(0.3) - vy * sin(0.3), vx * sin(0.3) + vy * cos(0.3), 0.9])
    turned = derivation.evaluate("dynamics", {"eta2": Exact(1)})
    assert float(turned["theta_rate"]) != 0
    posture = derivation.state_space("posture")
    single, double = (posture([0, 0, 0], [-2.0, 3.0], [t]).full().ravel()[2] for t in (1.1, 2.2))
    assert single == pytest.approx(0.165 * 5 / 1.1) and double == pytest.approx(single / 2)


def test_every_backend_has_the_track_as_a_parameter(tmp_path: Path) -> None:
    base = BASES["six, wide in the middle"]
    path = tmp_path / "skid.yaml"
    path.write_text(base.text("1.3"))
    for backend in ("exact", "casadi", "numpy", "c"):
        out, _ = run_cli(
            "eval", str(path), "inverse", "vx=0.2", "omega=-0.5", "wide=1.5", "--backend", backend, "--json"
        )
        spins = json.loads(out)
        assert spins["w4.spin"] == pytest.approx((0.2 + 0.75 * 0.5) / 0.165, rel=1e-6)
        assert spins["w3.spin"] == pytest.approx((0.2 - 0.75 * 0.5) / 0.165, rel=1e-6)


def test_the_layout_stays_what_it_is(tmp_path: Path) -> None:
    """Places, matrices and degrees are the robot's; so is what its contacts do. Lint finds nothing, compare and export
    go by the track, the report says what stands for it, and it may draw a trailer."""
    more = "trailers: [{length: 0.8, hitch: 0.4}]\nfunctions: [trailer, contact_velocity]\n"
    path = tmp_path / "skid.yaml"
    path.write_text(HUSKY.text("1.04", more))
    derivation = wmrgen.derive(wmrgen.load(path))
    data = derivation.model()
    assert data["degenerate"] and data["effective_track"] == 1.04 and data["wheels"][0]["y"] == 0.2775
    assert "differential drive of its effective track" in " ".join(data["reasons"])
    contact = derivation.evaluate("contact_velocity", {"omega": Exact(2)})
    assert float(contact["w0.vx"]) == pytest.approx(-0.555)
    rates = derivation.evaluate("trailer", {"w0.spin": Exact(-1), "w1.spin": Exact(1)})
    assert float(rates["theta_rate"]) == pytest.approx(2 * 0.165 / 1.04)
    assert "no findings" in run_cli("lint", str(path))[0]
    run_cli("export", str(path), "--to", "ros2_control", "-o", str(tmp_path))
    assert "wheel_separation: 1.04\n" in (tmp_path / "skid_controllers.yaml").read_text(encoding="utf-8")
    run_cli("derive", str(path), "-o", str(tmp_path / "out"))
    report = (tmp_path / "out" / "skid" / "report.md").read_text(encoding="utf-8")
    assert r"T_e = \mathit{wide} = 1.04" in report and r"\frac{v_x-\frac{\mathit{wide}}{2}\;\omega}" in report


WHEEL = "  - {{name: extra, type: {}, x: 0.1, y: {}, heading: {}, r: 0.1{}}}\n"


@pytest.mark.parametrize(
    ("track", "wheel", "names"),
    [
        ("0", "", ()),
        ("-1.2", "", ()),
        ("1", WHEEL.format("swedish", 0, 0, ", gamma: 45 deg"), ("extra",)),
        ("1", WHEEL.format("fixed", 0, 0.1, ""), ()),
    ],
)
def test_robots_that_do_not_skid_have_none(track: str, wheel: str, names: tuple[str, ...]) -> None:
    with mistaken(Code.VALUE, "wide", "effective_track", *names):
        of_text(HUSKY.text(track) + wheel)


@pytest.mark.parametrize("wheels", [HUSKY.wheels[::2], HUSKY.wheels[:1]])
def test_one_side_has_no_track(wheels: tuple[tuple[float, float, float], ...]) -> None:
    with mistaken(Code.VALUE, "wide", "effective_track"):
        of_text(Base(wheels).text("1"))


def test_a_robot_without_fixed_wheels_has_no_track() -> None:
    with mistaken(Code.VALUE, "wide", "effective_track"):
        of_text(Base(()).text("1") + "  - {name: ball, type: spherical, x: 0, y: 0}\n")


@pytest.mark.parametrize(
    ("wheel", "possible"),
    [
        ("", True),
        (WHEEL.format("castor", 0, 0, ", d: -0.05"), True),
        (WHEEL.format("steered", 0, 0, ""), True),
        (WHEEL.format("swedish", 0, 0, ", gamma: 45 deg"), False),
    ],
)
def test_an_effective_track_is_advised_where_it_can_be_said(
    wheel: str, possible: bool, tmp_path: Path
) -> None:
    """By lint, among the reasons and by the model, which says of steered wheels, too, what it holds for."""
    path = tmp_path / "skid.yaml"
    path.write_text(HUSKY.text("1").replace("effective_track: wide\n", "") + wheel)
    derivation = wmrgen.derive(wmrgen.load(path))
    model = derivation.system("twist").text
    texts = (run_cli("lint", str(path), code=1)[0], " ".join(derivation.mobility.reasons), model)
    assert ["effective_track" in text for text in texts[1:]] == [possible] * 2
    assert ("Write effective_track" in texts[0]) == possible
    assert ("no steered wheel" in model) == ("steered" in wheel)


@pytest.mark.parametrize(("ratio", "where"), [(1, "curve"), (-1, "motion")])
def test_a_locked_axle_slides_whatever_its_model_in_twist_inputs_is_told(ratio: int, where: str) -> None:
    """And the model says so, beside what it says of the steered wheel."""
    text = (
        "wmrgen: 1\nname: locked\nwheels:\n"
        "  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}\n"
        "  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
        "  - {name: front, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1}\n"
        f"couplings:\n  - {{equal: [left.spin, right.spin], ratios: [1, {ratio}]}}\n"
    )
    model = of_text(text).system("twist").text
    *_, rolling, sliding = model.split("; ")
    assert "steered wheel" in rolling and "slide" in sliding and f"every {where}" in sliding


BESIDE = ((0.7, 0.1), (-0.6, -0.35))  # pivots of steered wheels, in the frame of the base


@pytest.mark.parametrize(
    "turning", [(0.6, 0.8), (0.0, -0.9), (-0.4, 0.3)], ids=["curve", "on the spot", "back"]
)
@pytest.mark.parametrize("name", BASES)
def test_steered_wheels_follow_a_base_that_skids(name: str, turning: tuple[float, float]) -> None:
    """Sides roll at u -+ omega T/2 about the middle of the fixed wheels, and steered wheels along their pivots."""
    base, track, (u, omega) = BASES[name], 1.1, turning
    e = complex(cos(base.heading), sin(base.heading))
    pivots = [complex(*base.at) + e * complex(*p) for p in BESIDE]
    steered = "".join(
        f"  - {{name: s{k}, type: steered, x: {p.real!r}, y: {p.imag!r}, heading: 0, r: 0.1}}\n"
        for k, p in enumerate(pivots)
    )
    d = of_text(base.text("1") + steered)
    assert d.mobility.skids and d.mobility.robot_type is None
    assert d.driven.mobility.robot_type == (1, 1) and d.driven.mobility.dof == 3
    xs, ys = ([w[k] for w in base.wheels] for k in (0, 1))
    middle = complex(*base.at) + e * complex(sum(xs) / len(xs), (max(ys) + min(ys)) / 2)
    v = u * e - 1j * omega * middle  # of P
    twist = {"vx": v.real, "vy": v.imag, "omega": omega}
    out = values(d, "inverse", twist | {"wide": track})
    assert out["slip"] == pytest.approx(0, abs=1e-9)
    for k, (_, y, own) in enumerate(base.wheels):
        side = (u - omega * track / 2 * (1 if y > 0 else -1)) * cos(own)
        assert out[f"w{k}.spin"] == pytest.approx(side / base.radius, abs=1e-9)
    for k, p in enumerate(pivots):
        rolls = (v + 1j * omega * p) * complex(cos(out[f"s{k}.steer"]), -sin(out[f"s{k}.steer"]))
        assert [rolls.imag, rolls.real] == pytest.approx([0, 0.1 * out[f"s{k}.spin"]], abs=1e-9)
    back = values(d, "forward", out | {"wide": track})
    assert [back[n] for n in twist] == pytest.approx([*twist.values()], abs=1e-8)
    assert back["slip"] == pytest.approx(0, abs=1e-8)


def values(d: Derivation, function: str, given: dict[str, float]) -> dict[str, float]:
    ir = lower(d.formula(function))
    return evaluate(ir, {p.name: given.get(p.name, 0.0) for p in ir.inputs}, FLOAT64)
