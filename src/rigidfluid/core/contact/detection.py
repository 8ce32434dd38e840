"""Asks a system's detector, and takes no contacts from it that cannot be."""

from __future__ import annotations

from rigidfluid.core.model.contact_results import refuse_lost_contacts
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose


def detect(system: System, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
    """All contacts with gap ≤ ``reach`` [length], as the system's detector finds them.

    Raises
    ------
    PluginError
        If they are between surfaces that there are not, or arrays have a wrong shape.
    StepRejected
        If a gap, point or normal is no number.
    """
    contacts = system.detector.detect(pose, mesh, reach)
    refuse_lost_contacts(contacts, len(system.bodies), len(system.surfaces), system.dimension)
    return contacts
