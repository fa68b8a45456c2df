"""What a generated file says about itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from wmrgen.ir.nodes import Function
from wmrgen.ir.site import NO_SITE, Site


@dataclass(frozen=True, slots=True)
class Place:
    """A function in a generated ``file``: its line, and the lines of the quantities that it names."""

    file: str
    function: str
    line: int
    quantities: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts for the banner of a generated file. Everything is plain text; backends escape it.

    ``wheel_lines``: the wheel table, one finished line per wheel and note. ``model_hash``: hexadecimal digest of the
    model. ``bound_lines``: what is proved of the code, for the backend whose code that is. ``site``: what the robot
    file says about inputs. ``formulas``: the functions as lowered. ``options``: what the user chose of what the
    backend takes. ``places``: where the code of other backends computes what (for the report).
    """

    description: str = ""
    wheel_lines: tuple[str, ...] = ()
    model_hash: str = ""
    wmrgen_version: str = ""
    sympy_version: str = ""
    bound_lines: tuple[str, ...] = ()
    site: Site = NO_SITE
    formulas: tuple[Function, ...] = ()
    options: Mapping[str, str | bool] = field(default_factory=dict)
    places: tuple[Place, ...] = ()
