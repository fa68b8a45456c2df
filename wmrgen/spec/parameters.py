"""Parameters of a robot file, in an order in which each stands after those it uses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from wmrgen.errors import RobotFileError, Several
from wmrgen.spec.expressions import parse_value
from wmrgen.spec.fields import Mapped
from wmrgen.spec.keys import PARAMETER, ROBOT
from wmrgen.spec.names import Names, parameter_name
from wmrgen.spec.numbers import Facts, Kind, Scope, facts_of, parameters_in
from wmrgen.spec.records import ParameterSpec, Quantity
from wmrgen.spec.tables import mapping_of, severed, table_of
from wmrgen.spec.text import MappingNode, Node, Scalar, quoted, scalar_of


def read_parameters(
    node: Node | None, scope: Scope, names: Names, several: Several
) -> tuple[tuple[ParameterSpec, ...], Scope]:
    """Parameters that can be read, each after those it uses, and the scope that knows them."""
    if node is None:
        return (), scope
    mapping = mapping_of(node, "parameters", "parameters: and lines such as half_track: 0.1655")
    value = ROBOT.field("parameters").value
    assert isinstance(value, Mapped)
    if len(mapping.entries) > value.most:
        what = f"{len(mapping.entries)} parameters"
        several.add(mapping.error(what, f"At most {value.most} are read."))
    facts: dict[str, Facts | None] = dict.fromkeys(key.text for key, _ in mapping.entries)
    scope = replace(scope, facts=facts)
    nodes: dict[str, Scalar] = {}
    trees = {}
    tunable = {}
    rests = [severed(key, entry) for key, entry in mapping.entries]
    for (key, entry), rest, behind in zip(mapping.entries, rests, [*rests, None][1:], strict=True):
        name = key.text
        if rest:
            several.add(key.error(f"{quoted(name)} stands where a key is expected", *rest))
        if rest or behind:  # half of a value is not judged
            facts[name] = None
            continue
        with several:
            names.add(parameter_name(key), "a parameter", key)
        with several:
            nodes[name], tunable[name] = _entry(name, entry)
            trees[name] = parse_value(nodes[name], scope.facts, Kind.ANY, f"parameter {name}")
    parameters: list[ParameterSpec] = []
    order: list[str] = []
    with several:
        order = _dependency_order({name: parameters_in(tree) for name, (tree, _) in trees.items()}, nodes)
    for name in order:
        with several:
            expr, has_unit = trees[name]
            facts[name] = facts_of(expr, has_unit, scope, nodes[name])
            quantity = Quantity(expr, nodes[name].text.strip(), nodes[name].mark)
            parameters.append(ParameterSpec(name, quantity, tunable[name]))
    return tuple(parameters), scope


def _dependency_order(uses: Mapping[str, set[str]], nodes: Mapping[str, Scalar]) -> list[str]:
    """Names ordered so that each stands after those it uses, in file order otherwise.

    RobotFileError for a circle. Iterative: a chain of parameters may be long.
    """
    order: dict[str, None] = {}
    for root in uses:
        path = [root]
        while path:
            name = path[-1]
            missing = [used for used in sorted(uses[name]) if used not in order and used in uses]
            if not missing:
                order[name] = None
                path.pop()
            elif missing[0] in path:
                raise _circle(path[path.index(missing[0]) :], nodes[name])
            else:
                path.append(missing[0])
    return list(order)


def _circle(names: list[str], node: Scalar) -> RobotFileError:
    if len(names) == 1:
        return node.error(f"parameter {names[0]} refers to itself", "", "Give it a number.")
    chain = " -> ".join([*names[:6], *(["…"] if len(names) > 6 else []), names[0]])
    return node.error(
        f"parameters refer to each other in a circle: {chain}", "", "Give one of them a number."
    )


def _entry(name: str, node: Node) -> tuple[Scalar, bool]:
    """The value node of a parameter and whether it is tunable."""
    what = f"parameter {name}"
    if not isinstance(node, MappingNode):
        return scalar_of(node, what), False
    several, tunable = Several(), False
    table = table_of(node, PARAMETER, several, what)
    with several:
        tunable = table.word("tunable")
    with several:
        value = scalar_of(table.require("value", what), what)
    several.end()
    return value, tunable
