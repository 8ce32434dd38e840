"""Does the law leave bodies free where they should be?"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.core.contact.laws.loads import impact_energy
from rigidfluid.core.contact.pairs.proximity import are_separate
from rigidfluid.core.contact.pairs.representative_contacts import body_classes, free, wall_contacts
from rigidfluid.core.mechanics.shapes import half_thickness, inscribed_radius
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.scene.mesh_tables import MeshTable


def start_findings(system: System, interaction: Interaction, start: Contacts) -> Iterator[Finding]:
    """Report the pair within range at the start that stores most energy; a warning where that is more than the expected
    impact. ``start`` has the contacts of bodies and all surfaces of the domain."""
    repelling = np.append(np.arange(len(system.bodies)), [wall.surface for wall in system.walls])
    law = interaction.law
    near = select(start, (start.gap < law.range) & (start.sign > 0.0) & np.isin(start.body_b, repelling))
    near = select(near, are_separate(system, near) & interaction.acts_in(near))
    if len(near) == 0:
        return
    stored, impact = law.energy(near), impact_energy(near, system.loads)
    most = int(np.argmax(stored))
    names = system.surfaces[near.body_a[most]], system.surfaces[near.body_b[most]]
    gap, energy = float(near.gap[most]), float(stored[most])
    pairs = len({*zip(near.body_a.tolist(), near.body_b.tolist(), strict=True)})
    found = {"pairs": pairs, "gap": gap, "energy": energy, "impact_energy": float(impact[most])}
    text = f"{pairs} pairs start within range, {names[0]} and {names[1]} at a gap of {figure(gap)}"
    if energy <= impact[most]:
        yield Finding("note", "start", names, text, found=found)
        return
    text += f", which stores {figure(energy)}: more than the expected impact of {figure(impact[most])}"
    remedy = (
        f"Move them apart by {figure(law.range - gap)}, or set {interaction.field}.range to {round_down(gap)} or less."
    )
    yield Finding("warning", "start", names, text, remedy, found, {"range": gap})


def parallel_wall_findings(system: System, interaction: Interaction) -> Iterator[Finding]:
    """Find parallel flat walls between which a body midway is never free of both: a warning; or only at some angles: a
    note."""
    flat = [(wall, plane) for wall in system.walls if (plane := wall.shape.plane)]
    for (wall, plane), (opposite, other) in combinations(flat, 2):
        if not np.array_equal(plane.unit_normal, -other.unit_normal):
            continue
        pair, width = [wall.name, opposite.name], float(plane.signed_distance(other.point[None])[0])
        for kind in body_classes(system):
            both = wall_contacts(system, kind[:1] * 2, [wall, opposite])
            if free(system, kind) and interaction.acts_in(both).all():
                yield from _between_finding(system.surfaces[kind[0]], system.bodies[kind[0]], pair, width, interaction)


def _between_finding(
    name: str, body: Body, pair: list[str], width: float, interaction: Interaction
) -> Iterator[Finding]:
    law_range = interaction.law.range
    least, most = 0.5 * width - body.bounding_radius, 0.5 * width - inscribed_radius(body)
    if law_range <= least:
        return
    found = {"range": law_range, "least_centred_gap": least, "most_centred_gap": most}
    always = law_range > most
    text = f"midway between {pair[0]} and {pair[1]} {name} has gaps of {figure(least)} to {figure(most)}"
    text += ", so that both act in every place" if always else ", so that at some angles both act in every place"
    key = f"{interaction.field}.range"
    remedy = "Widen the domain."
    if least > 0.0:
        remedy = f"Set {key} to {round_down(least)} or less; ignore this if it is intended."
    yield Finding("warning" if always else "note", "free-gap", (name, *pair), text, remedy, found, {"range": least})


def range_findings(system: System, interaction: Interaction, mesh: MeshTable | None) -> Iterator[Finding]:
    """Warn of a range wider than the smallest body, or narrower than the finest cells in gaps but for laws of films."""
    law, key = interaction.law, f"{interaction.field}.range"
    smallest = min((kind[0] for kind in body_classes(system)), key=lambda body: half_thickness(system.bodies[body]))
    name, size = system.surfaces[smallest], half_thickness(system.bodies[smallest])
    if law.range > size:
        text = f"the law reaches {figure(law.range)}, further than the largest ball inside {name}, {figure(size)}"
        remedy, found = f"Set {key} to {round_down(size)} or less.", {"range": law.range, "half_thickness": size}
        yield Finding("warning", "range", (name,), text, remedy, found, {"range": size})
    if mesh is None or law.film:
        return
    finest, enough = mesh.size_body / 2**mesh.refinements, law.range * 2**mesh.refinements
    if law.range < finest:
        text = f"the law begins at {figure(law.range)}, within one of the finest cells of {figure(finest)}"
        remedy = f"Set mesh.size_body to {round_down(enough)} or less, or widen {key}."
        found = {"range": law.range, "size_body": mesh.size_body, "finest_cell": finest}
        yield Finding("warning", "range", (), text, remedy, found, {"size_body": enough})
