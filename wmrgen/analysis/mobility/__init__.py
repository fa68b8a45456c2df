"""The mobility of a robot: degrees, ranks, reachable dimensions, and the reasons for them."""

from wmrgen.analysis.mobility.analyse import analyse
from wmrgen.analysis.mobility.records import Mobility, Singularity

__all__ = ["Mobility", "Singularity", "analyse"]
