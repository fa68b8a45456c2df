"""The backends: an entry for each, with all that other modules need to know of it.

A backend is imported only when it is used.
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


CasadiFunction: TypeAlias = Any  # casadi.Function; casadi ships no types
CasadiSymbol: TypeAlias = Any  # casadi.SX or casadi.MX
# A function, and its inputs by contract name; tunables may be left out.
Request = tuple[str, Mapping[str, float]]


class Place(NamedTuple):
    """The place of a function in a generated file."""

    file: str
    function: str
    line: int
    quantities: tuple[tuple[str, int], ...]  # named quantities that the function computes, with their lines


class VectorForm(NamedTuple):
    """A function of the vectors x, u and p, for optimisers."""

    name: str  # of the function in generated code
    function: Function
    vectors: tuple[tuple[str, ...], ...]  # contract names of the entries of x, u and p; some may be unused
    result: str  # name of the resulting vector
    nominal: tuple[float, ...]  # entries of p
    bounds: tuple[tuple[float, ...], ...]  # lower and upper bounds of x, of u, and of the results of `limits`
    others: tuple[
        Function, ...
    ] = ()  # the same function in other operations, which may have shorter derivatives


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts about a robot for its generated files. Texts are plain; backends escape them."""

    description: str = ""
    wheel_lines: tuple[str, ...] = ()  # table of the wheels: a line for each wheel and each note
    model_hash: str = ""  # hexadecimal digest of the model
    wmrgen_version: str = ""
    sympy_version: str = ""  # no banner has it: a patch of sympy would change every generated file
    bound_lines: tuple[str, ...] = ()  # proved bounds, for the backend whose code they are about
    constants: tuple[
        tuple[str, float, str], ...
    ] = ()  # numbers of the robot file: name (left.radius), value, text
    # Joint of the module (left.spin) -> its name in ROS, and the sign of its rotation there.
    joint_names: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    motors: frozenset[str] = frozenset()  # joints of the module that have a motor
    frame: str = ""  # name of the robot frame in ROS
    robot_type: tuple[int, int] | None = None  # degrees of mobility and steerability; None: degenerate
    site: Site = NO_SITE  # what the robot file says about inputs
    # Options of the backend that the user chose.
    options: Mapping[str, str | bool] = field(default_factory=dict)
    places: tuple[Place, ...] = ()  # functions in the code of other backends, for the report
    vectors: tuple[
        VectorForm, ...
    ] = ()  # the model x' = f(x, u, p), and the constraints under which it holds
    written: Module | None = None  # the functions before optimisation


class Backend(Protocol):
    """The functions of a backend's module. It may also have ``places(files)``, if the report refers to its code."""

    def emit(self, module: Module, facts: Facts) -> dict[str, bytes]:
        """Return the content of every file of this backend by name."""

    def evaluate(self, module: Module, requests: Sequence[Request], **options: str) -> list[dict[str, float]]:
        """Return the outputs of each request by contract name."""


class Files(NamedTuple):
    """Files of one purpose."""

    names: tuple[str, ...]  # with {robot} for the name of the robot, and * for that of any function
    what: str = ""  # text for the report; the report does not list files without a text


