"""Stress of contacts between bodies, with that of the films in them apart."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.coupling.contact_forces import film_forces
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import radius_of
from rigidfluid.core.model.types import Contacts, Pose, Twist
from rigidfluid.post.reports.results import Results
from rigidfluid.post.statistics.contact_rows import ContactRows


def contact_stresses(results: Results, rows: ContactRows) -> dict[str, FloatArray]:
    """Stress (s, d, d) by cause: ``contacts``, and where a law gives a film its resistance, ``lubrication``; the
    ``rows`` are those of contacts between bodies that move."""
    force = rows.vectors("f")
    if not any(interaction.law.film for interaction in results.system.interactions):
        return {"contacts": rows.stress(force)}
    film = np.zeros_like(force)
    for state in np.unique(rows.state):
        here = rows.state == state
        film[here] = _film(results, rows.selected(here), int(rows.samples.step[state]))
    return {"contacts": rows.stress(force - film), "lubrication": rows.stress(film)}


def _film(results: Results, rows: ContactRows, step: int) -> FloatArray:
    """Force of the film in each contact of one state on a (c, d) [force]."""
    system, row = results.system, int(np.searchsorted(results.bodies["step"][:, 0], step))
    number = {name: row for row, name in enumerate(results.names)}
    body_a, body_b = (np.array([number[name] for name in names]) for names in rows.names)
    radii = np.array([radius_of(body) for body in system.bodies])
    contacts = Contacts(
        body_a=body_a,
        body_b=body_b,
        point_a=rows.vectors("a"),
        point_b=rows.vectors("b"),
        normal=rows.vectors("n"),
        gap=rows.columns["gap"],
        radius_a=radii[body_a],
        radius_b=radii[body_b],
        at_wall=np.zeros(len(body_a), dtype=bool),
        shift=rows.shifts(),
    )
    quantity = {name: results.quantity(name)[row] for name in ("position", "orientation", "velocity")}
    pose = Pose(quantity["position"], quantity["orientation"])
    return film_forces(system, contacts, pose, Twist(quantity["velocity"], results.quantity("angular_velocity")[row]))
