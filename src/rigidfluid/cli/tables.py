"""Figures and tables that commands print at their end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from rigidfluid.cli.console import complain, make_console, tell

if TYPE_CHECKING:
    from rigidfluid.checks import Report
    from rigidfluid.core.output.history import History
    from rigidfluid.post.comparison.comparison import Comparison
    from rigidfluid.post.insertion.figures import Figures as InsertionFigures
    from rigidfluid.post.statistics.figures import Statistics
    from rigidfluid.post.studies.results import Results

MOST_BODIES = 20
"""Largest number of bodies or surfaces that a table shows."""

MOST_NOTES = 3
"""Largest number of notes on one question that a check prints."""

_CHECK_STYLES = {"error": "red", "warning": "yellow"}
_STYLES = {"serious warning": "red", "warning": "yellow"}
"""Colours of what a run is told at its end, by its grade."""


def print_insertion(figures: InsertionFigures) -> None:
    """Print how well bodies came into a mesh, by surface, and the mesh's worst cells."""
    table = Table("surface", "shape", "facets", "given vertices kept", "vertices off", "middles off", box=SIMPLE_HEAD)
    for row in figures.surfaces[:MOST_BODIES]:
        kept = "" if row.given_corners is None else f"{row.kept_corners} of {row.given_corners}"
        off = f"{row.vertices_off:.1e}", f"{row.middles_off:.1e}"
        table.add_row(Text(row.name), row.kind, str(row.facets), kept, *off)
    make_console().print(table)
    if len(figures.surfaces) > MOST_BODIES:
        tell(f"and {len(figures.surfaces) - MOST_BODIES} more surfaces, in the report")
    seconds = ", ".join(f"{phase} {_figure(value)} s" for phase, value in figures.seconds.items())
    tell(f"{figures.cells} cells, {figures.vertices} vertices, worst quality {_figure(figures.worst_quality)}")
    tell(f"volume of the fluid: {figures.volume:.8g} of {figures.exact_volume:.8g}; {seconds}")


def print_study(results: Results) -> None:
    """Print how many runs of a study there are, and of random samples the figure's quantiles and Sobol indices, or the
    settings that no other ones beat in error and time."""
    failed = len(results.plan) - len(results.outcomes)
    reference = "" if results.reference is None else f"; reference {_figure(results.reference)}"
    tell(f"{len(results.plan)} runs, {failed} failed{reference}")
    for one in (one for one in results.samples if len(one.known)):
        low, median, high = map(_figure, one.quantiles)
        about = f"{_knobs(one.variant)}: " if one.variant else ""
        tell(f"{about}{results.target.of}: median {median}, 5 to 95 % from {low} to {high}")
        for name, index in one.indices.items():
            first = f"{index.first:.2f} ± {index.first_confidence:.2f}"
            total = f"{index.total:.2f} ± {index.total_confidence:.2f}"
            tell(f"  {name}: first-order Sobol index {first}, total {total}")
    if results.study.parameters:
        return
    for settings, key in zip(results.plan, results.prints, strict=True):
        if key in results.front:
            seconds, error = results.points[key]
            tell(f"on the Pareto front: {_knobs(settings)}: error {_figure(error)} in {_figure(seconds)} s")


def print_statistics(found: Statistics) -> None:
    """Print those figures of statistics that are no curves."""
    for line in found.lines:
        tell(line)


def _knobs(settings: Mapping[str, object]) -> str:
    return ", ".join(f"{knob} {value}" for knob, value in settings.items())


