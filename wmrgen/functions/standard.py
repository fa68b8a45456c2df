"""Declare the functions that every robot has: its kinematics."""

from __future__ import annotations

from wmrgen.analysis import kinematics
from wmrgen.analysis.kinematics import Formula
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Kind, Reason, function, underivable
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import Limits


@function("Siegwart (3.12)-(3.19)", Kind.FIRMWARE, Limits.COMMANDED)
def inverse(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands for a twist of P and the present steering angles."""
    return kinematics.inverse(robot, mobility)


@function("Siegwart (3.24), (3.26); Tzafestas (2.8a)", Kind.FIRMWARE, Limits.MEASURED)
def forward(robot: Robot, _: Mobility) -> Formula:
    """Return the twist of P and its residual for sensed joint rates and angles."""
    return kinematics.forward(robot)


@function("Konstantinov, case of constant speeds; sinc near 0 is ours", Kind.FIRMWARE, Limits.MEASURED)
def odometry(_: Robot, __: Mobility) -> Formula:
    """Return the pose after a step at constant twist."""
    return kinematics.odometry()


@function("Siegwart 3.4; Campion, Bastin, d'Andrea-Novel (1996)", Kind.STANDARD)
def dynamics(robot: Robot, mobility: Mobility) -> Formula:
    """Return the rates of the posture for inputs along the null space."""
    return kinematics.dynamics(robot, mobility)


@function(
    "Siegwart (3.20) corrected, (3.21), (3.22)",
    Kind.STANDARD,
    exists=lambda robot: kinematics.contacts(robot) is not None,
)
def contacts(robot: Robot, _: Mobility) -> Formula:
    """Return the speeds of rollers and spheres for a twist."""
    formula = kinematics.contacts(robot)
    if formula is None:
        why = "it has neither rollers (r_sw) nor spheres with a radius (r)"
        raise underivable(robot, "contacts", why, Reason.NO_ROLLERS)
    return formula
