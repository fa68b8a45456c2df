"""What a generated file says about itself."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.backends.lines import Place
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Function
from wmrgen.ir.site import NO_SITE, Site


@dataclass(frozen=True, slots=True)
class Meta:
    """Facts for the banner of a generated file. Everything is plain text; backends escape it.

    ``wheel_lines``: the wheel table, one finished line per wheel and note. ``bound_lines``: what is proved (float C).
    ``model_hash``: hexadecimal digest of the model. For C only: ``scalar``, ``math`` and ``target``, see
    `wmrgen.ir.kernels.choice`. ``site``: what the robot file says about inputs. ``fuzz``: a fuzzing harness too.
    ``formulas``: the functions as lowered; ``places``: where the C computes what (for the report).
    """

    description: str = ""
    wheel_lines: tuple[str, ...] = ()
    model_hash: str = ""
    wmrgen_version: str = ""
    sympy_version: str = ""
    scalar: str = DEFAULT.scalar
    math: str = DEFAULT.math
    target: str = DEFAULT.target
    bound_lines: tuple[str, ...] = ()
    site: Site = NO_SITE
    fuzz: bool = False
    formulas: tuple[Function, ...] = ()
    places: tuple[Place, ...] = ()


NO_META = Meta()
