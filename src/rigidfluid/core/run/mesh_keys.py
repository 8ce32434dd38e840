"""Turns the keys of a scene's [mesh] table into wanted cell sizes, the way in which bodies come into the mesh, and the
conditions on which it is made anew."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mesh.inserter import BY_SHAPE, Inserter
from rigidfluid.core.mesh.mesh_adaptation import Renewal
from rigidfluid.core.mesh.regions import RefinedBox, Region, curved_walls
from rigidfluid.core.mesh.size_field import Sizes
from rigidfluid.core.mesh.size_interface import SizeField
from rigidfluid.core.mesh.wake import Wake
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.scene.scene import MeshTable


def sizes_of(table: MeshTable, domain: Domain) -> Sizes:
    """Parameters of the cell size in a domain."""
    boxes = [RefinedBox(np.array(box.lower), np.array(box.upper), box.size) for box in table.refine]
    regions: tuple[Region, ...] = (*boxes, *curved_walls(domain, table.size, table.size_wall))
    return Sizes(
        table.size, table.size_body, table.growth, table.cells_per_gap, table.refinements, table.order, regions
    )


def wakes_of(table: MeshTable | None, dimension: int) -> tuple[SizeField, ...]:
    """Size field of the wakes behind bodies, if the table asks for them."""
    if table is None or table.wake is None:
        return ()
    return (Wake(table.wake.time, table.wake.size, table.growth, dimension),)


def inserter_of(table: MeshTable | None) -> Inserter:
    """Way in which the bodies come into the first mesh."""
    return BY_SHAPE if table is None else Inserter(table.inserter, table.mesher_timeout)


def renewal_of(table: MeshTable | None, clock: Clock) -> Renewal:
    """Conditions on which a mesh is made anew; none is tried in the time of a whole step after a failure."""
    pause = clock.ticks(0)
    if table is None:
        return Renewal(0.0, pause)
    oldest = None if table.remesh_every is None else clock.tick_from(table.remesh_every)
    return Renewal(table.quality, pause, oldest)
