"""``wmrgen derive`` writes the generated files of robots; ``wmrgen check`` says which of them are out of date.

Both skip a robot whose files are fresh, see `wmrgen.derivation.freshness`. This module is imported before that is
known, so it imports nothing that takes long.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import (
    Json,
    Math,
    Out,
    Robots,
    Scalar,
    Target,
    argument,
    count_option,
    flag,
    option,
    option_with_default,
    robot_files,
    verb,
)
from wmrgen.cli.parallel import in_order, processes_for
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import Difference, Written, differences, write_tree
from wmrgen.derivation.manifest import (
    MANIFEST,
    PAGES,
    Manifest,
    listed_files,
    recorded_inputs,
    recorded_options,
    unlisted,
)
from wmrgen.errors import ErrorCollector, NotDerivableError, StaleError, UsageError, WmrgenError

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.ir.kernels.choice import Choice
    from wmrgen.robotfile.records import RobotSpec

_WHY = {
    "missing": "missing",
    "differs": "not what the robot file gives today",
    "not produced": "no robot file produces it",
}
_MODEL = "model.json"
_PACKAGE = "package-"  # begins the names of folders of packages
_KIND = "package"  # the entry of a package's manifest that names its kind

# Robot files that were read before the workers started: a worker that is a fork need not read them again.
_read: dict[Path, tuple[RobotSpec, Robot]] = {}


class Request(NamedTuple):
    """What to generate of one robot file."""

    path: Path
    scalar: str  # float or double
    math: str  # inline or libm
    target: str  # processor of the C
    switches: tuple[str, ...]  # of fuzz, batch
    formats: tuple[str, ...]  # of html, pdf, tex
    packages: tuple[str, ...]  # kinds of packages
    sketch: bool  # whether a terminal shows a top view

    @property
    def options(self) -> dict[str, str]:
        """The options that the manifest of the robot's folder records."""
        report = {"formats": " ".join(self.formats)} if self.formats else {}
        return self.package_options | report

    @property
    def package_options(self) -> dict[str, str]:
        """The options that the manifest of a package records."""
        choice = {"scalar": self.scalar, "math": self.math, "target": self.target}
        return choice | dict.fromkeys(self.switches, "yes")


class Derived(NamedTuple):
    """What a worker made of a robot file."""

    name: str
    files: dict[str, bytes]  # of the robot's folder, by name
    packages: dict[str, dict[str, bytes]]  # folder of packages -> files of this robot's
    remarks: list[str]  # notes, findings and warnings, in order
    reason: str  # why the robot has its degrees; may be empty
    sketch: list[str]  # lines of the top view
    unproved: str  # functions without proved bounds, although the robot has limits
    error: WmrgenError | None = None  # why there is nothing else


class Task(NamedTuple):
    """A robot file that `derive` was given."""

    path: Path
    inputs: dict[str, str]  # what its files are made from; empty if that cannot be recorded
    fresh: tuple[str, Manifest] | None  # name of the robot and its manifest, if nothing has to be derived


Jobs = Annotated[
    int | None,
    count_option("--jobs", "Processes that derive several robots. Default: one a processor."),
]


def _kinds(incomplete: str) -> list[str]:
    from wmrgen.codegen.packages import PACKAGES

    return [kind for kind in PACKAGES if kind.startswith(incomplete)]


