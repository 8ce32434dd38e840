"""Words for what foreign code gives or raises, which may fail to have any."""

from __future__ import annotations

from contextlib import suppress


def error_text(error: BaseException) -> str:
    """The words of an error, where it has any."""
    with suppress(Exception):  # foreign code may raise anything
        return str(error)
    return "an error that cannot be shown"


def shown(value: object) -> str:
    """The representation of a value, where it has any."""
    with suppress(Exception):
        return repr(value)
    return "a value that cannot be shown"
