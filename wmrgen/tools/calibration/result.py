"""The result of a calibration: parameters, the fit behind them, and a verdict."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.tools.calibration.errors import Drawn, Errors, drawn, errors
from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.gyro import GyroEstimate
from wmrgen.tools.calibration.joint_noise import JointNoise
from wmrgen.tools.calibration.noise import Noise
from wmrgen.tools.calibration.observability import Estimate
from wmrgen.tools.calibration.path import Reals
from wmrgen.tools.calibration.picture import picture
from wmrgen.tools.calibration.slips import Slip

_GAIN = 0.9  # of errors with nominal values: a fit lowers errors on its own drives a little whatever it fits


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another number of turns that the logs allow."""

    turns: float  # in the rotation that is least certain
    odds: float  # of the chosen number against this one
    parameters: dict[str, float]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Errors of odometry from the first pose of each leg on, over the same poses of the same logs."""

    nominal: Errors
    held_out: Errors  # each log with parameters and mount from other logs
    folds: int
    blind: tuple[str, ...]  # unknowns that some folds do not determine

    @property
    def better(self) -> bool:
        """Whether the parameters predict logs that they were not fitted to better than nominal ones."""
        return self.held_out.total < self.nominal.total


@dataclass(frozen=True, slots=True)
class Calibration:
    """The result."""

    fit: Fit
    parameters: dict[str, Estimate]
    mount: dict[str, Estimate]
    clocks: dict[str, Estimate]  # by log
    unobservable: tuple[tuple[str, ...], ...]  # parameters that are determined only together, or not at all
    covariance: Reals  # (P, P) of the parameters, in SI units
    noise: Noise
    joint_noise: JointNoise | None  # None: odometry shows no random walk
    gyro: GyroEstimate | None  # None: the robot has no gyro, or the logs have no readings of it
    slips: tuple[Slip, ...]
    turns: float  # in the rotation that is least certain; nan where no number was in doubt
    alternatives: tuple[Alternative, ...]
    # None: no log can be left out, because the others do not determine the parameters, or no error was measured.
    verdict: Verdict | None

    @property
    def better(self) -> bool:
        """Whether the new values are better than nominal ones, on drives left out or, without a verdict, on all."""
        if self.verdict is not None:
            return self.verdict.better
        return not self.after.measured or self.after.total < _GAIN * self.before.total

    @property
    def before(self) -> Errors:
        """Errors with nominal parameters and mount."""
        return errors(self.residuals(nominal=True))

    @property
    def after(self) -> Errors:
        """Errors with those of the fit."""
        return errors(self.residuals())

    def residuals(self, nominal: bool = False) -> list[Drawn]:
        """Return odometry and reference of each log.

        Args:
            nominal: Whether to use nominal parameters and mount instead of the fitted ones.
        """
        problem = self.fit.problem
        shared = problem.origin if nominal else self.fit.state.shared
        return [drawn(problem, index, shared, float(own[0])) for index, own in enumerate(self.fit.state.own)]

    def figure(self) -> str:
        """Return an SVG of paths, errors and parameters."""
        before = [log.whole for log in self.residuals(nominal=True)]
        after = [log.whole for log in self.residuals()]
        return picture(before, after, self.parameters)

    def _repr_svg_(self) -> str:
        return self.figure()
