"""Statistics of a run: measured, and written as figures and a plot beside its results."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib

from rigidfluid.core.mechanics.suspension import mean_gap, mean_velocity, velocity_fluctuations
from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.history import History
from rigidfluid.core.output.tables import table_path
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.results_in_memory import results_of
from rigidfluid.post.reports.style import STYLE, save
from rigidfluid.post.run_results import load_results
from rigidfluid.post.statistics.blocks import mean
from rigidfluid.post.statistics.contact_network import contact_network
from rigidfluid.post.statistics.contact_rows import contact_rows
from rigidfluid.post.statistics.contact_stresses import contact_stresses
from rigidfluid.post.statistics.curves import curves, table_text
from rigidfluid.post.statistics.diffusion import diffusion
from rigidfluid.post.statistics.figures import Statistics
from rigidfluid.post.statistics.fluid_layers import OUTPUTS, fluid_layers
from rigidfluid.post.statistics.gap_distribution import gap_distribution
from rigidfluid.post.statistics.pair_distribution import pair_distribution
from rigidfluid.post.statistics.plot import statistics_plot
from rigidfluid.post.statistics.presence import presence
from rigidfluid.post.statistics.profiles import LAYERS, profile
from rigidfluid.post.statistics.samples import SAMPLES, samples_of
from rigidfluid.post.statistics.structure_factor import structure_factor
from rigidfluid.post.statistics.suspension_stress import suspension_stress
from rigidfluid.post.statistics.wall_stresses import wall_stresses

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation


def statistics(
    folder: Path, since: float | None = None, until: float | None = None, across: str = "y"
) -> tuple[Statistics, list[Path]]:
    """Measure the statistics of a run, and write ``statistics.json``, ``statistics.png`` and tables of the
    curves, ``statistics_….csv``, beside its results.

    They are means from the time ``since``, a third of the run if not given, to ``until``, its end; the profile is
    ``across`` an axis. Raises OutputError for a folder that cannot be read, and for too few bodies or states.
    """
    results = read_results(folder, motion_only=True)
    found = measured(results, tables_of(load_results(folder)), since, until, across)
    figures = Path(folder) / "statistics.json"
    texts = {figures: json.dumps(found.to_dict(), indent=2, allow_nan=False, ensure_ascii=False) + "\n"}
    texts |= {figures.with_name(f"statistics_{name}.csv"): table_text(table) for name, table in curves(found).items()}
    with matplotlib.rc_context(STYLE), writing(figures):
        for path, text in texts.items():
            replace_text(path, text)
        plots = save(found.units.put_into_labels(statistics_plot(found)), Path(folder), "statistics", ["png"])
    return found, [*texts, *plots]


def measure_statistics(
    run: Simulation | History, since: float | None = None, until: float | None = None, across: str = "y"
) -> Statistics:
    """Measure the statistics of the bodies of a run, in memory or from its folder; nothing is written.

    A mean of a figure f is Σ f/s over s states at even times, at most 200, and its standard error that of blocks of
    states. A figure is that of the bodies that are there in the state; what wants a body has its mean over the states
    with any.

    Parameters
    ----------
    run : Simulation or History
        A simulation, also while it goes on, as an observer gets it; or what `run` or `load_results` has returned.
    since, until : float, optional
        First and last time of the means; from a third of the run until now if not given [time].
    across : str
        Axis across which the profiles are, ``x``, ``y`` or ``z``; those of the fluid want a run that writes fields to
        a folder.

    Returns
    -------
    Statistics
        Means with their standard errors; ``to_dict()`` gives those of ``statistics.json``.

    Raises
    ------
    OutputError
        If there are fewer than two states with two bodies that move, the times or the axis are not there, or a history
        does not know its bodies: that of a model made in Python, or of a run that goes on.

    Notes
    -----
    Flyvbjerg & Petersen, J. Chem. Phys. 91 (1989) 461, doi:10.1063/1.457480.
    """
    tables = tables_of(run if isinstance(run, History) else run.history)
    return measured(results_of(run), tables, since, until, across)


def tables_of(history: History) -> dict[str, dict[str, Any]]:
    """Tables of contacts, stresslets and walls of a run; nothing of one that an earlier version has not written."""
    folder, names = history.folder, ("contacts", "stresslets", "walls")
    written = [name for name in names if folder is None or name == names[0] or table_path(folder, name).exists()]
    return {name: history.table(name) if name in written else {} for name in names}


def measured(
    results: Results,
    tables: Mapping[str, dict[str, Any]],
    since: float | None = None,
    until: float | None = None,
    across: str = "y",
    most: int = SAMPLES,
    outputs: int = OUTPUTS,
) -> Statistics:
    """Statistics of these results, with their ``tables`` of contacts, stresslets and walls, in at ``most`` so many
    states; the fluid's at most at so many ``outputs``."""
    if across not in list(results.axes):
        raise OutputError("--across", across, f"one of {', '.join(results.axes)}", "Name an axis.")
    samples, axis = samples_of(results, since, until, most), results.axes.index(across)
    rows, stresslets = contact_rows(samples, tables["contacts"]), tables["stresslets"]
    stress = None
    if stresslets:
        by_contacts = contact_stresses(results, rows.selected(rows.paired))
        stress = suspension_stress(samples, stresslets, by_contacts)
    return Statistics(
        results.units,
        samples,
        presence(samples),
        mean(mean_gap(samples.gap)[samples.count > 0]),
        gap_distribution(samples),
        mean(samples.map_states(mean_velocity, samples.velocity)),
        mean(
            samples.map_states(partial(velocity_fluctuations, shear=samples.shear), samples.velocity, samples.position)
        ),
        pair_distribution(samples),
        structure_factor(samples),
        diffusion(samples),
        profile(samples, axis, fluid_layers(results, samples, axis, LAYERS, outputs)),
        contact_network(rows),
        stress,
        wall_stresses(samples, tables["walls"]) if tables["walls"] else None,
        results.system.fluid is not None,
    )
