"""Statistics of a run: measured, and written as figures and a plot beside its results."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

from rigidfluid.core.mechanics.suspension import mean_gap, mean_velocity, velocity_fluctuations
from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.tables import table_path
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.style import STYLE, save
from rigidfluid.post.run_results import load_results
from rigidfluid.post.statistics.blocks import mean
from rigidfluid.post.statistics.contact_network import contact_network
from rigidfluid.post.statistics.contact_rows import contact_rows
from rigidfluid.post.statistics.contact_stresses import contact_stresses
from rigidfluid.post.statistics.diffusion import diffusion
from rigidfluid.post.statistics.figures import Statistics
from rigidfluid.post.statistics.fluid_layers import fluid_layers
from rigidfluid.post.statistics.pair_distribution import pair_distribution
from rigidfluid.post.statistics.plot import statistics_plot
from rigidfluid.post.statistics.profiles import LAYERS, profile
from rigidfluid.post.statistics.samples import SAMPLES, samples_of
from rigidfluid.post.statistics.structure_factor import structure_factor
from rigidfluid.post.statistics.suspension_stress import suspension_stress


def statistics(
    folder: Path, since: float | None = None, until: float | None = None, across: str = "y"
) -> tuple[Statistics, list[Path]]:
    """Measure the statistics of a run, and write ``statistics.json`` and ``statistics.png`` beside its results.

    They are means from the time ``since``, a third of the run if not given, to ``until``, its end; the profile is
    ``across`` an axis. Raises OutputError for a folder that cannot be read, and for too few bodies or states.
    """
    results = read_results(folder, motion_only=True)
    found = measured(results, tables_of(Path(folder)), since, until, across)
    figures = Path(folder) / "statistics.json"
    with matplotlib.rc_context(STYLE), writing(figures):
        text = json.dumps(found.to_dict(), indent=2, allow_nan=False, ensure_ascii=False)
        replace_text(figures, text + "\n")
        plots = save(found.units.put_into_labels(statistics_plot(found)), Path(folder), "statistics", ["png"])
    return found, [figures, *plots]


def tables_of(folder: Path) -> dict[str, dict[str, Any]]:
    """Tables of contacts and stresslets of a run; nothing of one that an earlier version has not written."""
    run, names = load_results(folder), ("contacts", "stresslets")
    return {name: run.table(name) if name == names[0] or table_path(folder, name).exists() else {} for name in names}


def measured(
    results: Results,
    tables: Mapping[str, dict[str, Any]],
    since: float | None = None,
    until: float | None = None,
    across: str = "y",
    most: int = SAMPLES,
) -> Statistics:
    """Statistics of these results, with their ``tables`` of contacts and stresslets, in at most so many states."""
    if across not in list(results.axes):
        raise OutputError("--across", across, f"one of {', '.join(results.axes)}", "Name an axis.")
    samples, axis = samples_of(results, since, until, most), results.axes.index(across)
    rows, stresslets = contact_rows(samples, tables["contacts"]), tables["stresslets"]
    stress = None
    if stresslets:
        by_contacts = contact_stresses(results, rows.selected(rows.paired))
        stress = suspension_stress(samples, results.system, stresslets, by_contacts)
    return Statistics(
        results.units,
        samples,
        mean(mean_gap(samples.gap)),
        mean(mean_velocity(samples.velocity)),
        mean(velocity_fluctuations(samples.velocity)),
        pair_distribution(samples),
        structure_factor(samples),
        diffusion(samples),
        profile(samples, axis, fluid_layers(results, samples, axis, LAYERS)),
        contact_network(rows),
        stress,
        results.system.fluid is not None,
    )
