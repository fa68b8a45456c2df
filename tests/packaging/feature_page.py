"""docs/features.md: which drive has which function, and what each back end computes.

``python -m tests.packaging.feature_page`` writes it.
"""

from __future__ import annotations

from collections.abc import Iterator

import wmrgen
from tests.conftest import ROOT
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import FUNCTIONS, Kind, Reason, UnderivableError, names

PAGE = ROOT / "docs" / "features.md"
# A robot of the gallery for each kind of drive, with a heading that fits a column.
DRIVES = {
    "differential": "pioneer3dx",
    "skid-steer": "clearpath_a200",
    "car": "ackermann_car",
    "tricycle": "textbook_tricycle",
    "with trailers": "car_with_trailers",
    "4-wheel steering": "kelly_4ws",
    "synchro": "synchro_drive",
    "swerve": "wpilib_swervebot",
    "driven castors": "nomad_xr4000",
    "mecanum": "kuka_youbot",
    "omni": "lekiwi",
}
HAS, KEY, LACKS = "✓", "○", "–"
# The robot lacks these functions only because its file lacks a key.
MISSING_KEY = {
    Reason.NO_LIMIT,
    Reason.NO_ENCODER,
    Reason.NO_NOISE,
    Reason.NO_CENTRE_OF_GRAVITY,
    Reason.NO_TRAILERS,
}
LANGUAGES = {
    "c99": ("C99", "always"),
    "rust": ("Rust", "`derive --package rust`"),
    "javascript": ("JavaScript", "`derive --package javascript`"),
    "casadi": ("CasADi", "always"),
    "numpy": ("NumPy, JAX, PyTorch, CuPy", "always"),
}
HEAD = """\
# Features: which drive has which function

Each column is a robot of the [gallery](../generated/README.md). For your own robot, `wmrgen functions ROBOT` prints
the list with the reason for each missing function.

"""
KINDS = {
    Kind.FIRMWARE: "## In every language, for every robot",
    Kind.STANDARD: "## In CasADi, NumPy and JavaScript; in C and Rust if the robot file lists them",
    Kind.OPTIONAL: "## In every language, if the robot file lists them under `functions`",
}
LEGEND = f"""\
{HAS} the robot has the function. {KEY} its file lacks a key that the function needs, such as a limit or an encoder.
{LACKS} the robot does not have the function for another reason. `contacts` needs `r_sw` of Swedish wheels or
`r` of balls. `virtual_angle` and `virtual_steering` need a virtual wheel (`virtual`).
"""


def page() -> str:
    """Return the whole page."""
    return HEAD + LEGEND + "".join(_functions()) + "".join(_back_ends())


def _functions() -> Iterator[str]:
    """Yield a table for each kind of function: a column for each drive, a row for functions with equal cells."""
    derivations = [wmrgen.derive(wmrgen.load(ROOT / "robots" / f"{robot}.yaml")) for robot in DRIVES.values()]
    every = names()
    for kind, title in KINDS.items():
        yield f"\n{title}\n\n| function | {' | '.join(DRIVES)} |\n|---|{':-:|' * len(DRIVES)}\n"
        rows: dict[str, list[str]] = {}
        for name in every:
            if FUNCTIONS[name].kind is kind:
                cells = " | ".join(_cell(derivation, name) for derivation in derivations)
                rows.setdefault(cells, []).append(f"`{name}`")
        for cells, functions in rows.items():
            yield f"| {', '.join(functions)} | {cells} |\n"


def _cell(derivation: Derivation, name: str) -> str:
    """Return whether a robot has a function."""
    try:
        derivation.formula(name)
    except NotDerivableError as error:
        return KEY if isinstance(error, UnderivableError) and error.reason in MISSING_KEY else LACKS
    return HAS


def _back_ends() -> Iterator[str]:
    """Yield a table of the back ends that compute."""
    columns = ("language", "written", "`eval --backend`", "options", "proved rounding errors")
    yield f"\n## Back ends\n\n| {' | '.join(columns)} |\n|{'---|' * len(columns)}\n"
    for entry in BACKENDS.values():
        if entry.word:
            language, written = LANGUAGES[entry.name]
            options = ", ".join(f"`--{option}`" for option in entry.options) or "–"
            yield f"| {language} | {written} | `{entry.word}` | {options} | {'yes' if entry.proved else '–'} |\n"
    yield "\n`eval --backend exact` uses none of them: it computes in exact numbers.\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
