"""The table of keys: the reader, the JSON Schema, the reference page and the wheel types agree on it."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from tests.conftest import GALLERY, ROOT, Outcome
from tests.depth import everyday, examples
from tests.robotfile.files import read
from wmrgen import robot_of
from wmrgen.errors import Code, Mark, RobotFileError
from wmrgen.functions.control.gains import TEXTBOOK
from wmrgen.functions.registry import check, optional_names
from wmrgen.geometry.layout import build
from wmrgen.robotfile.fields import (
    Amount,
    Field,
    Interval,
    Letter,
    ListOf,
    Name,
    OneOf,
    OuterName,
    Text,
    Version,
)
from wmrgen.robotfile.keys import GAINS, JOINTS, ROBOT, SECTIONS, VIRTUAL, WHEEL
from wmrgen.robotfile.numbers import Kind, spellings_of
from wmrgen.robotfile.quantities import parse_value
from wmrgen.robotfile.reference import example, reference
from wmrgen.robotfile.schema import MODELINE, SCHEMA_FILE, json_schema
from wmrgen.robotfile.text import Scalar
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

SCHEMA = json_schema(optional_names())
VALIDATOR = Draft202012Validator(SCHEMA)
WRONG: tuple[Any, ...] = ({"no such": {}}, [["nested"]], None, True)
WORDS = ("snap", "slip", "precise", "tunable")
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
MUTATED = ("ackermann_car", "car_with_trailers", "kuka_youbot", "pioneer3dx", "pr2", "wpilib_swervebot")
Path_ = tuple[Any, ...]


def accepted(document: Any) -> bool:
    """Whether the reader accepts the document, written as YAML."""
    try:
        spec = read(yaml.dump(document, Dumper=DUMPER, sort_keys=False, allow_unicode=True))
        build(spec)
        check(spec.functions)
    except RobotFileError:
        return False
    return True


def places(node: Any, path: Path_ = ()) -> Iterator[Path_]:
    """The path of every value in a document."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


def unlike(document: Any) -> list[int]:
    """Indices of the wheels that differ in type or keys from the wheels before them."""
    forms = [(wheel["type"], *sorted(wheel)) for wheel in document["wheels"]]
    return [k for k, form in enumerate(forms) if forms.index(form) == k]


def at(document: Any, path: Path_) -> Any:
    for key in path:
        document = document[key]
    return document


def mutants(document: Any) -> Iterator[tuple[str, Any]]:
    """Documents with one thing wrong: a key misspelled, a required one left out, a value of the wrong form."""
    numbers = unlike(document)
    for path in places(document):
        if path[0] == "wheels" and len(path) > 1 and path[1] not in numbers:
            continue
        *above, key = path
        if isinstance(key, str) and (not above or above[-1] != "parameters"):
            changed = copy.deepcopy(document)
            inside = at(changed, tuple(above))
            inside[f"{key}_"] = inside.pop(key)
            yield f"{path} misspelled", changed
        for wrong in WRONG:
            text = key in ("description", "source") and wrong in (None, True)
            if text or (wrong is True and key in WORDS):
                continue  # which is right
            changed = copy.deepcopy(document)
            at(changed, tuple(above))[key] = wrong
            yield f"{path} = {wrong}", changed
    for key in ("wmrgen", "name", "wheels"):
        yield f"without {key}", {k: v for k, v in document.items() if k != key}
    for k in numbers:
        wheel = document["wheels"][k]
        required = ("name", "type", *WHEEL_TYPES[wheel["type"]].required)
        pairs = [("heading", "beta"), ("x", "l"), ("y", "l"), ("l", "x"), ("alpha", "x")]
        changes = [{key: None} for key in required]
        changes += [{extra: 0.5} for key, extra in pairs if key in wheel]
        kind = WHEEL_TYPES[wheel["type"]]
        changes += [{f.key: 0.5} for f in WHEEL.fields if f.misfit and not kind.takes(f.key)]
        for change in changes:
            changed = copy.deepcopy(document)
            for key, value in change.items():
                changed["wheels"][k].pop(key, None)
                if value is not None:
                    changed["wheels"][k][key] = value
            yield f"wheel {k}: {change}", changed


