"""The two ways in which contacts are detected: by the bodies' poses alone, or on the fluid's mesh."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from rigidfluid.core.contact.pairs.round_contacts import on_round_shapes
from rigidfluid.core.model.detection import Detection, FollowedContacts, Sight
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose

if TYPE_CHECKING:
    from rigidfluid.core.contact.pairs.near_pairs import NearPairs


class PoseDetection(Detection):
    """`Detection` by a detector that is asked at any pose on the way: it misses nothing, and needs no mesh."""

    on_mesh: ClassVar[bool] = False

    def __init__(self, system: System) -> None:
        # whoever only chooses a way of detection, as a check does, loads no compiled kernels
        from rigidfluid.core.contact.path.look_ahead import foreseen, look_ahead

        self._system = system
        self._foreseen, self._look_ahead = partial(foreseen, system), partial(look_ahead, system)

    @cached_property
    def near_balls(self) -> NearPairs | None:
        """Neighbour list of the bodies, if all are balls that repel each other, between flat walls, in closed form;
        else None."""
        bodies, walls = self._system.bodies, self._system.walls
        if len(self._system.joined) or len(np.unique(self._system.assembly)) < len(bodies):
            return None
        balls = [body.radius for body in bodies if body.radius is not None]
        closed_form = vars(type(self._system.detector)).get("closed_form", False)
        if not closed_form or len(balls) < len(bodies) or not all(wall.shape.plane for wall in walls):
            return None
        from rigidfluid.core.contact.pairs.near_pairs import NearPairs, flat_walls

        return NearPairs(np.array(balls), flat_walls(bodies, walls))

    @staticmethod
    def mesh_at(pose: Pose, make: Callable[[Pose], Mesh]) -> Mesh:
        return Mesh.empty(pose.position.shape[1])

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        return self._system.detector.detect(pose, mesh, reach)

    def look_ahead(self, near: FollowedContacts, dynamics: BodyDynamics, size: float) -> Sight:
        return self._look_ahead(dynamics, size)

    def widened(self, sight: Sight, dynamics: BodyDynamics, size: float) -> Sight:
        now = self._look_ahead(dynamics, size)
        return now if now.reach > sight.reach else sight

    def followed(
        self, near: FollowedContacts, law: ForceLaw, dynamics: BodyDynamics, size: float, reach: float
    ) -> tuple[Contacts, FollowedContacts]:
        pairs = self._foreseen(law, dynamics, size, reach)
        return pairs.start, pairs

    def has_missed(self, seen: Contacts, found: Contacts) -> bool:
        return False


class DetectionOfImages(PoseDetection):
    """`PoseDetection` between periodic surfaces: bodies meet each other's images too."""

    def __init__(self, system: System) -> None:
        from rigidfluid.core.contact.pairs.image_detection import ImageDetection

        super().__init__(system)
        make = partial(type(system.detector), system.detector.options)
        self._images = ImageDetection(make, system.bodies, system.walls, system.lattice)

    @property
    def near_balls(self) -> None:
        """None: the list knows no images."""
        return None

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        return self._images.detect(pose, reach)


class MeshDetection(Detection):
    """`Detection` on the mesh at the start of a step and at its end; between them contacts move with their bodies."""

    on_mesh: ClassVar[bool] = True

    def __init__(self, system: System) -> None:
        self._system = system

    @staticmethod
    def mesh_at(pose: Pose, make: Callable[[Pose], Mesh]) -> Mesh:
        return make(pose)

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        return on_round_shapes(self._system.detector.detect(pose, mesh, reach), self._system.walls, pose)

    def look_ahead(self, near: FollowedContacts, dynamics: BodyDynamics, size: float) -> Sight:
        return Sight(near.extrapolate, np.inf, size)

    def widened(self, sight: Sight, dynamics: BodyDynamics, size: float) -> Sight:
        return sight

    def followed(
        self, near: FollowedContacts, law: ForceLaw, dynamics: BodyDynamics, size: float, reach: float
    ) -> tuple[Contacts, FollowedContacts]:
        return near.extrapolate(dynamics.pose), near

    def has_missed(self, seen: Contacts, found: Contacts) -> bool:
        """Tell whether a contact in range was beyond the detector's reach, or a pair has more than were seen."""
        count = len(self._system.surfaces)
        before, after = (each.body_a * count + each.body_b for each in (seen, found))
        pairs, counts = np.unique(after[found.gap < self._system.law_range], return_counts=True)
        return bool(np.any(counts > np.count_nonzero(before == pairs[:, None], axis=1)))


def detection_by(detector: type[Detector]) -> type[PoseDetection | MeshDetection]:
    """Way of detection by detectors of this class."""
    return MeshDetection if detector.needs_mesh else PoseDetection
