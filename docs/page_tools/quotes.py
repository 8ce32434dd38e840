"""Figures that a text quotes from pages, each with a mark behind it: 17.45<!-- page: row → column -->.

A row is named by its first cells, with commas between them, as many as it takes to tell it from others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from page_tools.places import PAGES

_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_NUMBER = re.compile(r"(?P<digits>\d*\.?\d+)(?:·10(?P<power>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?P<percent> %)?")
_MARK = re.compile(r"<!-- (?P<page>\w+): (?P<row>.+?) → (?P<column>.+?) -->")
_IN_CELL = re.compile(r"(\d*\.?\d+(?:e[-+]?\d+)?)(%?)")


@dataclass(frozen=True)
class Quote:
    """A figure as it is ``text``: its ``value`` and the ``unit`` of its last digit; where it is from."""

    text: str
    value: float
    unit: float
    percent: bool
    page: str
    row: str
    column: str

    def agrees(self, cell: str) -> bool:
        """Whether it is a number of a cell, without its sign, to as many digits as it has."""
        for digits, percent in _IN_CELL.findall(cell):
            found = float(digits) * (100.0 if self.percent and not percent else 1.0)
            if bool(percent) <= self.percent and abs(found - self.value) <= 0.501 * self.unit:
                return True
        return False


def quotes(text: str) -> list[Quote]:
    """All that a text quotes; raises ValueError where there is a mark behind no number."""
    return [_quote(text[: mark.start()], mark) for mark in _MARK.finditer(text)]


def unmarked(text: str) -> list[str]:
    """The numbers of a text behind which there is no mark."""
    bare = _MARK.sub("<>", text)
    return [found.group() for found in _NUMBER.finditer(bare) if not bare.startswith("<>", found.end())]


def disagreements(text: str, pages: Path = PAGES) -> Iterator[str]:
    """What a text quotes and its page does not say."""
    for quote in quotes(text):
        path = pages / f"{quote.page}.md"
        cells = list(_cells(path.read_text(encoding="utf-8"), quote)) if path.exists() else []
        where = f"{quote.page}: {quote.row} → {quote.column}"
        if len(cells) != 1:
            yield f"{quote.text} is from {where}, and there are {len(cells)} such cells"
        elif not quote.agrees(cells[0]):
            yield f"{quote.text} is not {cells[0]} of {where}"


def _quote(before: str, mark: re.Match[str]) -> Quote:
    numbers = [number for number in _NUMBER.finditer(before[-40:]) if number.end() == len(before[-40:])]
    if not numbers:
        raise ValueError(f"{mark.group()} stands behind no number")
    digits, power, percent = numbers[0].group("digits", "power", "percent")
    scale = 10.0 ** int((power or "0").translate(_POWERS))
    unit = 10.0 ** -len(digits.partition(".")[2])
    value = float(digits) * scale
    return Quote(numbers[0].group(), value, unit * scale, percent is not None, *mark.group("page", "row", "column"))


def _cells(page: str, quote: Quote) -> Iterator[str]:
    """In all tables of a page, the cells of this row and column."""
    head: list[str] = []
    for line in [*page.splitlines(), ""]:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not head or not cells:
            head = cells
        elif quote.column in head and any(", ".join(cells[:n]) == quote.row for n in range(1, len(cells))):
            yield cells[head.index(quote.column)]