def print_end(history: History, folder: Path) -> None:
    """Print the figures of a run, complete or not, and where it has written."""
    from rigidfluid.core.output.verdict import verdict

    summary = history.summary
    if summary["reynolds"]:
        solid, fluid = _figure(summary["reynolds_solid_density"]), _figure(summary["reynolds"])
        tell(f"highest Reynolds number: {solid} with the density of the solid, {fluid} with that of the fluid")
    if summary["smallest_gap"] is not None:
        tell(f"smallest gap: {_figure(summary['smallest_gap'])}")
    if summary["rest_position"]:
        _print_positions(summary["rest_position"])
    if summary["failed_remeshes"]:
        tell(
            f"warning: a new mesh could not be made {summary['failed_remeshes']} times; the one before served on. "
            f"The latest failure, {summary['latest_failed_remesh']}",
            "yellow",
        )
    _print_energy(summary["energy"])
    for grade, text in verdict(summary):
        tell(f"{grade}: {text}", _STYLES.get(grade, ""))
    if summary["unknowns"]:
        tell(_stage_costs(summary["wall_time_per_stage"], summary["wall_time"]))
    names = [Path(file).name for file in summary["files"]]
    filled = [name for name in names if _has_rows(folder / name)]
    empty = f", and {len(names) - len(filled)} tables without rows" if len(filled) < len(names) else ""
    tell(f"wrote to {folder}: {', '.join(filled)}{empty}")


def _has_rows(path: Path) -> bool:
    """Tell whether a table has more than its header, or the file is none."""
    if path.suffix != ".csv":
        return True
    with path.open(encoding="utf-8") as lines:
        return len(list(islice(lines, 2))) > 1


def _print_positions(position: Mapping[str, Sequence[float]]) -> None:
    shown = dict(islice(position.items(), MOST_BODIES))
    more = len(position) - len(shown)
    tell(f"position at the end: {_figure(shown)}" + (f", and {more} more in bodies.csv" if more else ""))


def _stage_costs(seconds: Mapping[str, float], total: float) -> str:
    """Words on the wall time of a run, of its meshes and its linear systems [s]."""
    made, moved, carried, solved, answered = (
        seconds.get(stage, 0.0) for stage in ("mesh", "move mesh", "transfer", "advance", "response")
    )
    meshes = (
        f"meshes {made + moved + carried:.1f} s (made {made:.1f}, moved {moved:.1f}, fluid carried over {carried:.1f})"
    )
    return f"time: {total:.1f} s, of it {meshes}, solving {solved + answered:.1f} s"


def _print_energy(energy: Mapping[str, Any]) -> None:
    """Print energy created and lost, both net in their worst stretch and summed, and unaccounted for at the end."""
    from rigidfluid.core.output.energy_account import per_cent

    put_in, friction = energy["put_in"], ""
    if energy["path_friction"] and put_in > 0.0:
        friction = f", friction of impacts {per_cent(energy['path_friction'] / put_in)} at most"
    stabilised = f", {per_cent(energy['grad_div'])} by stabilisation" if energy["grad_div"] else ""
    created, lost, all_created, all_lost = (
        per_cent(energy[f"{which}_{flow}"]) for which in ("largest", "summed") for flow in ("creation", "loss")
    )
    tell(
        f"energy: {created} created, {lost} lost (summed {all_created}, {all_lost}) of {_figure(energy['at_hand'])} at "
        f"hand; {per_cent(energy['unaccounted'])} unaccounted for at the end{friction}{stabilised}, of "
        f"{_figure(put_in)} put in"
    )


def print_features(report: Report) -> None:
    """Print which parts of a scene cost time, and why."""
    table = Table("part", "", "why")
    for feature in report.features:
        table.add_row(feature.name, "on" if feature.on else "off", feature.why)
    make_console().print(table)


def print_domain(report: Report) -> None:
    """Print the domain's size, its surfaces and remarks on it."""
    domain = report.domain
    tell(f"domain: {domain.type}" + (f", from {domain.file}" if domain.file else ""))
    tell(f"from {_figure(domain.lower)} to {_figure(domain.upper)}, of size {_figure(domain.volume)}")
    table = Table("surface", "shape", "area", "condition")
    for surface in domain.surfaces[:MOST_BODIES]:
        table.add_row(surface.name, surface.shape, _figure(surface.area), surface.condition)
    make_console().print(table)
    if len(domain.surfaces) > MOST_BODIES:
        tell(f"and {len(domain.surfaces) - MOST_BODIES} more surfaces")
    for remark in domain.remarks:
        tell(f"{remark}.")


