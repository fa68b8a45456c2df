"""Records of the mobility analysis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.notation import plain

Array = NDArray[np.float64]
TOLERANCE = (
    1e-9  # relative to the largest singular value: far above the rounding of doubles, below any real length
)
CAMPION = ((3, 0), (2, 0), (2, 1), (1, 1), (1, 2))  # Campion's five types, (mobility, steerability)


class Rank(NamedTuple):
    """A rank that is determined numerically and exactly."""

    value: int  # number of singular values above TOLERANCE relative to the largest one
    exact: int | None  # in exact arithmetic; None if there is no exact configuration
    singular_values: tuple[float, ...]

    @property
    def margin(self) -> float:
        """The smallest singular value above the tolerance, divided by the tolerance; infinite for rank 0."""
        if not self.value:
            return float("inf")
        return self.singular_values[self.value - 1] / (TOLERANCE * self.singular_values[0])

    @property
    def disagrees(self) -> bool:
        """Whether the exact rank differs from the numerical rank, usually because of rounded decimals in the file."""
        return self.exact is not None and self.exact != self.value


class Admissible(NamedTuple):
    """The twists that some steering permits: a subspace of twists, or a quadratic cone."""

    basis: Array  # rows that span the set, shape (n, 3)
    sample: Array  # a generic twist of the set
    linear: bool  # False for a quadratic cone
    tangent: Array  # rows that span the tangent space at the sample
    chosen: tuple[int, ...] = ()  # indices of independent constant rows, from fixed wheels and couplings
    normal: Row | None = None  # row of a further linear constraint, which coupled steering imposes

    @property
    def dimension(self) -> int:
        """The dimension of the set of twists."""
        return len(self.basis) if self.linear else len(self.basis) - 1


class Singularity(NamedTuple):
    """A set of states at which a rank drops or an angle is undefined."""

    kind: str  # icr_on_pivot, shared_axle, drive or rolling_rank
    # Polynomials in joint angles and named parameters, which all vanish in these states. A row is multiplied by the
    # twist (vx, vy, omega).
    conditions: tuple[Poly | Row, ...]
    meaning: str  # a clause without a full stop, with names in backticks
    wheels: tuple[str, ...]

    @property
    def everywhere(self) -> bool:
        """Whether the layout itself is singular although it has enough wheels, which deserves a warning."""
        return self.kind == "rolling_rank" and len(self.wheels) > 2


class Balance(NamedTuple):
    """A comparison of motors with degrees of freedom."""

    joint: str  # spin: driving; steer: steering
    motors: int  # actuated joints, coupled ones counted once
    independent: int  # degrees of freedom that the motors command
    need: int  # degrees of freedom that the robot has

    @property
    def lacking(self) -> int:
        """The number of degrees of freedom that no motor commands."""
        return self.need - self.independent

    @property
    def surplus(self) -> int:
        """The number of relations that the motor rates must satisfy; 0 if degrees of freedom are lacking."""
        return 0 if self.lacking else self.motors - self.independent

    def __str__(self) -> str:
        what = "steering" if self.joint == "steer" else "driving"
        joints, degrees, relations = ("s" * (n != 1) for n in (self.motors, self.need, self.surplus))
        head = f"{what}: {self.motors} actuated joint{joints} for {self.need} degree{degrees} of freedom"
        if self.lacking:
            return f"{head}, short by {self.lacking}"
        if self.surplus:
            of = "angles" if self.joint == "steer" else "rates"
            if self.motors == 1:
                return f"{head}, 1 more than needed: one {of.removesuffix('s')} alone lets every wheel roll"
            return (
                f"{head}, {self.surplus} more than needed: {self.surplus} relation{relations} must hold between "
                f"the {of}"
            )
        return f"{head}, exactly enough"


class Reason(NamedTuple):
    """A sentence that explains the degrees of a robot."""

    key: str  # the kind of the sentence, which does not change with its wording
    text: str  # the sentence, with names in backticks
    argues: bool = True  # False for a sentence that only repeats the layout or a definition


@dataclass(frozen=True, slots=True)
class Mobility:
    """Degrees, ranks and their reasons (Siegwart (3.40)-(3.42); Campion, Bastin, d'Andrea-Novel 1996)."""

    degree_of_mobility: int
    degree_of_steerability: int
    rank_C1f: Rank
    rank_C1: Rank
    explanation: tuple[Reason, ...]
    actuation: tuple[Balance, ...]  # for driving, and for steering if the robot steers
    apart: tuple[str, ...]  # three fixed wheels whose axles meet in no common point, if there are any
    skids: bool  # the robot is degenerate and turns only by skidding
    verdict: str  # the sentence why the robot is degenerate; "" if it is not
    # Dimensions of pose and steering that inputs and Lie brackets span, by order of the brackets.
    growth_vector: tuple[int, ...]
    singularities: tuple[Singularity, ...]
    admissible: Admissible
    basis_rows: tuple[Row, ...]  # independent rows of C1 (working view), steering symbolic
    basis_rows_symbolic: tuple[Row, ...]
    basis_wheels: tuple[str, ...]  # the steered wheels among them
    null_space: tuple[Row, ...]  # columns, working view
    null_space_symbolic: tuple[Row, ...]
    scaled: tuple[Row, ...]  # null_space with columns scaled so that eta is a speed: see `basis.scaled`
    scaled_symbolic: tuple[Row, ...]
    driven: tuple[Robot, Mobility] | None = None  # the equivalent differential drive of a skid-steer robot

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the degrees are as they are, in sentences."""
        return tuple(plain(reason.text) for reason in self.explanation)

    @property
    def argument(self) -> tuple[str, ...]:
        """The reasons without those that repeat the layout or a definition, with names of wheels in backticks."""
        return tuple(reason.text for reason in self.explanation if reason.argues)

    @property
    def in_symbols(self) -> Mobility:
        """The mobility of `Robot.in_symbols`, in which every named parameter is a symbol."""
        driven = self.driven and (self.driven[0].in_symbols, self.driven[1].in_symbols)
        return replace(
            self,
            basis_rows=self.basis_rows_symbolic,
            null_space=self.null_space_symbolic,
            scaled=self.scaled_symbolic,
            driven=driven,
        )

    @property
    def degree_of_maneuverability(self) -> int:
        """The sum of mobility and steerability, Siegwart (3.42)."""
        return self.degree_of_mobility + self.degree_of_steerability

    @property
    def deciding(self) -> str:
        """The most important reason: why the robot is degenerate, else the first one; "" if there is none."""
        return self.verdict or next(iter(self.reasons), "")

    @property
    def ddof(self) -> int:
        """The number of differentiable degrees of freedom, Siegwart 3.4.1."""
        return self.growth_vector[0] - self.degree_of_steerability

    @property
    def dof(self) -> int:
        """The number of degrees of freedom: dimensions of the pose that motions reach, Siegwart 3.4.1."""
        return self.growth_vector[-1] - self.degree_of_steerability

    @property
    def degree_of_nonholonomy(self) -> int:
        """The length of the growth vector: steps until it no longer grows."""
        return len(self.growth_vector)

    @property
    def holonomic(self) -> bool:
        """Whether DDOF = DOF, Siegwart 3.4.2."""
        return self.ddof == self.dof

    @property
    def omnidirectional(self) -> bool:
        """Whether the robot can take any twist at any time."""
        return self.ddof == 3

    @property
    def robot_type(self) -> tuple[int, int] | None:
        """(degree of mobility, degree of steerability) if this is one of Campion's five types, else None."""
        pair = (self.degree_of_mobility, self.degree_of_steerability)
        return pair if pair in CAMPION else None

    @property
    def degenerate(self) -> bool:
        """Whether the type is none of Campion's five."""
        return self.robot_type is None
