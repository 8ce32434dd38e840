"""Turns the keys of a scene's [mesh] table into wanted cell sizes, the way in which bodies come into the mesh, and the
conditions on which it is regenerated."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mesh.adaptation.mesh_adaptation import MeshUpdater, Renewal
from rigidfluid.core.mesh.adaptation.no_mesh import NoMesh
from rigidfluid.core.mesh.adaptation.updater import Updater
from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.core.mesh.size.equidistribution import Equidistribution
from rigidfluid.core.mesh.size.regions import RefinedBox, Region, curved_walls
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.mesh.size.wake import Wake
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.mesh_error import ErrorOfFlow
from rigidfluid.core.model.system import System
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.force_errors import ErrorOfForces
from rigidfluid.core.run.stopwatch import Stopwatch
from rigidfluid.core.scene.mesh_tables import MeshTable
from rigidfluid.core.setup.fluid import Fluid, NoFluid


def sizes_of(table: MeshTable, domain: Domain) -> Sizes:
    """Parameters of the cell size in a domain."""
    boxes = [RefinedBox(np.array(box.lower), np.array(box.upper), box.size) for box in table.refine]
    regions: tuple[Region, ...] = (*boxes, *curved_walls(domain, table.size, table.size_wall))
    return Sizes(
        table.size, table.size_body, table.growth, table.cells_per_gap, table.refinements, table.order, regions
    )


def wakes_of(table: MeshTable, dimension: int) -> tuple[SizeField, ...]:
    """Size field of the wakes behind bodies, if the table asks for them."""
    if table.wake is None:
        return ()
    return (Wake(table.wake.time, table.wake.size, table.growth, dimension),)


def accuracy_of(table: MeshTable, dimension: int) -> Equidistribution | None:
    """Size field of the accuracy, if the table asks for one."""
    return None if table.accuracy is None else Equidistribution(table.accuracy, table.most_cells, dimension)


def inserter_of(table: MeshTable) -> Inserter:
    """Way in which the bodies come into the first mesh."""
    return Inserter(table.inserter, table.mesher_timeout)


def renewal_of(table: MeshTable, clock: Clock, accuracy: Equidistribution | None) -> Renewal:
    """Conditions on which a mesh is regenerated; none is tried in the time of a whole step after a failure."""
    oldest = clock.tick_from(table.remesh_every) if table.remesh_every else np.inf
    return Renewal(table.quality, clock.ticks(0), oldest, accuracy)


def updater_of(fluid: Fluid | NoFluid, system: System, clock: Clock, watch: Stopwatch) -> Updater:
    """Keeper of a fluid's mesh; of none without a fluid."""
    table = fluid.mesh
    if table is None:
        return NoMesh(system)
    accuracy = accuracy_of(table, system.dimension)
    wanted = (*wakes_of(table, system.dimension), *fluid.size_fields, *([] if accuracy is None else [accuracy]))
    renewal = renewal_of(table, clock, accuracy)
    estimate = ErrorOfForces(clock.time) if table.goal == "forces" else ErrorOfFlow()
    return MeshUpdater(system, sizes_of(table, system.domain), renewal, wanted, inserter_of(table), watch, estimate)
