"""Errors of questions that do not depend on each other, raised together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import ParamSpec, Protocol, TypeVar, cast

from rigidfluid.errors import PluginError, RigidfluidError, SceneError, SceneErrors

P = ParamSpec("P")
T = TypeVar("T")


class Ask(Protocol):
    """A question asked of a scene."""

    def __call__(self, question: Callable[P, T], *values: P.args, **keys: P.kwargs) -> T:
        """The answer; None where it is an error, which is raised later."""


@contextmanager
def all_told() -> Iterator[Ask]:
    """Yield a function that asks questions; their errors are raised together at the end."""
    found: list[RigidfluidError] = []

    def ask(question: Callable[P, T], *values: P.args, **keys: P.kwargs) -> T:
        try:
            return question(*values, **keys)
        except (SceneError, PluginError) as error:
            found.append(error)
        return cast(T, None)

    yield ask
    raise_all(found)


def raise_all(errors: Iterable[RigidfluidError]) -> None:
    """Raise one error as it is, several as SceneErrors, those about the same once; nothing without any."""
    parts = [part for error in errors for part in (error.errors if isinstance(error, SceneErrors) else [error])]
    different: dict[str, RigidfluidError] = {}
    for part in parts:
        different.setdefault(part.subject, part)
    if len(different) == 1:
        raise next(iter(different.values())) from None
    if different:
        raise SceneErrors(different.values()) from None
