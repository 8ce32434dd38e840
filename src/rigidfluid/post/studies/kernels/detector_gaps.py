"""The gaps that a detector finds among balls or ellipsoids in a box."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import combinations, product
from math import ceil
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.core.scene.validation import read_table
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.errors import SceneError
from rigidfluid.post.studies.kernels.convex_gaps import true_gap
from rigidfluid.post.studies.kernels.kernel import Kernel
from rigidfluid.post.studies.kernels.timing import fastest
from rigidfluid.post.studies.subject import Outcome
from rigidfluid.registry import DETECTOR, Registry

REPEATS = 3
LONGEST = 0.3, 0.45
"""Bounds of a body's longest semi-axis [length]."""
JITTER = 0.04
"""How far a body is from the middle of its cell of side 1, along each axis, so that no two overlap [length]."""
ROUNDING = float(np.finfo(float).eps)
"""Least error, that of the true gaps [length]."""
FAR_SIZE = 0.3
"""Edge length of the mesh away from the bodies [length]."""


class DetectorGaps(Kernel):
    """Largest |gap - true gap| of all pairs and poses; gaps beyond ``reach``, and pairs not found, count as ``reach``.

    Seconds are those of one call of the detector, the best of three, averaged over the poses; meshes and what depends
    on their cells alone are made before. Unknowns are vertices of the mesh, steps are poses.
    """

    figure: ClassVar[str] = "gap"
    against: ClassVar[str] = "the gap of the shapes"

    detector: str = Field(description="Name of a detector, as in a scene")
    options: dict[str, dict[str, Any]] = Field(
        default={}, description="Tables of keys of `[contact]` for a detector, by its name"
    )
    dimension: Literal[2, 3] = Field(default=2, description="2 for disks and ellipses, 3 for balls and ellipsoids")
    bodies: int = Field(default=9, ge=2, le=10_000, description="How many bodies [1]")
    aspect: float = Field(default=1.0, ge=1, le=50, description="Longest over shortest semi-axis; 1 for balls [1]")
    size: float = Field(default=0.05, gt=0, description="Edge length of the mesh on the bodies [length]")
    reach: float = Field(default=0.25, gt=0, description="Gap up to which contacts are asked for [length]")
    poses: int = Field(default=3, ge=1, description="How many random poses are tried [1]")
    seed: int = Field(default=0, ge=0, description="Of the random shapes and poses [1]")

    @model_validator(mode="after")
    def _check(self) -> DetectorGaps:
        self._part_options()
        return self

    def reads(self, knob: str) -> bool:
        """Options of other detectors are not read, nor is the mesh's size by a detector without a mesh."""
        if knob == "size":
            return detection_by(self._part).on_mesh
        return not knob.startswith("options.") or knob.startswith(f"options.{self.detector}.")

    def run(self, progress: Callable[[float], None]) -> Outcome:
        """Ask the detector in each pose, and compare with the gaps of the shapes."""
        rng = np.random.default_rng(self.seed)
        semi_axes = self._semi_axes(rng)
        bodies = [_body(row) for row in semi_axes.tolist()]
        errors, seconds, vertices = [], [], 0
        for number in range(self.poses):
            pose, detector = self._pose(rng), self._part(self._part_options(), bodies, [])
            mesh = detection_by(self._part).mesh_at(pose, partial(self._mesh, bodies))
            call = partial(detector.detect, pose, mesh, self.reach)
            seconds.append(fastest(call, REPEATS))
            errors += self._errors(semi_axes, pose, call())
            vertices = max(vertices, len(mesh.points))
            progress((number + 1) / self.poses)
        if not errors:
            raise SceneError("reach", self.reach, "a reach that some gap is below", "Widen it, or add bodies or poses.")
        return Outcome(max(*errors, ROUNDING), float(np.mean(seconds)), vertices, self.poses)

    @property
    def _part(self) -> type[Detector]:
        return Registry.load().get(DETECTOR, self.detector, "detector")

    def _part_options(self) -> PartOptions:
        return read_table(self._part.Options, self.options.get(self.detector, {}), f"options.{self.detector}")

    def _errors(self, semi_axes: FloatArray, pose: Pose, contacts: Contacts) -> list[float]:
        """|gap - true gap| of each pair within reach, by its true or its detected gap [length]."""
        found: dict[tuple[int, int], float] = {}
        for a, b, gap in zip(contacts.body_a.tolist(), contacts.body_b.tolist(), contacts.gap.tolist(), strict=True):
            found[a, b] = min(gap, found.get((a, b), self.reach))
        bounds, errors = semi_axes.max(axis=1), []
        for a, b in combinations(range(len(semi_axes)), 2):
            apart = np.linalg.norm(pose.position[a] - pose.position[b]) - bounds[a] - bounds[b]
            true = true_gap(semi_axes, pose, a, b) if apart <= self.reach else np.inf
            if true <= self.reach or (a, b) in found:
                errors.append(abs(found.get((a, b), self.reach) - min(true, self.reach)))
        return errors

    def _semi_axes(self, rng: np.random.Generator) -> FloatArray:
        """Semi-axes (n, d) in geometric progression, the longest of each body at random [length]."""
        shape = self.aspect ** -np.linspace(0.0, 1.0, self.dimension)
        return rng.uniform(*LONGEST, (self.bodies, 1)) * shape

    def _pose(self, rng: np.random.Generator) -> Pose:
        """Each body in a cell of its own, tilted at random."""
        cells = np.array(list(product(range(self._side), repeat=self.dimension)))[: self.bodies]
        turns = rng.normal(size=(self.bodies, 1 if self.dimension == 2 else 4))
        if self.dimension == 3:
            turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        return Pose(cells + 0.5 + rng.uniform(-JITTER, JITTER, cells.shape), turns)

    def _mesh(self, bodies: list[Body], pose: Pose) -> Mesh:
        corners = BoxOptions(lower=(0.0,) * self.dimension, upper=(float(self._side),) * self.dimension)
        sizes = Sizes(max(FAR_SIZE, self.size), self.size, 0.5)
        return generate_mesh(FluidDomain(bodies, pose, Box(corners, self.dimension), ()), sizes)

    @property
    def _side(self) -> int:
        """Cells along an edge of the box."""
        root: float = self.bodies ** (1.0 / self.dimension)
        return ceil(round(root, 9))


def _body(semi_axes: list[float]) -> Body:
    if len(set(semi_axes)) == 1:
        return Sphere(SphereOptions(radius=semi_axes[0]), len(semi_axes))
    return Ellipsoid(EllipsoidOptions(semi_axes=tuple(semi_axes)), len(semi_axes))
