"""What a study runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from rigidfluid.studies.model import Settings


@dataclass(frozen=True)
class Outcome:
    """What one run gives: the ``figure``, wall ``seconds``, ``unknowns`` of a step and ``steps``."""

    figure: float
    seconds: float
    unknowns: int
    steps: int


class Subject(Protocol):
    """Something that can be run with any settings of a study."""

    def identity(self, settings: Settings) -> str:
        """All that decides the outcome with these settings: of equal identity, one run is enough."""

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """Run it, and tell ``progress`` how much is done, from 0 to 1; raises RigidfluidError where it fails."""
