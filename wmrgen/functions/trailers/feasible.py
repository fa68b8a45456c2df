"""What a robot file asks of its layout beyond the wheels, judged before anything is derived."""

from __future__ import annotations

from wmrgen.functions.models.virtual import check_virtual
from wmrgen.functions.trailers.trailer import check_trailers
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


def check(robot: Robot, mobility: Mobility) -> None:
    """NotDerivableError where the file asks for trailers or virtual wheels that the layout cannot have."""
    check_virtual(robot, mobility)
    check_trailers(robot, mobility)
