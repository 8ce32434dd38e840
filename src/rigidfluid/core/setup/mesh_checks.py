"""Refuses a mesh whose keys contradict each other, the steps, or the domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.errors import MeshError, SceneError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.scene.mesh_tables import MeshTable
    from rigidfluid.core.scene.run_tables import TimeTable

MOST_CELLS = 10**9
"""Greatest number of cells, each a cube or square of the edge length: more are a slip of units, and a mesher would
never end."""


def check_mesh_table(mesh: MeshTable, time: TimeTable) -> None:
    """Refuse what contradicts itself in the tables alone; raises SceneError at the first contradiction."""
    if mesh.size_body > mesh.size:
        raise SceneError("mesh.size_body", mesh.size_body, f"at most mesh.size = {mesh.size}", "Swap or correct them.")
    if mesh.accuracy is None and mesh.most_cells != type(mesh).model_fields["most_cells"].default:
        remedy = "Add accuracy = 0.05, or leave it out."
        raise SceneError("mesh.most_cells", mesh.most_cells, "one beside mesh.accuracy, which reads it", remedy)
    if mesh.remesh_every is not None and mesh.remesh_every < time.step:
        allowed = f"at least time.step = {time.step}"
        raise SceneError("mesh.remesh_every", mesh.remesh_every, allowed, "Re-mesh less often.")
    if mesh.size_wall is not None:
        _check_size("mesh.size_wall", mesh.size_wall, mesh)
    if mesh.wake is not None:
        _check_size("mesh.wake.size", mesh.wake.size, mesh)
    for number, box in enumerate(mesh.refine):
        at = f"mesh.refine.{number}"
        _check_size(f"{at}.size", box.size, mesh)
        if np.any(np.array(box.lower) >= np.array(box.upper)):
            allowed = f"each number below that of `upper` = {list(box.upper)}"
            raise SceneError(f"{at}.lower", list(box.lower), allowed, "Swap or correct them.")


def check_cells(mesh: MeshTable, domain: Domain) -> None:
    """Refuse cells too many to be meant, and boxes that refine nothing; raises SceneError."""
    _check_count("mesh.size", mesh.size, domain.volume, "this domain", domain.dimension)
    lower, upper = domain.extent
    for number, box in enumerate(mesh.refine):
        inside = np.minimum(box.upper, upper) - np.maximum(box.lower, lower)
        if np.any(inside <= 0.0):
            allowed = f"a box that meets the domain, which reaches from {lower.tolist()} to {upper.tolist()}"
            found = f"one from {list(box.lower)} to {list(box.upper)}"
            raise SceneError(f"mesh.refine.{number}", found, allowed, "Move the box into it.")
        _check_count(f"mesh.refine.{number}.size", box.size, float(np.prod(inside)), "this box", domain.dimension)


def check_inserter(mesh: MeshTable, shapes: Sequence[Body], domain: Domain, field: str = "body") -> None:
    """Refuse shapes, of the tables ``field``, that no mesher puts into this domain; raises SceneError."""
    try:
        Inserter(mesh.inserter).chosen(shapes, domain, field)
    except MeshError as error:
        raise SceneError(error.subject, error.found, error.allowed, error.remedy) from error


def _check_size(field: str, size: float, mesh: MeshTable) -> None:
    """A region coarser than all else would refine nothing."""
    if size > mesh.size:
        raise SceneError(field, size, f"at most mesh.size = {mesh.size}", "Refine it, or leave it out.")


def _check_count(field: str, size: float, volume: float, where: str, dimension: int) -> None:
    least = (volume / MOST_CELLS) ** (1.0 / dimension)
    if size < least:
        raise SceneError(field, size, f"at least {least:.3g} for {where}", "Coarsen it.")
