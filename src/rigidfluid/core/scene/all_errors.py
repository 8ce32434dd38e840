"""Errors of questions that do not depend on each other, raised together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import ParamSpec, TypeVar, cast

from rigidfluid.errors import PluginError, RigidfluidError, SceneError, SceneErrors

P = ParamSpec("P")
T = TypeVar("T")


class Ask:
    """Asks questions of a scene, and keeps the ``errors`` that are their answers."""

    def __init__(self) -> None:
        self.errors: list[RigidfluidError] = []

    def __call__(self, question: Callable[P, T], *values: P.args, **keys: P.kwargs) -> T:
        """The answer; None where it is an error, which is raised later."""
        try:
            return question(*values, **keys)
        except (SceneError, PluginError) as error:
            self.errors.append(error)
        return cast(T, None)

    @property
    def subjects(self) -> list[str]:
        """Subjects of the errors, one by one."""
        return [one.subject for error in self.errors for one in error.single_errors]


@contextmanager
def all_told() -> Iterator[Ask]:
    """Yield what asks questions; their errors are raised together at the end."""
    ask = Ask()
    yield ask
    raise_all(ask.errors)


def raise_all(errors: Iterable[RigidfluidError]) -> None:
    """Raise errors together, without what an earlier one says of the same subject; nothing without any."""
    told: set[str] = set()
    different: list[RigidfluidError] = []
    for error in errors:
        different += [one for one in error.single_errors if one.subject not in told]
        told.update(one.subject for one in error.single_errors)
    raise_together(different)


def raise_together(errors: Sequence[RigidfluidError]) -> None:
    """Raise one error as it is, several as SceneErrors; nothing without any."""
    if len(errors) == 1:
        raise errors[0] from None
    if errors:
        raise SceneErrors(errors) from None
