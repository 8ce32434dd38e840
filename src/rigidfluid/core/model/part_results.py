"""Refuses results of parts that no run may go on with: no numbers, or arrays that would be read beyond their end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Advance, Contacts, Pose
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
        refuse_shape(key, quantity, values, shape, "body")
        _refuse_lost_bodies(names, quantity, values, key)
    for quantity in _ENERGIES:
        refuse_no_number("fluid", quantity, getattr(advance, quantity), key)
    if advance.stress_power is not None:
        refuse_no_number("fluid", "stress_power", advance.stress_power, key)


_POWERS = ("boundary_power", "spurious_flux", "grad_div", "source_power")
_ENERGIES = ("kinetic_energy", "dissipation", "dissipation_midway", *_POWERS)


def refuse_lost_forces(contacts: Contacts, force: FloatArray, key: str = "contact.law") -> None:
    """Raise an error unless a law's ``force`` (m, d) has a row of finite numbers for each contact."""
    refuse_shape(key, "forces", force, contacts.normal.shape, "contact")
    refuse_no_number("contacts", "force", force, key)


def _refuse_lost_bodies(names: Sequence[str], quantity: str, values: FloatArray, key: str) -> None:
    if not np.isfinite(values).all():
        lost = int(np.argmin(np.isfinite(values).all(axis=1)))
        refuse_no_number(f"body {names[lost]}", quantity, values[lost], key)


def refuse_shape(key: str, quantity: str, found: Any, wanted: tuple[int, ...], owner: str) -> None:
    """Raise PluginError unless an array that a part gave has the shape ``wanted``, a row for each ``owner``."""
    shape = np.shape(found)
    if shape != wanted:
        raise PluginError(key, f"{quantity} of shape {shape}", f"{wanted}, a row for each {owner}", remedy(key))


def remedy(key: str) -> str:
    """Remedy for a part that gives arrays that none should give."""
    return f"Mend the part that {key} names; its contract test in rigidfluid.testing shows more."
