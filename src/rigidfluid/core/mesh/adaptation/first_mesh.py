"""The first mesh of a scene; in a periodic domain it is cut open elsewhere where a body hardly reaches beyond."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.chosen_cut import well_cut
from rigidfluid.core.mesh.adaptation.level_set import level_set_mesh
from rigidfluid.core.mesh.adaptation.remesh import LONGEST_EDGE, remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.fill import fill_mesh
from rigidfluid.core.mesh.generation.inserter import BY_SHAPE, Inserter
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.periodic import with_exact_images
from rigidfluid.core.mesh.generation.refine_surface import long_edges, long_seam_edges
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

BISECTABLE = 4.0
"""Kept edges at most this many times longer than wanted are left to bisection; longer ones may cut through the gap."""

GENERATIONS = 8
"""Largest number of times that the first mesh is generated, each time finer where an edge is too long for the gap it
faces."""

SLIDES = (0.0, 0.382, 0.618)
"""Shares of a period by which the surfaces that cut a first mesh are slid, one after the other, until there is one: the
mesher fails where a body hardly reaches beyond them."""


def initial_mesh(
    fluid_domain: FluidDomain,
    sizes: Sizes,
    inserter: Inserter = BY_SHAPE,
    watch: Callable[[str], AbstractContextManager[None]] = lambda _: nullcontext(),
) -> Mesh:
    """First mesh of a scene: made in the ``inserter``'s way, then graded by the wanted size like every later one.

    Markers are surface numbers, as in :func:`~rigidfluid.core.mesh.generation.meshing.generate_mesh`. ``watch`` times a
    stage by its name, "insertion" and "grading". Raises MeshError where no valid mesh can be made.
    """
    domain = fluid_domain.domain
    failures = []
    for share in SLIDES if domain.periodic and is_same_when_slid(domain) else SLIDES[:1]:
        try:
            with watch("insertion"):
                mesh = _inserted(fluid_domain, sizes, inserter, share)
            with watch("grading"):
                return remesh(mesh, fluid_domain.placed_on(mesh), sizes)
        except MeshError as error:
            failures.append(error)
    raise failures[0]


def is_same_when_slid(domain: Domain) -> bool:
    """Tell whether a periodic domain is the same all along its periods: its walls are planes along them."""
    planes = [piece.shape.plane for k, piece in enumerate(domain.pieces) if k not in domain.periodic_pieces]
    return all(plane is not None and not (domain.lattice @ plane.unit_normal).any() for plane in planes)


def _inserted(fluid_domain: FluidDomain, sizes: Sizes, inserter: Inserter, share: float) -> Mesh:
    """The first mesh before it is graded; that of a periodic domain is well cut, and its surfaces were first slid by a
    ``share`` of the periods."""
    domain, pose = fluid_domain.domain, fluid_domain.pose
    if not domain.periodic:
        return inserted_mesh(fluid_domain, sizes, inserter)
    slid = share * domain.lattice.sum(axis=0)
    winding = replace(fluid_domain, pose=replace(pose, position=pose.position - slid)).periods_outside()
    position = pose.position - winding @ domain.lattice
    inside, around = (replace(fluid_domain, pose=replace(pose, position=at)) for at in (position - slid, position))
    mesh = inserted_mesh(inside, sizes, inserter)
    moved = with_exact_images(replace(mesh, points=mesh.points + slid), len(fluid_domain.bodies), domain)
    return well_cut(moved, around, sizes, winding)


def inserted_mesh(fluid_domain: FluidDomain, sizes: Sizes, inserter: Inserter) -> Mesh:
    """The first mesh before it is graded; as for `initial_mesh`."""
    way = inserter.chosen(fluid_domain.bodies, fluid_domain.domain)
    if way != "cad":
        insert = fill_mesh if way == "fill" else level_set_mesh
        return insert(fluid_domain, sizes, inserter.timeout)
    finer: list[tuple[FloatArray, float]] = []
    for _ in range(GENERATIONS):
        mesh = generate_mesh(fluid_domain, sizes, finer)
        _, *on_bodies = long_edges(mesh, fluid_domain, sizes, BISECTABLE)
        on_seams = long_seam_edges(mesh, fluid_domain, sizes, LONGEST_EDGE)
        points, wanted = (np.concatenate(both) for both in zip(on_bodies, on_seams, strict=True))
        if not len(points):
            break
        finer += zip(points, wanted, strict=True)
    return mesh
