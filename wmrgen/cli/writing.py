"""Robot files that a command writes, with the schema beside them that their first line names."""

from __future__ import annotations

from pathlib import Path

from wmrgen.artifacts import write_file
from wmrgen.shipped import shipped
from wmrgen.spec.schema import SCHEMA_FILE


def write_robot_file(path: Path, text: str) -> list[str]:
    """Write ``text``, and the schema for editors where none is there yet; the files written.

    UsageError for a file name that cannot be, EnvironmentFailure where it cannot be written."""
    schema = path.parent / SCHEMA_FILE
    write_file(path, text.encode())
    if schema.exists():
        return [str(path)]
    write_file(schema, (shipped("robots") / SCHEMA_FILE).read_bytes())
    return [str(path), str(schema)]
