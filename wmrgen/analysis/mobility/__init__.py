"""How a robot can move: degrees, ranks, reachable dimensions, and why."""

from wmrgen.analysis.mobility.analyse import analyse
from wmrgen.analysis.mobility.records import Mobility, Singularity

__all__ = ["Mobility", "Singularity", "analyse"]
