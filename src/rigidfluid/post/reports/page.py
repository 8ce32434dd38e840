"""One HTML page that needs no other file: the figures that matter, the pictures, what it cost, and the scene."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from html import escape
from typing import Any

import numpy as np

from rigidfluid.core.output.energy_account import per_cent
from rigidfluid.core.output.verdict import verdict
from rigidfluid.core.scene.scene_text import scene_text
from rigidfluid.post.reports.coefficients import Figures
from rigidfluid.post.reports.error_bars import error_table
from rigidfluid.post.reports.html import document, file_list, grid, table, with_contents
from rigidfluid.post.reports.results import Results

_MOST_BODIES = 8
_ENERGIES = {
    "gravity": "supplied by gravity",
    "boundary": "supplied through the faces",
    "control": "supplied by what drives prescribed bodies",
    "body_force": "supplied by the force on the fluid",
    "exchange": "brought by bodies that entered, less what left with others",
    "dissipation": "dissipated by viscosity",
    "grad_div_loss": "taken by grad-div stabilisation, in cells too coarse for the flow",
    "contact_loss": "taken by dampers of contacts and joints",
    "transfer_loss": "lost in transfers between meshes",
    "kinetic": "kinetic, at the end",
    "contact": "stored in contacts, at the end",
    "residual": "not accounted for",
    "residual_steps": "of it by steps of smooth motion",
    "residual_contacts": "of it at impacts",
    "residual_remeshing": "of it in steps after new meshes",
    "residual_mesh": "of it through curved slip faces",
    "residual_start": "of it in first steps",
    "path_friction": "of it at most friction of impacts between the fluid's solutions",
    "put_in": "put in: stored at the start, and the most that was supplied",
    "at_hand": "at hand: the most that was there at once",
}
_MASSES = {
    "start": "mass of all bodies at the start",
    "entered": "of those that entered",
    "gone": "of those that left",
    "there": "of those that are there at the end",
    "residual": "not accounted for",
}
_BROUGHT = {
    "exchange": "energy brought by bodies that entered, less what left with others",
    "bodies": "of it kinetic energy of these bodies themselves",
    "fluid_and_contacts": "of it energy of the fluid and of contacts, which change with them",
}
_SHARES = {
    "largest_creation": "created from nowhere at most, over what was at hand",
    "largest_loss": "lost at most, beyond friction of impacts, over what was at hand",
    "summed_creation": "created, summed, in one stretch, over what was at hand",
    "summed_loss": "lost, summed, in one stretch, over what was at hand",
    "grad_div": "taken by grad-div stabilisation, until the end, over what was put in",
    "unaccounted": "not accounted for, at the end, over what was put in",
}


def page(
    results: Results,
    files: Iterable[tuple[str, str]],
    pictures: Sequence[str],
    notes: Iterable[str],
    coefficients: Sequence[tuple[str, Figures]],
    others: Iterable[str],
) -> str:
    """Compose the HTML page from results, names and content of files next to it, embedded pictures, notes, coefficients
    by body, and ``others``, which are HTML."""
    summary, scene = results.summary, results.model.document
    told = (f"{grade.capitalize()}: {text}" for grade, text in verdict(summary)) if summary else ()
    measured = [
        f"<p>{escape(_status(results))} Units are those of the scene; in 2D all is per unit depth.</p>",
        *(f'<p class="note">{escape(note)}</p>' for note in (*told, *notes)),
        *([table(_figures(summary)), *_cycles(summary.get("cycles", {}))] if summary else ()),
        *_changes(results),
        *_coefficients(coefficients),
        *error_table(results, _MOST_BODIES),
        *others,
        "<h2>Pictures</h2>",
        *pictures,
        *(_balance_and_cost(summary) if summary else ()),
    ]
    parts = [
        *map(results.units.put_into, measured),
        "<h2>Data</h2>",
        file_list(files),
        "<h2>Scene</h2>",
        f"<details open><summary>With all defaults</summary><pre>{escape(scene_text(scene))}</pre></details>",
        *(["<h2>Versions</h2>", table(summary["versions"].items())] if summary else ()),
    ]
    return document(scene["scene"]["name"], with_contents(parts))


def _status(results: Results) -> str:
    """Sentences that tell how far the run is, what it is from, and when its latest row was written."""
    summary, end = results.summary, results.model.time.end
    at = f"{results.time[-1]:.5g} of {end:.5g} [time]"
    status = f"Status: {summary['status']}" if summary else "Status: goes on, or was stopped; resumed by --resume"
    if results.goes_on:
        status = "Status: goes on"
    written = datetime.fromtimestamp(results.written, UTC)
    when = f"{'until' if results.goes_on else 'of'} {written:%Y-%m-%d %H:%M} UTC"
    return f"{status}, at {at}. Results {when}, by rigidfluid run with the scene below; page by rigidfluid report."


def _balance_and_cost(summary: Mapping[str, Any]) -> Iterator[str]:
    yield from ("<h2>Energy balance</h2>", table(_energy(summary["energy"])), "<h2>Cost</h2>", table(_cost(summary)))


def _figures(summary: Mapping[str, Any]) -> Iterable[tuple[str, object]]:
    if summary["reynolds"] is not None:
        yield "highest Reynolds number, density of the solid", summary["reynolds_solid_density"]
        yield "highest Reynolds number, density of the fluid", summary["reynolds"]
    yield "smallest gap [length]", summary["smallest_gap"]
    places = list(summary["rest_position"].items())
    for body, place in places[:_MOST_BODIES]:
        yield f"last position of {body} [length]", ", ".join(f"{value:.5g}" for value in place)
    if len(places) > _MOST_BODIES:
        yield "", f"and of {len(places) - _MOST_BODIES} more bodies, in bodies.csv"


def _cycles(mechanisms: Mapping[str, Any]) -> Iterator[str]:
    """A table for each mechanism whose strokes repeat."""
    for name, found in mechanisms.items():
        moved, turned = found["displacement"], found["rotation"]
        if not moved:
            continue
        three = len(moved[0]) == 3
        yield f"<h2>Cycles of {escape(name)}</h2>"
        yield f"<p>Each takes {found['period']:.5g} [time].</p>"
        head = ("cycle", *(f"along {axis} [length]" for axis in "xyz"[: len(moved[0])]))
        spins = ("about x [rad]", "about y [rad]", "about z [rad]") if three else ("turned [rad]",)
        rows = enumerate(zip(moved, turned, strict=True), start=1)
        yield grid((*head, *spins), [(number, *place, *(turn if three else (turn,))) for number, (place, turn) in rows])


def _changes(results: Results) -> Iterator[str]:
    """A table of the first bodies that entered or left."""
    time, end, rows = results.time, len(results.time) - 1, []
    for name, there, mass in zip(results.names, results.present.T, results.system.mass.tolist(), strict=True):
        if not there.all():
            first, last = np.flatnonzero(there)[[0, -1]]
            entered = float(time[first - 1]) if first > 0 else ""
            rows.append((name, entered, float(time[last]) if last < end else "", mass))
    if rows:
        yield "<h2>Bodies that entered or left</h2>"
        yield grid(("body", "entered [time]", "left [time]", "mass [mass]"), rows[:_MOST_BODIES])
        if len(rows) > _MOST_BODIES:
            yield f"<p>And {len(rows) - _MOST_BODIES} more bodies, in exchanges.csv.</p>"
    if "exchanges" in results.summary:
        yield from _exchange_sums(results.summary["exchanges"])


def _exchange_sums(account: Mapping[str, Any]) -> Iterator[str]:
    """Tables of the mass that was there, came and went, and of the bodies' part of the energy that did."""
    mass, energy = account["mass"], account["energy"]
    yield table([(f"{words} [mass]", mass[key]) for key, words in _MASSES.items()])
    yield table([(f"{words} [energy]", energy[key]) for key, words in _BROUGHT.items()])


