"""What generated files are made from, and whether a folder is still what these inputs give.

The same robot file, options, wmrgen and libraries give the same bytes. `wmrgen derive` records hashes and versions of
all of them in the manifest. A folder is fresh, and need not be derived, if its manifest records those of today and its
files have the recorded hashes. The recorded values are the same on every machine: they contain no path and no time.

The inputs are hashed before anything is derived. A file that changes meanwhile makes the next run derive again.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from wmrgen.derivation.manifest import Manifest, intact, sha256
from wmrgen.derivation.version import __version__
from wmrgen.robotfile.text import MAX_BYTES, read_at_most

# Generated text, numbers or pages depend on these distributions.
LIBRARIES = ("sympy", "mpmath", "casadi", "numpy", "jinja2", "pyyaml", "markdown-it-py")
# Modules with a table that a script may add to before it calls the command line.
REGISTRIES = (
    "wmrgen.functions.registry",
    "wmrgen.codegen.registry",
    "wmrgen.codegen.packages.kinds",
    "wmrgen.robotfile.wheel_types",
    "wmrgen.ir.ops.record",
    "wmrgen.tools.lint.record",
)
REMARKS = "remarks"  # the entry of ``made_from`` that counts what `derive` had to say about a robot
_PACKAGE = Path(__file__).resolve().parents[1]
_NAME = re.compile(rb"""^name:[ \t]*["']?([A-Za-z][A-Za-z0-9_]{0,30})["']?[ \t]*(?:#.*)?\r?$""", re.MULTILINE)


def can_compare() -> bool:
    """Return whether this process runs wmrgen as it is installed.

    A script that registers a function, a wheel type or a back end of its own has imported the registry before it calls
    the command line. The hashes do not cover such a script, so its files are always derived.
    """
    return not any(name in sys.modules for name in REGISTRIES)


def robot_bytes(path: Path) -> bytes | None:
    """Return the bytes of a robot file; None if it is missing, no regular file, or too large."""
    try:
        content = read_at_most(path, MAX_BYTES + 1)
    except (OSError, ValueError):
        return None
    return content if len(content) <= MAX_BYTES else None


def name_in(content: bytes) -> str | None:
    """Return the name that a robot file probably gives its robot: its folder is looked up before the file is parsed."""
    found = _NAME.findall(content)
    return found[0].decode() if len(found) == 1 else None


def inputs(robot_file: bytes | None = None, folders: Iterable[Path] = ()) -> dict[str, str]:
    """Return what generated files depend on, as the manifest records it.

    Args:
        robot_file: Content of the robot file; None for files that belong to no robot.
        folders: Folders of Python modules besides wmrgen that make the files.

    Returns:
        Names -> versions or SHA-256 sums. Nothing if a folder is missing or the version of a library is not known.
    """
    versions = library_versions()
    if len(versions) < len(LIBRARIES):
        return {}
    hashes = {"own_files": hash_of_own_files()}
    for folder in folders:
        if not folder.is_dir():
            return {}
        hashes[folder.name] = _hash_of_tree([(folder, folder.name, ".py")])
    if robot_file is not None:
        hashes["robot_file"] = sha256(robot_file)
    python = ".".join(map(str, sys.version_info[:2]))
    return {"wmrgen": __version__, "python": python, **versions, **hashes}


def fresh(
    directory: Path, expected: Mapping[str, str], options: Mapping[str, str] | None = None
) -> Manifest | None:
    """Return the manifest of a folder if its files are those that today's inputs give.

    Args:
        directory: The folder of a robot, a package or the textbook library.
        expected: The `inputs` of today.
        options: The options of `derive`; None: whatever options the manifest records.

    Returns:
        The manifest, or None if the folder has to be derived.
    """
    if not expected or directory.is_symlink() or directory.parent.is_symlink():
        return None
    manifest = intact(directory)
    if manifest is None:
        return None
    recorded = {key: value for key, value in manifest.made_from.items() if key != REMARKS}
    same_options = options is None or dict(options) == manifest.made_with
    return manifest if same_options and recorded == dict(expected) else None


@cache
def library_versions() -> dict[str, str]:
    """Return the installed versions of `LIBRARIES`; a library whose version is not known is left out.

    They are read from the names of the folders of installed metadata. importlib.metadata would take as long as
    everything else that a run without changes does.
    """
    versions: dict[str, str] = {}
    for folder in sys.path:
        try:
            names = [path.name for path in Path(folder or ".").iterdir()]
        except OSError:
            continue
        for name in names:
            stem, dot, ending = name.rpartition(".")
            distribution, _, rest = stem.partition("-")
            key = distribution.lower().replace("_", "-")
            if dot and ending in ("dist-info", "egg-info") and key in LIBRARIES:
                versions.setdefault(key, rest.partition("-")[0])
    return {name: versions[name] for name in LIBRARIES if versions.get(name)}


@cache
def hash_of_own_files() -> str:
    """Return one SHA-256 of wmrgen's modules and templates, by name; the same in a wheel and in a checkout."""
    templates = _PACKAGE / "templates"  # in a wheel
    if not templates.is_dir():
        templates = _PACKAGE.parent / "templates"  # in a checkout
    return _hash_of_tree([(_PACKAGE, "wmrgen", ".py"), (templates, "templates", "")])


def _hash_of_tree(folders: Iterable[tuple[Path, str, str]]) -> str:
    """Return one hash of the files below some folders, each with the name that stands for it and an ending of files."""
    lines = []
    for folder, title, ending in folders:
        for directory, below, names in os.walk(folder):
            outside = {"__pycache__", "tests"}
            if directory == str(_PACKAGE):
                outside |= {"templates", "robots"}  # data of a wheel, beside the package in a checkout
            below[:] = [name for name in below if name not in outside]
            relative = os.path.relpath(directory, folder).replace(os.sep, "/")
            for name in names:
                if name.endswith(ending):
                    content = Path(directory, name).read_bytes()
                    lines.append(f"{title}/{relative}/{name} {sha256(content)}")
    return sha256("\n".join(sorted(lines)).encode())
