"""Xacro to URDF by the package xacro, kept from what a file of strangers must not do.

The package evaluates Python: `${…}` under a check that nested functions and `vars` pass by, `$(eval …)` under none.
Here both are what `importing/expressions.py` leaves of it; files are read only in the folders of the packages given and
of the file itself, the environment is not read. Macros end after so many elements.
"""

from __future__ import annotations

import contextlib
import errno
import io
import itertools
import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

from wmrgen.errors import EnvironmentFailure, Mark, RobotFileError
from wmrgen.robotfile.text import printable, quoted, read_at_most
from wmrgen.tools.importing.expressions import checked, counted, offered, weighed
from wmrgen.tools.importing.read import MAX_BYTES, Place, parse, parse_file, placed, refuse

_UNPREFIXED = ("property", "macro", "include", "arg")
_MOST_MISSING, _YAML_BYTES = 20, 1 << 16
_UNKNOWN = "/package that is not known"  # the folder of those; what is only named need not be there
PLACE = "wmrgen.place"  # an attribute: by which its place is remembered


class _Trail:
    """Where the package is in the files. ``files``: roots of those that are opened and not parsed yet; ``at``: places
    of the element that it evaluates, last, and of those around it."""

    def __init__(self) -> None:
        self.files: list[Element] = []
        self.at: list[Place | None] = []
        self.places: dict[str, Place | None] = {}

    def parsed(self, parse: Callable[..., Any]) -> Callable[..., Any]:
        """A function that parses, with the places of its elements: as attributes, which outlive macros, but of those of
        xacro, which takes no others."""

        def call(*args: Any) -> Any:
            document = parse(*args)
            elements = document.getElementsByTagName("*")
            for node, element in zip(elements, placed(self.files.pop()), strict=True):
                node.setUserData(PLACE, element.place, self)
                if not node.tagName.startswith("xacro:"):
                    node.setAttribute(PLACE, str(len(self.places)))
                    self.places[node.getAttribute(PLACE)] = element.place
            return document

        return call

    def inside(self, walk: Callable[..., Any]) -> Callable[..., Any]:
        """A function that evaluates what is in an element."""

        def call(node: Any, *scopes: Any) -> Any:
            self.at.append(node.getUserData(PLACE))
            result = walk(node, *scopes)
            self.at.pop()
            return result

        return call

    def beside(self, work: Callable[..., Any]) -> Callable[..., Any]:
        """A function that does what an element of xacro says."""

        def call(node: Any, *args: Any) -> Any:
            self.at[-1] = node.getUserData(PLACE)
            return work(node, *args)

        return call

    def handle(self, _: int, key: str, place: Place | None, __: Any, copy: Any) -> None:
        """Copies of an element, as macros make them, have its place."""
        copy.setUserData(key, place, self)


class _Arguments(dict[str, str]):
    """The values of arguments by name, and those that a file has ``asked`` for."""

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.asked: set[object] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(name)
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


class Resolved(NamedTuple):
    """What a xacro file makes."""

    urdf: bytes  # its elements have the attribute PLACE
    places: dict[str, Place | None]  # by that attribute: where a file has the element
    called: list[str]  # the names of the macros that it calls
    notes: list[str]