def test_the_schema_is_valid() -> None:
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_the_schema_accepts_every_robot(path: Path) -> None:
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert [error.message for error in VALIDATOR.iter_errors(document)] == []


@pytest.mark.parametrize("name", everyday(MUTATED, ("ackermann_car",)))
@pytest.mark.slow
def test_reader_and_schema_refuse_what_is_wrong(name: str) -> None:
    document = yaml.safe_load((ROOT / "robots" / f"{name}.yaml").read_text(encoding="utf-8"))
    assert accepted(document)
    for what, mutant in mutants(document):
        assert not accepted(mutant), what
        assert not VALIDATOR.is_valid(mutant), what


FIXED = {"name": "left", "type": "fixed", "x": 7, "y": 1, "heading": 3, "r": "5 cm"}
MARKED = {
    ("y",): ("required", "'y'"),
    ("x", "y"): ("required", "x: and y:"),
    ("heading",): ("required", "heading: 0"),
    ("r=TODO",): ("r", "[m]"),
    ("r=[1, 2]",): ("r", "(m, mm,"),
    ("name=front-left",): ("name", "31"),
    ("beta=1",): ("properties", "3"),
    ("l=1", "alpha=0"): ("properties", "7"),
    ("x", "y", "l=1", "alpha=5", "α=0"): ("properties", "5"),
    ("limits={spin: [1, 2, 3]}",): ("spin", "[rad/s]"),
    ("limits={spin: 3 m}",): ("spin", "[rad/s]"),
}


@pytest.mark.parametrize("changes", MARKED, ids=" ".join)
def test_editors_mark_a_mistake_once(changes: tuple[str, ...]) -> None:
    """A change without a value removes the key. yaml-language-server shows ``errorMessage`` if there is one."""
    wheel: dict[str, Any] = dict(FIXED)
    for key, equals, value in (change.partition("=") for change in changes):
        wheel.pop(key, None)
        wheel |= {key: yaml.safe_load(value)} if equals else {}
    (error,) = VALIDATOR.evolve(schema={**SCHEMA["$defs"]["fixed"], "$defs": SCHEMA["$defs"]}).iter_errors(
        wheel
    )
    said = (
        error.schema.get("errorMessage", error.message) if isinstance(error.schema, dict) else error.message
    )
    place, words = MARKED[changes]
    assert [*error.schema_path, *error.path][-1] == place and words in said


def test_editors_show_units_and_defaults() -> None:
    wheel = SCHEMA["$defs"]["swedish"]["properties"]
    shown = [
        wheel["gamma"],
        wheel["weight"],
        SCHEMA["properties"]["angles"],
        wheel["limits"]["properties"]["spin"],
    ]
    ends = (" [rad]; default: 0", "; default: 1", "; default: rad", " [rad/s]")
    assert all(each["description"].endswith(end) for each, end in zip(shown, ends, strict=True))


def quantity(text: str, kind: Kind) -> bool:
    """Whether the reader accepts a text as a quantity of a kind, with the parameters p and q."""
    try:
        parse_value(Scalar(Mark("bot.yaml", 1, 1, text), text, False), ("p", "q"), kind, "x")
    except RobotFileError:
        return False
    return True


def pattern(kind: Kind) -> str:
    return str(SCHEMA["$defs"][kind.name.lower()]["pattern"])


TOKENS = "p q pi π 12 0.5 .5 1e5 2E-3 e ( ) + - * ** / , sin( atan2(".split()
TOKENS += [" ", "\t", *(unit for kind in Kind for unit in spellings_of(kind))]


@settings(max_examples=examples(300), derandomize=True)
@given(st.lists(st.sampled_from(TOKENS), min_size=1, max_size=7).map("".join), st.sampled_from(Kind))
def test_the_schema_accepts_every_quantity_that_is_read(text: str, kind: Kind) -> None:
    assert re.search(pattern(kind), text) or not quantity(text, kind)


@pytest.mark.parametrize("kind", Kind)
def test_reader_and_schema_accept_the_same_units(kind: Kind) -> None:
    """A number may have a unit of the kind, in any spelling, but no other word."""
    units = [unit for each in Kind for unit in spellings_of(each)]
    words = [f"{gap}{word}" for gap in ("", " ") for word in (*units, *'pi inch e e5 m² "'.split(), "")]
    for text in (number + word for number in ("3", "-.5", "1.5") for word in words):
        assert bool(re.search(pattern(kind), text)) is quantity(text, kind), text


