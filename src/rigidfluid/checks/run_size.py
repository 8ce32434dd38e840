"""Sizes of the meshes expected in a run, at the start and at the most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log2

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts, design_contacts
from rigidfluid.checks.resolution import narrowest_gaps
from rigidfluid.checks.settled_pose import settled_pose
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.mesh.adaptation.mmg import MESHER_MEMORY
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.cell_count import Count, expected_count
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.size.size_interface import SizeField, with_fields_at_rest
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, SolverCost
from rigidfluid.core.run.mesh_keys import sizes_of
from rigidfluid.core.scene.mesh_tables import MeshTable
from rigidfluid.core.setup.model import Model

_LATER_OVER_FIRST = 1.05
"""Cells of a mesh made from another one over those of a first mesh, most often."""

_SHARE_OF_REST = 0.8
"""Weight of the gap at rest in the geometric mean with the gap at which an impact would end without the film [1], for
the least gap of an impact that a film brakes; fitted to the sphere of ten Cate et al. and of the paper, and to the
paper's ellipsoid."""

_HELD = 0.01
"""Least gap, over a law's range, that the law rather than the film determines [1]."""

_DIAMETERS_OF_A_MESH = 2.0
"""Distance that a body goes until its mesh is worn, over its diameter [1]."""


@dataclass(frozen=True, slots=True)
class RunSize:
    """Cells of the mesh at the ``start``, and the ``most``, with bodies settled down to a ``gap`` [length], None where
    none falls; what the backend takes for them; how many ``meshes`` are made, the first one included; and the
    ``memory`` of the run at its most, where a mesh is made while factors are held [byte]."""

    start: Count
    most: Count
    gap: float | None
    start_cost: SolverCost
    most_cost: SolverCost
    meshes: int
    memory: float


def run_size(model: Model, system: System, mesh: MeshTable) -> RunSize | None:
    """Sizes that a run is expected to have; None where the backend cannot predict its cost."""
    sizes = sizes_of(mesh, system.domain)
    start = _count(system, system.pose, sizes, model.fluid.size_fields)
    start_cost = system.backend.solver_cost(*start)
    if start_cost is None:
        return None
    gap = least_gap(list(design_contacts(system)), sizes)
    settled = settled_pose(system, model.exact_detector, gap)
    meshes = _later_meshes(system, settled, gap, sizes, model.time.end)
    falls = bool(np.any(settled.position != system.pose.position))
    most = max(start, _count(system, settled, sizes, model.fluid.size_fields)) if falls else start
    if meshes:
        most = Count(*(_LATER_OVER_FIRST * number for number in most))
    most_cost = system.backend.solver_cost(*most)
    assert most_cost is not None
    memory = max(start_cost.memory, most_cost.memory)
    if meshes:
        memory += MESHER_MEMORY[system.dimension]
    return RunSize(start, most, gap if falls else None, start_cost, most_cost, 1 + meshes, memory)


def least_gap(contacts: list[DesignContacts], sizes: Sizes) -> float:
    """Least gap g_rest^0.8 g_impact^0.2 by rest and impacts, at least what the finest cells resolve [length].

    If a law holds the bodies in one of the two alone it is that gap, and if in none, that of the finest cells.
    """
    finest = sizes.cells_per_gap * sizes.smallest
    rest = _least([(design, narrowest_gaps(design)) for design in contacts])
    impact = _least([(design, design.turning_gaps()) for design in contacts])
    if rest is None or impact is None:
        return max(rest or impact or 0.0, finest)
    mean = float(rest**_SHARE_OF_REST * min(impact, rest) ** (1.0 - _SHARE_OF_REST))
    return max(mean, finest)


def _least(gaps: list[tuple[DesignContacts, FloatArray]]) -> float | None:
    """Least gap at which a law holds a body or ends its impact, None where there is none [length]."""
    found = [float(gap) for design, mine in gaps for gap in mine if gap > _HELD * design.law.range]
    return min(found, default=None)


def _count(system: System, pose: Pose, sizes: Sizes, fields: Sequence[SizeField]) -> Count:
    """Expected mesh around bodies at a ``pose`` in a fluid at rest."""
    around = fluid_domain_at(system, pose)
    return expected_count(around, with_fields_at_rest(sizes, fields, around))


def _later_meshes(system: System, settled: Pose, gap: float, sizes: Sizes, end: float) -> int:
    """Number of meshes after the first: one for each two diameters that a body goes, for the body with the most, and
    one for each time that its gap halves from where cells of the bodies' size resolve it. A body that does not fall
    goes at its prescribed or expected speed, through the domain at the most."""
    diameter = 2.0 * np.array([equal_volume_radius(body) for body in system.bodies])
    fallen = np.linalg.norm(settled.position - system.pose.position, axis=1)
    speed = np.linalg.norm(system.twist.velocity, axis=1)
    if system.loads.travel_speed is not None:
        speed = np.where(system.prescribed, speed, system.loads.travel_speed)
    way = np.where(fallen > 0.0, fallen, np.minimum(speed * end, float(np.max(system.domain.size))))
    lands = bool(np.any(fallen > 0.0))
    halvings = log2(max(2.0 * sizes.cells_per_gap * sizes.size_body / gap, 1.0)) if lands else 0.0
    return int(np.ceil(float(np.max(way / diameter, initial=0.0)) / _DIAMETERS_OF_A_MESH + halvings))
