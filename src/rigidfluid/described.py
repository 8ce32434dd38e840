"""Objects that tell in a few facts what they are: in one line, and as a table in a notebook."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from html import escape

_MOST_NAMES = 5
_LONGEST = 80


class Described:
    """Object with a short `repr` and an HTML table of the same facts."""

    @abstractmethod
    def _facts(self) -> Mapping[str, object]:
        """Facts by name, in order; those that are empty are left out."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}: {text}' for name, text in _told(self._facts()).items())})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        """Table that notebooks show."""
        rows = "".join(
            f"<tr><th style='text-align: left'>{escape(name)}</th><td style='text-align: left'>{escape(text)}</td></tr>"
            for name, text in _told(self._facts()).items()
        )
        return f"<table><caption>{type(self).__name__}</caption>{rows}</table>"


def first_names(names: Sequence[str]) -> str:
    """Count of the names, and the first of them."""
    shown = ", ".join(names[:_MOST_NAMES]) + (", …" if len(names) > _MOST_NAMES else "")
    return f"{len(names)} ({shown})" if names else ""


def _told(facts: Mapping[str, object]) -> dict[str, str]:
    """Texts of the facts that are there, each in one line."""
    texts = {name: " ".join(_text(fact).split()) for name, fact in facts.items() if fact is not None}
    return {name: text[:_LONGEST] + "…" * (len(text) > _LONGEST) for name, text in texts.items() if text}


def _text(fact: object) -> str:
    return f"{fact:.6g}" if isinstance(fact, float) else str(fact)
