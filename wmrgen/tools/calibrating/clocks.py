"""How far the clocks of a calibration's drives agree, read off the offsets that each drive shows alone.

An offset that slips and noise explain is none, and clocks of one tracker are late by about as much in each drive; yet
nobody can say beforehand by how much they differ. So true offsets are normal about a mean, and mean and variance are
those that the drives show (empirical Bayes: Efron and Morris, J. Am. Stat. Assoc. 68:117, 1973). The variance is what
squares of the offsets are more than their errors make, by moments (DerSimonian and Laird, Control. Clin. Trials 7:177,
1986). Where it is large beside these errors, the prior that follows is weak, and each drive's offset stays its own.
The mean is one estimate more that may be chance: its square less that of its error is what is taken for true.

The cost of a fit counts poses as if none depended on those before it, so it counts what they tell of a clock too often,
by as much as it says variances are too small. A prior has to count as often (Ribatet, Cooley and Davison, Stat. Sinica
22:813, 2012).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibrating.path import Reals

_SAME = 0.01  # tenths of a second that clocks may be apart in any case


@dataclass(frozen=True, slots=True)
class Clocks:
    """In tenths of a second: what true offsets are on average, ``late``, its standard ``error``, and the standard
    deviation of offsets about it, ``apart``; a cost counts ``counted`` times what poses tell of them."""

    late: float = 0.0
    error: float = 0.0
    apart: float = np.inf
    counted: float = 1.0

    @property
    def weight(self) -> float:
        """What an offset that is one tenth of a second from ``late`` costs, twice."""
        return self.counted / self.apart**2


ALONE = Clocks()  # nothing is known: each drive tells its own
ONE = Clocks(apart=1e-3)  # log and truth have one clock: a tenth of a millisecond is nothing


def shown(offsets: Reals, variances: Reals, independent: Reals) -> Clocks:
    """What ``offsets`` (n,) of drives show. ``variances`` (n,) are those of their errors, ``independent`` (n,) what
    these would be if poses did not depend on each other."""
    weights = 1 / variances
    total = weights.sum()
    mean = weights @ offsets / total
    square, degrees = weights @ (offsets - mean) ** 2, len(offsets) - 1
    between = (square - degrees) / (total - weights @ weights / total) if degrees else 0.0
    apart = max(between, _SAME**2)
    weights = 1 / (variances + apart)
    late, error = weights @ offsets / weights.sum(), 1 / weights.sum()
    true = max(0.0, 1 - error / late**2) if late else 0.0
    counted = np.median(variances / independent)
    return Clocks(float(true * late), float(np.sqrt(error)), float(np.sqrt(apart)), float(counted))
