"""Check that attributes have the types that interfaces annotate."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from inspect import isclass
from types import UnionType
from typing import Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.error_text import shown


def refuse_other_types(cls: type, part: Any) -> None:
    """Raise `Wrong` for an attribute that is missing, or not of the type that an interface of ``cls`` annotates.

    ``part`` is an object of the class, or the class itself, of which only class variables are checked.
    """
    for name, hint, is_class_variable in _annotated(cls):
        if is_class_variable or part is not cls:
            value = getattr(part, name, _MISSING)
            if value is _MISSING or not _fits(value, hint):
                found = "nothing" if value is _MISSING else describe(value)
                raise Wrong(f"{found} as {name}", hint.__name__ if isclass(hint) else str(hint))


_MISSING = object()


@cache
def _annotated(cls: type) -> tuple[tuple[str, Any, bool], ...]:
    """Attributes that the interfaces of a class annotate: name, type, and whether it is a class variable."""
    hints: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        if "kind" in vars(base):  # an interface
            hints |= get_type_hints(base)
    return tuple(
        (name, get_args(hint)[0] if get_origin(hint) is ClassVar else hint, get_origin(hint) is ClassVar)
        for name, hint in hints.items()
    )


def describe(value: Any) -> str:
    """Describe a value in few words: its type, and its shape or text."""
    if isinstance(value, np.ndarray):
        kind = "an array" if type(value) is np.ndarray else f"a {type(value).__name__}, a kind of array,"
        return f"{kind} of {value.dtype} of shape {value.shape}"
    text = shown(value)
    return f"{type(value).__name__} {text if len(text) < 60 else text[:56] + ' ...'}"


def _fits(value: Any, hint: Any) -> bool:
    origin, inner = get_origin(hint), get_args(hint)
    if hint is Any:
        return True
    if hint is float:
        return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if origin is Literal:
        return any(isinstance(value, type(one)) and value == one for one in inner)
    if origin in (Union, UnionType):
        return any(_fits(value, one) for one in inner)
    if origin is type:
        return isclass(value) and issubclass(value, inner[0])
    if origin is tuple:
        return isinstance(value, tuple) and all(_fits(one, inner[0]) for one in value)
    if isclass(origin) and issubclass(origin, Mapping):
        key_type, value_type = inner
        return isinstance(value, Mapping) and all(_fits(k, key_type) and _fits(v, value_type) for k, v in value.items())
    return isinstance(value, origin or hint)
