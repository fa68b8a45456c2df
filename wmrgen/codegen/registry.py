"""The backends: one entry each, which says all that others need to know.

A backend is imported only when asked for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias, cast

from wmrgen.errors import UsageError
from wmrgen.geometry.ports import NO_SITE, Site

if TYPE_CHECKING:
    from wmrgen.ir.nodes import Function, Module


# A function, and its inputs by contract name; a tunable may be left out.
CasadiFunction: TypeAlias = Any  # casadi.Function; casadi ships no types
CasadiSymbol: TypeAlias = Any  # casadi.SX or casadi.MX
Request = tuple[str, Mapping[str, float]]


class Place(NamedTuple):
    """A function in a generated ``file``: its line, and the lines of the quantities that it names."""

    file: str
    function: str
    line: int
    quantities: tuple[tuple[str, int], ...]


class VectorForm(NamedTuple):
    """A ``function`` of the vectors x, u and p to the vector ``result``: the contract names of the entries of each;
    it may do without some. ``others``: the same function in other operations, of which there may be fewer if
    derivatives count. ``nominal``: the entries of p. ``bounds``: least and most of x, of u and of what `limits` gives,
    in this order. ``name`` of what backends make of it."""

    name: str
    function: Function
    vectors: tuple[tuple[str, ...], ...]
    result: str
    nominal: tuple[float, ...]
    bounds: tuple[tuple[float, ...], ...]
    others: tuple[Function, ...] = ()


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts for the banner of a generated file. Everything is plain text; backends escape it.

    ``wheel_lines``: the wheel table, one finished line per wheel and note. ``model_hash``: hexadecimal digest of the
    model. ``constants``: numbers of the robot file, each with its name, ``left.radius``, and what it is.
    ``bound_lines``: what is proved of the code, for the backend whose code that is. ``site``: what the robot
    file says about inputs. ``options``: what the user chose of what the backend takes. ``places``: where the code of
    other backends computes what (for the report). ``vectors``: the model of the robot as x' = f(x, u, p), where it has
    one, and what has to be 0 where it holds. ``written``: the functions as they were lowered, not optimised.
    """

    description: str = ""
    wheel_lines: tuple[str, ...] = ()
    model_hash: str = ""
    wmrgen_version: str = ""
    sympy_version: str = ""
    bound_lines: tuple[str, ...] = ()
    constants: tuple[tuple[str, float, str], ...] = ()
    site: Site = NO_SITE
    options: Mapping[str, str | bool] = field(default_factory=dict)
    places: tuple[Place, ...] = ()
    vectors: tuple[VectorForm, ...] = ()
    written: Module | None = None


class Backend(Protocol):
    """What the module of a backend offers; ``places(files)`` too, where readers may want lines of its code."""

    def emit(self, module: Module, facts: Facts) -> dict[str, bytes]:
        """File name -> content, for every file of this backend."""

    def evaluate(self, module: Module, requests: Sequence[Request], **options: str) -> list[dict[str, float]]:
        """Outputs by contract name of each request."""


class Files(NamedTuple):
    """Files of one purpose: their names, with ``{robot}`` in place and ``*`` for any function; ``what`` they are,
    for the report (nothing: they are not listed)."""

    names: tuple[str, ...]
    what: str = ""


class Entry(NamedTuple):
    """A backend.

    ``module`` is its import path; ``source`` the attribute of Derivation that it reads: ``module``, ``array_module``,
    ``c_module``, or ``itself`` (a backend for readers). ``word``: what `wmrgen eval --backend` calls it; nothing where
    it computes nothing. ``files``: what it writes. ``options``: of what
    `derive` and `eval` let the user choose, the names that it takes; ``switches``: the same of `derive` alone.
    ``proved``: the proofs are about its code, and it writes them down. ``package``: it writes only where
    `derive --package` asks for it.
    """

    name: str
    module: str
    source: str
    word: str = ""
    files: tuple[Files, ...] = ()
    options: tuple[str, ...] = ()
    switches: tuple[str, ...] = ()
    proved: bool = False
    package: bool = False

    def load(self) -> Backend:
        return cast(Backend, import_module(self.module))

    def offers(self, name: str) -> Any:
        """What this backend offers beyond the protocol, as ``functions`` of CasADi and NumPy; None where it does
        not."""
        return getattr(self.load(), name, None)

    def evaluate(
        self, module: Module, requests: Sequence[Request], options: Mapping[str, str]
    ) -> list[dict[str, float]]:
        """`Backend.evaluate` with those of the options that it takes, of each function and its variants: a backend
        may give the residual in a function of its own, so that who does not need it does not pay. UsageError where
        it has none of them."""
        parts = {
            name: [f.name for f in module.functions if (f.variant_of or f.name) == name]
            for name, _ in requests
        }
        for name in (name for name, variants in parts.items() if not variants):
            has = " ".join(f.name for f in module.functions)
            raise UsageError(f"{self.word} has no function {name!r} of {module.name}. It has: {has}.")
        chosen = {name: options[name] for name in self.options if name in options}
        every = [(part, case) for name, case in requests for part in parts[name]]
        answers = iter(self.load().evaluate(module, every, **chosen))
        zeros = {
            name: {key: 0.0 for f in module.functions if f.name in parts[name] for key in f.zeros}
            for name in parts
        }
        return [
            {key: x for _ in parts[name] for key, x in next(answers).items()} | zeros[name]
            for name, _ in requests
        ]


