"""Rows of a study: the settings and outcome of each run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rigidfluid.errors import RigidfluidError
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Outcome, Subject

COMPLETE, FAILED = "complete", "failed"


@dataclass(frozen=True)
class Row:
    """One run: its ``outcome``, or the ``message`` of its failure."""

    outcome: Outcome | None
    message: str = ""

    @property
    def status(self) -> str:
        """ "complete" or "failed"."""
        return FAILED if self.outcome is None else COMPLETE


def try_run(subject: Subject, settings: Settings, progress: Callable[[float], None]) -> Row:
    """The row of a run, failed or not."""
    try:
        return Row(subject.run(settings, progress))
    except RigidfluidError as error:
        return Row(None, str(error))


def fingerprint(identity: str) -> str:
    """A short text that stands for an identity."""
    return hashlib.sha256(identity.encode()).hexdigest()[:16]


def text_of(value: Any) -> str:
    """A knob's value as the CSV and the plot show it."""
    return value if isinstance(value, str) else json.dumps(value)


def short_text(value: Any, among: Sequence[Any]) -> str:
    """The same in few words: of a table only the keys that are not alike in all of the tables ``among``."""
    if not isinstance(value, Mapping):
        return text_of(value)
    differing = [key for key, part in value.items() if any(other.get(key) != part for other in among)]
    return ", ".join(f"{key} {text_of(value[key])}" for key in differing)


def words(settings: Settings) -> str:
    """All settings of a run in one line."""
    return ", ".join(f"{name} {text_of(value)}" for name, value in settings.items())


def cells(knobs: Sequence[str], settings: Settings) -> list[str]:
    """The values of the knobs; an empty text where a run does not read one."""
    return [text_of(settings[knob]) if knob in settings else "" for knob in knobs]
