"""Resolve a xacro file in a process of its own, which has limits of memory and time.

An expression of a few characters can take all memory or never end. The process has the checks of `importing.xacro`;
here the result travels as JSON, with the places of all elements.
"""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from wmrgen.codegen.compiler import run_python
from wmrgen.errors import EnvironmentFailure, Mark, RobotFileError
from wmrgen.robotfile.text import printable
from wmrgen.tools.importing.read import Place, Text, parse, placed, refuse
from wmrgen.tools.importing.xacro import PLACE, Resolved, resolve_here

# [s] The largest descriptions of the collection (PR2, Axebot) take 2 s on a slow machine.
LONGEST = 60.0
# [bytes] of address space. A PR2 takes a third of it, most of which are shared libraries.
MOST_MEMORY = 1 << 30
_CODE = (
    "import sys; sys.path[:] = {path!r}; from wmrgen.tools.importing.xacro_process import answer; "
    "sys.stdout.write(answer(sys.stdin.read()))"
)


def resolve(
    file: Path, arguments: Mapping[str, str], packages: Mapping[str, Path], longest: float = LONGEST
) -> tuple[Element, list[str], list[str]]:
    """Resolve a xacro file.

    Args:
        file: The file.
        arguments: The values of its arguments by name.
        packages: The folders of ROS packages by name.
        longest: The time after which the process is stopped [s].

    Returns:
        The root of the URDF, its elements placed where the files have them; the names of the macros that the file
        calls; and notes.

    Raises:
        RobotFileError: The file is no valid xacro, or takes too much memory or time.
    """
    folders = {name: str(folder) for name, folder in packages.items()}
    asked = json.dumps({"file": str(file), "arguments": dict(arguments), "packages": folders})
    name = printable(file.name)
    printed = run_python(_CODE.format(path=sys.path), asked, longest)
    if printed is None:
        what = f"{name}: xacro takes longer than {longest:g} s"
        raise refuse(what, "It was stopped.", "Look for a loop or a large power in an expression.")
    reply: dict[str, Any] = json.loads(printed)
    if "environment" in reply:
        raise EnvironmentFailure(reply["environment"])
    if "error" in reply:
        mark = reply.pop("mark")
        raise RobotFileError(
            reply["error"], mark and Mark(*mark), reply["why"], reply["instead"], reply["code"]
        )
    root = parse(reply["urdf"].encode(), printable(str(file)))
    texts = [Text(data.encode("latin-1"), path) for path, data in reply["texts"]]
    for element in placed(root):
        place = reply["places"].get(element.attrib.pop(PLACE, ""))
        element.place = place and Place(texts[place[0]], place[1], place[2])
    return root, reply["called"], reply["notes"]


def answer(asked: str) -> str:
    """Return the answer of the process to a request, both as JSON."""
    _limit_memory()
    request = json.loads(asked)
    packages = {name: Path(folder) for name, folder in request["packages"].items()}
    file = Path(request["file"])
    try:
        return json.dumps(_as_data(resolve_here(file, request["arguments"], packages)))
    except EnvironmentFailure as failure:
        return json.dumps({"environment": str(failure)})
    except RobotFileError as error:
        return json.dumps(_error_as_data(error))
    except MemoryError:
        what = f"{printable(file.name)}: xacro takes more than {MOST_MEMORY >> 20} MiB of memory"
        return json.dumps(
            _error_as_data(refuse(what, "", "Look for an expression that makes a large value."))
        )


def _limit_memory() -> None:
    """Limit the memory of this process if the system can."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def _as_data(resolved: Resolved) -> dict[str, Any]:
    """Return what was resolved as data for JSON."""
    texts: dict[int, int] = {}
    sources: list[tuple[str, str]] = []
    places = {}
    for key, place in resolved.places.items():
        if place is not None:
            if id(place.text) not in texts:
                texts[id(place.text)] = len(sources)
                sources.append((place.text.file, place.text.data.decode("latin-1")))
            places[key] = (texts[id(place.text)], place.line, place.column)
    return {
        "urdf": resolved.urdf.decode(),
        "places": places,
        "texts": sources,
        "called": resolved.called,
        "notes": resolved.notes,
    }


def _error_as_data(error: RobotFileError) -> dict[str, Any]:
    """Return an error as data for JSON."""
    mark = error.mark and (error.mark.file, error.mark.line, error.mark.column, error.mark.text)
    parts = {"why": error.why, "instead": error.instead, "code": str(error.code)}
    return {"error": error.what, "mark": mark, **parts}