class Entry(NamedTuple):
    """A backend."""

    name: str
    module: str  # import path
    source: str  # attribute of Derivation that it reads: module, array_module, c_module, or itself (for documents)
    word: str = ""  # of `wmrgen eval --backend`; "" if it computes nothing
    files: tuple[Files, ...] = ()
    options: tuple[str, ...] = ()  # options of `derive` and `eval` that it takes
    switches: tuple[str, ...] = ()  # switches of `derive` that it takes
    proved: bool = False  # whether bounds are proved for its code, and it prints them
    package: bool = False  # whether it writes only for `derive --package`

    def load(self) -> Backend:
        """Import the module of the backend."""
        return cast(Backend, import_module(self.module))

    def offers(self, name: str) -> Any:
        """Return a function of the module that the protocol does not require; None if the module lacks it."""
        return getattr(self.load(), name, None)

    def evaluate(
        self, module: Module, requests: Sequence[Request], options: Mapping[str, str]
    ) -> list[dict[str, float]]:
        """Return the outputs of each request by contract name, including outputs of the function's variants.

        A function and its variants may give different outputs, for example the residual, so that a caller who does not
        need an output does not pay for it.

        Args:
            module: The functions of the robot.
            requests: Names of functions with their inputs.
            options: Options of the user. The backend gets those that it takes.

        Raises:
            UsageError: The robot has no such function.
        """
        parts: dict[str, list[str]] = {}  # function -> names of the function and its variants
        for name, _ in requests:
            parts[name] = [f.name for f in module.functions if (f.variant_of or f.name) == name]
            if not parts[name]:
                has = " ".join(f.name for f in module.functions)
                raise UsageError(f"{self.word} has no function {name!r} of {module.name}. It has: {has}.")
        chosen = {name: options[name] for name in self.options if name in options}
        every = [(part, case) for name, case in requests for part in parts[name]]
        answers = iter(self.load().evaluate(module, every, **chosen))
        results = []
        for name, _ in requests:
            outputs: dict[str, float] = {}
            for _ in parts[name]:
                outputs |= next(answers)
            for part in parts[name]:
                outputs |= dict.fromkeys(module.function(part).zeros, 0.0)
            results.append(outputs)
        return results


BACKENDS: dict[str, Entry] = {}
EXACT_WORD = "exact"  # of `wmrgen eval --backend`: exact arithmetic, which is not a backend


def register(entry: Entry) -> None:
    """Add a backend. Raise ValueError if another backend has its name, its word or one of its files."""
    names = {name for files in entry.files for name in files.names}
    for other in BACKENDS.values():
        theirs = {name for files in other.files for name in files.names}
        if entry.name == other.name or (entry.word and entry.word == other.word) or names & theirs:
            raise ValueError(f"backend {entry.name} has the name, the word or a file of backend {other.name}")
    if entry.word == EXACT_WORD:
        raise ValueError(f"the word {EXACT_WORD} is reserved for exact arithmetic")
    BACKENDS[entry.name] = entry


def unasked() -> list[Entry]:
    """Return the backends whose files `derive` writes without `--package`."""
    return [entry for entry in BACKENDS.values() if not entry.package]


def of_word(word: str) -> Entry | None:
    """Return the backend with this word of `wmrgen eval --backend`; None if there is none."""
    return next((entry for entry in BACKENDS.values() if word and entry.word == word), None)


def known_words() -> tuple[str, ...]:
    """Return all words of `wmrgen eval --backend`."""
    return (EXACT_WORD, *(entry.word for entry in BACKENDS.values() if entry.word))


for _entry in (
    Entry(
        "c99", "wmrgen.codegen.c", "c_module", "c",
        files=(
            Files(("{robot}.h", "{robot}.c"), "the functions in C99"),
            Files(("{robot}_checked.h", "{robot}_checked.c"), "the same functions with a check of their inputs"),
            Files(
                ("test/{robot}_selftest.c",),
                "test vectors with exact results, to run on the target machine",
            ),
            Files(("test/{robot}_fuzz.c",)),
            Files(("{robot}_many.h", "{robot}_many.c")),
            Files(("example/main.c",), "a control loop from sensors to motors, on a figure that the robot can drive"),
        ),
        options=("scalar", "math", "target"), switches=("fuzz", "batch"), proved=True,
    ),
    Entry(
        "numpy", "wmrgen.codegen.arrays", "array_module", "numpy",
        files=(Files(("{robot}.py",), "the functions for arrays of NumPy, JAX, PyTorch and CuPy"),),
    ),
    Entry(
        "casadi", "wmrgen.codegen.casadi", "module", "casadi",
        files=(
            Files(("{robot}_*.casadi",), "the functions for CasADi, including the posture model `dynamics`"),
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
        files=(
            Files((
                "layout.svg", "symbols.svg", "contact.svg", "motion.svg", "singular.svg", "reach.svg", "wiring.svg",
            )),
        ),
    ),
    Entry(
        "report", "wmrgen.report.sections", "itself",
        files=(
            Files(("report.md",)),
            Files(("numerics.md",), "operation counts, proved ranges and rounding errors, lines of the code"),
            Files(("wiring.md",), "a check sheet for commissioning: the sign of every joint for each motion"),
        ),
    ),
):  # fmt: skip
    register(_entry)
