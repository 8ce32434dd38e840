"""Refuses conditions that the domain's surfaces do not have, or cannot have."""

from __future__ import annotations

from collections import Counter
from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.nested.rows import check_rows
from rigidfluid.core.scene.scene import BoundaryTable, VelocityTable, WallTable
from rigidfluid.core.setup.boundary import conditions, oblique_parts
from rigidfluid.core.setup.boundary_samples import points_of, quadrature, sample_times, sampled_inflows
from rigidfluid.core.setup.boundary_tables import Place, placed_tables, tables_of_walls
from rigidfluid.core.setup.boundary_values import boundary_value, wall_velocity
from rigidfluid.core.setup.time_factor import rows_over_time
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.interfaces import FluidBackend
    from rigidfluid.core.scene.scene import Scene

ACROSS = 1e-12
"""Greatest velocity of a sliding flat wall across itself, over its speed, that counts as rounding [1]."""

ACROSS_CURVED = 1e-6
"""Greatest velocity of a sliding curved wall across itself, over its speed, that counts as rounding [1]; its normals
are differences of distances."""

ROUNDING, EXPRESSIONS = 1e-12, 1e-3
"""Net inflow over all flow through the boundary that is allowed for numbers, by rounding, and for expressions [1]."""


def check_boundary(scene: Scene, domain: Domain) -> None:
    """Refuse, with SceneError, unknown names, probes outside the domain, and conditions that contradict themselves or a
    surface's shape."""
    for number, table in enumerate(scene.boundary):
        _check_on(domain, table, f"boundary.{number}")
        _check_table(table, f"boundary.{number}")
    for at, rows in rows_over_time(scene).items():
        check_rows(rows, scene.time.end, at)
    for wall, place in tables_of_walls(scene, domain):
        _check_sliding(domain, wall, place)
    for table, place in placed_tables(scene, domain):
        _check_values(scene, domain, table, place)
    _check_names(scene, domain)
    outside = ~domain.contains(np.array(scene.output.probes, dtype=float).reshape(-1, scene.dimension))
    if outside.any():
        i = int(np.argmax(outside))
        field, found = f"output.probes.{i}", list(scene.output.probes[i])
        raise SceneError(field, found, "a point of the domain", "Move it inside.")


def check_inflow(scene: Scene, domain: Domain) -> None:
    """Raise SceneError where more flows in than out: an incompressible fluid needs a way out.

    Fluxes are integrated over surfaces whose shape is known, at many times; expressions may be off by what a mesh makes
    of them, which the backend balances.
    """
    if any(condition.is_open for condition in conditions(scene, domain)):
        return
    inflows = sampled_inflows(scene, domain)
    times = sample_times(scene, steady=all(inflow.velocity.is_steady for inflow in inflows))
    fluxes = [[inflow.flux(time) for inflow in inflows] for time in times]
    if not inflows or None in fluxes[0]:
        return
    flows = np.array(fluxes)
    passing = np.abs(flows).sum(axis=1)
    in_numbers = not any(inflow.velocity.velocity.names for inflow in inflows)
    allowed = ROUNDING * passing if in_numbers else EXPRESSIONS * np.max(passing)
    excess = np.abs(flows.sum(axis=1)) - allowed
    worst = int(np.argmax(excess))
    if excess[worst] > 0.0:
        when = "" if len(times) == 1 else f" at time {times[worst]:g}"
        raise SceneError(
            "boundary",
            f"a net inflow of {flows[worst].sum():.6g} [length^{scene.dimension}/time]{when} and no outlet",
            "as much outflow as inflow, or a surface of type 'pressure'",
            "Give one surface type = 'pressure', pressure = 0.0.",
        )


def check_oblique(scene: Scene, backend: type[FluidBackend], domain: Domain) -> None:
    """Raise SceneError where a ``backend`` is asked for slip or pressure on a surface that it cannot take them on."""
    if backend.oblique_faces:
        return
    for table, place in oblique_parts(scene, domain):
        found = f"{table.type!r} on {place.piece.name!r}, which does not lie across an axis"
        allowed = f"'wall' or 'velocity' there with backend {backend.name!r}"
        raise SceneError(f"{place.at}.type", found, allowed, "Use backend = 'scikit-fem'.")


def _check_on(domain: Domain, table: BoundaryTable, at: str) -> None:
    allowed = ("all", *domain.names)
    if table.on not in allowed:
        raise SceneError(f"{at}.on", repr(table.on), ", ".join(allowed), "Name a surface of the domain.")


@singledispatch
def _check_table(table: BoundaryTable, at: str) -> None:
    """Refuse keys of a table that its type has and that do not go together; of most types they all do."""


@_check_table.register(VelocityTable)
def _check_velocity_table(table: VelocityTable, at: str) -> None:
    if table.velocity is None and table.flux is None:
        raise SceneError(f"{at}.velocity", "nothing", "a value with type = 'velocity'", "Add 'velocity' or 'flux'.")
    if table.velocity is not None and table.flux is not None:
        raise SceneError(f"{at}.flux", "flux takes the place of velocity, and both are given", None, "Keep one.")


@_check_table.register(WallTable)
def _check_wall_table(table: WallTable, at: str) -> None:
    if table.centre is not None and table.angular_velocity is None:
        raise SceneError(f"{at}.centre", "a centre is read only with an angular_velocity", None, "Leave it out.")


def _check_sliding(domain: Domain, table: WallTable, place: Place) -> None:
    """Refuse a wall whose velocity leads out of itself somewhere."""
    velocity = wall_velocity(table, domain.dimension)
    if velocity is None:
        return
    shape = place.piece.shape
    points = points_of(shape, domain)
    moving, normal = velocity(points), shape.normal(points)
    across = np.sum(moving * normal, axis=1)
    worst = int(np.argmax(np.abs(across)))
    allowed = ACROSS if shape.plane is not None else ACROSS_CURVED
    if abs(across[worst]) > allowed * float(np.linalg.norm(moving, axis=1).max()):
        key = "velocity" if table.angular_velocity is None else "angular_velocity"
        remedy = "Set type = 'velocity', or let it move along itself"
        if shape.plane is not None and table.angular_velocity is None:
            along = (moving[worst] - across[worst] * normal[worst]).tolist()
            remedy = f"Keep what is along it, {along}, or set type = 'velocity'"
        found = f"{list(getattr(table, key))}, of which {across[worst]:.6g} across the wall {place.piece.name!r}"
        raise SceneError(f"{place.at}.{key}", found, "a velocity along the wall", f"{remedy}.")


def _check_values(scene: Scene, domain: Domain, table: BoundaryTable, place: Place) -> None:
    """Refuse expressions and profiles that cannot be, and values that are not finite where they are sampled."""
    value = boundary_value(table, place)
    if value is None:
        return
    points, _ = quadrature(place.piece, domain)
    for time in sample_times(scene, steady=value.is_steady):
        value(time, points)


def _check_names(scene: Scene, domain: Domain) -> None:
    names, wholes = [body.name for body in scene.body], [table.name for table in scene.mechanism]
    single = sum(body.part_of not in wholes for body in scene.body)
    for name, count in Counter([*names, *wholes, *domain.names]).items():
        if count > 1:
            last = len(names) - 1 - names[::-1].index(name) if name in names else single
            field = f"body.{last}.name" if last < single else "mechanism.name"
            raise SceneError(field, repr(name), "a name that no other body or surface has", "Rename it.")
