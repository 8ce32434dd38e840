"""Results of a study so far: the error of each run, and the Pareto front."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

from rigidfluid.post.studies.model import FINEST, Study
from rigidfluid.post.studies.rows import Row, words
from rigidfluid.post.studies.sampled import Sampled, sampled
from rigidfluid.post.studies.strict_table import Settings
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

    @property
    def first_failure(self) -> str:
        """The reason of the first run that failed, with its settings; empty where none has."""
        rows = ((settings, self.rows.get(key)) for settings, key in zip(self.plan, self.prints, strict=True))
        failed = ((settings, row) for settings, row in rows if row is not None and row.outcome is None)
        return next((f"{words(settings)}: {row.message}" for settings, row in failed), "")

    @cached_property
    def samples(self) -> list[Sampled]:
        """Random samples with each numerical setting; none in a study without random parameters."""
        figures = {key: outcome.figure for key, outcome in self.outcomes.items()}
        runs = zip(self.plan, self.prints, strict=True)
        return sampled(self.study, [(settings, figures.get(key, math.nan)) for settings, key in runs])

    @cached_property
    def groups(self) -> list[list[str]]:
        """Fingerprints of the runs with the same physical parameters, which share a reference."""
        groups: dict[str, list[str]] = {}
        for settings, key in zip(self.plan, self.prints, strict=True):
            same = json.dumps([settings[name] for name in self.study.parameters], default=str)
            groups.setdefault(same, []).append(key)
        return list(groups.values())

    @cached_property
    def finest(self) -> dict[str, str]:
        """Fingerprint of the run that is the reference of each one that is done; none if these are given."""
        if self.target.reference != FINEST:
            return {}
        done = ([key for key in group if key in self.outcomes] for group in self.groups)
        best = {most_expensive({key: self.outcomes[key] for key in group}): group for group in done if group}
        return {key: finest for finest, group in best.items() for key in group}

    @cached_property
    def references(self) -> dict[str, float]:
        """Reference value of each figure, by fingerprint."""
        if isinstance(self.target.reference, float):
            return dict.fromkeys(self.outcomes, self.target.reference)
        return {key: self.outcomes[finest].figure for key, finest in self.finest.items()}

    @property
    def reference(self) -> float | None:
        """The reference value of all figures; None if there is none yet, or one in each group."""
        values = set(self.references.values())
        return values.pop() if len(values) == 1 else None

    @property
    def is_relative(self) -> bool:
        """Tell whether errors are divided by the reference: if asked for, and if none is 0."""
        return self.target.relative and 0 not in self.references.values()

    @cached_property
    def errors(self) -> dict[str, float]:
        """|figure - reference|, over |reference| if relative, by fingerprint."""
        apart = {key: abs(self.outcomes[key].figure - value) for key, value in self.references.items()}
        return {key: error / abs(self.references[key]) if self.is_relative else error for key, error in apart.items()}

    @cached_property
    def points(self) -> dict[str, tuple[float, float]]:
        """(seconds, error) of the runs with an error, which the reference run has not: on scales without a zero."""
        drawn = {key: (self.outcomes[key].seconds, error) for key, error in self.errors.items()}
        return {key: point for key, point in drawn.items() if point[1] > 0}

    @cached_property
    def front(self) -> list[str]:
        """Fingerprints of the points that no other of their group beats, by seconds in each."""
        groups = ({key: self.points[key] for key in group if key in self.points} for group in self.groups)
        return [key for group in groups for key in pareto_front(group)]


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
