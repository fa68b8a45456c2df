"""What the analysis finds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot

Array = NDArray[np.float64]
TOLERANCE = 1e-9  # relative to the largest singular value
CAMPION = ((3, 0), (2, 0), (2, 1), (1, 1), (1, 2))  # the types that are not degenerate


class Rank(NamedTuple):
    """A rank decided twice: exactly, and at TOLERANCE relative to the largest singular value.

    ``exact`` is None where no exact configuration exists. ``value`` follows the tolerance.
    """

    value: int
    exact: int | None
    singular_values: tuple[float, ...]

    @property
    def margin(self) -> float:
        """The smallest singular value that counts over the tolerance line: how far from a lower rank."""
        if not self.value:
            return float("inf")
        return self.singular_values[self.value - 1] / (TOLERANCE * self.singular_values[0])

    @property
    def disagrees(self) -> bool:
        """True where exact arithmetic sees more than a rounding-sized difference justifies."""
        return self.exact is not None and self.exact != self.value


class Admissible(NamedTuple):
    """The twists that some steering permits: a cone inside null(C0).

    ``basis``: spans the cone (rows, numbers). ``sample``: one generic twist of the cone. ``linear`` is False when the
    cone is a conic; ``tangent``: spans its tangent space at the sample. ``chosen``: indices of independent constant
    rows (fixed wheels and couplings). ``normal``: the row of a further linear constraint that coupled steering
    imposes, or None.
    """

    basis: Array
    sample: Array
    linear: bool
    tangent: Array
    chosen: tuple[int, ...] = ()
    normal: Row | None = None

    @property
    def dimension(self) -> int:
        """Of the cone."""
        return len(self.basis) if self.linear else len(self.basis) - 1


class Singularity(NamedTuple):
    """Where a rank drops or an angle is undefined. ``conditions``, which may have named parameters, all vanish there.

    A condition that is a row is multiplied with (vx, vy, omega). ``meaning`` has names in backticks.
    """

    kind: str
    conditions: tuple[Poly | Row, ...]
    meaning: str
    wheels: tuple[str, ...]

    @property
    def everywhere(self) -> bool:
        """True where the layout itself is singular, though it has wheels enough: worth a warning."""
        return self.kind == "rolling_rank" and len(self.wheels) > 2


class Balance(NamedTuple):
    """Motors against degrees of freedom.

    ``joint``: spin, of driving, or steer, of steering. ``motors``: joints that are actuated, coupled ones counted once;
    ``independent``: how many of the ``need`` freedoms they command.
    """

    joint: str
    motors: int
    independent: int
    need: int

    @property
    def lacking(self) -> int:
        """Freedoms that no motor commands."""
        return self.need - self.independent

    @property
    def surplus(self) -> int:
        """Motors beyond need, none where freedoms are lacking: relations that their rates must keep."""
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
                return f"{head}, 1 beyond need: one {of.removesuffix('s')} alone lets every wheel roll"
            return f"{head}, {self.surplus} beyond need: {self.surplus} relation{relations} must hold between the {of}"
        return f"{head}, exactly enough"


@dataclass(frozen=True, slots=True)
class Mobility:
    """Degrees, ranks and their reasons (Siegwart (3.40)-(3.42); Campion, Bastin, d'Andrea-Novel 1996).

    ``apart``: three fixed wheels whose axles meet in no common point, where there are such. ``argument``: of the
    ``reasons`` those that argue, names of wheels in backticks; ``verdict``: the one why the robot is degenerate, ""
    where it is not; ``skids``: because it turns by skidding alone. ``growth_vector``: dimensions of pose and steering
    angles that the inputs and their Lie brackets span, by order.
    """

    degree_of_mobility: int
    degree_of_steerability: int
    rank_C1f: Rank
    rank_C1: Rank
    reasons: tuple[str, ...]
    argument: tuple[str, ...]
    actuation: tuple[Balance, ...]  # of driving; of steering, where there is any
    apart: tuple[str, ...]
    skids: bool
    verdict: str
    growth_vector: tuple[int, ...]
    singularities: tuple[Singularity, ...]
    admissible: Admissible
    basis_rows: tuple[Row, ...]  # independent rows of C1 (working view), steering symbolic
    basis_rows_symbolic: tuple[Row, ...]
    basis_wheels: tuple[str, ...]  # the steered wheels among them
    null_space: tuple[Row, ...]  # columns, working view
    null_space_symbolic: tuple[Row, ...]
    scaled: tuple[Row, ...]  # the same columns, so that eta is a speed: see `basis.scaled`; working view
    scaled_symbolic: tuple[Row, ...]
    driven: tuple[Robot, Mobility] | None = None  # what wheel speeds follow from, if not the layout

    @property
    def in_symbols(self) -> Mobility:
        """The same of `Robot.in_symbols`: every named parameter is a symbol."""
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
        """Siegwart (3.42)."""
        return self.degree_of_mobility + self.degree_of_steerability

    @property
    def deciding(self) -> str:
        """The reason to tell where only one is told: why the robot is degenerate, else the first; "" without any."""
        return self.verdict or next(iter(self.reasons), "")

    @property
    def ddof(self) -> int:
        """Differentiable degrees of freedom, Siegwart 3.4.1."""
        return self.growth_vector[0] - self.degree_of_steerability

    @property
    def dof(self) -> int:
        """Degrees of freedom: dimensions of the pose that the motions reach, Siegwart 3.4.1."""
        return self.growth_vector[-1] - self.degree_of_steerability

    @property
    def degree_of_nonholonomy(self) -> int:
        """Steps until the growth vector stays."""
        return len(self.growth_vector)

    @property
    def holonomic(self) -> bool:
        """DDOF = DOF, Siegwart 3.4.2."""
        return self.ddof == self.dof

    @property
    def omnidirectional(self) -> bool:
        """Every twist is possible at once."""
        return self.ddof == 3

    @property
    def robot_type(self) -> tuple[int, int] | None:
        """(degree of mobility, degree of steerability), where that is one of Campion's five types."""
        pair = (self.degree_of_mobility, self.degree_of_steerability)
        return pair if pair in CAMPION else None

    @property
    def degenerate(self) -> bool:
        """Whether the type is none of Campion's five."""
        return self.robot_type is None
