"""Functions that a caller gives: their errors are told with the key that they are given for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from traceback import walk_tb
from typing import Any, TypeVar, cast

from rigidfluid.core.geometry.interrupts import is_interrupt
from rigidfluid.error_text import error_text
from rigidfluid.errors import RigidfluidError, SceneError

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class GivenFunction:
    """A ``function`` given for a key ``field``; errors that it raises become a SceneError."""

    function: Callable[..., Any]
    field: str

    def __call__(self, *given: Any) -> Any:
        """Result of the function."""
        try:
            return self.function(*given)
        except (RigidfluidError, MemoryError):  # the run tells of memory
            raise
        except (Exception, SystemExit, GeneratorExit) as error:
            if is_interrupt(error):
                raise KeyboardInterrupt from error
            module, line = _raised_in(error)
            found = f"{type(error).__name__}: {error_text(error)}, raised in module {module}, line {line}"
            raise SceneError(self.field, found, "a function that returns its values", "Mend it there.") from error


def _raised_in(error: BaseException) -> tuple[str, int]:
    """Module and line that an error came from: the innermost in the module of the function."""
    lines = [(str(frame.f_globals.get("__name__")), line) for frame, line in walk_tb(error.__traceback__)]
    own = lines[min(1, len(lines) - 1)][0]
    return next(one for one in reversed(lines) if one[0] == own)


def guarded_function(function: F, field: str) -> F:
    """The ``function`` given for a key ``field``, as a `GivenFunction` unless it is one of rigidfluid itself."""
    is_own = str(getattr(function, "__module__", "")).startswith("rigidfluid.")
    return function if is_own else cast(F, GivenFunction(function, field))