def _coefficients(bodies: Sequence[tuple[str, Figures]]) -> Iterator[str]:
    """A table of the first bodies; more have it in the plot."""
    if not bodies:
        return
    yield "<h2>Drag and lift</h2>"
    yield "<p>Of the second half of the time, by the reference of the plot of coefficients.</p>"
    head = ("body", "mean drag", "mean lift", "half of the lift's range", "Strouhal number", "by its")
    rows = []
    for name, found in bodies[:_MOST_BODIES]:
        period = ("no period", "") if found.strouhal is None else (found.strouhal, found.by)
        rows.append((name, found.drag, found.lift, found.swing, *period))
    yield grid(head, rows)
    if len(bodies) > _MOST_BODIES:
        yield f"<p>And of {len(bodies) - _MOST_BODIES} more bodies, in the plot.</p>"


def _energy(energy: Mapping[str, float]) -> Iterable[tuple[str, object]]:
    for key, meaning in _ENERGIES.items():
        yield f"{meaning} [energy]", energy[key]
    for key, meaning in _SHARES.items():
        yield meaning, per_cent(energy[key])


def _cost(summary: Mapping[str, Any]) -> Iterable[tuple[str, object]]:
    yield "time reached [time]", summary["time"]
    for key in ("steps", "rejected_steps", "remeshes", "failed_remeshes", "cells", "unknowns"):
        yield key.replace("_", " "), summary[key]
    if summary["failed_remeshes"]:
        yield "latest failed remesh", summary["latest_failed_remesh"]
    if summary.get("mesh_error", {}).get("latest") is not None:
        yield "relative error of the mesh, estimated at the end", per_cent(summary["mesh_error"]["latest"])
    yield "wall time [s]", summary["wall_time"]
    for stage, seconds in sorted(summary["wall_time_per_stage"].items(), key=lambda item: -item[1]):
        yield f"of it: {stage} [s]", seconds
    if summary.get("peak_memory") is not None:
        yield "peak memory of the process [MB]", summary["peak_memory"] / 1e6
