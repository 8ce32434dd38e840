"""From a run's folder to pictures and a page beside its results."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from rigidfluid.core.output.writer import writing
from rigidfluid.reports.coefficient_plot import coefficient_caption, coefficient_plot
from rigidfluid.reports.coefficients import Figures, figures, reference
from rigidfluid.reports.contact_plot import contact_plot
from rigidfluid.reports.lines import energy_plot, force_plot, gap_plot, joint_plot, position_plot, speed_plot, step_plot
from rigidfluid.reports.mechanisms import mechanism_plot
from rigidfluid.reports.page import page
from rigidfluid.reports.pictures import (
    gap_picture,
    mesh_picture,
    moments,
    narrowest_moment,
    speed_picture,
    streamline_picture,
    vorticity_picture,
    whole_mesh_picture,
)
from rigidfluid.reports.results import Results, read_results
from rigidfluid.reports.rotation_plot import rotation_plot, torque_plot, turning
from rigidfluid.reports.style import STYLE, save

FOLDER, PAGE = "report", "report.html"


def report(out: Path) -> list[Path]:
    """Make plots and one page from the results in a folder.

    Parameters
    ----------
    out : Path
        Folder that a run has written.

    Returns
    -------
    list of Path
        What was written: PNG files, SVG files for the plots over time, and last ``report.html``, which holds them all.

    Raises
    ------
    OutputError
        Where a result is missing or cannot be read, or the disk refuses.
    SceneError, PluginError
        Where the run's scene cannot be built here, as when one of its plug-ins is not installed.
    """
    out = Path(out)
    results = read_results(out)
    written: list[Path] = []
    shown: list[tuple[Path, str]] = []
    with matplotlib.rc_context(STYLE), writing(out / FOLDER):
        (out / FOLDER).mkdir(exist_ok=True)
        for name, caption, figure, kinds in _pictures(results):
            paths = save(figure, out / FOLDER, name, kinds)
            written += paths
            shown.append((paths[0], caption))
        (out / PAGE).write_text(page(results.summary, shown, _notes(results), _figures(results)), encoding="utf-8")
    return [*written, out / PAGE]


def _pictures(results: Results) -> Iterator[tuple[str, str, Figure, tuple[str, ...]]]:
    """Name, caption, figure and file formats of each picture; each is made when it is asked for."""
    raster, both = ("png",), ("png", "svg")
    if _has_pictures(results):
        shown = moments(results)
        yield "speed_field", "Speed of the fluid. Solids are grey.", speed_picture(shown), raster
        caption = "Streamlines, seen by an observer at rest, over the speed."
        yield "streamlines", caption, streamline_picture(shown), raster
        caption = "Vorticity, positive where the fluid turns counter-clockwise."
        yield "vorticity", caption, vorticity_picture(shown), raster
        yield "whole_mesh", "The whole mesh at the last output time.", whole_mesh_picture(shown[-1]), raster
        yield "mesh", "Mesh about the body that came nearest to another surface.", mesh_picture(shown), raster
        caption = "The smallest gap among the output times."
        yield "smallest_gap", caption, gap_picture(narrowest_moment(results)), raster
    yield "position", "Where the bodies are.", position_plot(results), both
    if results.system.mechanisms is not None:
        yield "mechanisms", "Ways of the mechanisms and of their components.", mechanism_plot(results), both
    yield "speed", "How fast the bodies are.", speed_plot(results), both
    if np.isfinite(results.bodies["gap"]).any():
        yield "gap", "Distance from each body to the nearest other surface.", gap_plot(results), both
    if turning(results).any():
        yield "rotation", "How bodies turn.", rotation_plot(results), both
        yield "torque", "Torques about the bodies' centres.", torque_plot(results), both
    yield "force", "What the fluid and what contacts do to each body.", force_plot(results), both
    by = reference(results)
    if by is not None:
        caption = coefficient_caption(by, results.system.dimension)
        yield "coefficients", caption, coefficient_plot(results, by), both
    if results.contact_counts.any():
        yield "contacts", "Contacts: how many, the largest force, the least gap.", contact_plot(results), both
    if results.joints:
        yield "joints", "How far hinges have turned, and what acts in joints.", joint_plot(results), both
    yield "energy", "Energy supplied, and where it is.", energy_plot(results), both
    if results.scene.time.tolerance is not None:
        yield "step", "How long the steps are.", step_plot(results), both


def _figures(results: Results) -> list[tuple[str, Figures]]:
    """The coefficients of each body, where there are any."""
    by = reference(results)
    return [] if by is None else list(zip(results.names, figures(results, by), strict=True))


def _has_pictures(results: Results) -> bool:
    return bool(results.series) and results.system.dimension == 2


def _notes(results: Results) -> Iterator[str]:
    if not results.series:
        yield "This run has no fluid, and so no pictures of the flow."
    elif not _has_pictures(results):
        yield "Pictures of the flow are made of 2D runs alone; ParaView opens fields.pvd."
