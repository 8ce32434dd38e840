"""Results of a study so far: the error of each run, and the Pareto front."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

from rigidfluid.post.studies.model import Settings, Study
from rigidfluid.post.studies.rows import Row
from rigidfluid.post.studies.subject import Outcome, Target

K = TypeVar("K")

ROUND_OFF = 1e-6
"""Relative difference of errors that makes no run more accurate than another."""


@dataclass(frozen=True)
class Results:
    """A study's planned runs and those that are done.

    ``plan`` holds the knobs that each run reads, ``prints`` its fingerprint; ``rows`` what is done, by fingerprint.
    """

    study: Study
    target: Target
    plan: list[Settings]
    prints: list[str]
    rows: dict[str, Row]

    @cached_property
    def outcomes(self) -> dict[str, Outcome]:
        """Outcomes of the runs that did not fail, by fingerprint."""
        done = {key: self.rows[key].outcome for key in self.prints if key in self.rows}
        return {key: outcome for key, outcome in done.items() if outcome is not None}

    @cached_property
    def finest(self) -> str | None:
        """Fingerprint of the run that is the reference; None if a number is, or if no run is done."""
        if self.target.reference is not None or not self.outcomes:
            return None
        return most_expensive(self.outcomes)

    @property
    def reference(self) -> float | None:
        """Reference value of the figure; None if it is not known yet."""
        return self.target.reference if self.finest is None else self.outcomes[self.finest].figure

    @property
    def is_relative(self) -> bool:
        """Whether errors are divided by the reference: if asked for, and if it is not 0."""
        return self.target.relative and self.reference != 0

    @cached_property
    def errors(self) -> dict[str, float]:
        """|figure - reference|, over |reference| if relative, by fingerprint."""
        if self.reference is None:
            return {}
        scale = abs(self.reference) if self.is_relative else 1.0
        return {key: abs(outcome.figure - self.reference) / scale for key, outcome in self.outcomes.items()}

    @cached_property
    def points(self) -> dict[str, tuple[float, float]]:
        """(seconds, error) of the runs with an error, which the reference run has not: on scales without a zero."""
        drawn = {key: (self.outcomes[key].seconds, error) for key, error in self.errors.items()}
        return {key: point for key, point in drawn.items() if point[1] > 0}

    @cached_property
    def front(self) -> list[str]:
        """Fingerprints of the points that no other beats, by seconds."""
        return pareto_front(self.points)


def most_expensive(outcomes: Mapping[K, Outcome]) -> K:
    """Key of the run with the most unknowns times steps, among equals the most steps, among equals the longest."""
    return max(outcomes, key=lambda key: _work(outcomes[key]))


def _work(outcome: Outcome) -> tuple[int, int, float]:
    return outcome.unknowns * outcome.steps, outcome.steps, outcome.seconds


def pareto_front(points: Mapping[K, tuple[float, float]]) -> list[K]:
    """Keys of the non-dominated (seconds, error) points, by seconds.

    Errors that differ by round-off alone, as between backends, count as equal, and the fastest run is kept.
    """
    front: list[K] = []
    for key in sorted(points, key=lambda key: points[key]):
        if not front or points[key][1] < (1 - ROUND_OFF) * points[front[-1]][1] or points[key] == points[front[-1]]:
            front.append(key)
    return front