def test_the_page_is_fresh() -> None:
    page = (ROOT / "docs" / "robot_file.md").read_text(encoding="utf-8")
    assert page == reference(), "run: wmrgen schema --markdown > docs/robot_file.md"


def test_the_schema_beside_the_gallery_is_fresh_and_every_robot_names_it() -> None:
    text = (ROOT / "robots" / SCHEMA_FILE).read_text(encoding="utf-8")
    assert json.loads(text) == SCHEMA, f"run: wmrgen schema > robots/{SCHEMA_FILE}"
    assert not [p.name for p in GALLERY if not p.read_text(encoding="utf-8").startswith(f"{MODELINE}\n")]


def test_the_command_prints_both(wmrgen_cli: Callable[..., Outcome]) -> None:
    schema, again, page = (wmrgen_cli("schema", *words) for words in ((), ("--json",), ("--markdown",)))
    assert schema == again
    assert schema.code == 0 and yaml.safe_load(schema.out) == SCHEMA
    assert page == Outcome(0, reference(), "")
    assert wmrgen_cli("schema", "--json", "--markdown").code == 2


def test_wheel_types_have_existing_keys() -> None:
    own = {f.key for f in WHEEL.fields if f.misfit}
    common = set(WHEEL.keys) - own
    for kind in WHEEL_TYPES.values():
        assert set(kind.keys) <= own
        assert set(kind.required) <= own | common and not set(kind.required) & set(kind.keys)
        assert all(WHEEL.field(key).missing for key in kind.required), "a required key needs its message"
        assert not any(kind.takes(key) for key in kind.misfits) and set(kind.misfits) <= own
    assert all(any(kind.takes(key) for kind in WHEEL_TYPES.values()) for key in own), (
        "a key that no wheel takes"
    )


@pytest.mark.parametrize("name", SECTIONS)
def test_hints_lead_to_one_key(name: str) -> None:
    section = SECTIONS[name]
    assert len(set(section.keys)) == len(section.keys)
    aliases = [alias for f in section.fields for alias in f.aliases]
    assert len(set(aliases)) == len(aliases)
    assert not set(aliases) & set(section.keys)
    assert all(key in section.keys for choice in section.choices for keys in choice.sets for key in keys)


def test_default_gains_are_those_of_the_textbook() -> None:
    assert {f.key: float(f.default) for f in GAINS.fields} == {k: float(v) for k, v in TEXTBOOK.items()}
    assert all(isinstance(f.value, Amount) for f in GAINS.fields)


WHERE = {
    "`limits`, of the robot or of a wheel": "limits: {{{}}}",
    "`noise`, of the robot or of a wheel": "noise: {{{}}}",
    "`spin` and `steer_rate` of `noise`": "noise: {{spin: {{{}}}}}", "`steer` of `noise`": "noise: {{steer: {{{}}}}}",
    "`encoder`, of the robot or of a wheel": "encoder: {{{}}}", "`spin` of `encoder`": "encoder: {{spin: {{{}}}}}",
    "`steer` of `encoder`": "encoder: {{steer: {{{}}}}}", "`gyro`": "gyro: {{{}}}",
    "`lag`, of the robot or of a wheel": "lag: {{{}}}",
    "A parameter with more than a value": "parameters: {{p: {{{}}}}}", "Each of `couplings`": "couplings: [{{{}}}]",
    "Each of `virtual`": "virtual: [{{{}}}]", "Each of `trailers`": "trailers: [{{{}}}]", "`cg`": "cg: {{{}}}",
    "`gains`": "gains: {{{}}}",
}  # fmt: skip


