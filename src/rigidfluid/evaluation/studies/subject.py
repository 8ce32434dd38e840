"""What a study runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from rigidfluid.errors import RigidfluidError
from rigidfluid.evaluation.studies.model import Settings

Made = TypeVar("Made")


@dataclass(frozen=True)
class Outcome:
    """What one run gives: the ``figure``, ``seconds`` by the study's clock, ``unknowns`` of a step and ``steps``."""

    figure: float
    seconds: float
    unknowns: int
    steps: int


@dataclass(frozen=True)
class Target:
    """What the ``figure`` is, and what it should be: the ``reference``, or None for its value in the finest run.

    ``of`` says what an error is of, ``against`` what it is against; with ``relative`` it is divided by the reference.
    """

    figure: str
    reference: float | None
    of: str
    against: str
    relative: bool


class Subject(Protocol):
    """Something that can be run with any settings of a study."""

    target: Target

    def read(self, settings: Settings) -> Settings:
        """Those of the settings that change what a run with them does; of equal ones, one run is enough."""

    def identity(self, settings: Settings) -> str:
        """All that decides the outcome with these settings."""

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """Run it, and tell ``progress`` how much is done, from 0 to 1; raises RigidfluidError where it fails."""


def tried(
    all_settings: Iterable[Settings], make: Callable[[Settings], Made]
) -> tuple[list[Made], list[RigidfluidError]]:
    """What can be made of the settings of a study.

    Parameters
    ----------
    all_settings : iterable of dict
        The settings of each run.
    make : callable
        Makes what is run, or raises RigidfluidError.

    Returns
    -------
    list, list
        What was made, at least one, and the errors of the settings that are not valid.

    Raises
    ------
    RigidfluidError
        The first, if nothing can be made of any: then the study is wrong, not a setting.
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
