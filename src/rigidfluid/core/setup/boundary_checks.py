"""Refuses conditions that the domain's surfaces do not have, or cannot have."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.setup.boundary import boundary_table, table_key
from rigidfluid.core.setup.boundary_samples import quadrature, sample_times, sampled_inflows
from rigidfluid.core.setup.boundary_values import (
    BoundaryPressure,
    BoundaryVelocity,
    prescribed_pressure,
    prescribed_velocity,
)
from rigidfluid.core.setup.time_factor import check_rows
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.domain import Domain, Piece
    from rigidfluid.core.scene.scene import BoundaryTable, Scene

ACROSS = 1e-12
"""A wall may slide with so much of its speed across itself, by rounding [1]."""

ROUNDING, EXPRESSIONS = 1e-12, 1e-3
"""Net inflow over all flow through the boundary that is allowed for numbers, by rounding, and for expressions [1]."""


def check_boundary(scene: Scene, domain: Domain) -> None:
    """Refuse names that the domain does not know, and conditions that contradict themselves or a surface's shape.

    Parameters
    ----------
    scene : Scene
        Its tables ``boundary``, its bodies' names and its probes.
    domain : Domain
        The domain that it names.

    Raises
    ------
    SceneError
        At the first contradiction.
    """
    for number, table in enumerate(scene.boundary):
        _check_table(domain, table, f"boundary.{number}")
        if isinstance(table.over_time, tuple):
            check_rows(table.over_time, scene.time.end, f"boundary.{number}.over_time")
    for piece in domain.pieces:
        held = boundary_table(scene, piece.name)
        if held is not None:
            _check_shape(piece, held, table_key(scene, held))
            _check_values(scene, piece, held, table_key(scene, held))
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


def _check_table(domain: Domain, table: BoundaryTable, at: str) -> None:
    allowed = ("all", *domain.names)
    if table.on not in allowed:
        raise SceneError(f"{at}.on", repr(table.on), ", ".join(allowed), "Name a surface of the domain.")
    for key, types in (("velocity", ("velocity", "wall")), ("pressure", ("pressure",))):
        given = getattr(table, key) is not None
        if given and table.type not in types:
            raise SceneError(f"{at}.{key}", f"it on a {table.type!r} surface", f"it with type = {key!r}", "Keep one.")
        if table.type == key and not given:
            raise SceneError(f"{at}.{key}", "nothing", f"a value with type = {key!r}", f"Add {key!r}.")
    if table.profile != "uniform" and table.type != "velocity":
        found = f"{table.profile!r} on a {table.type!r} surface"
        raise SceneError(f"{at}.profile", found, "it with type = 'velocity'", "Leave it out.")
    for key in ("over_time", "ramp"):
        if getattr(table, key) is not None and table.type not in ("velocity", "pressure"):
            found = f"it on a {table.type!r} surface"
            raise SceneError(f"{at}.{key}", found, "it with type = 'velocity' or 'pressure'", "Leave it out.")
    if table.type == "wall" and any(isinstance(component, str) for component in table.velocity or ()):
        remedy = "Give numbers, or set type = 'velocity'."
        raise SceneError(
            f"{at}.velocity", list(table.velocity or ()), "numbers on a 'wall', which slides evenly", remedy
        )


def _check_shape(piece: Piece, table: BoundaryTable, at: str) -> None:
    plane = piece.shape.plane
    if table.type in ("slip", "pressure") and (plane is None or plane.axis is None):
        found = f"{table.type!r} on {piece.name!r}, which does not lie across an axis"
        raise SceneError(f"{at}.type", found, "'wall' there", "Make it a wall, or a flat surface across an axis.")
    if table.velocity is None:
        return
    if plane is None:
        found = f"{list(table.velocity)} on {piece.name!r}, which is not flat"
        raise SceneError(f"{at}.velocity", found, "none there", "Leave it out, or make the surface flat.")
    if table.type != "wall":
        return
    velocity = np.array(table.velocity, dtype=float)
    across = float(velocity @ plane.unit_normal)
    if abs(across) > ACROSS * float(np.linalg.norm(velocity)):
        along = (velocity - across * plane.unit_normal).tolist()
        found = f"{list(table.velocity)}, of which {across:.6g} across the wall {piece.name!r}"
        remedy = f"Keep what is along it, {along}, or set type = 'velocity'."
        raise SceneError(f"{at}.velocity", found, "a velocity along the wall", remedy)


def _check_values(scene: Scene, piece: Piece, table: BoundaryTable, at: str) -> None:
    """Refuse expressions and profiles that cannot be, and values that are not finite where they are sampled."""
    value: BoundaryVelocity | BoundaryPressure
    if table.type == "velocity":
        value = prescribed_velocity(piece, table, at)
    elif table.type == "pressure":
        value = prescribed_pressure(piece, table, scene.dimension, at)
    else:
        return
    points, _ = quadrature(piece)
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
