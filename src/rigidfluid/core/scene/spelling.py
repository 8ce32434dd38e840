"""The nearest of known words to one that is not known."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def suggestion(word: str, words: Iterable[str]) -> str:
    """The question "Did you mean …?" with the nearest of ``words``, or nothing where none is near."""
    near = nearest(word, words)
    return f"Did you mean {near!r}?" if near else ""


def nearest(word: str, words: Iterable[str]) -> str | None:
    """The nearest of ``words`` to a word, None where none is near."""
    return next(iter(difflib.get_close_matches(word, list(words), n=1)), None)