@verb("derive")
def derive(
    robots: Robots,
    out: Out = Path("generated"),
    as_json: Annotated[
        bool, flag("--json", 'Print model.json; for several robots: {"robots": […]}.')
    ] = False,
    scalar: Annotated[Scalar, option_with_default("Scalar type of the generated C.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    fuzz: Annotated[bool, flag("--fuzz", "Write a libFuzzer harness of the C too.")] = False,
    batch: Annotated[bool, flag("--batch", "Write the C functions over arrays of states too.")] = False,
    package: Annotated[
        list[str] | None,
        option(
            "Write DIR/package-KIND/<name>/ too: cmake, arduino, platformio, esp-idf, zephyr, ros2, rust, javascript.",
            "KIND",
            _kinds,
        ),
    ] = None,
    html: Annotated[bool, flag("--html", "Write report.html too: one file, and the robot to drive.")] = False,
    pdf: Annotated[
        bool,
        flag("--pdf", "Write report.pdf too, by an installed LuaLaTeX, XeLaTeX or Chromium."),
    ] = False,
    tex: Annotated[bool, flag("--tex", "Write report.tex too, for lualatex or xelatex.")] = False,
    jobs: Jobs = None,
) -> int:
    """Example:  wmrgen derive robots/pioneer3dx.yaml -o build

    Derive robots and write DIR/<name>/: model, report, C, CasADi, NumPy. A robot whose files are up to date is not
    derived again, unless there were notes or warnings about it.
    """
    comparable = freshness.can_compare()
    request = Request(
        path=Path(),
        scalar=scalar,
        math=math or ("inline" if scalar == "float" else "libm"),  # the same default as `choice`
        target=target,
        switches=tuple(name for name, wanted in (("fuzz", fuzz), ("batch", batch)) if wanted),
        formats=tuple(name for name, wanted in (("html", html), ("pdf", pdf), ("tex", tex)) if wanted),
        packages=tuple(package or ()),
        sketch=len(robots) == 1 and not as_json and console.on_a_terminal(),
    )
    tasks = [_task(path, out, request, comparable) for path in robots]
    made = _derive_all(tasks, request, jobs)
    written = _write_all(tasks, made, out, request)
    if as_json:
        _print_models(tasks, made, out)
        return 0
    for task in tasks:
        if task.fresh:
            _print_fresh(*task.fresh, out)
        else:
            _print_derived(made[task.path], written[task.path], out)
    for task in tasks:
        name = task.fresh[0] if task.fresh else made[task.path].name
        for kind in dict.fromkeys(request.packages):
            folder = out / f"{_PACKAGE}{kind}" / name
            console.result(f"  {folder.as_posix()}/: {' '.join(listed_files(folder))}")
    return 0


def _task(path: Path, out: Path, request: Request, comparable: bool) -> Task:
    """Return what has to be done for a robot file. A robot with remarks is derived again, so that they are repeated."""
    content = freshness.robot_bytes(path) if comparable else None
    if content is None:
        return Task(path, {}, None)
    inputs = freshness.inputs(content)
    name = freshness.name_in(content)
    manifest = freshness.fresh(out / name, inputs, request.options) if name else None
    if name is None or manifest is None or freshness.REMARKS in manifest.made_from:
        return Task(path, inputs, None)
    for kind in request.packages:
        folder = out / f"{_PACKAGE}{kind}" / name
        if not freshness.fresh(folder, _package_inputs(inputs, kind), request.package_options):
            return Task(path, inputs, None)
    return Task(path, inputs, (name, manifest))


def _package_inputs(inputs: Mapping[str, str], kind: str) -> dict[str, str]:
    """Return what the manifest of a package records; nothing if the robot's records nothing."""
    return {**inputs, _KIND: kind} if inputs else {}


def _derive_all(tasks: Sequence[Task], request: Request, jobs: int | None) -> dict[Path, Derived]:
    """Derive the robots that are not fresh; no file is written before all robot files are read and all are derived."""
    names: dict[str, Path] = {}
    for task in tasks:
        if task.fresh:
            _take_name(names, task.fresh[0], task.path)
    paths = [task.path for task in tasks if not task.fresh]
    if not paths:
        return {}
    from wmrgen.ir.kernels.choice import choice

    choice(request.scalar, request.math, request.target)  # refuses what does not go together
    if request.packages:
        from wmrgen.codegen.packages import of_kinds

        of_kinds(request.packages)  # refuses unknown kinds
    made: dict[Path, Derived] = {}
    with console.progress() as step:
        _load_all(paths, names)
        import wmrgen.derivation.emit  # noqa: F401  sympy: a file that is refused need not wait for it

        requests = [request._replace(path=path) for path in paths]
        results = in_order(derive_one, requests, processes_for(len(paths), jobs))
        for number, path in enumerate(paths, 1):
            step(f"deriving {_read[path][1].name} ({number} of {len(paths)})")
            made[path] = next(results)
            for remark in made[path].remarks:
                console.note(remark)
            if error := made[path].error:
                raise error
    return made


def _take_name(names: dict[str, Path], name: str, path: Path) -> None:
    """Record the name of a robot. UsageError if another file has it too."""
    word = name.lower()  # some disks do not distinguish upper and lower case
    if word in names:
        raise UsageError(f"{path} and {names[word]} both describe a robot called {name}")
    names[word] = path


def _load_all(paths: Sequence[Path], names: dict[str, Path]) -> None:
    """Read all robot files, so that a bad one leaves nothing behind, and check that no two robots have one name."""
    collector = ErrorCollector()
    for path in paths:
        with collector:
            _read[path] = wmrgen.read(path)
    collector.end()
    for path in paths:
        _take_name(names, _read[path][1].name, path)


def derive_one(request: Request) -> Derived:
    """Derive one robot; a mistake in its file is returned as ``error``."""
    from wmrgen.codegen.packages import of_kinds
    from wmrgen.codegen.registry import BACKENDS
    from wmrgen.derivation.emit import artifacts
    from wmrgen.derivation.emit import package as packaged
    from wmrgen.ir.kernels.choice import choice

    spec, robot = _read.get(request.path) or wmrgen.read(request.path)
    remarks: list[str] = []
    try:
        derivation = derived(spec, robot, remarks.append)
        chosen = choice(request.scalar, request.math, request.target)
        files = artifacts(derivation, chosen, request.switches)
        if request.formats:
            from wmrgen.report.pages.formats import formatted

            files |= formatted(derivation, files, request.formats)
        packages = {}
        for kind in of_kinds(request.packages):
            packages[kind.folder] = packaged(kind, derivation, chosen, files)
        sketch = BACKENDS["drawing"].offers("sketch")(robot) if request.sketch else []
        unproved = [f.name for f in derivation.bounds.functions if f.alarms]
        reason = derivation.mobility.deciding.partition("\n")[0]
    except WmrgenError as error:
        return Derived(robot.name, {}, {}, remarks, "", [], "", error)
    return Derived(robot.name, files, packages, remarks, reason, sketch, ", ".join(unproved))


def derived(spec: RobotSpec, robot: Robot, say: Callable[[str], None] = console.note) -> Derivation:
    """Return the derivation of a robot after its notes and likely mistakes are reported.

    Args:
        spec: What the robot file says.
        robot: The robot that it describes.
        say: Called with each note, finding and warning.

    Returns:
        The derivation.

    Raises:
        NotDerivableError: A finding stops the derivation, or the robot cannot have a function that the file requests.
    """
    from wmrgen.cli.loading import linted
    from wmrgen.geometry.notation import listed, plain

    derivation = wmrgen.derive(robot)
    findings = linted(spec, derivation)
    reported = {finding.what for finding in findings}
    for note in map(plain, robot.notes):
        if note not in reported:
            say(f"note: {robot.name}: {note}")
    if robot.gains:
        from wmrgen.functions.control.gains import warnings

        for warning in warnings(robot, "goto_pose" in robot.functions):
            say(f"warning: {robot.name}: {warning}")
    for finding in findings:
        if finding.stops:
            ignored = f"To derive it all the same write beside the line: # wmrgen: ignore {finding.code}"
            raise NotDerivableError(finding.what, finding.mark, finding.instead, ignored, finding.code)
        say(str(finding))
    # This refuses trailers and virtual wheels that the robot cannot have.
    _ = derivation.mobility
    _refuse_functions(spec, derivation)
    if unused := _unused_sections(spec):
        from wmrgen.functions.registry import declaration, names

        readers = [name for name in names() if set(declaration(name).reads) & set(unused)]
        say(
            f"note: {robot.name}: no function of the generated C uses {listed(unused, 'or')}. List one of these under "
            f"functions if the robot has it (`wmrgen functions`): {', '.join(readers)}"
        )
    return derivation


def _unused_sections(spec: RobotSpec) -> list[str]:
    """Return the sections of a robot file that no function of its C uses."""
    from wmrgen.functions.registry import SECTIONS, declaration

    given = {
        "trailers": bool(spec.trailers),
        "cg": spec.cg is not None,
        "encoder": bool(spec.encoders) or any(w.encoders for w in spec.wheels),
        "noise": bool(spec.noise) or any(w.noise for w in spec.wheels),
    }
    used = {section for function in spec.functions for section in declaration(function.name).reads}
    return [section for section in SECTIONS if given[section] and section not in used]


def _refuse_functions(spec: RobotSpec, derivation: Derivation) -> None:
    """Raise one NotDerivableError for all requested functions that the robot cannot have, each at its place."""
    lacking = []
    for name, mark in spec.functions:
        try:
            derivation.formula(name)
        except NotDerivableError as error:
            error.mark = error.mark or mark
            lacking.append(error)
    if lacking:
        joined = NotDerivableError(lacking[0].what, lacking[0].mark)
        joined.parts = tuple(lacking)
        raise joined


def _recorded(made: Derived, inputs: Mapping[str, str]) -> dict[str, str]:
    """Return the inputs for the manifest, with the number of remarks if there are any."""
    count = len(made.remarks) + bool(made.unproved)
    return {**inputs, freshness.REMARKS: str(count)} if inputs and count else dict(inputs)


def _write_all(
    tasks: Sequence[Task], made: Mapping[Path, Derived], out: Path, request: Request
) -> dict[Path, Written]:
    """Write the folders of all robots, then their packages."""
    written: dict[Path, Written] = {}
    derived_tasks = [task for task in tasks if task.path in made]
    for task in derived_tasks:
        robot = made[task.path]
        inputs = _recorded(robot, task.inputs)
        written[task.path] = write_tree(out / robot.name, robot.files, request.options, inputs)
    for task in derived_tasks:
        robot = made[task.path]
        for folder, files in robot.packages.items():
            inputs = _package_inputs(task.inputs, folder.removeprefix(_PACKAGE))
            write_tree(out / folder / robot.name, files, request.package_options, inputs)
    return written


def _print_models(tasks: Sequence[Task], made: Mapping[Path, Derived], out: Path) -> None:
    models = []
    for task in tasks:
        content = (out / task.fresh[0] / _MODEL).read_bytes() if task.fresh else made[task.path].files[_MODEL]
        models.append(content.decode().rstrip("\n"))
    console.result(models[0] if len(models) == 1 else '{"robots": [\n' + ",\n".join(models) + "\n]}")


def _print_fresh(name: str, manifest: Manifest, out: Path) -> None:
    """Print what a robot is, and that nothing was written."""
    _print_type(json.loads((out / name / _MODEL).read_bytes()))
    files = [*manifest.files, MANIFEST]
    console.result(f"  {(out / name).as_posix()}/ (all up to date): {_listed(files)}")


def _print_derived(made: Derived, written: Written, out: Path) -> None:
    """Print what a robot is, and what was written."""
    _print_type(json.loads(made.files[_MODEL]))
    if made.reason:
        console.result(f"  {made.reason}")
    for line in made.sketch:
        console.result(f"    {line}".rstrip())
    files = written.changed + written.unchanged
    state = f"{len(written.changed)} new or changed" if written.changed else "all up to date"
    console.result(f"  {(out / made.name).as_posix()}/ ({state}): {_listed(files)}")
    if made.unproved:
        console.note(
            f"{made.name}: not proved, although limits are given: {made.unproved} (numerics.md says why)"
        )
    for file in written.removed:
        console.note(f"{made.name}: removed {file}, which is no longer produced")


def _print_type(model: Mapping[str, Any]) -> None:
    """Print the degrees of a robot from its model.json."""
    kind = model["robot_type"]
    title = f"type ({kind[0]}, {kind[1]})" if kind else "degenerate"
    console.result(
        f"{model['name']}: {title}, mobility {model['degree_of_mobility']}, "
        f"steerability {model['degree_of_steerability']}, maneuverability {model['degree_of_maneuverability']}",
        "bold",
    )


def _listed(files: Sequence[str]) -> str:
    """Return the names of files in one line; more than four files with one ending are counted instead."""
    endings = [PurePosixPath(file).suffix for file in files]
    count = Counter(endings)
    words = {f"*{e} ({count[e]})" if count[e] > 4 else file for file, e in zip(files, endings, strict=True)}
    return " ".join(sorted(words))


class Check(NamedTuple):
    """A robot file whose generated files are to be compared."""

    path: Path
    out: Path


class Checked(NamedTuple):
    """How the generated files of a robot differ from what its file gives today."""

    name: str
    stale: list[Difference]
    error: WmrgenError | None = None  # why the robot cannot be derived


@verb("check")
def check(
    robots: Annotated[
        list[Path] | None, argument("ROBOT.yaml...", "Default: robots/*.yaml.", robot_files)
    ] = None,
    out: Out = Path("generated"),
    full: Annotated[
        bool,
        flag("--full", "Derive every robot, even if its manifest says that nothing changed."),
    ] = False,
    jobs: Jobs = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen check

    Report which generated files are not what the robot files give today. Exit code 1 if there are any.
    """
    comparable = freshness.can_compare() and not full
    paths = robots or sorted(Path("robots").glob("*.yaml"))
    if not paths:
        raise UsageError("no robot file is given, and there is no robots/*.yaml here. Name a robot file.")
    checked: dict[Path, Checked] = {}
    if comparable:
        checked = {path: Checked(name, []) for path in paths if (name := _fresh_robot(path, out))}
    stale_paths = [path for path in paths if path not in checked]
    with console.progress() as step:
        requests = [Check(path, out) for path in stale_paths]
        results = in_order(check_one, requests, processes_for(len(requests), jobs))
        for number, path in enumerate(stale_paths, 1):
            step(f"checking {path} ({number} of {len(stale_paths)})")
            checked[path] = next(results)
    in_file_order = [checked[path] for path in paths]
    errors = [robot.error for robot in in_file_order if robot.error]
    stale = [difference for robot in in_file_order for difference in robot.stale]
    if not robots and not errors:
        from wmrgen.cli.gallery import differing_gallery
        from wmrgen.cli.textbook import differing_library

        try:
            stale += differing_library(out, comparable)
        except WmrgenError as error:  # the folder is here, the library is not
            errors.append(error)
        names = {robot.name for robot in in_file_order}
        stale += [*differing_gallery(out, comparable), *_strangers(out, names, comparable)]
    for failure in errors:
        console.failure(str(failure))
    _print_stale(stale, errors, len(paths), out, as_json)
    if comparable and not stale and not errors and stale_paths and not as_json:
        count = f"{len(stale_paths)} of {len(paths)}" if len(paths) > 1 else "the"
        console.note(
            f"The manifests of {count} robots record other inputs (wmrgen, Python or a library), so these robots were "
            "derived to compare them. `wmrgen derive` updates the manifests."
        )
    return errors[0].exit_code if errors else (StaleError.exit_code if stale else 0)


def _print_stale(
    stale: Sequence[Difference], errors: Sequence[WmrgenError], robots: int, out: Path, as_json: bool
) -> None:
    files = [(difference.path.as_posix(), _WHY[difference.why]) for difference in stale]
    if as_json:
        entries = [{"file": file, "why": why} for file, why in files]
        console.data({"robots": robots, "stale": entries, **console.all_as_data(errors)})
        return
    for file, why in files:
        console.result(f"{file}: {why}")
    if stale:
        console.note(
            "Run `wmrgen derive` on the robot files, then `wmrgen gallery`; remove files that have no robot file."
        )
    elif not errors:
        count = f"{robots} robot{'s' * (robots != 1)}"
        console.result(f"{count}: everything under {out.as_posix()}/ is up to date")


def _fresh_robot(path: Path, out: Path) -> str | None:
    """Return the name of a robot if its folder and its packages are fresh and have no other files, else None."""
    content = freshness.robot_bytes(path)
    name = freshness.name_in(content) if content else None
    if content is None or name is None:
        return None
    inputs = freshness.inputs(content)
    folders = {out / name: inputs}
    for folder in out.glob(f"{_PACKAGE}*/{name}"):
        folders[folder] = _package_inputs(inputs, folder.parent.name.removeprefix(_PACKAGE))
    for folder, expected in folders.items():
        manifest = freshness.fresh(folder, expected)
        if manifest is None or unlisted(folder, list(manifest.files)):
            return None
    return name


def check_one(request: Check) -> Checked:
    """Derive one robot with the options that its manifests record, and compare its folder and its packages."""
    from wmrgen.codegen.packages import PACKAGES
    from wmrgen.derivation.emit import artifacts
    from wmrgen.derivation.emit import package as packaged
    from wmrgen.ir.kernels.choice import noted as choice_of

    path, out = request
    stale: list[Difference] = []
    try:
        robot = wmrgen.load(path)
        derivation = wmrgen.derive(robot)
        folders = {out / kind.folder / robot.name: kind for kind in PACKAGES.values()}
        for folder in (out / robot.name, *(folder for folder in folders if folder.is_dir())):
            words = recorded_options(folder)
            choice, formats = choice_of(words), words.get("formats", "").split()
            switches = [name for name in ("fuzz", "batch") if name in words]
            files = artifacts(derivation, choice, switches)
            if folder in folders:
                files = packaged(folders[folder], derivation, choice, files)
            if formats:
                files |= _recorded_formats(derivation, files, folder, formats)
            stale += differences(folder, files, _options(choice, switches, formats))
    except WmrgenError as error:
        return Checked("", [], error)
    return Checked(robot.name, stale)


def _options(choice: Choice, switches: Sequence[str], formats: Sequence[str]) -> dict[str, str]:
    """Return the options as the manifest of a folder records them."""
    report = {"formats": " ".join(formats)} if formats else {}
    return choice.words() | dict.fromkeys(switches, "yes") | report


def _recorded_formats(
    derivation: Derivation, files: Mapping[str, bytes], folder: Path, formats: Sequence[str]
) -> dict[str, bytes]:
    """Return the report in the formats that a manifest records. A PDF is taken as it is: browsers print differently."""
    from wmrgen.report.pages.formats import PDF, formatted

    again = formatted(derivation, files, [name for name in formats if name != "pdf"])
    printed = folder / PDF
    return {**again, PDF: printed.read_bytes()} if "pdf" in formats and printed.is_file() else again


def _strangers(out: Path, names: set[str], comparable: bool) -> list[Difference]:
    """Return what is in ``out``, or in a folder of packages there, and belongs to no robot."""
    from wmrgen.cli.textbook import ERRATA, FOLDER

    places = {out: {*names, FOLDER, ERRATA, *PAGES, MANIFEST}}
    for folder in out.glob(f"{_PACKAGE}*"):
        if _holds_packages(folder, names, comparable):
            places[out].add(folder.name)
            places[folder] = names
    found = []
    for place, expected in places.items():
        if place.is_dir():
            found += [path for path in sorted(place.iterdir()) if path.name not in expected]
    return [Difference(path, "not produced") for path in found]


def _holds_packages(folder: Path, names: set[str], comparable: bool) -> bool:
    """Return whether a folder is one of packages: by a manifest in it that is fresh, else by its name."""
    kind = folder.name.removeprefix(_PACKAGE)
    if comparable and any(recorded_inputs(folder / name).get(_KIND) == kind for name in names):
        return True
    from wmrgen.codegen.packages import PACKAGES

    return kind in PACKAGES
