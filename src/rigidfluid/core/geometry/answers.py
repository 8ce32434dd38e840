"""Checks of what parts give: arrays of finite numbers of a shape, single numbers, and objects of a type."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, isfinite
from typing import Any

import numpy as np

from rigidfluid.core.geometry.guarded import Check
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.geometry.wrong import Wrong

_FLOAT = np.dtype(float)

Shape = Callable[..., tuple[int, ...]]
"""The shape wanted, from a part and the arguments that it was given."""


def rows(shape: Shape, shorter: bool = False, positive: bool = False) -> Check:
    """Check of an array of finite numbers of that shape, of ``positive`` ones alone if so; a ``shorter`` step may mend
    numbers that are not finite, where the part is asked within one."""

    def check(answer: Any, part: Any, *given: Any, **named: Any) -> None:
        wanted = shape(part, *given, **named)
        if not _are_numbers(answer, wanted):
            refuse_other_rows(answer, wanted, "", shorter)
        if positive and not np.all(answer > 0.0):
            raise Wrong(f"{np.min(answer)}", "numbers above 0")

    return check


def refuse_other_rows(answer: Any, shape: tuple[int, ...], name: str = "", shorter: bool = False) -> None:
    """Raise `Wrong` unless an answer, or the ``name`` of it, is an array of finite numbers of a ``shape``."""
    if _are_numbers(answer, shape):
        return
    refuse_other_shape(answer, shape, name)
    finite = np.isfinite(answer)
    if not finite.all():
        raise Wrong(f"{name} {answer[~finite].flat[0]}".strip(), "finite numbers", shorter)


def _are_numbers(answer: Any, shape: tuple[int, ...]) -> bool:
    """Tell whether it surely is an array of finite numbers of a ``shape``: told quickly, as some are asked for hundreds
    of times in a step."""
    return (
        type(answer) is np.ndarray
        and answer.dtype is _FLOAT
        and answer.shape == shape
        and isfinite(np.vdot(answer, answer))
    )


def refuse_other_shape(answer: Any, shape: tuple[int, ...], name: str = "", kinds: str = "fiu") -> None:
    """Raise `Wrong` unless it is an array of a ``shape``, of numbers of these ``kinds``, as NumPy names them."""
    if not (type(answer) is np.ndarray and answer.dtype.kind in kinds and answer.shape == shape):
        numbers = {"fiu": "real numbers", "iu": "whole numbers", "b": "truth values"}[kinds]
        raise Wrong(f"{name} {describe(answer)}".strip(), f"an array of {numbers} of shape {shape}")


def refuse_no_number(answer: Any, name: str = "", least: float = -inf, shorter: bool = False) -> None:
    """Raise `Wrong` unless an answer, or the ``name`` of it, is a finite number above ``least``."""
    if type(answer) is not float and (np.ndim(answer) != 0 or np.asarray(answer).dtype.kind not in "fiu"):
        raise Wrong(f"{name} {describe(answer)}".strip(), "a real number")
    if not isfinite(answer):
        raise Wrong(f"{name} {answer}".strip(), "a finite number", shorter)
    if not answer > least:
        raise Wrong(f"{name} {answer}".strip(), f"a number above {least:g}")


def number(least: float = -inf, shorter: bool = False) -> Check:
    """Check of a finite number above ``least``."""

    def check(answer: Any, *_: Any, **__: Any) -> None:
        refuse_no_number(answer, "", least, shorter)

    return check


def curvature(answer: Any, *_: Any) -> None:
    """Refuse what is no radius of curvature: it is infinite of a plane, and nowhere zero."""
    if not (isinstance(answer, float) and abs(answer) == inf):
        refuse_no_number(answer)
    if answer == 0.0:
        raise Wrong(f"{answer}", "a radius of curvature other than 0")


def corners(answer: Any, part: Any) -> None:
    """Refuse what is no pair of a lower and an upper corner, which may be infinite."""
    if not (isinstance(answer, tuple) and len(answer) == 2):
        raise Wrong(describe(answer), "a pair of corners")
    lower, upper = answer
    for corner in answer:
        refuse_other_shape(corner, np.shape(lower))
    if lower.ndim != 1 or not np.all(lower <= upper):
        raise Wrong(f"corners {lower.tolist()} and {upper.tolist()}", "a lower and an upper one")


def optional(check: Check) -> Check:
    """The same check where the answer is not None."""

    def checked(answer: Any, part: Any, *given: Any, **named: Any) -> None:
        if answer is not None:
            check(answer, part, *given, **named)

    return checked


def refuse_others(answer: Any, wanted: type, name: str = "") -> None:
    """Raise `Wrong` unless an answer, or the ``name`` of it, is of a type ``wanted``."""
    if not isinstance(answer, wanted):
        raise Wrong(f"{name} {describe(answer)}".strip(), f"an object of {wanted.__name__}")


def instance(wanted: Callable[[], type]) -> Check:
    """Check of an object of a type, which ``wanted`` gives when it is there."""

    def check(answer: Any, *_: Any, **__: Any) -> None:
        refuse_others(answer, wanted())

    return check


def several(wanted: Callable[[], type], least: int = 0) -> Check:
    """Check of a sequence of at ``least`` so many objects of a type, which ``wanted`` gives when it is there."""

    def check(answer: Any, *_: Any, **__: Any) -> None:
        if not isinstance(answer, list | tuple):
            raise Wrong(describe(answer), "a list or tuple")
        if len(answer) < least:
            raise Wrong(f"{len(answer)} objects", f"at least {least}")
        for one in answer:
            refuse_others(one, wanted())

    return check


def anything(answer: Any, *_: Any, **__: Any) -> None:
    """Refuse nothing: what is raised is told all the same."""
