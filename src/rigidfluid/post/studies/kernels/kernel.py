"""Base class of the kernels of a study."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar

from pydantic import BaseModel, ConfigDict

from rigidfluid.post.studies.subject import Outcome


class Kernel(BaseModel, ABC):
    """A calculation with an exact answer; its fields are the knobs of a study, unknown ones are refused.

    ``figure`` names the quantity with the error, ``against`` the exact answer.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    figure: ClassVar[str]
    against: ClassVar[str]

    def reads(self, knob: str) -> bool:
        """Tell whether a knob, by its dotted key, changes anything, given the values of the others."""
        return True

    @abstractmethod
    def run(self, progress: Callable[[float], None]) -> Outcome:
        """Calculate; the outcome's figure is the error, its seconds are those of the calculation without set-up."""
