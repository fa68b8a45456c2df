"""What a process says by its exit code: a script must tell a wrong robot file from a missing compiler."""

from __future__ import annotations

import pytest

from wmrgen.errors import (
    EnvironmentFailure,
    NotDerivableError,
    RobotFileError,
    StaleError,
    UsageError,
    WmrgenError,
)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (StaleError, 1),
        (RobotFileError, 2),
        (UsageError, 2),
        (NotDerivableError, 3),
        (EnvironmentFailure, 4),
    ],
)
def test_each_kind_of_failure_has_its_exit_code(error: type[WmrgenError], code: int) -> None:
    failure = error("what went wrong")
    assert failure.exit_code == code
    assert "what went wrong" in str(failure)