def resolve_here(file: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> Resolved:
    """Resolve a xacro file in this process, without limits of memory and time: see `xacro_process.resolve`.

    Args:
        file: The file.
        arguments: The values of its arguments by name.
        packages: The folders of ROS packages by name.

    Raises:
        RobotFileError: The file makes no URDF; the error names the arguments that it lacks.
    """
    try:
        import xacro
    except ImportError:
        raise EnvironmentFailure(
            "xacro is resolved by the package xacro: pip install 'wmrgen[import]'"
        ) from None
    roots = [file.resolve().parent, *(folder.resolve() for folder in packages.values())]
    values = {name: _with_folders(value, packages) for name, value in arguments.items()}
    missing: list[str] = []
    plain: list[str] = []
    called: list[str] = []
    trail = _Trail()
    opened = partial(_opened, file=file, roots=roots, plain=plain, files=trail.files)
    with _kept(xacro, roots, packages, opened, called, trail), contextlib.redirect_stderr(io.StringIO()):
        while len(missing) < _MOST_MISSING:
            trail.at.clear()
            given = _Arguments({**values, **dict.fromkeys(missing, "1")})
            try:
                document = xacro.process_file(str(file.resolve()), mappings=given)
                break
            except Exception as error:
                name = _undefined(error)
                if name is None or name in missing:
                    if missing:
                        break
                    place = next(filter(None, reversed(trail.at)), None)
                    raise _failed(file, error, plain, place.mark if place else None) from None
                missing.append(name)
    if missing:
        words = " ".join(f"{name}:=VALUE" for name in missing)
        raise refuse(
            f"{printable(file.name)}: these arguments have no default: {printable(', '.join(missing))}",
            "",
            f"Give them behind the file: {printable(words)}.",
        )
    has = printable(", ".join(sorted(map(str, given.asked)))) or "none"
    notes = [f"the file has no argument {quoted(n)}; it has {has}" for n in values if n not in given.asked]
    return Resolved(document.toxml(encoding="utf-8"), trail.places, called, notes)


def macros(file: Path) -> list[str]:
    """The names of the macros that a file defines."""
    root = parse_file(file)
    return [e.get("name", "") for e in root.iter() if isinstance(e.tag, str) and e.tag.endswith("}macro")]


def _failed(file: Path, error: Exception, plain: list[str], mark: Mark | None) -> RobotFileError:
    """What the package says, and where; ``plain``: elements of xacro that it does not know as such."""
    for cause in _causes(error):
        if isinstance(cause, RobotFileError):
            return (
                cause
                if cause.mark
                else refuse(f"{printable(file.name)}: {cause.what}", cause.why, cause.instead, mark)
            )
        if isinstance(cause, FileNotFoundError):
            lost = printable(Path(str(cause.filename)).name)
            return refuse(
                f"{printable(file.name)}: it includes {quoted(lost)}, which is not there", mark=mark
            )
        if isinstance(cause, RecursionError):
            what = f"{printable(file.name)}: macros, or files that it includes, call each other without end"
            return refuse(what, "", "Delete one of the calls.", mark)
    words = re.sub(r"\s+", " ", str(error) or type(error).__name__)
    what = f"{printable(file.name)}: xacro: {quoted(words, 300)[1:-1]}"
    if not plain:
        return refuse(what, mark=mark)
    return refuse(
        what, f"In {plain[0]} has no prefix, and is passed over.", "Write xacro: before such names.", mark
    )


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error of xacro, and what it wraps."""
    while error is not None:
        yield error
        error = getattr(error, "exc", None)


def _undefined(error: Exception) -> str | None:
    """The argument that an error misses."""
    return next((str(e.args[0]) for e in _causes(error) if type(e).__name__ == "ArgException"), None)


def _with_folders(value: str, packages: Mapping[str, Path]) -> str:
    return re.sub(r"\$\(find ([^)\s]+)\)", lambda match: _package(match[1], packages), value)


def _package(name: str, packages: Mapping[str, Path]) -> str:
    return str(packages[name].resolve()) if name in packages else f"{_UNKNOWN}/{name}"


@contextlib.contextmanager
def _kept(
    xacro: Any,
    roots: list[Path],
    packages: Mapping[str, Path],
    opened: Callable[[Path], object],
    called: list[str],
    trail: _Trail,
) -> Iterator[None]:
    """The package with its doors shut; as it was, afterwards."""
    from unittest.mock import patch  # a slow import that only xacro needs

    from xacro import substitution_args

    evaluate, expand, count = xacro.safe_eval, xacro.handle_macro_call, itertools.count()

    def call(node: Any, *scopes: Any) -> Any:
        called.extend(re.findall("^xacro:(.+)", node.tagName))
        return expand(node, *scopes)

    symbols = offered(xacro.create_global_symbols())
    doors: list[tuple[Any, str, Any]] = [
        (xacro, "open", lambda path, *_: opened(Path(path))),
        (xacro, "glob", SimpleNamespace(glob=lambda pattern: _globbed(pattern, roots))),
        (xacro, "_global_symbols", symbols),
        (xacro, "safe_eval", lambda text, *scopes: weighed(evaluate(checked(text), *scopes))),
        (xacro, "eval_text", counted(xacro.eval_text, count)),
        (xacro, "handle_macro_call", counted(trail.beside(call), count)),
        (xacro, "parse", trail.parsed(xacro.parse)),
        (xacro, "eval_all", trail.inside(xacro.eval_all)),
        (xacro, "check_attrs", trail.beside(xacro.check_attrs)),
        (substitution_args, "_eval", lambda text, context: _evaluated(text, context, symbols)),
        (substitution_args, "_eval_find", lambda name: _package(name, packages)),
        (substitution_args, "_eval_env", _no_environment),
        (substitution_args, "_eval_optenv", lambda name, default="": default),
    ]
    with contextlib.ExitStack() as shut:
        for module, name, door in doors:
            shut.enter_context(patch.object(module, name, door, create=True))
        yield


def _evaluated(text: str, context: Mapping[str, Any], symbols: Mapping[str, Any]) -> str:
    """What ``$(eval …)`` computes: an expression as ``${…}`` is, in which arguments stand by their names. The package
    ends it at its first parenthesis, so it calls nothing."""
    import xacro
    from xacro.substitution_args import convert_value

    given = context["arg"]
    named = given.keys() & re.findall(r"\w+", text)
    arguments = {name: convert_value(str(given[name]), "auto") for name in named}
    return str(xacro.safe_eval(text, {**symbols, **arguments}))


def _no_environment(name: str) -> str:
    raise refuse(f"$(env {quoted(name)[1:-1]}) reads the environment, which import does not")


def _opened(path: Path, file: Path, roots: list[Path], plain: list[str], files: list[Element]) -> io.StringIO:
    """The text of a file below one of ``roots``; XML without document type, its root added to ``files``, and its
    elements of xacro that lack the prefix to ``plain``."""
    where = _inside(path, roots)
    try:
        data = read_at_most(where, MAX_BYTES + 1)
    except ValueError as error:
        raise refuse(f"{printable(path.name)}: {error}") from None
    if where.suffix in (".yaml", ".yml"):
        if len(data) > _YAML_BYTES:
            raise refuse(f"{printable(path.name)}: larger than {_YAML_BYTES // 1024} KiB")
        return io.StringIO(data.decode("utf-8-sig"))
    files.append(parse(data, printable(str(file if where == file.resolve() else path)), strict=True))
    plain += [f"{printable(path.name)} <{e.tag}>" for e in files[-1] if e.tag in _UNPREFIXED]
    return io.StringIO(data.decode("utf-8-sig"))


def _globbed(pattern: str, roots: list[Path]) -> list[str]:
    """The files that match: the pattern is of the name, in a folder below one of ``roots``."""
    _inside(Path(pattern).parent, roots)
    return [str(path) for path in Path(pattern).parent.glob(Path(pattern).name)]


def _inside(path: Path, roots: list[Path]) -> Path:
    """A path resolved, below one of ``roots``."""
    if path.is_relative_to(_UNKNOWN):
        name = str(path.relative_to(_UNKNOWN)).partition("/")[0]
        raise refuse(f"the package {quoted(name)} is not known", "", f"Give --package {printable(name)}=DIR.")
    where = path.resolve()
    if not any(where.is_relative_to(root) for root in roots):
        why = "outside the packages given (--package NAME=DIR)"
        raise PermissionError(errno.EACCES, why, printable(str(path)))
    return where
