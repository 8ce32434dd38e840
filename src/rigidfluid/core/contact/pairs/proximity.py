"""Proximity of bodies and walls: contacts of one pose, and each body's nearest gap."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs import broad_phase
from rigidfluid.core.contact.pairs.gap_curvature import with_gap_curvatures
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.rigid import angle_between
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.interactions import acted_in
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.errors import StepRejected


def detect(system: System, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
    """Contacts with gap ≤ ``reach`` [length], as the system's detector finds them; balls are round on any mesh."""
    return with_gap_curvatures(system.detection.detect(pose, mesh, reach), system, pose)


def detect_contacts_and_gaps(system: System, pose: Pose, mesh: Mesh | None) -> tuple[Contacts, FloatArray]:
    """Contacts that may repel, and each body's nearest gap (n,), both as far as ``system.reach``, else infinite.

    Parts of one articulated body, and bodies that a joint joins, do not touch each other, yet the gap between them
    counts, for the fluid there.
    """
    count = len(system.bodies)
    near = detect(system, pose, mesh, system.reach)
    gaps = np.full(count, np.inf)
    np.minimum.at(gaps, near.body_a, near.gap)
    paired = near.body_b < count
    np.minimum.at(gaps, near.body_b[paired], near.gap[paired])
    return interacting(system, near), gaps


def interacting(system: System, contacts: Contacts) -> Contacts:
    """Choose the contacts that are between separate bodies, and some law's, if there is any law."""
    if len(contacts) == 0:
        return contacts
    chosen = are_separate(system, contacts)
    if system.interactions:
        chosen &= acted_in(system.interactions, contacts)
    return select(contacts, chosen)


def are_separate(system: System, contacts: Contacts) -> BoolArray:
    """Tell whether a contact (m,) is neither between parts of one articulated body nor between bodies at one joint; an
    image of either is separate."""
    count = len(system.bodies)
    other = system.assembly[np.minimum(contacts.body_b, count - 1)]
    apart = (contacts.body_b >= count) | (system.assembly[contacts.body_a] != other)
    if len(system.joined):
        pairs = np.sort(np.column_stack([contacts.body_a, contacts.body_b]), axis=1)
        surfaces = len(system.surfaces)
        apart &= ~np.isin(pairs @ [surfaces, 1], system.joined @ [surfaces, 1])
    if contacts.shift is not None:
        apart |= contacts.shift.any(axis=1)
    return np.asarray(apart)


def refuse_overlap(system: System, body: int, gap: float) -> None:
    """Raise StepRejected unless the ``gap`` of a ``body`` [length] is positive."""
    if not gap > 0.0:
        others = "widen its range or refine mesh.size_body" if system.has_fluid else "or widen its range"
        remedy = f"Strengthen the contact force, {others}."
        if body in system.joined:
            remedy += " Joined bodies do not repel each other: they need a spring in the joint, or more room."
        raise StepRejected(
            f"body {system.surfaces[body]}",
            f"a gap of {gap:.3e}",
            "a positive gap to every other surface",
            remedy,
        )


def least_gaps(system: System, pose: Pose, gaps: FloatArray) -> FloatArray:
    """Nearest gap of each body (n,), and where it is not measured the largest known lower bound [length]."""
    beyond = ~np.isfinite(gaps)
    if not beyond.any():
        return gaps
    if len(system.lattice.vectors):
        return np.where(beyond, system.reach, gaps)
    bounds = system.bounding_radii
    free = np.maximum(broad_phase.least_gaps(pose.position, bounds, system.walls), system.reach)
    return np.where(beyond, free, gaps)


def travel(system: System, start: Pose, end: Pose) -> FloatArray:
    """Greatest displacement of any surface point of each body between two poses, |Δx| + R Δθ (n,) [length]."""
    moved = np.linalg.norm(end.position - start.position, axis=1)
    return np.asarray(moved + system.arms * angle_between(start.orientation, end.orientation))
