"""Two makings of a page: whether they say the same, but for what depends on the machine's speed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import zip_longest

NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d+)*|\.\d+)(?:e[-+]?\d+)?")
TIMED = re.compile(r"CPU|\bseconds\b|\bmemory\b|\bwall time|^\[?m?s\]?$|Pareto")
"""Heads of columns and rows, and lines of prose, that tell times."""
MADE = re.compile(r"^Made on ")
ROUND_OFF = 1e-10
"""Numbers below are rounding, and as good as each other."""


def differences(before: str, after: str) -> Iterator[str]:
    """Lines of which one says what the other does not: other words, or numbers that differ by more than one in the last
    digit printed."""
    for one, other in zip_longest(_lines(before), _lines(after), fillvalue=""):
        if not _same(one, other):
            yield f"- {one}\n+ {other}"


def _lines(text: str) -> Iterator[str]:
    """What may be compared: lines but for timed cells and sentences, and for when the page was made."""
    head: list[str] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            head = []
            if not MADE.match(line) and not TIMED.search(line):
                yield line
            continue
        head = head or cells
        if not TIMED.search(cells[0]) or cells is head:
            kept = [cell for name, cell in zip(head, cells, strict=False) if cells is head or not TIMED.search(name)]
            yield " | ".join(kept)


def _same(one: str, other: str) -> bool:
    if NUMBER.sub("#", one) != NUMBER.sub("#", other):
        return False
    return all(map(_agree, NUMBER.findall(one), NUMBER.findall(other)))


def _agree(one: str, other: str) -> bool:
    if one == other:
        return True
    values, unit = [float(text.replace(",", "")) for text in (one, other)], max(_unit(one), _unit(other))
    return abs(values[0] - values[1]) <= 1.01 * unit or max(map(abs, values)) < ROUND_OFF


def _unit(text: str) -> float:
    """One in the last digit."""
    digits, _, power = text.replace(",", "").partition("e")
    return 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
