"""Functions of an object that its user may replace between steps."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.geometry.value_types import describe
from rigidfluid.errors import ArgumentError


class Replaceable:
    """Attribute that holds a function; anything else is refused when it is set."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, holder: Any, owner: type) -> Any:
        return self if holder is None else vars(holder)[self._name]

    def __set__(self, holder: Any, value: Any) -> None:
        if not callable(value):
            raise ArgumentError(self._name, describe(value), "a function", "Give one that can be called.")
        vars(holder)[self._name] = value
