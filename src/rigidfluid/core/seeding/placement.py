"""Places and orientations of a swarm: thin ones by random insertion, dense ones by growth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import inscribed_radius
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose
from rigidfluid.core.seeding.clearance import Clearance, Surroundings
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.growth import Growth
from rigidfluid.core.seeding.insertion import Insertion
from rigidfluid.core.seeding.regions import Region
from rigidfluid.core.seeding.swarm import Swarm
from rigidfluid.errors import SceneError

_THIN = {2: 0.45, 3: 0.3}
"""Fraction of the region that bounding balls fill, by dimension, up to which bodies are inserted in full size [1].
Insertion ends at .547 in 2D and .38 in 3D (J. Feder 1980)."""

_START = {2: 0.25, 3: 0.15}
"""Fraction that small bodies fill when growth starts [1]."""

_SMALLER, _SMALLEST = 0.8, 0.05
"""Factor of the size where small bodies do not find places either, and the least size [1]."""

_SAMPLES = 4096
"""Number of points by which a region is compared with the domain."""


@dataclass(frozen=True)
class Others:
    """Bodies that are there before a swarm, with their ``pose``."""

    bodies: tuple[Body, ...]
    pose: Pose

    def joined(self, bodies: tuple[Body, ...], pose: Pose) -> Others:
        """These and further bodies."""
        position = np.concatenate([self.pose.position, pose.position])
        return Others(
            (*self.bodies, *bodies), Pose(position, np.concatenate([self.pose.orientation, pose.orientation]))
        )


@dataclass(frozen=True)
class Placement:
    """Places for the bodies of a ``swarm`` in a ``region`` with ``surroundings``, among ``others``, which bodies in
    full size find or, if they may ``grow``, smaller ones; raises SceneError where there is not enough room."""

    swarm: Swarm
    region: Region
    surroundings: Surroundings
    others: Others
    draws: Draws
    grow: bool = True

    def placed(self, orientation: FloatArray, turning: bool) -> tuple[Pose, Literal["insertion", "growth"]]:
        """Pose of the bodies, and how it was found, from orientations (n, q), which growth changes if ``turning``."""
        self._refuse_overfull()
        self._refuse_narrow()
        scale = self._first_scale() if self.grow else 1.0
        while scale > _SMALLEST:
            position = self._inserted(scale)
            if position is not None:
                start = Pose(position, orientation)
                return (start, "insertion") if scale == 1.0 else (self._grown(start, scale, turning), "growth")
            if not self.grow:
                break
            scale *= _SMALLER
        raise self._stuck(0.0)

    def _first_scale(self) -> float:
        radii, dimension = self.swarm.bounding_radii, self.swarm.dimension
        ball = np.pi if dimension == 2 else 4.0 / 3.0 * np.pi
        filled = ball * float(np.sum((radii + 0.5 * self.swarm.gap) ** dimension)) / self.region.volume
        return 1.0 if filled <= _THIN[dimension] else (_START[dimension] / filled) ** (1.0 / dimension)

    def _inserted(self, scale: float) -> FloatArray | None:
        swarm, others = self.swarm, self.others
        bounds = np.array([body.bounding_radius for body in others.bodies])
        insertion = Insertion(self.region, self.surroundings, self.draws)
        return insertion.places(scale * swarm.bounding_radii, scale * swarm.gap, others.pose.position, bounds)

    def _grown(self, start: Pose, scale: float, turning: bool) -> Pose:
        swarm, count = self.swarm, len(self.swarm)
        growth = Growth(swarm.bodies, self.others.bodies, self.surroundings, swarm.gap, turning, self.draws)
        whole = Others((), start).joined((), self.others.pose).pose
        pose, reached = growth.grown(whole, scale)
        if reached < 1.0:
            raise self._stuck(reached)
        return Pose(pose.position[:count], pose.orientation[:count])

    def _stuck(self, scale: float) -> SceneError:
        """Error for bodies that have no room beyond this size."""
        gap = f"a smaller `gap` than {self.swarm.gap:.3g}, or another `scene.seed`"
        if not scale:
            return self._too_much("fewer or smaller, as no place was found", gap)
        reached = self._asked * scale**self.swarm.dimension
        return self._too_much(f"up to about {reached:.3g}, which was reached with gaps in proportion", gap)

    def _refuse_overfull(self) -> None:
        if self._asked >= 1.0:
            raise self._too_much("less than the region", "a larger region")

    @property
    def _asked(self) -> float:
        """Volume of the bodies over that of the region [1]."""
        return self.swarm.volume / self.region.volume

    def _too_much(self, allowed: str, remedy: str) -> SceneError:
        """Error for bodies that ask for more room than is ``allowed``."""
        swarm, share = self.swarm, f"{self._asked:.3g} of the region's volume"
        if len(swarm) == 1:
            return SceneError(f"{swarm.at}.shape", f"a body of {share}", allowed, f"Make it smaller, or give {remedy}.")
        key = "number" if swarm.table.fraction is None else "fraction"
        return SceneError(
            f"{swarm.at}.{key}", f"{len(swarm)} bodies, {share}", allowed, f"Ask for fewer bodies, or {remedy}."
        )

    def _refuse_narrow(self) -> None:
        """Refuse gaps and bodies for which the region is too narrow even where nothing else is."""
        lower, upper = self.region.extent
        half = 0.5 * float(np.min(upper - lower))
        radius = max(map(inscribed_radius, self.swarm.bodies))
        if radius + self.swarm.gap > half:
            found = f"{self.swarm.gap:.3g} on both sides of a body {2.0 * radius:.3g} thick"
            allowed = f"together at most the width of the region, {2.0 * half:.3g}"
            raise SceneError(f"{self.swarm.at}.gap", found, allowed, "Make the gap or the bodies smaller.")


def refuse_outside(region: Region, around: Region, at: str, draws: Draws) -> None:
    """Raise SceneError for a ``region`` that has no part in the one ``around``."""
    lower, upper = region.extent
    points = lower + (upper - lower) * draws.uniform(_SAMPLES, len(lower))
    if not around.contains(points[region.contains(points)]).any():
        found = f"a region from {lower.tolist()} to {upper.tolist()} outside the domain"
        low, high = (corner.tolist() for corner in around.extent)
        raise SceneError(at, found, f"a region inside the domain from {low} to {high}", "Move it.")


def nearest(
    bodies: tuple[Body, ...], pose: Pose, others: Others, around: Surroundings, start: float
) -> tuple[float, int]:
    """Smallest gap of bodies to each other, to others and to the surfaces around, looked for from ``start`` on
    [length], at most that of bounding balls to their own images; and the number of the body that has it."""
    whole = Others(bodies, pose).joined(others.bodies, others.pose)
    bounds = np.array([body.bounding_radius for body in bodies])
    clearance, own = Clearance(whole.bodies, len(bodies), around), around.lattice.shortest - 2.0 * float(bounds.max())
    reach = min(start, own)
    while not len((gaps := clearance.within(whole.pose, reach)).gap):
        if reach == own:
            return own, int(np.argmax(bounds))
        reach = min(4.0 * reach, own)
    least = int(np.argmin(gaps.gap))
    return float(gaps.gap[least]), int(gaps.a[least])
