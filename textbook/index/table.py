"""All rows, text by text."""

from __future__ import annotations

from textbook.index import aa274, kelly, konstantinov, siegwart, tzafestas
from textbook.index.records import Row

ROWS: tuple[Row, ...] = (
    *tzafestas.ROWS,
    *konstantinov.ROWS,
    *kelly.ROWS,
    *siegwart.ROWS,
    *aa274.ROWS,
)
