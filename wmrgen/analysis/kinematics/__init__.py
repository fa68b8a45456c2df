"""Kinematics in symbols: inverse, forward, odometry and the posture model."""

from wmrgen.analysis.kinematics.contacts import contacts
from wmrgen.analysis.kinematics.forward import forward
from wmrgen.analysis.kinematics.inverse import inverse
from wmrgen.analysis.kinematics.pose import dynamics, odometry
from wmrgen.analysis.kinematics.records import Formula

__all__ = ["Formula", "contacts", "dynamics", "forward", "inverse", "odometry"]
