"""Answer to a question: how grave it is, about whom, how much, and what would be enough."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import ceil, floor, isfinite, log10
from typing import Any, Literal

Grade = Literal["error", "warning", "note"]
Figures = Mapping[str, float | int | str | None]
GRADES: tuple[Grade, ...] = ("error", "warning", "note")


@dataclass(frozen=True, slots=True)
class Finding:
    """The answer to one question about one body or pair.

    ``grade``: ``error``, it cannot work; ``warning``, it may not do what is meant; ``note``, for information.
    ``question``: which check asks, as in docs/check.md. ``subject``: the surfaces, by name. ``found``, ``enough``:
    figures by name, in the scene's units. ``text`` says what was found, ``remedy`` what to do; empty for a note.
    """

    grade: Grade
    question: str
    subject: tuple[str, ...]
    text: str
    remedy: str = ""
    found: Figures = field(default_factory=dict)
    enough: Figures = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Values for JSON, which knows neither infinity nor NaN: such figures are null."""
        return {
            "grade": self.grade,
            "question": self.question,
            "subject": list(self.subject),
            "text": self.text,
            "remedy": self.remedy,
            "found": _finite(self.found),
            "enough": _finite(self.enough),
        }


def figure(value: float) -> str:
    """A number to three digits."""
    return f"{value:.3g}"


def round_down(value: float) -> str:
    """Round a positive number down to three digits, so that whoever copies it stays on the right side."""
    return _rounded(value, floor)


def round_up(value: float) -> str:
    """Round a positive number up to three digits."""
    return _rounded(value, ceil)


def _rounded(value: float, to_whole: Callable[[float], int]) -> str:
    unit = 10.0 ** (floor(log10(value)) - 2)
    return figure(to_whole(value / unit) * unit)


def _finite(figures: Figures) -> dict[str, Any]:
    return {key: None if isinstance(value, float) and not isfinite(value) else value for key, value in figures.items()}
