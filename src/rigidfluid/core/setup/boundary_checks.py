"""Refuses conditions that a surface of the domain, a backend or an incompressible fluid cannot have."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.fluid.conditions import Periodic, no_pressure
from rigidfluid.core.mechanics.wall_velocity import WallVelocity
from rigidfluid.core.setup.boundary_data import BoundaryData
from rigidfluid.core.setup.boundary_samples import points_of, quadrature, sample_times, sampled_inflows
from rigidfluid.core.setup.image_checks import check_crossed
from rigidfluid.core.setup.opposite import is_opposite
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.fluid.conditions import BoundaryCondition
    from rigidfluid.core.geometry.arrays import FloatArray
    from rigidfluid.core.geometry.piece import Piece
    from rigidfluid.core.setup.model import Model

ACROSS = 1e-12
"""Greatest velocity of a sliding flat wall across itself, over its speed, that counts as rounding [1]."""

ACROSS_CURVED = 1e-6
"""Greatest velocity of a sliding curved wall across itself, over its speed, that counts as rounding [1]; its normals
are differences of distances."""

ROUNDING, EXPRESSIONS = 1e-12, 1e-3
"""Net inflow over all flow through the boundary that is allowed for numbers, by rounding, and for expressions [1]."""


def check_boundary(model: Model) -> None:
    """Refuse, with SceneError, conditions for surfaces that there are not, walls that slide out of themselves, and
    values that are not there."""
    for name in model.boundary:
        if name not in model.domain.names:
            allowed = ", ".join(model.domain.names)
            raise SceneError(f"boundary {name!r}", "no surface of the domain", allowed, "Name one of these.")
    placed = list(zip(model.conditions, model.domain.pieces, strict=True))
    for condition, piece in placed:
        if condition.is_wall:
            _check_wall(model, condition, piece)
    for condition, piece in placed:
        if not condition.is_wall:
            _check_values(model, condition, piece)


def check_inflow(model: Model) -> None:
    """Raise SceneError where more flows in than out: an incompressible fluid needs a way out.

    Fluxes are integrated over surfaces whose shape is known, at many times; functions may be off by what a mesh makes
    of them, which the backend balances.
    """
    if any(condition.is_open for condition in model.conditions):
        return
    inflows = sampled_inflows(model.conditions, model.domain)
    times = sample_times(model.conditions, model.time.end, steady=all(inflow.velocity.is_steady for inflow in inflows))
    fluxes = [[inflow.flux(time) for inflow in inflows] for time in times]
    if not inflows or None in fluxes[0]:
        return
    flows = np.array(fluxes)
    passing = np.abs(flows).sum(axis=1)
    in_numbers = not any(inflow.velocity.value.names for inflow in inflows)
    allowed = ROUNDING * passing if in_numbers else EXPRESSIONS * np.max(passing)
    excess = np.abs(flows.sum(axis=1)) - allowed
    worst = int(np.argmax(excess))
    if excess[worst] > 0.0:
        when = "" if len(times) == 1 else f" at time {times[worst]:g}"
        raise SceneError(
            "boundary",
            f"a net inflow of {flows[worst].sum():.6g} [length^{model.dimension}/time]{when} and no outlet",
            "as much outflow as inflow, or a surface of type 'pressure'",
            "Give one surface type = 'pressure', pressure = 0.0.",
        )


def check_oblique(model: Model) -> None:
    """Raise SceneError where the backend is asked for slip or pressure on a surface that it cannot take them on."""
    backend = model.fluid.backend.part
    if backend.oblique_faces:
        return
    for condition in oblique_conditions(model):
        found = f"{condition.type!r} on {condition.name!r}, which does not lie across an axis"
        allowed = f"'wall' or 'velocity' there with backend {backend.name!r}"
        raise SceneError(f"{condition.field}.type", found, allowed, "Use backend = 'scikit-fem'.")


def check_periodic(model: Model) -> None:
    """Refuse, with SceneError, periodic surfaces together with a backend, window, domain or condition that cannot take
    them."""
    domain, backend = model.domain, model.fluid.backend.part
    _check_pairs(model)
    if not domain.periodic:
        return
    at = f"{model.conditions[domain.periodic[0][0]].field}.type"
    if not backend.periodic_faces:
        found = f"'periodic' with backend {backend.name!r}"
        raise SceneError(at, found, "a backend that takes periodic surfaces", "Use backend = 'scikit-fem'.")
    held = [condition for condition in model.conditions if condition.held_flux is not None]
    if held and not backend.held_fluxes:
        found = f"a flux through a periodic surface with backend {backend.name!r}"
        remedy = "Use backend = 'scikit-fem', or give pressure_drop."
        raise SceneError(f"{held[0].field}.flux", found, "a backend that finds the drop of pressure", remedy)
    if model.window is not None:
        raise SceneError(at, "'periodic' with a window", "one of both", "Remove [domain.window].")
    if domain.facets is not None:
        found = f"'periodic' in a domain of type {domain.name!r}, which is made of facets"
        raise SceneError(at, found, "a domain with a CAD shape, as 'box'", "Choose another type.")
    for other in oblique_conditions(model):
        found = f"'periodic' together with {other.type!r} on {other.name!r}, which does not lie across an axis"
        raise SceneError(at, found, "'wall' there", "Make it a wall, or do without periodic surfaces.")
    detector = model.detection[0].part
    if model.wet and detection_by(detector).on_mesh:
        found = f"{detector.name!r} with periodic surfaces, on whose mesh bodies may be images of themselves"
        raise SceneError("contact.detector", found, "a detector that needs no mesh", 'Use detector = "auto".')
    if not model.wet:
        _refuse_dry_drop(model)
        check_crossed(model, at)


def _refuse_dry_drop(model: Model) -> None:
    """Refuse a drop of pressure where there is no fluid."""
    for condition in model.conditions:
        if isinstance(condition, Periodic) and condition.drop is not no_pressure:
            found = f"a drop of pressure with backend {model.fluid.backend.part.name!r}"
            raise SceneError(f"{condition.field}.pressure_drop", found, "one in a fluid", "Leave it out.")


def _check_pairs(model: Model) -> None:
    """Refuse pairs of the domain that are no opposite pieces, or that have other conditions than periodic ones."""
    pieces, paired = model.domain.pieces, [number for pair in model.domain.periodic for number in pair]
    for first, second in model.domain.periodic:
        known = first in range(len(pieces)) and second in range(len(pieces)) and first != second
        if not (known and paired.count(first) == paired.count(second) == 1):
            allowed = f"two of the numbers 0 to {len(pieces) - 1}, each in one pair"
            raise SceneError(
                "domain.periodic", f"the pair {(first, second)}", allowed, "Correct the numbers of pieces."
            )
        if not is_opposite(model.domain, pieces[first], pieces[second]):
            names = f"{pieces[first].name!r} and {pieces[second].name!r}"
            allowed = "flat pieces that are equal and face each other"
            raise SceneError("domain.periodic", names, allowed, "Choose other pieces.")
    for number, condition in enumerate(model.conditions):
        if isinstance(condition, Periodic) != (number in paired):
            found = f"{condition.type!r} on {condition.name!r}, which is {'' if number in paired else 'not '}in a pair"
            remedy = "Give both of a pair `Periodic`, and the domain `with_periodic` pairs of numbers."
            raise SceneError(condition.field, found, "periodic conditions on pairs alone", remedy)
    for _, second in model.domain.periodic:
        condition = model.conditions[second]
        if isinstance(condition, Periodic) and (condition.drop is not no_pressure or condition.held_flux is not None):
            statement = (
                f"only the first of a pair can have a drop of pressure or a flux, and {condition.name!r} is the "
            )
            raise SceneError(condition.field, f"{statement}second", None, "Keep that of the first.")
    for first, _ in model.domain.periodic:
        condition = model.conditions[first]
        if isinstance(condition, Periodic) and condition.drop is not no_pressure and condition.held_flux is not None:
            statement = f"{condition.name!r} has a drop of pressure, and a flux for which it is to be found"
            raise SceneError(condition.field, statement, None, "Keep one.")


def oblique_conditions(model: Model) -> list[BoundaryCondition]:
    """Conditions that hold a part of the velocity on a surface that lies across no axis."""
    planes = [piece.shape.plane for piece in model.domain.pieces]
    across = [plane is not None and plane.axis is not None for plane in planes]
    return [each for each, along in zip(model.conditions, across, strict=True) if each.holds_part and not along]


def _check_wall(model: Model, condition: BoundaryCondition, piece: Piece) -> None:
    """Refuse a wall whose velocity is not that by which bodies meet it, or leads out of itself somewhere."""
    points = points_of(piece.shape, model.domain)
    if condition.sliding is None:
        _check_wall_velocity(model, condition, points, np.zeros_like(points))
        return
    moving = condition.sliding(points)
    _check_wall_velocity(model, condition, points, moving)
    shape, key, given = piece.shape, *_given(condition.sliding)
    normal = shape.normal(points)
    across = np.sum(moving * normal, axis=1)
    worst = int(np.argmax(np.abs(across)))
    allowed = ACROSS if shape.plane is not None else ACROSS_CURVED
    if abs(across[worst]) > allowed * float(np.linalg.norm(moving, axis=1).max()):
        remedy = "Set type = 'velocity', or let it move along itself"
        if shape.plane is not None and key == "velocity":
            along = (moving[worst] - across[worst] * normal[worst]).tolist()
            remedy = f"Keep what is along it, {along}, or set type = 'velocity'"
        found = f"{given}, of which {across[worst]:.6g} across the wall {piece.name!r}"
        raise SceneError(f"{condition.field}.{key}", found, "a velocity along the wall", f"{remedy}.")


def _check_wall_velocity(model: Model, condition: BoundaryCondition, points: FloatArray, slides: FloatArray) -> None:
    """Refuse a wall whose velocity at ``points`` (N, d) is not ``slides`` (N, d), by which bodies meet it."""
    for time in (0.0, 0.5 * model.time.end, model.time.end):
        if not np.array_equal(condition.velocity(time, points), slides):
            found = f"a wall {condition.name!r} with a velocity of its own at time {time:g}"
            allowed = "the velocity `sliding(points)`, by which bodies meet a wall, zero if None"
            remedy = "Give `NoSlip` a `sliding`, or take `PrescribedVelocity`, which is no wall."
            raise SceneError(condition.field, found, allowed, remedy)


def _given(sliding: object) -> tuple[str, object]:
    """Key of a wall's velocity in a scene, and what is given there."""
    if not isinstance(sliding, WallVelocity):
        return "sliding", "a velocity"
    key = "angular_velocity" if sliding.angular_velocity.any() else "velocity"
    return key, getattr(sliding, key).tolist()


def _check_values(model: Model, condition: BoundaryCondition, piece: Piece) -> None:
    """Refuse functions whose values, where they are sampled, are not finite or not of their shape."""
    points, _ = quadrature(piece, model.domain)
    steady = isinstance(condition.data, BoundaryData) and condition.data.is_steady
    for time in sample_times(model.conditions, model.time.end, steady=steady and condition.held_flux is None):
        if condition.held_flux is not None and not np.isfinite(condition.held_flux(float(time))):
            found = f"a flux of {condition.held_flux(float(time))} on {piece.name!r} at time {time:g}"
            raise SceneError(condition.field, found, "finite numbers", "Correct the function.")
        asked = {"velocities": condition.velocity, "pressures": condition.pressure}
        for what, shape in (("velocities", points.shape), ("pressures", points.shape[:1])):
            values = np.asarray(asked[what](float(time), points))
            if values.shape != shape or not np.isfinite(values).all():
                found = f"{what} of shape {values.shape} on {piece.name!r} at time {time:g}, or not finite"
                raise SceneError(condition.field, found, f"finite {what} of shape {shape}", "Correct the function.")
