"""Interface of what a study runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol

from rigidfluid.post.studies.strict_table import Settings


@dataclass(frozen=True)
class Outcome:
    """Outcome of one run: the ``figure``, ``seconds`` by the study's clock, ``unknowns`` of a step and ``steps``, and
    the ``slope`` of the figure over the first parameter, None where that is not known."""

    figure: float
    seconds: float
    unknowns: int
    steps: int
    slope: float | None = None


@dataclass(frozen=True)
class Target:
    """Name of the ``figure``, and its ``reference`` value, "finest" for its value in the finest run, or None.

    ``of`` names the quantity with the error, ``against`` its reference, which divides the error with ``relative``.
    ``units``: units of the figure ("") and of knobs by name, each in brackets after a space, or nothing.
    """

    figure: str
    reference: float | Literal["finest"] | None
    of: str
    against: str
    relative: bool
    units: Mapping[str, str] = field(default_factory=dict)

    def axis_label(self, knob: str) -> str:
        """Name of a knob with its unit."""
        return f"{knob}{self.units.get(knob, '')}"

    @property
    def figure_label(self) -> str:
        """The quantity with its unit."""
        return f"{self.of}{self.units.get('', '')}"


class Subject(Protocol):
    """Something that can be run with any settings of a study."""

    target: Target

    def read(self, settings: Settings) -> Settings:
        """Settings that have an effect on the run; one run is enough for equal ones."""

    def identity(self, settings: Settings) -> str:
        """Text that determines the outcome with these settings."""

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        """Run it, and tell ``progress`` how much is done, from 0 to 1; raises RigidfluidError where it fails."""
