"""Bodies in a domain, before it is asked what is around them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from rigidfluid.core.contact.path.detector_choice import exact_detector
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.piece import all_names
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.scene.all_errors import raise_all
from rigidfluid.core.setup.components import component_bodies
from rigidfluid.core.setup.rigid_body import PlacedMechanism, RigidBody
from rigidfluid.errors import SceneError
from rigidfluid.registry import Registry


class Arrangement:
    """Properties that follow from bodies, mechanisms and the domain that they are in."""

    domain: Domain
    bodies: tuple[RigidBody, ...]
    mechanisms: tuple[PlacedMechanism, ...]
    registry: Registry

    @property
    def crossed(self) -> Lattice:
        """The lattice by which bodies cross periodic surfaces, without vectors where they do not."""
        return self.domain.cells

    @property
    def dimension(self) -> int:
        """Number of space dimensions."""
        return self.domain.dimension

    @cached_property
    def all_bodies(self) -> tuple[RigidBody, ...]:
        """The single bodies, and after them the components of all mechanisms, where they are at the start."""
        return (*self.bodies, *component_bodies(self.mechanisms, self.dimension))

    @cached_property
    def shapes(self) -> tuple[Body, ...]:
        """Shapes of all bodies."""
        return tuple(body.shape for body in self.all_bodies)

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of all bodies, then of the domain's pieces."""
        return (*(body.name for body in self.all_bodies), *self.domain.names)

    @cached_property
    def exact_detector(self) -> type[Detector]:
        """The cheapest detector that is exact and needs no mesh."""
        return exact_detector(self.shapes, self.domain.pieces, self.registry)


@dataclass(frozen=True)
class PlacedBodies(Arrangement):
    """Bodies and mechanisms in a domain, with the parts that are installed."""

    domain: Domain
    bodies: tuple[RigidBody, ...]
    mechanisms: tuple[PlacedMechanism, ...]
    registry: Registry


def check_names(placed: Arrangement) -> None:
    """Refuse, with SceneError, names that bodies, mechanisms and surfaces of the domain share."""
    raise_all(_doubled_names(placed))


def doubled(field: str, name: str) -> SceneError:
    """Error for a name at a ``field`` that another body or surface has."""
    return SceneError(field, repr(name), "a name that no other body or surface has", "Rename it.")


def _doubled_names(placed: Arrangement) -> Iterator[SceneError]:
    names, wholes = [body.name for body in placed.all_bodies], [whole.name for whole in placed.mechanisms]
    for name, count in Counter([*names, *wholes, *all_names(placed.domain.pieces)]).items():
        if count > 1:
            last = len(names) - 1 - names[::-1].index(name) if name in names else len(names)
            yield doubled(f"body.{last}.name" if last < len(placed.bodies) else "mechanism.name", name)