def print_bodies(report: Report) -> None:
    """Print a table of the bodies, if there are any; of many, those nearest to another surface."""
    if not report.bodies:
        return
    nearest = sorted(report.bodies, key=lambda body: float("inf") if body.smallest_gap is None else body.smallest_gap)
    shown = nearest[:MOST_BODIES]
    table = Table("body", "type", "mass", "submerged weight", "impact speed", "smallest gap", "to")
    for body in report.bodies if len(report.bodies) <= MOST_BODIES else shown:
        figures = body.mass, body.submerged_weight, body.impact_speed, body.smallest_gap
        table.add_row(body.name, body.type, *map(_figure, figures), body.nearest)
    make_console().print(table)
    if len(report.bodies) > len(shown):
        tell(f"and {len(report.bodies) - len(shown)} bodies that are further from anything")


def print_pairs(report: Report) -> None:
    """Print a table of the pairs that may touch, a row for each kind of pair."""
    if not report.pairs:
        return
    heads = "impact of", "pairs", "speed", "Stokes number", "film meshed to", "law from", "touch at"
    table = Table(*heads, "friction", "restitution", "in the fluid")
    for pair in report.pairs[:MOST_BODIES]:
        gaps = map(_figure, (pair.speed, pair.stokes_number, pair.resolved, pair.range, pair.roughness))
        ends = ("unknown" if end is None else _figure(end) for end in (pair.restitution, pair.rebound))
        table.add_row(Text(" and ".join(pair.names)), str(pair.count), *gaps, pair.friction, *ends)
    make_console().print(table)


def print_verdict(report: Report) -> None:
    """Print how many errors and warnings a check has found, and which."""
    tell(f"{report.scene}: {report.count('error')} errors, {report.count('warning')} warnings")
    for finding in report.findings:
        if finding.grade != "note":
            tell(f"{finding.grade}: {finding.text}. {finding.remedy}", _CHECK_STYLES[finding.grade])


def print_notes(report: Report) -> None:
    """Print notes of a check, by question; of many that answer the same one, the first."""
    notes: dict[str, list[str]] = {}
    for finding in report.findings:
        if finding.grade == "note":
            notes.setdefault(finding.question, []).append(finding.text)
    for question, texts in notes.items():
        for text in texts[:MOST_NOTES]:
            tell(f"{question}: {text}.")
        if len(texts) > MOST_NOTES:
            tell(f"{question}: and {len(texts) - MOST_NOTES} more, which --json writes.")


def print_backends(comparison: Comparison) -> None:
    """Print differences of backends, their costs, and which have failed."""
    from rigidfluid.post.comparison.tables import HEADER, cost_rows, difference_rows, meaning

    for pair in comparison.pairs:
        # without vertical lines it fits into 80 columns
        title = f"{pair.other} compared with {pair.reference}"
        table = Table(*HEADER, title=title, box=SIMPLE_HEAD, padding=0)
        for row in difference_rows(comparison, pair):
            table.add_row(*map(Text, row))
        make_console().print(table)
        tell(meaning(pair))
    costs = Table("", *(run.backend for run in comparison.runs))
    for row in cost_rows(comparison):
        costs.add_row(*map(Text, row))
    make_console().print(costs)
    for run in comparison.failed:
        complain(f"{run.backend} failed: {run.error}")


def _figure(value: Any) -> str:
    """Format a number, or a list or table of them, to four digits."""
    if value is None:
        return "none"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_figure(part)}" for key, part in value.items())
    if hasattr(value, "__iter__"):
        return f"({', '.join(map(_figure, value))})"
    return f"{value:.4g}"
