"""The process that all attempts of a test process are forked from."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.hostile.attempts import Server


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    server = Server(tmp_path_factory.mktemp("hostile"))
    yield server
    server.close()
