"""``wmrgen fmt``: robot files in one format."""

from __future__ import annotations

from typing import Annotated

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robots, flag, verb
from wmrgen.errors import StaleError


@verb("fmt")
def fmt(
    robots: Robots,
    only_check: Annotated[
        bool, flag("--check", "Write nothing; exit code 1 if a file would change.")
    ] = False,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen fmt robots/*.yaml

    Format robot files: indentation, aligned columns of wheels, spaces at brackets and comments. Values, comments and
    the order of lines do not change, and neither does the robot. Files with anchors, aliases or tags are rejected and
    not rewritten, because robot files must not have them: use parameters instead.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.robotfile.text import MAX_BYTES, bytes_of, decode
    from wmrgen.robotfile.typesetting import formatted

    before = {path: bytes_of(path, MAX_BYTES + 1) for path in robots}
    after = {path: formatted(decode(data, str(path)), str(path)).encode() for path, data in before.items()}
    changed = [path for path in after if after[path] != before[path]]
    if not only_check:
        for path in changed:
            write_file(path, after[path])
    if as_json:
        same = [str(path) for path in after if path not in changed]
        console.data({"changed": [str(path) for path in changed], "unchanged": same})
    else:
        for path in changed:
            console.result(f"{path}: {'would change' if only_check else 'changed'}")
        console.result(f"{len(after) - len(changed)} of {len(after)} formatted already")
    return StaleError.exit_code if only_check and changed else 0
