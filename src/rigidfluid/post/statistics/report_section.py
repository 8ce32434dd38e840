"""Statistics as a section of a run's report."""

from __future__ import annotations

from html import escape

from rigidfluid.errors import OutputError
from rigidfluid.post.reports.html import grid
from rigidfluid.post.reports.report import Section
from rigidfluid.post.reports.results import Results
from rigidfluid.post.run_results import load_results
from rigidfluid.post.statistics.figures import told
from rigidfluid.post.statistics.measure import measured, tables_of
from rigidfluid.post.statistics.plot import statistics_plot
from rigidfluid.post.statistics.samples import LEAST
from rigidfluid.post.statistics.suspension_stress import SuspensionStress

FEWEST = 8
"""Fewest bodies of a run without stresslets whose report has statistics."""
MOST = 40_000
"""Most places of bodies, over all states, that a report looks at."""
OUTPUTS = 10
"""Most output times whose fields it reads for them."""
_WORDS = "Structure, motion and layers of the bodies, means from a third of the run on, with their standard errors."


def section(results: Results) -> Section:
    """Statistics from a third of the run on; nothing for few bodies without stresslets, or for one."""
    tables, moving = tables_of(load_results(results.folder)), results.present & ~results.system.prescribed
    count = int(moving.sum(axis=1).max())
    if count < (LEAST if len(tables["stresslets"].get("step", ())) else FEWEST):
        return Section()
    try:
        found = measured(results, tables, most=max(1, MOST // count), outputs=OUTPUTS)
    except OutputError as error:
        told_of = f"None: {error.found}. rigidfluid statistics measures them between times that are chosen."
        return Section(["<h2>Statistics</h2>", f'<p class="note">{escape(told_of)}</p>'])
    parts = ["<h2>Statistics</h2><ul>", *(f"<li>{escape(line)}</li>" for line in found.lines), "</ul>"]
    parts += [] if found.suspension is None else [_stresses(found.suspension, found.units.pressure)]
    return Section(parts, [("statistics", _WORDS, statistics_plot(found), ("png", "svg"))])


def _stresses(stress: SuspensionStress, unit: str) -> str:
    """Table of the stress of the bodies by cause, in this ``unit``."""
    head = ("stress of the bodies by", f"pressure [{unit}]", "added viscosity [1]", f"normal differences [{unit}]")
    rows = [
        (cause, *("" if mean is None else told(mean) for mean in (one.pressure, one.viscosity, one.differences)))
        for cause, one in stress.by_cause.items()
    ]
    return grid(head, rows)
