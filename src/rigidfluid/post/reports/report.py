"""Pictures and a page made from a run's folder, next to its results."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import matplotlib
import numpy as np

from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.output.disk import replace_file, writing
from rigidfluid.core.output.results_folder import join_folder
from rigidfluid.core.output.run_files import ADDED, FILES, RUN
from rigidfluid.core.setup.model import Model
from rigidfluid.post.reports.coefficient_plot import coefficient_caption, coefficient_plot
from rigidfluid.post.reports.coefficients import Figures, figures, reference
from rigidfluid.post.reports.contact_plot import contact_plot
from rigidfluid.post.reports.html import Picture, save_pictures
from rigidfluid.post.reports.lines import (
    energy_plot,
    force_plot,
    gap_plot,
    joint_plot,
    position_plot,
    speed_plot,
    step_plot,
)
from rigidfluid.post.reports.mechanisms import mechanism_plot
from rigidfluid.post.reports.moment import Moment, moment, narrowest, nearest_body, shown_outputs
from rigidfluid.post.reports.narrowest import gap_middle
from rigidfluid.post.reports.page import page
from rigidfluid.post.reports.pictures import (
    flow_picture,
    gap_picture,
    mesh_picture,
    scalar_picture,
    streamline_picture,
    viscosity_picture,
    whole_mesh_picture,
)
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.rotation_plot import rotation_plot, torque_plot, turning
from rigidfluid.post.reports.scalar_plot import scalar_plot
from rigidfluid.post.reports.scale import QUANTITIES, Scale
from rigidfluid.post.reports.shared_scale import shared_scale, shared_scales
from rigidfluid.post.reports.space import dry_space_picture, flow_space_picture
from rigidfluid.post.reports.style import STYLE
from rigidfluid.post.reports.view_plane import PlaneName, ViewPlane, view_plane

FOLDER, PAGE = "report", "report.html"


class Section(NamedTuple):
    """A section of the page: its ``parts``, which are HTML, and its pictures, which are shown with the others."""

    parts: Sequence[str] = ()
    pictures: Sequence[Picture] = ()


def report(
    out: Path,
    plane: PlaneName = "motion",
    follow: str | None = None,
    model: Model | None = None,
    sections: Iterable[Callable[[Results], Section]] = (),
) -> list[Path]:
    """Make plots and one page from the results in a folder; return the files written, last ``report.html``.

    The page also has the ``sections`` that others make of the results. Pictures of a 3D run show the ``plane`` that
    `view_plane` takes; they ``follow`` a body by name, else that with the least gap. A run of a model made in Python
    wants the ``model``. Raises OutputError for missing or unreadable results, an unknown body or plane, or a disk that
    refuses; SceneError or PluginError if the run's scene cannot be built here, as without one of its plug-ins.
    """
    out = Path(out)
    results = read_results(out, model=model)
    join_folder(out, RUN, ADDED)
    seen = view_plane(results, plane)
    body = None if follow is None else results.number_of(follow)
    with matplotlib.rc_context(STYLE), writing(out / FOLDER):
        others = [make(results) for make in sections]
        (out / FOLDER).mkdir(exist_ok=True)
        units = results.units
        named = (
            (name, units.put_into(caption), units.put_into_labels(figure), kinds)
            for name, caption, figure, kinds in chain(_pictures(results, seen, body), *(one.pictures for one in others))
        )
        written, shown = save_pictures(named, out / FOLDER)
        parts = [part for one in others for part in one.parts]
        replace_file(out / PAGE, page(results, _data(out), shown, _notes(results), _figures(results), parts).encode())
    return [*written, out / PAGE]


def _flow_pictures(results: Results, plane: ViewPlane, body: int | None) -> Iterator[Picture]:
    """Pictures of the fluid; each is made when it is asked for."""
    raster, watched = ("png",), nearest_body(results) if body is None else body
    where = _slice_location(results, plane, watched)
    shown = [moment(results, output, plane, watched) for output in shown_outputs(results)]
    speed, turns, pressure = shared_scales(results, QUANTITIES, plane, body)
    yield (
        "speed_field",
        f"Speed of the fluid. Bodies are grey, what is outside is hatched.{where}",
        flow_picture(shown, speed),
        raster,
    )
    caption = f"Streamlines, seen by an observer at rest, over the speed.{where}"
    if where:
        caption += " None where the flow makes more than 45° with the plane."
    yield "streamlines", caption, streamline_picture(shown, speed), raster
    caption = f"Vorticity, positive where the fluid turns counter-clockwise.{where}"
    yield "vorticity", caption, flow_picture(shown, turns), raster
    yield "pressure", f"Dynamic pressure.{where}", flow_picture(shown, pressure), raster
    if shown[-1].section.fields.scalar is not None:
        too = " Bodies that conduct it have its colours inside." if any(one.insides for one in shown) else ""
        caption = f"The scalar that the fluid carries along.{too}{where}"
        yield "scalar", caption, scalar_picture(shown, shared_scale(results, "scalar", plane, body)), raster
    if shown[-1].section.fields.viscosity is not None:
        stress = _yield_stress(results)
        line = "" if stress is None else " Inside of the white line the stress is below the yield stress."
        caption = f"Viscosity.{line}{where}"
        scale = shared_scale(results, "viscosity", plane, body)
        yield "viscosity", caption, viscosity_picture(shown, scale, stress), raster
    yield "whole_mesh", f"The whole mesh at the last output time.{where}", whole_mesh_picture(shown[-1], speed), raster
    if where:
        yield (
            "space",
            f"Bodies, the paths of a few, and the speed.{where}",
            flow_space_picture(results, shown, plane, speed),
            raster,
        )
    if results.names:
        yield from _close_ups(results, shown, plane, speed, body)


def _close_ups(
    results: Results, shown: Sequence[Moment], plane: ViewPlane, speed: Scale, body: int | None
) -> Iterator[Picture]:
    """Pictures of the mesh about a body, and of the smallest gap."""
    raster, where = ("png",), _slice_location(results, plane, nearest_body(results) if body is None else body)
    whose = "the body that came nearest to another surface" if body is None else results.names[body]
    about = [moment for moment in shown if moment.has_body]
    if about:
        yield "mesh", f"Mesh about {whose}.{where}", mesh_picture(about, speed), raster
    output, nearest = narrowest(results, body)
    middle = gap_middle(results, results.state_at(results.series[output][0]), nearest, plane)
    if middle is not None:
        caption = f"The smallest gap among the output times.{_slice_location(results, plane, nearest)}"
        picture = gap_picture(moment(results, output, plane, nearest), middle, speed)
        yield "smallest_gap", caption, picture, raster


def _yield_stress(results: Results) -> float | None:
    """Yield stress of the fluid, None where it flows under any stress [force/length^(d-1)]."""
    fluid = results.system.fluid
    if fluid is None or not isinstance(fluid.material, GeneralisedNewtonian):
        return None
    return fluid.material.yield_stress


def _slice_location(results: Results, plane: ViewPlane, body: int) -> str:
    """Sentence that locates the slice of a 3D run; empty in 2D."""
    through = results.names[body] if results.names else "the middle of the domain"
    return f" In the {plane.words} through {through}." if results.system.dimension == 3 else ""


def _pictures(results: Results, plane: ViewPlane, body: int | None) -> Iterator[Picture]:
    """All pictures; each is made when it is asked for."""
    both = ("png", "svg")
    if results.series:
        yield from _flow_pictures(results, plane, body)
    elif results.system.dimension == 3:
        times = [results.outputs[output][0] for output in shown_outputs(results)]
        yield "space", "The bodies, and the paths of a few.", dry_space_picture(results, times, plane), ("png",)
    if results.names:
        yield from _body_plots(results, plane)
    if results.model.fluid.scalar is not None and len(results.time) > 1:
        caption = "The scalar: means in bodies, fluxes into the fluid, and the extremes."
        yield "scalar_over_time", caption, scalar_plot(results), both
    yield "energy", "Energy supplied, and where it is.", energy_plot(results), both
    if results.model.time.tolerance is not None:
        yield "step", "How long the steps are.", step_plot(results), both


def _body_plots(results: Results, plane: ViewPlane) -> Iterator[Picture]:
    """Plots of bodies over time; each is made when it is asked for."""
    both = ("png", "svg")
    yield "position", "Where the bodies are.", position_plot(results, plane), both
    if results.system.motions.names:
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
        yield "joints", "How far joints have moved, and what acts in them.", joint_plot(results), both


def _data(out: Path) -> Iterator[tuple[str, str]]:
    """Names and content of the files that the run has written so far, but for those in folders."""
    for files in FILES:
        for path in sorted(out.iterdir()):
            if re.fullmatch(files.pattern, path.name) and path.name != PAGE and ".part" not in path.suffixes:
                yield path.name, files.content.replace("`", "")


def _figures(results: Results) -> list[tuple[str, Figures]]:
    """The coefficients of each body, where there are any."""
    by = reference(results)
    return [] if by is None else list(zip(results.names, figures(results, by), strict=True))


def _notes(results: Results) -> Iterator[str]:
    if not results.series:
        yield "This run has no fluid, and so no pictures of the flow."
