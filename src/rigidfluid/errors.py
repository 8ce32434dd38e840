"""The exception tree: every error a user can meet, and nothing else.

RigidfluidError
├── SceneError          the scene or study file, or a value in it, cannot be used
│   ├── SceneErrors     several such errors, told at once
│   └── ArgumentError   a value that was given in Python, not in a file
├── PluginError         a plug-in is missing, misspelt, doubled or incomplete, or a part gives what none may
├── MeshError           no valid mesh can be made for this geometry
├── OutputError         a result cannot be written or read back
└── StepError           the simulation cannot go on, even with the shortest step
    └── StepRejected    one attempted step is not usable; the loop retries it shorter

RunWarning tells of what throws doubt on the results of a run that came to its end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Self


class RigidfluidError(Exception):
    """Base of all errors that rigidfluid raises on purpose.

    Parameters
    ----------
    subject : str
        What the error is about: a field (``body.0.density``), a body, a pair or a time.
    found : object
        The value found there; or, without ``allowed``, a sentence that says what is wrong.
    allowed : str, optional
        What would have been accepted; None where that is no value.
    remedy : str
        What the user can do about it.

    Attributes
    ----------
    place : str
        Where it stands in a file, as ``scene.toml:12``, or on the command line; empty where that is not known.
    source : str
        The part of a plug-in that raised it, and by which method; empty where it was rigidfluid.
    """

    place = ""
    source = ""

    def __init__(self, subject: str, found: object, allowed: str | None, remedy: str) -> None:
        self.subject = subject
        self.found = found
        self.allowed = allowed
        self.remedy = remedy
        statement = found if allowed is None else f"found {found}; allowed is {allowed}"
        super().__init__(f"{subject}: {statement}. {remedy}")

    def __str__(self) -> str:
        raised = f" Raised by {self.source}." if self.source else ""
        return f"{self.place}: {super().__str__()}{raised}" if self.place else super().__str__() + raised

    @property
    def single_errors(self) -> tuple[RigidfluidError, ...]:
        """The errors that it tells of: itself, but where it stands for several."""
        return (self,)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the error by its four parts, its place and its source, so that it can pass between processes."""
        origin = {"place": self.place, "source": self.source}
        return type(self), (self.subject, str(self.found), self.allowed, self.remedy), origin

    def renamed(self, name: Callable[[str], str]) -> Self:
        """The same error about the subject that ``name`` makes of this one."""
        renamed = type(self)(name(self.subject), self.found, self.allowed, self.remedy)
        renamed.source = self.source
        return renamed


class SceneError(RigidfluidError):
    """The scene or study file, or a value in it, cannot be used."""


class SceneErrors(SceneError):
    """Several errors of a scene, told at once; its subject is that of the first.

    Parameters
    ----------
    errors : iterable of RigidfluidError
        SceneErrors and PluginErrors, two or more.
    """

    def __init__(self, errors: Iterable[RigidfluidError]) -> None:
        self.errors = tuple(errors)
        first = self.errors[0]
        super().__init__(first.subject, first.found, first.allowed, first.remedy)

    @property
    def single_errors(self) -> tuple[RigidfluidError, ...]:
        """Its errors."""
        return self.errors

    def __str__(self) -> str:
        return "\n".join([f"{len(self.errors)} errors", *map(str, self.errors)])

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.errors,)

    def renamed(self, name: Callable[[str], str]) -> Self:
        return type(self)(error.renamed(name) for error in self.errors)


class ArgumentError(SceneError, ValueError):
    """A table, or options of a part, cannot be made in Python of these values."""


class PluginError(RigidfluidError):
    """A plug-in is missing, misspelt, doubled or incomplete, or a part gives what none may."""


class MeshError(RigidfluidError):
    """No valid mesh can be made for this geometry."""


class OutputError(RigidfluidError):
    """A result cannot be written or read back."""


class StepError(RigidfluidError):
    """The simulation cannot go on, even with the shortest step."""


class StepRejected(StepError):
    """One attempted step is not usable; the loop retries it shorter."""


class SharedInterrupt(KeyboardInterrupt):
    """Ctrl-C on one of several processes, raised on all of them at the same exchange."""


class RunWarning(UserWarning):
    """Something throws doubt on the results of a run, as energy that was created."""
