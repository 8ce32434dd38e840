"""Length of a step for the sake of its error: the longest whose local error is tolerated."""

from __future__ import annotations

from rigidfluid.core.model.state import State
from rigidfluid.core.run.clock import Clock
from rigidfluid.errors import StepRejected

GROWS = 1 / 6
"""Below this share of the tolerance the next step is twice as long: its error is four times that, half the tolerance.
From there the error has to change by more than twice before a step changes again, as each change has a cost."""


class StepController:
    """Proposes and judges steps by their estimated errors; ``tolerance``: of the relative local error per unit time
    [1]."""

    def __init__(self, clock: Clock, tolerance: float) -> None:
        self._clock, self._tolerance = clock, tolerance

    def propose(self, state: State) -> int:
        """The level of the next step: that of the last, or one longer where its error, contacts in it, is far below
        the tolerance."""
        longest, estimate = self._clock.longest_level(state.tick, state.level), state.estimate
        if estimate is None or state.level is None or estimate.steps == 0:
            return longest
        return longest if estimate.with_contacts <= GROWS * self._tolerance else max(longest, state.level)

    def judge(self, candidate: State) -> None:
        """Raise StepRejected where the error is not tolerated, unless nothing is known of it or no step is shorter."""
        estimate = candidate.estimate
        if estimate is None or estimate.is_unknown or candidate.level == self._clock.levels:
            return
        if estimate.error > self._tolerance:
            raise StepRejected(
                "the step",
                f"a local error of {estimate.error:.2g}",
                f"at most time.tolerance = {self._tolerance:g}",
                "Loosen time.tolerance, or lower time.shortest.",
            )
