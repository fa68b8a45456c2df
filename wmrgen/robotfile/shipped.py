"""Find the data folders of wmrgen: in an installed wheel below the package, in a checkout next to it."""

from __future__ import annotations

from pathlib import Path

from wmrgen.errors import EnvironmentFailure

_PACKAGE = Path(__file__).resolve().parents[1]


def shipped(name: str) -> Path:
    """Return the folder ``templates`` or ``robots``. Raise EnvironmentFailure if it is missing."""
    places = [_PACKAGE / name, _PACKAGE.parent / name]
    for folder in places:
        if folder.is_dir():
            return folder
    raise EnvironmentFailure(
        f"the {name} of wmrgen are missing: neither {places[0]} nor {places[1]} exists. Install wmrgen again."
    )
