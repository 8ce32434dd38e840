"""Interface by which the loop finds a system's contacts at a pose, and follows them over a step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Mesh, Pose


class FollowedContacts(Protocol):
    """Contacts of one pose, followed to others."""

    def extrapolate(self, pose: Pose) -> Contacts:
        """The same contacts, in the same order, when the bodies are at ``pose``."""

    def missed(self, law: ForceLaw, pose: Pose) -> float:
        """Energy at ``pose`` of contacts that came less that of contacts that went, as far as they are found."""


@dataclass(frozen=True)
class Sight:
    """Contacts at any pose, by ``contacts_at``: all up to a gap ``reach`` [length], enough for a ``span`` [time] at the
    speeds that it was made for. Contacts that are not detected again but move with their bodies have an infinite
    reach."""

    contacts_at: Callable[[Pose], Contacts]
    reach: float
    span: float


class Detection(ABC):
    """Detection of a system's contacts, by the bodies' poses alone or on the fluid's mesh."""

    on_mesh: ClassVar[bool]
    """Tell whether it looks at the fluid's mesh, and finds nothing without one."""

    @staticmethod
    @abstractmethod
    def mesh_at(pose: Pose, make: Callable[[Pose], Mesh]) -> Mesh:
        """The mesh that it looks at when the bodies are at ``pose``: what ``make`` makes, or one without cells."""

    @abstractmethod
    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        """All contacts with gap ≤ ``reach`` [length], sorted by (body_a, body_b), those of balls between the round
        shapes themselves; reach may be infinite."""

    @abstractmethod
    def look_ahead(self, near: FollowedContacts, dynamics: BodyDynamics, size: float) -> Sight:
        """Sight for a step of this ``size`` [time] at the present speeds, with the contacts ``near`` at its start."""

    @abstractmethod
    def widened(self, sight: Sight, dynamics: BodyDynamics, size: float) -> Sight:
        """Sight for the present speeds if that reaches farther, else this one: speeds at the start of a step do not
        show the energy that contacts store at a turning point."""

    @abstractmethod
    def followed(
        self, near: FollowedContacts, law: ForceLaw, dynamics: BodyDynamics, size: float, reach: float
    ) -> tuple[Contacts, FollowedContacts]:
        """Contacts now, and the same followed over a part of a step of this ``size`` [time]: those ``near`` at the
        step's start, or all that may come into range and at least those within ``reach`` [length]."""

    @abstractmethod
    def has_missed(self, seen: Contacts, found: Contacts) -> bool:
        """Tell whether a contact ``found`` in range at the end of a step was neither ``seen`` at its start nor on the
        way."""
