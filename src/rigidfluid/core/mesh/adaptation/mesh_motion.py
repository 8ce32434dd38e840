"""Moves a mesh with its bodies by the paper's harmonic map: factorised once for a reference mesh, one solve a step."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain

import numpy as np
from scipy.sparse import csc_array

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mesh.distribution import surface_vertices
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.periodic import Seams
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.extension import Extension, FactorisedExtension
from rigidfluid.core.model.types import CurvedEdges, Mesh, Pose
from rigidfluid.core.model.window import Window

MakeExtension = Callable[[Mesh, csc_array, BoolArray], Extension]


def factorised(mesh: Mesh, matrix: csc_array, held: BoolArray) -> Extension:
    """Extension of boundary values by factors of the matrix, in one process."""
    return FactorisedExtension(matrix, held)


class MeshMotion:
    """Harmonic map of a reference mesh, ∇·((1 + τ)∇x) = 0 with τ_e = (1 - V_min/V_max) / (V_e/V_max), P1.

    Small cells are stiff, large ones take the deformation. On the bodies x is the rigid motion from the reference pose
    (of a ball only its translation); vertices on a flat surface across an axis slide along it, so their normal
    coordinate is fixed and the natural condition holds along the surface; periodic surfaces go with the map, and x - X
    is that of their images; on other surfaces of the domain x = X.
    The mesh is of ``fluid_domain``, whose pose is the reference pose. ``extension`` makes the solver from the mesh, its
    stiffness matrix and the held vertices of one component. If a ``window`` of the domain is meshed, the mesh's ends go
    with it.

    Equation (ALE) of Van Landeghem et al., arXiv:2402.19093; τ after Kanchi and Masud, DOI 10.1002/fld.1512.
    """

    def __init__(
        self,
        mesh: Mesh,
        fluid_domain: FluidDomain,
        extension: MakeExtension = factorised,
        window: Window | None = None,
    ) -> None:
        bodies, domain = fluid_domain.bodies, fluid_domain.domain
        self._points = mesh.points
        self._curved = mesh.curved
        self._turns = np.array([body.radius is None for body in bodies], dtype=bool)
        self._pose = fluid_domain.pose
        surfaces = [surface_vertices(mesh, i) for i in range(len(bodies))]
        self._on_bodies = np.concatenate([*surfaces, np.empty(0, np.int64)])
        self._body = np.repeat(np.arange(len(bodies)), [len(on_body) for on_body in surfaces])
        self._held = held_components(mesh, len(bodies), domain)
        images, _ = Seams.from_domain(len(bodies), domain).originals(mesh)
        self._window = window
        ends = [] if window is None else [surface_vertices(mesh, len(bodies) + piece) for piece in window.ends]
        self._on_ends = np.concatenate([*ends, np.empty(0, np.int64)])
        matrix = stiffness(mesh)
        self._solves = [tied(extension, mesh, matrix, held, images) for held in self._held.T]

    def move(self, pose: Pose) -> FloatArray:
        """Geometry (N + K, d) of the mesh when the bodies are at ``pose``: vertices and middles of curved edges, those
        of a body on its surface [length]."""
        displacement = np.zeros_like(self._points)
        displacement[self._on_bodies] = self._rigid_displacement(pose, self._body, self._points[self._on_bodies])
        if self._window is not None:
            gone = self._window.displacement(pose) - self._window.displacement(self._pose)
            displacement[self._on_ends, self._window.axis] = gone
        for k, extension in enumerate(self._solves):
            extension.fill(displacement[:, k])
        moved: FloatArray = self._points + displacement
        return moved if self._curved is None else np.concatenate([moved, self._moved_middles(self._curved, pose)])

    def _moved_middles(self, curved: CurvedEdges, pose: Pose) -> FloatArray:
        """Middles of curved edges (K, d) [length]: those on a body move with it, those on walls stay."""
        middles = curved.middles.copy()
        on_body = curved.surface < len(self._turns)
        middles[on_body] += self._rigid_displacement(pose, curved.surface[on_body], middles[on_body])
        return middles

    def _rigid_displacement(self, pose: Pose, body: IntArray, reference: FloatArray) -> FloatArray:
        """x - X of points X (N, d) on bodies (N,): c + R Rᵣᵀ(X - cᵣ) - X, or c - cᵣ for a ball."""
        moved = (pose.position - self._pose.position)[body]
        turning = self._turns[body]
        if turning.any():
            of, points = body[turning], reference[turning]
            turn = rotation_matrices(pose.orientation) @ rotation_matrices(self._pose.orientation).swapaxes(1, 2)
            arm = points - self._pose.position[of]
            moved[turning] = pose.position[of] + np.einsum("nij,nj->ni", turn[of], arm) - points
        return np.asarray(moved)


class TiedExtension:
    """Extension in which vertices have the values of the ``originals`` (N,) that they are images of.

    ``make`` makes the extension of the values of the originals. If no value is held, the first is."""

    def __init__(
        self, make: MakeExtension, mesh: Mesh, matrix: csc_array, held: BoolArray, originals: IntArray
    ) -> None:
        self._rows, self._place = np.unique(originals, return_inverse=True)
        each = np.arange(len(originals))
        sums = csc_array((np.ones(len(each)), (each, self._place)), shape=(len(each), len(self._rows)))
        kept = np.zeros(len(self._rows), dtype=bool)
        kept[self._place[held]] = True
        kept[0] |= not kept.any()
        self._extension = make(mesh, csc_array(sums.T @ matrix @ sums), kept)

    def fill(self, values: FloatArray) -> None:
        of_originals = values[self._rows]
        self._extension.fill(of_originals)
        values[:] = of_originals[self._place]


def tied(make: MakeExtension, mesh: Mesh, matrix: csc_array, held: BoolArray, originals: IntArray) -> Extension:
    """Extension of values at a mesh's vertices, by what ``make`` makes where none is an image of another."""
    if np.array_equal(originals, np.arange(len(originals))):
        return make(mesh, matrix, held)
    return TiedExtension(make, mesh, matrix, held, originals)


def held_components(mesh: Mesh, bodies: int, domain: Domain) -> BoolArray:
    """Tell whether each component of the displacement is prescribed, (N, d): the normal one on a flat surface of the
    domain that lies across an axis, none on periodic ones, all on other surfaces and on bodies."""
    planes = [None] * bodies + [piece.shape.plane for piece in domain.pieces]
    held = np.zeros(mesh.points.shape, dtype=bool)
    for surface, plane in enumerate(planes):
        if surface - bodies not in chain(*domain.periodic):
            components = slice(None) if plane is None or plane.axis is None else plane.axis
            held[surface_vertices(mesh, surface), components] = True
    return held


def stiffness(mesh: Mesh) -> csc_array:
    """Matrix of ∫(1 + τ) ∇u·∇v for linear elements over this rank's cells, (N, N)."""
    volume = np.abs(cell_volumes(mesh.points, mesh.cells))
    smallest, largest = mesh.ranks.min(volume.min()), mesh.ranks.greatest(volume.max())
    tau = (1.0 - smallest / largest) / (volume / largest)
    corners = mesh.points[mesh.cells]
    inner = np.linalg.inv(corners[:, 1:] - corners[:, :1])
    gradients = np.concatenate([-inner.sum(axis=2, keepdims=True), inner], axis=2)
    local = ((1.0 + tau) * volume)[:, None, None] * (gradients.swapaxes(1, 2) @ gradients)
    rows, columns = np.broadcast_arrays(mesh.cells[:, :, None], mesh.cells[:, None, :])
    count = len(mesh.points)
    return csc_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count))
