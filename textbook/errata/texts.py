"""All records, text by text."""

from __future__ import annotations

from textbook.errata import (
    aa274,
    kelly,
    kelly_holds,
    konstantinov,
    siegwart,
    siegwart_conventions,
    siegwart_holds,
    tzafestas,
    tzafestas_conventions,
    tzafestas_holds,
)
from textbook.errata.records import Record

# What is not as printed, in the order of the texts; then what holds under a condition; then what holds.
ERRATA: tuple[Record, ...] = (
    *tzafestas.ERRATA, *konstantinov.ERRATA, *kelly.ERRATA, *siegwart.ERRATA, *aa274.ERRATA)  # fmt: skip
CONVENTIONS: tuple[Record, ...] = (
    *tzafestas_conventions.CONVENTIONS, *konstantinov.CONVENTIONS, *kelly.CONVENTIONS,
    *siegwart_conventions.CONVENTIONS, *aa274.CONVENTIONS)  # fmt: skip
HOLDS: tuple[Record, ...] = (
    *tzafestas_holds.HOLDS, *konstantinov.HOLDS, *kelly_holds.HOLDS, *siegwart_holds.HOLDS,
    *aa274.HOLDS)  # fmt: skip
# Numbers that the texts work out, and that are right.
WORKED: tuple[Record, ...] = (*siegwart_holds.NUMBERS, tzafestas_holds.AUGMENTATION)
RECORDS: tuple[Record, ...] = (*ERRATA, *CONVENTIONS, *HOLDS)
