"""Where calls of parts (`--size`) write several results: what the caller hands over, and no memory beyond it."""

from __future__ import annotations

from wmrgen.backends.c99.style import style
from wmrgen.backends.expression import body
from wmrgen.ir.nodes import Function, Node, Op, Port, Role

SEVERAL = {"part1": 2}


def printed(nodes: list[Node], results: tuple[int, ...], stores: tuple[str, ...]) -> tuple[str, ...]:
    outputs = tuple(Port(f"y{k}", Role.COMMAND, "1") for k in range(len(results)))
    function = Function("f", (Port("x", Role.COMMAND, "1"),), tuple(nodes), outputs, results)
    return body(function, lambda name: f"in->{name}", style("float"), None, stores, SEVERAL).statements


def call(x: int, at: int) -> list[Node]:
    """A call at node ``at`` and its two results."""
    return [Node(Op.CALL, (x,), name="part1"), *(Node(Op.PART, (at,), name=str(n)) for n in range(2))]


X = Node(Op.INPUT, name="x")


def test_results_are_written_where_they_belong() -> None:
    assert printed([X, *call(0, 1)], (3, 2), ("out->a", "out->b")) == ("part1(in->x, &out->b, &out->a);",)


def test_others_where_something_is_written_later() -> None:
    nodes = [X, *call(0, 1), Node(Op.ADD, (2, 3)), Node(Op.SUB, (2, 3))]
    assert printed(nodes, (4, 5), ("out->a", "out->b")) == (
        "part1(in->x, &out->a, &out->b);",
        "const float t0 = out->a;",
        "const float t1 = out->b;",
        "out->a = t0 + t1;",
        "out->b = t0 - t1;",
    )


def test_a_result_that_is_used_further_has_a_name() -> None:
    nodes = [X, *call(0, 1), Node(Op.MUL, (2, 3))]
    assert printed(nodes, (2, 4), ("out->a", "out->b")) == (
        "part1(in->x, &out->a, &out->b);",
        "const float t0 = out->a;",
        "const float t1 = out->b;",
        "out->b = t0 * t1;",
    )


def test_a_result_that_stands_twice_is_written_twice() -> None:
    statements = printed([X, *call(0, 1)], (2, 2, 3), ("out->a", "out->b", "out->c"))
    assert statements == ("part1(in->x, &out->b, &out->c);", "const float t0 = out->b;", "out->a = t0;")


def test_a_variable_where_there_is_no_room() -> None:
    nodes = [X, *call(0, 1), Node(Op.ADD, (2, 3))]
    assert printed(nodes, (4,), ("out->a",)) == (
        "float y0;",
        "part1(in->x, &out->a, &y0);",
        "const float t0 = out->a;",
        "const float t1 = y0;",
        "out->a = t0 + t1;",
    )


def test_what_is_written_already_is_left_alone() -> None:
    nodes = [X, Node(Op.NEG, (0,)), *call(0, 2), Node(Op.ADD, (3, 4))]
    assert printed(nodes, (1, 5), ("out->a", "out->b"))[:3] == (
        "float y0;",
        "out->a = -in->x;",
        "part1(in->x, &out->b, &y0);",
    )


def test_a_part_writes_through_its_pointers() -> None:
    nodes = [Node(Op.INPUT, name="x0"), Node(Op.NEG, (0,)), Node(Op.ABS, (0,))]
    function = Function("part1", (), tuple(nodes), (), (1, 2))
    found = body(function, str, style("float"), None, ("*y0", "*y1"), SEVERAL)
    assert found.statements == ("*y0 = -x0;", "*y1 = fabsf(x0);")
