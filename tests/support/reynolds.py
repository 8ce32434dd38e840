"""Reynolds' equation of a thin film between two surfaces over a plane, by finite volumes on a rectangular grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from rigidfluid.core.geometry.arrays import FloatArray


def clustered(half: float, finest: float, count: int) -> FloatArray:
    """Nodes (2 count + 1,) from -half to half, ``finest`` apart in the middle and farther towards the ends [length]."""
    low, high = 1e-3, 30.0
    for _ in range(200):
        rate = 0.5 * (low + high)
        low, high = (rate, high) if np.sinh(rate / count) * half / np.sinh(rate) > finest else (low, rate)
    return np.asarray(half * np.sinh(rate * np.linspace(-1.0, 1.0, 2 * count + 1)) / np.sinh(rate))


@dataclass(frozen=True)
class Film:
    """A film of viscosity 1 between a = h/2 + xᵀAx/2 and b = -h/2 - xᵀBx/2 over nodes ``x`` and ``y`` [length], with
    tensors A and B, ``upper`` and ``lower`` (2, 2) [1/length], and h, ``gap``; the pressure is 0 around it."""

    x: FloatArray
    y: FloatArray
    upper: FloatArray
    lower: FloatArray
    gap: float

    @cached_property
    def points(self) -> FloatArray:
        """Nodes (N, M, 2) [length]."""
        return np.stack(np.meshgrid(self.x, self.y, indexing="ij"), axis=-1)

    @cached_property
    def area(self) -> FloatArray:
        """Area of each node (N, M) [length²]."""
        return np.outer(*(_widths(nodes) for nodes in (self.x, self.y)))

    @cached_property
    def height(self) -> FloatArray:
        """Thickness of the film (N, M) [length]."""
        return self.gap + 0.5 * np.einsum("nmi,ij,nmj->nm", self.points, self.upper + self.lower, self.points)

    def pressure(self, source: FloatArray) -> FloatArray:
        """p (N, M) with ∇·(h³∇p) = 12 ``source``, (N, M) [length/time]."""
        whole, inside = np.zeros_like(self.height), self._inside
        whole.ravel()[inside] = self._factors.solve((12.0 * source * self.area).ravel()[inside])
        return whole

    def resistance(self) -> FloatArray:
        """Forces and couples (6,) on a about the middle of the film, with the opposite sign, by each of the velocities
        and angular velocities (6,) of a; b is at rest."""
        return np.transpose([-self._wrench(*np.split(unit, 2)) for unit in np.eye(6)])

    def _wrench(self, velocity: FloatArray, spin: FloatArray) -> FloatArray:
        """From the velocities u of a rigid body: flux h u/2 - h³∇p/12, traction p (-∇a, 1) - h∇p/2 - u/h on a."""
        slope, widening = self.points @ self.upper, self.points @ (self.upper + self.lower)
        height = 0.5 * (self.gap + np.sum(self.points * slope, axis=2))
        place = np.concatenate([self.points, height[..., None]], axis=2)
        u = velocity + np.cross(spin, place)
        turning = np.array([spin[1], -spin[0]])  # slope of u along a, by z
        spread = np.sum(widening * u[..., :2], axis=2) + self.height * (slope @ turning)
        p = self.pressure(u[..., 2] - np.sum(slope * u[..., :2], axis=2) + 0.5 * spread)
        # integrals of h∇p f are those of -p ∇(h f), as p is zero around
        shear, weight = -u[..., :2] / self.height[..., None], self.area[..., None]
        along = np.sum(weight * (shear + p[..., None] * (0.5 * widening - slope)), axis=(0, 1))
        z = place[..., 2:]
        lifted = z * (shear + p[..., None] * (0.5 * widening - slope)) + 0.5 * (p * self.height)[..., None] * slope
        lever = np.sum(weight * (self.points * p[..., None] - lifted), axis=(0, 1))
        across = np.stack([-self.points[..., 1], self.points[..., 0]], axis=-1)
        twist = np.sum(weight * across * (shear + p[..., None] * (0.5 * widening - slope)))
        return np.array([*along, np.sum(self.area * p), lever[1], -lever[0], twist])

    @cached_property
    def _inside(self) -> FloatArray:
        return np.arange(self.height.size).reshape(self.height.shape)[1:-1, 1:-1].ravel()

    @cached_property
    def _factors(self):  # type: ignore[no-untyped-def]
        number, rows, columns, values = np.arange(self.height.size).reshape(self.height.shape), [], [], []
        for axis, nodes, other in ((0, self.x, self.y), (1, self.y, self.x)):
            first, second = (np.take(number, np.arange(len(nodes) - 1) + k, axis).ravel() for k in (0, 1))
            face = np.outer(1.0 / np.diff(nodes), _widths(other))
            height = 0.5 * (self.height.ravel()[first] + self.height.ravel()[second])
            flux = height**3 * (face if axis == 0 else face.T).ravel()
            rows += [first, second, first, second]
            columns += [first, second, second, first]
            values += [-flux, -flux, flux, flux]
        matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsc()
        return splu(matrix[self._inside][:, self._inside])


def _widths(nodes: FloatArray) -> FloatArray:
    """Half the distance between the neighbours of each node, (N,) [length]."""
    steps = np.diff(nodes, prepend=nodes[0], append=nodes[-1])
    return np.asarray(0.5 * (steps[1:] + steps[:-1]))
