"""Refuses results of parts that no run may go on with: no numbers, or arrays that would be read beyond their end."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import njit

from rigidfluid.core.model.types import Advance, Contacts, FloatArray, Pose
from rigidfluid.errors import PluginError, StepRejected


def refuse_no_number(subject: str, quantity: str, values: FloatArray | float, key: str) -> None:
    """Raise StepRejected if any of ``values`` is not finite; ``key`` of the scene names the part that gave them."""
    numbers = np.asarray(values)
    finite = np.isfinite(numbers)
    if not finite.all():
        raise StepRejected(
            subject,
            f"a {quantity} of {numbers[~finite].flat[0]}",
            "finite numbers",
            f"Shorten time.step; if that does not help, look for the cause in what `{key}` says or names.",
        )


def refuse_lost_pose(names: Sequence[str], pose: Pose) -> None:
    """Raise StepRejected if a body is nowhere; ``names`` are the bodies' and more."""
    _refuse_lost_bodies(names, "position", pose.position, "body")
    _refuse_lost_bodies(names, "orientation", pose.orientation, "body")


def refuse_lost_advance(names: Sequence[str], advance: Advance, pose: Pose, motions: int) -> None:
    """Raise an error unless a backend's result has a row of finite numbers for each body, or each of the ``motions``
    that carry them, and finite energies."""
    key, (count, dimension) = "fluid.backend", pose.position.shape
    k = 1 if dimension == 2 else 3
    twist, wrench = advance.twist, advance.hydrodynamic_wrench
    for quantity, values, shape in (
        ("velocity", twist.velocity, (motions, dimension)),
        ("angular velocity", twist.angular_velocity, (motions, k)),
        ("force", wrench.force, (count, dimension)),
        ("torque", wrench.torque, (count, k)),
    ):
        _refuse_shape(key, quantity, values, shape, "body")
        _refuse_lost_bodies(names, quantity, values, key)
    for quantity in ("kinetic_energy", "dissipation", "dissipation_midway", "boundary_power"):
        refuse_no_number("fluid", quantity, getattr(advance, quantity), key)


def refuse_lost_forces(contacts: Contacts, force: FloatArray) -> None:
    """Raise an error unless a law's ``force`` (m, d) has a row of finite numbers for each contact."""
    _refuse_shape("contact.law", "forces", force, contacts.normal.shape, "contact")
    refuse_no_number("contacts", "force", force, "contact.law")


def refuse_lost_contacts(contacts: Contacts, bodies: int, surfaces: int, dimension: int) -> None:
    """Raise an error unless a detector's contacts are finite, and between surfaces that there are."""
    key, count, vectors = "contact.detector", len(contacts), ("point_a", "point_b", "normal")
    for name in vectors:
        _refuse_shape(key, name, getattr(contacts, name), (count, dimension), "contact")
    for name in ("body_a", "body_b", "gap"):
        _refuse_shape(key, name, getattr(contacts, name), (count,), "contact")
    if not _exist(contacts.body_a, contacts.body_b, bodies, surfaces):
        found = "a contact of surfaces that there are not"
        allowed = f"body_a from 0 to {bodies - 1}, body_b from 0 to {surfaces - 1}"
        raise PluginError(key, found, allowed, _remedy(key))
    if not _finite(contacts.gap, contacts.point_a, contacts.point_b, contacts.normal):
        for name in ("gap", *vectors):
            refuse_no_number("contacts", name, getattr(contacts, name), key)


def _refuse_lost_bodies(names: Sequence[str], quantity: str, values: FloatArray, key: str) -> None:
    if not np.isfinite(values).all():
        lost = int(np.argmin(np.isfinite(values).all(axis=1)))
        refuse_no_number(f"body {names[lost]}", quantity, values[lost], key)


def _refuse_shape(key: str, quantity: str, found: Any, wanted: tuple[int, ...], owner: str) -> None:
    shape = np.shape(found)
    if shape != wanted:
        raise PluginError(key, f"{quantity} of shape {shape}", f"{wanted}, a row for each {owner}", _remedy(key))


def _remedy(key: str) -> str:
    return f"Mend the part that {key} names; its contract test in rigidfluid.testing shows more."


@njit(cache=True)
def _exist(body_a, body_b, bodies, surfaces):
    missing = 0
    for i in range(len(body_a)):
        missing += not (0 <= body_a[i] < bodies and 0 <= body_b[i] < surfaces)
    return missing == 0


@njit(cache=True)
def _finite(gap, *vectors):
    """In one loop, as a detector is asked in every substep."""
    lost = 0
    for i in range(len(gap)):
        lost += not np.isfinite(gap[i])
        for vector in vectors:
            for k in range(vector.shape[1]):
                lost += not np.isfinite(vector[i, k])
    return lost == 0
