"""Does a law of thin films begin where the mesh ends to resolve them?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rigidfluid.checks.design_contacts import representative_contacts
from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.contact.pairs.gap_curvature import with_effective_radii
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.scene.mesh_tables import MeshTable

QUESTION = "film"
TWICE = 2.0
"""A range of more than that times the gap that the mesh still resolves is warned of."""


def resolved_gap(mesh: MeshTable, radius: FloatArray) -> FloatArray:
    """h²/R, the gap where a film, √(R gap) wide, is as wide as the finest cells h; of the effective ``radius``
    [length]."""
    return np.asarray((mesh.size_body / 2**mesh.refinements) ** 2 / radius)


def film_findings(system: System, mesh: MeshTable) -> Iterator[Finding]:
    """Compare the ranges of laws of films with h²/R, the gap where the finest cells h are as wide as the film, √(R
    gap); warnings where the mesh resolves the film that a law counts as well, and where a law counts sliding."""
    for design in representative_contacts(system):
        for interaction in design.interactions:
            if interaction.law.film and len(design.contacts):
                yield from _finding(system, interaction, design.contacts, mesh)


def _finding(system: System, interaction: Interaction, contacts: Contacts, mesh: MeshTable) -> Iterator[Finding]:
    radius = with_effective_radii(contacts, system.bodies, system.walls, system.pose).effective_radius
    row = int(np.nanargmax(radius))
    law_range, resolved = interaction.law.range, float(resolved_gap(mesh, radius[row]))
    names = system.surfaces[contacts.body_a[row]], system.surfaces[contacts.body_b[row]]
    if interaction.law.couples:
        yield _counts_sliding(interaction, names)
    if law_range <= TWICE * resolved:
        return
    finest = mesh.size_body / 2**mesh.refinements
    text = (
        f"{' and '.join(names)}: the finest cells, {figure(finest)}, resolve films down to gaps of {figure(resolved)}"
    )
    text += f", and {interaction.law.name!r} counts them again from {figure(law_range)} on"
    remedy = f"Leave the law out, set {interaction.field}.range to {round_down(resolved)}, or lower mesh.refinements."
    found = {"range": law_range, "resolved": resolved, "finest_cell": finest}
    yield Finding("warning", QUESTION, names, text, remedy, found, {"range": resolved})


def _counts_sliding(interaction: Interaction, names: tuple[str, str]) -> Finding:
    text = f"{' and '.join(names)}: a mesh resolves sliding and rolling in narrower gaps than squeezing, and"
    text += f" {interaction.law.name!r} counts them again"
    return Finding("warning", QUESTION, names, text, f"Set {interaction.field}.sliding to false.")
