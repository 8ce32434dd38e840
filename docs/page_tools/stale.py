"""Which pages no longer follow from what is here: edited, said otherwise by their module, or of other results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from page_tools.cpu_time import cpu_seconds
from page_tools.first_steps import ROUND_OFF, STEPS, Steps, difference, first_steps
from page_tools.places import PAGES, RECORDS
from page_tools.provenance import source_digest
from page_tools.record import Record, RunRecord, read_record
from rigidfluid.errors import PluginError, RigidfluidError

SECONDS = 15.0
"""The first steps of a page's runs are made again, the cheapest first, until they have taken so much CPU time."""

Again = Callable[[RunRecord], Steps]


def stale(names: list[str], again: Again, pages: Path = PAGES, records: Path = RECORDS) -> Iterator[tuple[str, str]]:
    """Pages that are out of date, and why; runs are made ``again`` where other sources than the present made them."""
    for name in names:
        record = read_record(name, records)
        if record is None:
            yield name, "has no record; make it"
            continue
        found = [f"{file} is not as it was written" for file in record.edited(pages)]
        found += [f"{path} says something else" for path in record.reworded()]
        if record.sources != (source_digest(),):
            found += _other_results(record, again)
        if found:
            yield name, f"{record.making}: {'; '.join(found)}"


def unseen(names: list[str], records: Path = RECORDS) -> Iterator[tuple[str, str]]:
    """Pages of whose results it cannot be said, since other sources have made them and no run of theirs is recorded."""
    for name in names:
        record = read_record(name, records)
        if record is not None and not record.runs and record.sources != (source_digest(),):
            yield name, record.making


def steps_again(run: RunRecord) -> Steps:
    """The first steps of a run, made by what is here."""
    return first_steps(run.settings.scene, STEPS)


def _other_results(record: Record, again: Again) -> Iterator[str]:
    start = cpu_seconds()
    for label, run in sorted(record.runs.items(), key=lambda item: item[1].cpu_seconds):
        if cpu_seconds() - start > SECONDS:
            return
        try:
            off = difference(run.steps, again(run))
        except PluginError:
            continue  # of a part that is not installed here nothing can be said
        except RigidfluidError as error:
            yield f"{label} does not run: {error}"
            continue
        if not off <= ROUND_OFF:
            yield f"{label} has other results, {off:.1e} apart after {STEPS} steps"
