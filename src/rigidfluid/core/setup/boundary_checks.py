"""Refuses conditions that the domain's surfaces do not have, or cannot have."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.nested.rows import check_rows
from rigidfluid.core.setup.boundary import boundary_table, table_key
from rigidfluid.core.setup.boundary_samples import points_of, quadrature, sample_times, sampled_inflows
from rigidfluid.core.setup.boundary_values import (
    BoundaryPressure,
    BoundaryVelocity,
    prescribed_pressure,
    prescribed_velocity,
    pressure_drop,
    wall_velocity,
)
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.interfaces import FluidBackend
    from rigidfluid.core.model.piece import Piece
    from rigidfluid.core.scene.scene import BoundaryTable, Scene

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
        _check_table(domain, table, f"boundary.{number}")
        if isinstance(table.over_time, tuple):
            check_rows(table.over_time, scene.time.end, f"boundary.{number}.over_time")
    for piece in domain.pieces:
        held = boundary_table(scene, piece.name)
        if held is not None:
            _check_sliding(domain, piece, held, table_key(scene, held))
            _check_values(scene, domain, piece, held, table_key(scene, held))
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
    tables = [boundary_table(scene, name) for name in domain.names]
    if any(table is not None and table.type == "pressure" for table in tables):
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
    for piece in domain.pieces:
        table, plane = boundary_table(scene, piece.name), piece.shape.plane
        if table is None or table.type not in ("slip", "pressure") or backend.oblique_faces:
            continue
        if plane is None or plane.axis is None:
            found = f"{table.type!r} on {piece.name!r}, which does not lie across an axis"
            allowed = f"'wall' or 'velocity' there with backend {backend.name!r}"
            raise SceneError(f"{table_key(scene, table)}.type", found, allowed, "Use backend = 'scikit-fem'.")


def _check_table(domain: Domain, table: BoundaryTable, at: str) -> None:
    allowed = ("all", *domain.names)
    if table.on not in allowed:
        raise SceneError(f"{at}.on", repr(table.on), ", ".join(allowed), "Name a surface of the domain.")
    if table.pressure_drop is not None and table.type != "periodic":
        statement = f"pressure_drop is valid only with type = 'periodic', not {table.type!r}"
        raise SceneError(f"{at}.pressure_drop", statement, None, "Leave it out.")
    for key, types in (("velocity", ("velocity", "wall")), ("pressure", ("pressure",))):
        given = getattr(table, key) is not None
        if given and table.type not in types:
            statement = f"{key} is valid only with type = {key!r}, not {table.type!r}"
            raise SceneError(f"{at}.{key}", statement, None, "Keep one.")
        if table.type == key and not given and table.flux is None:
            raise SceneError(f"{at}.{key}", "nothing", f"a value with type = {key!r}", f"Add {key!r}.")
    if table.flux is not None and (table.type != "velocity" or table.velocity is not None):
        statement = f"flux is valid only with type = 'velocity', not {table.type!r}"
        if table.velocity is not None:
            statement = "flux takes the place of velocity, and both are given"
        raise SceneError(f"{at}.flux", statement, None, "Keep one.")
    if table.profile != "uniform" and table.type != "velocity":
        statement = f"a profile is valid only with type = 'velocity', not {table.type!r}"
        raise SceneError(f"{at}.profile", statement, None, "Leave it out.")
    for key in ("over_time", "ramp"):
        if getattr(table, key) is not None and table.type not in ("velocity", "pressure"):
            statement = f"{key} is valid only with type = 'velocity' or 'pressure', not {table.type!r}"
            raise SceneError(f"{at}.{key}", statement, None, "Leave it out.")
    if table.angular_velocity is not None and table.type != "wall":
        statement = f"angular_velocity is valid only with type = 'wall', not {table.type!r}"
        remedy = "Give the velocity as expressions of x, y, z instead."
        raise SceneError(f"{at}.angular_velocity", statement, None, remedy)
    if table.centre is not None and table.angular_velocity is None:
        raise SceneError(f"{at}.centre", "a centre is read only with an angular_velocity", None, "Leave it out.")
    if table.type == "wall" and any(isinstance(component, str) for component in table.velocity or ()):
        remedy = "Give numbers, or set type = 'velocity'."
        raise SceneError(
            f"{at}.velocity", list(table.velocity or ()), "numbers on a 'wall', which slides evenly", remedy
        )


def _check_sliding(domain: Domain, piece: Piece, table: BoundaryTable, at: str) -> None:
    """Refuse a wall whose velocity leads out of itself somewhere."""
    velocity = wall_velocity(table, domain.dimension) if table.type == "wall" else None
    if velocity is None:
        return
    points = points_of(piece.shape, domain)
    moving, normal = velocity(points), piece.shape.normal(points)
    across = np.sum(moving * normal, axis=1)
    worst = int(np.argmax(np.abs(across)))
    allowed = ACROSS if piece.shape.plane is not None else ACROSS_CURVED
    if abs(across[worst]) > allowed * float(np.linalg.norm(moving, axis=1).max()):
        key = "velocity" if table.angular_velocity is None else "angular_velocity"
        remedy = "Set type = 'velocity', or let it move along itself"
        if piece.shape.plane is not None and table.angular_velocity is None:
            along = (moving[worst] - across[worst] * normal[worst]).tolist()
            remedy = f"Keep what is along it, {along}, or set type = 'velocity'"
        found = f"{list(getattr(table, key))}, of which {across[worst]:.6g} across the wall {piece.name!r}"
        raise SceneError(f"{at}.{key}", found, "a velocity along the wall", f"{remedy}.")


def _check_values(scene: Scene, domain: Domain, piece: Piece, table: BoundaryTable, at: str) -> None:
    """Refuse expressions and profiles that cannot be, and values that are not finite where they are sampled."""
    value: BoundaryVelocity | BoundaryPressure
    if table.type == "velocity":
        value = prescribed_velocity(piece, table, at)
    elif table.type == "pressure":
        value = prescribed_pressure(piece, table, scene.dimension, at)
    elif table.pressure_drop is not None:
        value = pressure_drop(table, scene.dimension, at)
    else:
        return
    points, _ = quadrature(piece, domain)
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
