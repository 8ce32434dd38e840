"""The latest answer to a question, kept while it is asked about the same objects."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any, Generic, TypeVar

Answer = TypeVar("Answer")


class Latest(Generic[Answer]):
    """Keeps one answer; the objects it was about are compared by identity, as records do not change."""

    def __init__(self) -> None:
        self._kept: tuple[tuple[Any, ...], Answer] | None = None

    def answer(self, about: tuple[Any, ...], ask: Callable[[], Answer]) -> Answer:
        """The kept answer if the latest question was ``about`` the same objects, else what ``ask`` returns."""
        if self._kept is None or not all(map(is_, about, self._kept[0])):
            self._kept = about, ask()
        return self._kept[1]
