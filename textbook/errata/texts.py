"""The five texts, and all records, text by text."""

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

# Edition, and what our copy is, by the name under which a text is cited.
BIBLIOGRAPHY = {
    "Tzafestas": "Spyros G. Tzafestas: *Introduction to Mobile Robot Control*. 1st edition, Elsevier, 2014. Chapter 2.",
    "Konstantinov": "Konstantinov: a paper on the kinematics of a robot with three omni wheels. Title and year are not "
    "recorded with our copy.",
    "Kelly": "Alonzo Kelly: *Mobile Robotics: Mathematics, Models, and Methods*. 1st edition, Cambridge University "
    "Press, 2013. Our copy is of the slides to chapter 4, not of the book; their date is not recorded.",
    "Siegwart": "Roland Siegwart, Illah R. Nourbakhsh, Davide Scaramuzza: *Introduction to Autonomous Mobile Robots*. "
    "2nd edition, MIT Press, 2011. Section 2.3 and chapter 3. The second copy is the text of some pages of the 1st "
    "edition (without Scaramuzza, 2004), from the digital library of Universitas Pertamina; page numbers are that "
    "edition's. It is quoted as it stands: dots, indices and some letters are out of their places.",
    "AA274": "Stanford University, course AA274: lecture 1, on the kinematics of wheeled robots. The year is not "
    "recorded with our copy.",
}

# What is not as it should be, then what holds, each in the order of the texts.
ENTRIES: tuple[Record, ...] = (
    *tzafestas.ENTRIES, *tzafestas_conventions.ENTRIES, *konstantinov.ENTRIES, *kelly.ENTRIES, *siegwart.ENTRIES,
    *siegwart_conventions.ENTRIES, *aa274.ENTRIES)  # fmt: skip
HOLDS: tuple[Record, ...] = (
    *tzafestas_holds.HOLDS, *konstantinov.HOLDS, *kelly_holds.HOLDS, *siegwart_holds.HOLDS,
    *aa274.HOLDS)  # fmt: skip
