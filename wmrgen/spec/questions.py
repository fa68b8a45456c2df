"""Open questions of a robot file: a value that nobody has given yet, as ``wmrgen import`` writes them."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.errors import Code, Several
from wmrgen.spec.text import MappingNode, Node, Scalar, SequenceNode

OPEN = "TODO"  # what stands in the place of the answer; a plain word, for text may say it in quotes


def refuse_questions(tree: Node) -> None:
    """RobotFileError for every open question."""
    several = Several()
    for key, node in _questions(tree, ""):
        with several:
            raise node.error(
                f"{key or 'this value'} is an open question",
                "Nothing is derived from a robot that is not known.",
                f"Write the answer in the place of {OPEN}; the comment beside it says what is asked.",
                code=Code.OPEN,
            )
    several.end()


def _questions(node: Node, key: str) -> Iterator[tuple[str, Scalar]]:
    if isinstance(node, Scalar) and node.plain and node.text == OPEN:
        yield key, node
    elif isinstance(node, SequenceNode):
        for item in node.items:
            yield from _questions(item, key)
    elif isinstance(node, MappingNode):
        for name, value in node.entries:
            yield from _questions(value, name.text)