def written(title: str, field: Field, text: str) -> str:
    """A robot file with ``text`` in a section, together with the other required keys of the section."""
    section = SECTIONS[title]
    kind = "fixed" if field.key == "effective_track" else "steered"
    wheels = [
        f"{{name: {name}, type: {kind}, x: 1, y: {y}, heading: 0, r: 0.1}}" for y, name in enumerate(_NAMES)
    ]
    if section is WHEEL:
        wheels.append(f"{{{', '.join([text, *_beside_in_a_wheel(field.key)])}}}")
    if section is JOINTS:
        wheels.append(f"{{name: w, type: steered, x: 0, y: 0, heading: 0, r: 0.1, joints: {{{text}}}}}")
    beside = [example(f) for f in section.fields if f.required and f is not field]
    if section is VIRTUAL:
        beside += ["steers: [a, b]"] * (field.key not in ("steers", "drives"))
        beside += [f"{other}: 1" for other in {"x": "y", "y": "x"}.get(field.key, "")]
    lines = {"wmrgen": "wmrgen: 1", "name": "name: bot", "wheels": f"wheels: [{', '.join(wheels)}]"}
    if section is ROBOT:
        lines |= {field.key: text}
    elif section not in (WHEEL, JOINTS):
        lines |= {title: WHERE[title].format(", ".join([text, *beside]))}
    return "\n".join(lines.values()) + "\n"


def _beside_in_a_wheel(key: str) -> list[str]:
    """The other keys of a wheel with ``key``. Its type has the key, and a motor if possible."""
    taking = [k for k in WHEEL_TYPES.values() if k.takes(key) or not WHEEL.field(key).misfit]
    kind = max(taking, key=lambda k: (len(k.actuated), len(k.joints)))
    drive = kind.powered if kind.powered and key == "driven" else kind
    keys = {"name": "w", "type": kind.name} | dict.fromkeys(drive.required, "0.1")
    keys |= {"l": "1", "alpha": "1"} if key in ("l", "alpha") else {"x": "0", "y": "0"}
    keys |= {"heading": "0"} if kind.oriented and key != "beta" else {}
    return [f"{k}: {v}" for k, v in keys.items() if k != key]


_NAMES = ("a", "b", "front_left", "front_right")
KEYS = [(title, f) for title, section in SECTIONS.items() for f in section.fields]


# An invalid value of each kind of quantity.
_WRONG = {
    Kind.LENGTH: "45 deg", Kind.ANGLE: "150 mm", Kind.SPEED: "1.2 m", Kind.RATE: "90 deg",
    Kind.ACCELERATION: "0.6 m/s", Kind.ANGULAR_ACCELERATION: "200 deg/s", Kind.TIME: "150 mm",
}  # fmt: skip


def mistake(field: Field) -> tuple[str, Code]:
    """Return an invalid ``key: value``, and the code of its error."""
    key = field.key
    match field.value:
        case Name():
            return f"{key}: front-left", Code.NAME
        case Letter():
            return f"{key}: omega", Code.NAME
        case OuterName():
            return f"{key}: wheel*", Code.NAME
        case ListOf(OneOf("wheel" | "function")):
            return f"{key}: [none]", Code.UNDECLARED
        case ListOf(OneOf()):
            return f"{key}: [none]", Code.FORM
        case Amount(Kind.ANY):
            return f"{key}: half", Code.UNDECLARED
        case Amount(kind):
            return f"{key}: {_WRONG[kind]}", Code.FORM
        case Interval():
            return f"{key}: [1, 0]", Code.VALUE
        case Version():
            return f"{key}: 2", Code.FORM
        case Text():
            return f"{key}: [two wheels]", Code.FORM
    return f"{key}: maybe", Code.FORM


@pytest.mark.parametrize(("title", "field"), KEYS, ids=lambda v: v if isinstance(v, str) else v.key)
def test_examples_of_the_page_are_accepted_and_refused(title: str, field: Field) -> None:
    robot_of(read(written(title, field, example(field))))
    wrong, code = mistake(field)
    with pytest.raises(RobotFileError) as refused:
        robot_of(read(written(title, field, wrong)))
    assert [part.code for part in refused.value.parts] == [code]
    assert VALIDATOR.is_valid(yaml.safe_load(written(title, field, example(field))))
    if isinstance(field.value, Amount) and field.value.unit:
        wrong, code = f"{field.key}: 2 mm", Code.FORM
        with pytest.raises(RobotFileError) as refused:
            read(written(title, field, wrong))
        assert [part.code for part in refused.value.parts] == [code]
    assert not VALIDATOR.is_valid(yaml.safe_load(written(title, field, wrong))) or code is not Code.FORM
