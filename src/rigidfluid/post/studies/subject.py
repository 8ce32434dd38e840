"""Interface of what a study runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeVar

from rigidfluid.errors import RigidfluidError
from rigidfluid.post.studies.strict_table import Settings

Made = TypeVar("Made")


@dataclass(frozen=True)
class Outcome:
    """Outcome of one run: the ``figure``, ``seconds`` by the study's clock, ``unknowns`` of a step and ``steps``."""

    figure: float
    seconds: float
    unknowns: int
    steps: int


@dataclass(frozen=True)
class Target:
    """Name of the ``figure``, and its ``reference`` value, "finest" for its value in the finest run, or None.

    ``of`` names the quantity with the error, ``against`` its reference, which divides the error with ``relative``.
    """

    figure: str
    reference: float | Literal["finest"] | None
    of: str
    against: str
    relative: bool


class Subject(Protocol):
    """Something that can be run with any settings of a study."""

    target: Target

    def read(self, settings: Settings) -> Settings:
        """Settings that have an effect on the run; one run is enough for equal ones."""

    def identity(self, settings: Settings) -> str:
        """Text that determines the outcome with these settings."""

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """Run it, and tell ``progress`` how much is done, from 0 to 1; raises RigidfluidError where it fails."""


def tried(
    all_settings: Iterable[Settings], make: Callable[[Settings], Made]
) -> tuple[list[Made], list[RigidfluidError]]:
    """Subjects that ``make`` builds from the settings of a study, at least one, and the errors of invalid settings.

    Raises the first error if no setting is valid: then the study is wrong, not a setting.
    """
    made: list[Made] = []
    errors: list[RigidfluidError] = []
    for settings in all_settings:
        try:
            made.append(make(settings))
        except RigidfluidError as error:
            errors.append(error)
    if not made:
        raise errors[0]
    return made, errors
