"""Degrees, ranks, null space, growth vector and texts of one robot fit each other."""

from __future__ import annotations

import pytest

from tests.laws.common import NAMES, gallery
from tests.oracle.compare import consistent


@pytest.mark.parametrize("name", NAMES)
def test_degrees_of_the_gallery(name: str) -> None:
    derivation = gallery(name)[0].derivation
    consistent(derivation.mobility)
    data = derivation.model()
    assert data["ddof"] == data["degree_of_mobility"] == len(derivation.null_space.T.tolist())
    assert data["ddof"] <= data["dof"] <= 3
