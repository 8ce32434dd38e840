"""Parts may be anyone's: whatever their methods give or raise is checked where it enters the program."""

from __future__ import annotations

from abc import ABCMeta
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, wraps
from traceback import walk_tb
from types import FunctionType
from typing import Any, TypeVar

from rigidfluid.core.geometry.interrupts import is_interrupt
from rigidfluid.core.geometry.value_types import refuse_other_types
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.error_text import error_text
from rigidfluid.errors import PluginError, RigidfluidError, StepRejected

Check = Callable[..., None]
"""Called with an answer, the part that gave it and the arguments that it was given; raises `Wrong`."""
F = TypeVar("F", bound=Callable[..., Any])

_REMEDY = "Mend it there; the contract tests in rigidfluid.testing show more."


def gives(check: Check) -> Callable[[F], F]:
    """Declare what a method or property of an interface gives, whoever overrides it."""

    def declared(function: F) -> F:
        vars(function)["__gives__"] = check
        return function

    return declared


class Guarded(ABCMeta):
    """Type of interfaces and of the classes that implement them.

    Answers that an interface declares by `gives` are checked at each call, but for what an overriding method asks of
    the one that it overrides. Properties are asked once an object is made, and so are attributes that the interface
    annotates. An interface has a ``kind``, its name in messages. Errors that
    are none of rigidfluid become a PluginError that names the part and the method, and keeps their cause.
    """

    def __init__(cls, name: str, bases: tuple[type, ...], namespace: dict[str, Any], **rest: Any) -> None:
        super().__init__(name, bases, namespace, **rest)
        cls._values: dict[str, Check | None] = {}
        cls._outermost: dict[str, Any] = {}
        declared = {
            key: member for base in reversed(cls.__mro__) for key, member in vars(base).items() if _declared_by(member)
        }
        for key, interface in declared.items():
            member = next(vars(base)[key] for base in cls.__mro__ if key in vars(base))
            plain = _function_of(member) is None
            if isinstance(interface, property):
                cls._values[key] = _declared_by(interface) if plain else None
                if plain:
                    continue
            if not (getattr(member, "__isabstractmethod__", False) or hasattr(_function_of(member), "__guarded__")):
                member = _guarded_member(cls, key, member, _declared_by(interface), isinstance(interface, classmethod))
                setattr(cls, key, member)
            cls._outermost[key] = _function_of(member)

    def __call__(cls, *given: Any, **named: Any) -> Any:
        with _blamed(cls, "__init__"):
            part = super().__call__(*given, **named)
            refuse_other_types(cls, part)
        for key, check in cls._values.items():
            value = getattr(part, key)
            if check is not None:
                with _blamed(cls, key):
                    check(value, part)
        return part


def named(cls: type) -> str:
    """Kind and name of a part's class, as messages have them."""
    name = getattr(cls, "name", None)
    return f"{getattr(cls, 'kind', 'part')} {(name if isinstance(name, str) else cls.__name__)!r}"


def _function_of(member: Any) -> Any:
    """The function behind a member of a class, None where it is a plain value."""
    if isinstance(member, FunctionType):
        return member
    return next((getattr(member, key) for key in ("fget", "func", "__func__") if hasattr(member, key)), None)


def _declared_by(member: Any) -> Any:
    return getattr(_function_of(member), "__gives__", None)


def _guarded_member(cls: type, key: str, member: Any, check: Check, is_of_class: bool) -> Any:
    """The member of a class by this name, its function guarded; ``is_of_class``: asked of the class, however it is
    written."""
    function = _function_of(member)
    if isinstance(member, property):
        return property(_guarded(function, key, check), member.fset, member.fdel, member.__doc__)
    if isinstance(member, cached_property):
        kept = cached_property(_guarded(function, key, check))
        kept.__set_name__(cls, key)
        return kept
    if isinstance(member, classmethod) or (is_of_class and isinstance(member, FunctionType)):
        return classmethod(_guarded(function, key, check))
    if not isinstance(member, FunctionType):  # a callable, or what is none

        def function(_: Any, *given: Any, **named: Any) -> Any:
            return member(*given, **named)

    guarded = _guarded(function, key, check)
    return classmethod(guarded) if is_of_class else guarded


def _guarded(function: Callable[..., Any], key: str, check: Check) -> Callable[..., Any]:
    """The function, what it gives or raises checked."""

    @wraps(function)
    def asked(part: Any, /, *given: Any, **named: Any) -> Any:
        try:
            answer = function(part, *given, **named)
            kind: Any = part if isinstance(part, type) else type(part)
            if kind._outermost.get(key) is asked:
                check(answer, part, *given, **named)
        except (RigidfluidError, MemoryError) as error:
            _add_source(error, part, key)
            raise
        except (Exception, SystemExit, GeneratorExit) as error:
            raise part_error(part, key, error) from error
        return answer

    vars(asked)["__guarded__"] = True
    return asked


@contextmanager
def _blamed(cls: type, key: str) -> Iterator[None]:
    try:
        yield
    except (RigidfluidError, MemoryError) as error:  # the run tells of memory
        _add_source(error, cls, key)
        raise
    except (Exception, SystemExit, GeneratorExit) as error:
        raise part_error(cls, key, error) from error


def is_foreign(cls: type) -> bool:
    """Tell whether a class of parts is not one of rigidfluid itself."""
    return not str(cls.__module__).startswith("rigidfluid.")


def _add_source(error: RigidfluidError | MemoryError, part: Any, key: str) -> None:
    """Say in an error by which method or attribute ``key`` of a foreign part, or its class, it came."""
    cls = part if isinstance(part, type) else type(part)
    if not is_foreign(cls):
        return
    if isinstance(error, MemoryError):
        error.args = error.args or (f"{named(cls)}, {key}",)
    elif not error.source and named(cls) not in error.subject:
        error.source = f"{named(cls)}, {key}"


def part_error(part: Any, key: str, error: BaseException) -> RigidfluidError | KeyboardInterrupt:
    """Error of a part, or its class, that names its method or attribute ``key`` and what that has raised or given.

    An interrupt that came within compiled code is given as one.
    """
    if is_interrupt(error):
        return KeyboardInterrupt()
    subject = f"{named(part if isinstance(part, type) else type(part))}, {key}"
    if isinstance(error, Wrong):
        if error.shorter:
            return StepRejected(
                subject, error.found, error.allowed, f"Shorten time.step; if that does not help: {_REMEDY}"
            )
        return PluginError(subject, error.found, error.allowed, _REMEDY)
    module, line = _raised_in(error, part if isinstance(part, type) else type(part))
    found = f"{type(error).__name__}: {error_text(error)}, raised in module {module}, line {line}"
    return PluginError(subject, found, "an answer, or an error of rigidfluid", _REMEDY)


def _raised_in(error: BaseException, cls: type) -> tuple[str, int]:
    """Module and line that an error came from: the innermost in the package of the part, which its author can mend."""
    lines = [(str(frame.f_globals.get("__name__")), line) for frame, line in walk_tb(error.__traceback__)]
    package = cls.__module__.partition(".")[0]
    return next((one for one in reversed(lines) if one[0].partition(".")[0] == package), lines[-1])
