"""Numbers: the functions of a robot, its motion."""

from __future__ import annotations

from typing import Annotated

import typer

from wmrgen.cli.declare import Json, Math, Robot, Scalar, Target, Words, argument, group, option, words

verb = group("Compute")


def _functions(incomplete: str) -> list[str]:
    from wmrgen.functions.registry import names

    return [name for name in names() if name.startswith(incomplete)]


@verb("evaluate", "Compute a function of a robot's model.", "eval")
def evaluate(
    robot: Robot,
    function: Annotated[
        str,
        argument(
            "FUNCTION", "One that `wmrgen functions` lists: inverse, forward, motion, goto_pose.", _functions
        ),
    ],
    values: Annotated[Words, words("Inputs in SI units: 0.5, 1/3, pi/2, '45 deg/s'.")] = None,
    backend: Annotated[
        str,
        typer.Option(
            metavar="WORD", help="What computes: exact, c (with a C compiler); an unknown word lists all."
        ),
    ] = "exact",
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of backend c.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    cases: Annotated[
        str | None,
        option("A list of {name: value}; prints the list of results. - is stdin.", "FILE.json"),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen eval robots/pioneer3dx.yaml inverse vx=0.5 omega="30 deg/s"

    Compute a function of a robot's model. Inputs that are not given are 0, parameters nominal. With the word
    textbook for the robot: a formula of the texts that needs none, as `wmrgen eval textbook pursuit distance=3`.
    """


@verb("motion", "Say where constant wheel speeds take a robot.")
def motion(
    robot: Robot,
    values: Annotated[
        Words, words("Speeds of wheels (left=4 or left.spin=4), steering angles, start pose x y theta.")
    ] = None,
    time: Annotated[str | None, option("How long [s].", "T")] = None,
    segments: Annotated[
        str | None,
        option(
            "A list of {vx vy omega | x_rate y_rate theta_rate | x y theta: value, dt: value}; - is stdin.",
            "FILE.json",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen motion robots/pioneer3dx.yaml left=4 right=2 --time 2.3

    Say where constant wheel speeds take a robot: the pose at the end, and the straight line or circle driven. With
    --segments: the wheel commands of each segment, waits for steering included.
    """


@verb("motion", "Find the centre of rotation of a twist or of steering angles.")
def icr(
    robot: Robot,
    values: Annotated[
        Words, words("vx vy omega (and a point: point.x point.y), or <wheel>.steer, or icr.x icr.y.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen icr robots/ackermann_car.yaml front_left.steer=0.3 front_right.steer=0.25

    Find the centre of rotation (ICR) of a twist; or of the axles at given steering angles, with the wheels that do
    not point at it; or the steering angles that turn the robot about icr.x, icr.y.
    """


@verb("design", "Size the rollers of a mecanum wheel.")
def rollers(
    radius: Annotated[str, option("Radius of the wheel: 150mm, 0.15.")],
    count: Annotated[str, option("Number of rollers, at least 3.")],
    angle: Annotated[str, option("Hub axis to roller axis: 45deg; 90deg is an omni wheel.")],
    as_json: Json = False,
) -> None:
    """Example:  wmrgen rollers --radius 150mm --count 8 --angle 45deg

    Size the rollers of a mecanum wheel: length of a roller, width of the wheel (Tzafestas (2.86)-(2.91)).
    """
