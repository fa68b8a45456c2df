"""Inverse and forward kinematics, odometry and the posture model, in symbols."""

from wmrgen.kinematics.contacts import contacts
from wmrgen.kinematics.forward import forward
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.pose import dynamics, odometry
from wmrgen.kinematics.records import Formula

__all__ = ["Formula", "contacts", "dynamics", "forward", "inverse", "odometry"]
