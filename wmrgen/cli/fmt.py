"""``wmrgen fmt``: robot files laid out alike."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wmrgen.cli import console
from wmrgen.derivation.artifacts import write_file
from wmrgen.errors import StaleError
from wmrgen.robotfile.load import text_of
from wmrgen.robotfile.typesetting import formatted


def fmt(robots: Sequence[Path], only_check: bool, as_json: bool) -> int:
    """Lay out every file, then write those that change. Exit code 1 where ``only_check`` and one would."""
    results = {path: formatted(text_of(path), str(path)).encode() for path in robots}
    changed = [path for path, content in results.items() if path.read_bytes() != content]
    for path in () if only_check else changed:
        write_file(path, results[path])
    if as_json:
        same = [str(path) for path in results if path not in changed]
        console.data({"changed": [str(path) for path in changed], "unchanged": same})
    else:
        for path in changed:
            console.result(f"{path}: {'would change' if only_check else 'changed'}")
        console.result(f"{len(results) - len(changed)} of {len(results)} laid out already")
    return StaleError.exit_code if only_check and changed else 0
