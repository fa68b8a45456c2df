"""What options choose from."""

from __future__ import annotations

from enum import StrEnum


class Scalar(StrEnum):
    """The floating-point type of the generated C."""

    float = "float"
    double = "double"


class Math(StrEnum):
    """Whose sines and arctangents the generated C uses."""

    inline = "inline"
    libm = "libm"


class Target(StrEnum):
    """The processor that the generated C is for."""

    m4f = "m4f"
    m0 = "m0"
    avr = "avr"
    host = "host"


class Form(StrEnum):
    """The forms of a model that ``wmrgen model`` prints."""

    posture = "posture"
    configuration = "configuration"
    eta = "eta"
    zeta = "zeta"
    trailer = "trailer"
    chained = "chained"
