"""The library: every function by name, and its code through the same stages as that of a robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property, partial
from typing import TYPE_CHECKING, Any

from textbook import canonical, car, castor, frames, inverses, polar, transforms, wheels
from wmrgen.kinematics.records import Formula
from wmrgen.kinematics.rollers import mecanum_roller

if TYPE_CHECKING:
    from wmrgen.ir.nodes import Module

Builder = Callable[[], Formula]
NAME = "textbook"

# Chapter -> its functions, in the order of the report.
CHAPTERS: dict[str, dict[str, Builder]] = {
    "Frames of the plane": {
        "rotation_world_to_robot": transforms.rotation_world_to_robot,
        "rotation_robot_to_world": transforms.rotation_robot_to_world,
        "world_to_robot": transforms.world_to_robot,
        "robot_to_world": transforms.robot_to_world,
        "rotate": transforms.rotate,
        "pose_compose": transforms.pose_compose,
        "pose_inverse": transforms.pose_inverse,
    },
    "Frames of space": {
        **{f"rotation_{axis}": partial(transforms.rotation_about, axis) for axis in "xyz"},
        "transform_apply": transforms.transform_apply,
        "transform_compose": transforms.transform_compose,
        "transform_inverse": transforms.transform_inverse,
    },
    "Generalised inverses": {
        f"inverse_{m}x{n}": partial(inverses.inverse_of_size, m, n) for m, n in inverses.SIZES
    },
    "Moving frames": {
        "transport_theorem": frames.transport_theorem,
        "galilean": frames.galilean,
        "moving_frame_velocity": frames.moving_frame_velocity,
        "moving_frame_acceleration": frames.moving_frame_acceleration,
        "skew_matrix": frames.skew_matrix,
        "h_matrix": frames.h_matrix,
        "omega_matrix": frames.omega_matrix,
        "two_step_velocity": frames.two_step_velocity,
        "two_step_acceleration": frames.two_step_acceleration,
        "articulated_wheel_velocity": frames.articulated_wheel_velocity,
        "articulated_wheel_acceleration": frames.articulated_wheel_acceleration,
        "wheel_velocity": frames.wheel_velocity,
        "offset_wheel_velocity": frames.offset_wheel_velocity,
        "specific_force": frames.specific_force,
    },
    "Single wheels": {
        "rolling_disk": wheels.rolling_disk,
        "disk_constraint": wheels.disk_constraint,
        "unicycle": wheels.unicycle,
        "steer_sense": wheels.steer_sense,
        "wheel_contributions": wheels.wheel_contributions,
        "swedish_wheel": wheels.swedish_wheel,
        "mecanum_wheel": wheels.mecanum_wheel,
        "mecanum_wheel_inverse": wheels.mecanum_wheel_inverse,
        "mecanum_roller": mecanum_roller,
        "omni_wheel": wheels.omni_wheel,
        "castor_swivel": castor.castor_swivel,
        "castor_alignment": castor.castor_alignment,
    },
    "Canonical forms": {
        **{f"chain_{n}": partial(canonical.chain, n) for n in (3, 4, 5, 6)},
        "brockett": canonical.brockett,
        "brockett_double": canonical.brockett_double,
        "unicycle_to_chain": canonical.unicycle_to_chain,
        "chain_to_brockett": canonical.chain_to_brockett,
        "brockett_to_chain": canonical.brockett_to_chain,
    },
    "Polar coordinates of the goal": {
        "polar_coordinates": polar.polar_coordinates,
        "polar_pose": polar.polar_pose,
        "polar_rates": polar.polar_rates,
        "polar_rates_reverse": polar.polar_rates_reverse,
        "polar_closed_loop": polar.polar_closed_loop,
        "polar_linearisation": polar.polar_linearisation,
        "polar_gains": polar.polar_gains,
    },
    "Cars": {
        "turning_radius": car.turning_radius,
        "pursuit": car.pursuit,
        "car_reduction": car.car_reduction,
        "car_bounds": car.car_bounds,
    },
}

FUNCTIONS: dict[str, Builder] = {name: build for part in CHAPTERS.values() for name, build in part.items()}


@cache
def formula(name: str) -> Formula:
    """A function of the library. KeyError for an unknown name."""
    return FUNCTIONS[name]()


class Textbook:
    """The library, or some of its functions, as backends read it: like a `Derivation`, without a robot."""

    def __init__(self, names: Sequence[str] | None = None) -> None:
        self.names = tuple(FUNCTIONS) if names is None else tuple(names)

    @property
    def itself(self) -> Textbook:
        """What backends for readers are given."""
        return self

    @cached_property
    def formulas(self) -> tuple[Formula, ...]:
        """The functions in symbols."""
        return tuple(formula(name) for name in self.names)

    @cached_property
    def raw_module(self) -> Module:
        """The functions as written, not optimised: what the exact backend evaluates."""
        from wmrgen.ir.nodes import Module
        from wmrgen.lower import lower

        return Module(NAME, tuple(lower(f) for f in self.formulas))

    @cached_property
    def module(self) -> Module:
        """The functions, optimised."""
        from wmrgen.ir.pipeline import optimise

        return optimise(self.raw_module.functions, NAME)

    @property
    def c_module(self) -> Module:
        """The functions for C: all of them."""
        return self.module

    def casadi(self) -> dict[str, Any]:
        """Function name -> casadi.Function."""
        from wmrgen.backends.casadi import functions

        return functions(self.module)

    def numpy(self) -> Any:
        """The functions, vectorised over NumPy arrays."""
        from wmrgen.backends.numpy import functions

        return functions(self.module)


def textbook(*names: str) -> Textbook:
    """The library; with names, only those functions. KeyError for an unknown name when it is first read."""
    return Textbook(names or None)
