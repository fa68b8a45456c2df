"""What a robot's file says about the inputs and outputs of its functions, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Site:
    """``limits``: contract name -> (low, high), SI units; ``pivots``: wheel, x, y [m]."""

    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    pivots: tuple[tuple[str, float, float], ...] = ()


NO_SITE = Site()