BACKENDS: dict[str, Entry] = {}
EXACT_WORD = "exact"  # the word of `wmrgen eval --backend` for exact arithmetic, which is no backend


def register(entry: Entry) -> None:
    """Add a backend. ValueError where its name, its word or a file of it is another's."""
    names = {name for files in entry.files for name in files.names}
    for other in BACKENDS.values():
        theirs = {name for files in other.files for name in files.names}
        if entry.name == other.name or (entry.word and entry.word == other.word) or names & theirs:
            raise ValueError(f"backend {entry.name} has the name, a word or a file of backend {other.name}")
    if entry.word == EXACT_WORD:
        raise ValueError(f"{EXACT_WORD} is the word of exact arithmetic")
    BACKENDS[entry.name] = entry


def unasked() -> list[Entry]:
    """The backends that write without being asked for a package."""
    return [entry for entry in BACKENDS.values() if not entry.package]


def of_word(word: str) -> Entry | None:
    """The backend that `wmrgen eval --backend` calls ``word``."""
    return next((entry for entry in BACKENDS.values() if word and entry.word == word), None)


def known_words() -> tuple[str, ...]:
    """What `wmrgen eval --backend` knows."""
    return (EXACT_WORD, *(entry.word for entry in BACKENDS.values() if entry.word))


for _entry in (
    Entry(
        "c99", "wmrgen.codegen.c", "c_module", "c",
        files=(
            Files(("{robot}.h", "{robot}.c"), "the functions in C99"),
            Files(("{robot}_checked.h", "{robot}_checked.c"), "the same behind a check of their inputs"),
            Files(
                ("test/{robot}_selftest.c",),
                "test vectors with exact results, for the machine it is to run on",
            ),
            Files(("test/{robot}_fuzz.c",)),
            Files(("{robot}_many.h", "{robot}_many.c")),
            Files(("example/main.c",), "the loop from sensors to motors, on a figure that the robot can drive"),
        ),
        options=("scalar", "math", "target"), switches=("fuzz", "batch"), proved=True,
    ),
    Entry(
        "numpy", "wmrgen.codegen.arrays", "array_module", "numpy",
        files=(Files(("{robot}.py",), "the functions for NumPy, JAX, PyTorch and CuPy, over arrays of samples"),),
    ),
    Entry(
        "casadi", "wmrgen.codegen.casadi", "module", "casadi",
        files=(
            Files(("{robot}_*.casadi",), "the functions for CasADi, the posture model `dynamics` among them"),
        ),
    ),
    Entry(
        "rust", "wmrgen.codegen.rust", "c_module", "rust",
        options=("scalar", "math", "target"), proved=True, package=True,
    ),
    Entry(
        "javascript", "wmrgen.codegen.javascript", "module", "javascript",
        package=True,
    ),
    Entry(
        "drawing", "wmrgen.report.figures", "itself",
        files=(Files(("layout.svg", "symbols.svg", "motion.svg", "singular.svg", "reach.svg", "wiring.svg")),),
    ),
    Entry(
        "report", "wmrgen.report.sections", "itself",
        files=(
            Files(("report.md",)),
            Files(("numerics.md",), "costs, proved ranges and rounding errors, lines of the code"),
            Files(("wiring.md",), "a check sheet for the bench: the sign of every joint for each motion"),
        ),
    ),
):  # fmt: skip
    register(_entry)
