"""How a robot can move: degrees, ranks, reachable dimensions, and why."""

from wmrgen.mobility.analyse import analyse
from wmrgen.mobility.records import Mobility, Singularity

__all__ = ["Mobility", "Singularity", "analyse"]
