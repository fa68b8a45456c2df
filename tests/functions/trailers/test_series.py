"""Series of the path of the last axle: where they end."""

from __future__ import annotations

import pytest

from wmrgen.functions.trailers.series import DIGITS, threshold


@pytest.mark.parametrize("trailers", [0, 1, 2, 5, 16])
def test_the_least_product_of_cosines_is_the_power_of_two_that_keeps_to_the_digits(trailers: int) -> None:
    least, power = threshold(trailers), 2 * trailers + 5
    assert least.p == 1 and least.q.bit_count() == 1
    assert float(least) ** power >= 10.0**-DIGITS > (float(least) / 2) ** power
