"""Values of the types that interfaces annotate."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from inspect import isclass
from types import UnionType
from typing import Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from rigidfluid.core.geometry.wrong import Wrong


def refuse_other_types(cls: type, part: Any) -> None:
    """Raise `Wrong` for an attribute of a ``part``, of this class or the class itself, that is missing or of another
    type than an interface, which has a ``kind`` of its own, annotates; of a class itself those of classes alone."""
    for name, hint, of_class in annotated(cls):
        if of_class or part is not cls:
            value = getattr(part, name, Ellipsis)
            if value is Ellipsis or not _fits(value, hint):
                found = "nothing" if value is Ellipsis else told(value)
                raise Wrong(f"{found} as {name}", str(getattr(hint, "__name__", hint)) if isclass(hint) else str(hint))


@cache
def annotated(cls: type) -> tuple[tuple[str, Any, bool], ...]:
    """Name and type of what interfaces of a class annotate, and whether it is the class's."""
    hints: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        if "kind" in vars(base):
            hints |= get_type_hints(base)
    return tuple(
        (name, get_args(hint)[0] if get_origin(hint) is ClassVar else hint, get_origin(hint) is ClassVar)
        for name, hint in hints.items()
    )


def told(value: Any) -> str:
    """A value in few words."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) < 60 else text[:56] + ' ...'}"


def _fits(value: Any, hint: Any) -> bool:
    origin, inner = get_origin(hint), get_args(hint)
    if hint is Any:
        return True
    if hint is float:
        return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if origin is Literal:
        return any(value is one or value == one for one in inner if isinstance(value, type(one)))
    if origin in (Union, UnionType):
        return any(_fits(value, one) for one in inner)
    if origin is type:
        return isclass(value) and issubclass(value, inner[0])
    if origin is tuple:
        return isinstance(value, tuple) and all(_fits(one, inner[0]) for one in value)
    if origin is Mapping or (isclass(origin) and issubclass(origin, Mapping)):
        return isinstance(value, Mapping) and all(
            _fits(one, inner[0]) and _fits(to, inner[1]) for one, to in value.items()
        )
    return isinstance(value, origin or hint)
