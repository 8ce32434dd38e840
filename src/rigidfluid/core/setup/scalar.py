"""A scalar that the fluid of a model carries along, and how it becomes equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cache, partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.fluid.conduction import Conduction, Inside
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.scalar import NO_FLUX, Buoyancy, ScalarCondition, ScalarProblem, ScalarValue
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.given_function import guarded_function
from rigidfluid.core.mechanics.shapes import shape_key
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.checked import Number, Positive, checked
from rigidfluid.errors import MeshError, SceneError

if TYPE_CHECKING:
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.domain import Domain
    from rigidfluid.core.model.types import Mesh
    from rigidfluid.core.setup.fluid import Fluid
    from rigidfluid.core.setup.model import Model

_IN_THE_FLUID = "initial", "source"
"""Functions of a scalar that are evaluated anywhere in the fluid."""


@checked
class ScalarOnSurface:
    """The scalar on a surface: at most one of a value and a flux, and for bodies a capacity and a conductivity.

    Parameters
    ----------
    value : callable, optional
        ``value(time, points)`` (N,) that is held; of a body with a capacity the one at the start [scalar].
    flux : callable, optional
        ``flux(time, points)`` (N,) into the fluid [scalar·length/time].
    capacity : float, optional
        Heat capacity of a body over that of as much fluid: it has one value unless there is a conductivity [1].
    conductivity : float, optional
        Conductivity over the fluid's of a body with a capacity, which conducts inside [1].
    field : str
        Key of the scene's table that asks for it, for messages.
    """

    value: ScalarValue | None = None
    flux: ScalarValue | None = None
    capacity: Positive | None = None
    conductivity: Positive | None = None
    field: str = "scalar"


@checked
class Scalar:
    """A scalar that the fluid carries along: ∂T/∂t + ∇·(u T) = ∇·(κ∇T) + s.

    Parameters
    ----------
    diffusivity : float
        κ [length²/time].
    initial : callable
        ``initial(0, points)`` (N,) [scalar].
    source : callable, optional
        s, ``source(time, points)`` (N,) [scalar/time].
    expansion : float, optional
        β of Boussinesq's approximation; the flow does not feel the scalar if not given [1/scalar].
    reference : float
        Value without buoyancy [scalar].
    on_faces, on_bodies : mapping of str to ScalarOnSurface
        Conditions by the names of surfaces of the domain and of bodies; nothing goes through all others.
    """

    diffusivity: Positive
    initial: ScalarValue
    source: ScalarValue | None = None
    expansion: Number | None = None
    reference: Number = 0.0
    on_faces: Mapping[str, ScalarOnSurface] = field(default_factory=dict)
    on_bodies: Mapping[str, ScalarOnSurface] = field(default_factory=dict)


def with_scalar(problem: FluidProblem, scalar: Scalar, model: Model) -> FluidProblem:
    """The equations of a fluid with those of its scalar."""
    buoyancy = None
    if scalar.expansion is not None and model.gravity is not None:
        buoyancy = Buoyancy(scalar.expansion, scalar.reference, np.array(model.gravity, dtype=float))
    names = [body.name for body in model.all_bodies]
    insides: dict[tuple[str, str], Callable[[], Inside]] = {}
    on_bodies = [
        _on_body(scalar.on_bodies.get(name), shape, model, insides)
        for name, shape in zip(names, model.shapes, strict=True)
    ]
    on_faces = [_condition(scalar.on_faces.get(condition.name), model.domain) for condition in problem.conditions]
    conditions = (*on_bodies, *on_faces)
    initial, source = (_checked_value(getattr(scalar, key), f"scalar.{key}", model.domain) for key in _IN_THE_FLUID)
    assert initial is not None
    return replace(problem, scalar=ScalarProblem(scalar.diffusivity, initial, conditions, source, buoyancy))


def _condition(given: ScalarOnSurface | None, domain: Domain) -> ScalarCondition:
    if given is None:
        return NO_FLUX
    value, flux = (_checked_value(getattr(given, key), f"{given.field}.{key}", domain) for key in ("value", "flux"))
    return ScalarCondition(value, flux)


def _on_body(
    given: ScalarOnSurface | None, shape: Body, model: Model, insides: dict[tuple[str, str], Callable[[], Inside]]
) -> ScalarCondition:
    """The condition on a body of this ``shape``; ``insides`` by shape, to which its own is added."""
    condition = _condition(given, model.domain)
    if given is None or given.capacity is None:
        return condition
    capacity = given.capacity * shape.volume
    if given.conductivity is None:
        return replace(condition, capacity=capacity)
    inside = insides.setdefault(shape_key(shape), cache(partial(_inside, shape, model, given.field)))
    return replace(condition, conduction=Conduction(given.conductivity, capacity, inside))


def _inside(shape: Body, model: Model, at: str) -> Inside:
    """Cells inside a body, as large as those around it; raises MeshError."""
    from rigidfluid.core.mesh.generation.inside import inside_mesh  # few scenes have bodies that conduct

    table = model.fluid.mesh
    assert table is not None
    order = table.order if model.fluid.backend.part.curved_cells else 1
    sizes = Sizes(table.size, table.size_body, table.growth, order=order)
    try:
        mesh = inside_mesh(shape, sizes, table.mesher_timeout)
    except MeshError as error:
        remedy = "Leave it out, so that the body has one value, or change mesh.size_body."
        raise MeshError(f"{at}.conductivity", error.found, "a body that can be meshed inside", remedy) from error
    return cells_inside(mesh)


def cells_inside(mesh: Mesh) -> Inside:
    """The cells of a body's inside, and their curved edges, of a ``mesh`` of it."""
    curved = mesh.curved
    if curved is None:
        return Inside(mesh.points, mesh.cells, np.zeros((0, 2), dtype=np.int64), mesh.points[:0])
    return Inside(mesh.points, mesh.cells, curved.vertices, curved.middles)


def _checked_value(value: ScalarValue | None, at: str, domain: Domain) -> ScalarValue | None:
    return None if value is None else partial(_values, value, at, domain)


def _values(value: ScalarValue, at: str, domain: Domain, time: float, points: FloatArray) -> FloatArray:
    """Values (N,) at ``points`` (N, d) of a domain and of its images between periodic surfaces, where a mesh may go on;
    raises SceneError for others."""
    found = np.asarray(guarded_function(value, at)(time, domain.wrapped(points)))
    if found.shape != points.shape[:1] or not np.isfinite(found).all():
        told = f"values of shape {found.shape} at time {time:g}, or not finite"
        raise SceneError(at, told, f"finite ones of shape {points.shape[:1]}", "Correct the function.")
    return found


def check_scalar(model: Model, fluid: Fluid) -> None:
    """Refuse, with SceneError, a scalar that the model's backend, domain or bodies cannot have."""
    scalar = fluid.scalar
    if scalar is None:
        return
    with all_told() as ask:
        ask(_check_backend, model, fluid)
        ask(_check_buoyancy, model, fluid, scalar)
        ask(_check_faces, model, scalar)
        ask(_check_bodies, model, fluid, scalar)
        for key in _IN_THE_FLUID:
            ask(_check_function, model, f"scalar.{key}", getattr(scalar, key))


def _check_backend(model: Model, fluid: Fluid) -> None:
    if not fluid.backend.part.scalars:
        found = f"one with backend {fluid.backend.part.name!r}"
        raise SceneError("scalar", found, "a backend that solves for it", "Choose backend = 'scikit-fem'.")
    if model.window is not None:
        raise SceneError("scalar", "one with a window in the domain", None, "Leave out [domain.window].")


def _check_buoyancy(model: Model, fluid: Fluid, scalar: Scalar) -> None:
    if scalar.expansion is None:
        return
    if model.gravity is None:
        raise SceneError("scalar.expansion", scalar.expansion, "one with gravity", "Add fluid.gravity.")
    if fluid.initial == "steady":
        allowed = "'rest' or expressions with scalar.expansion"
        raise SceneError("fluid.initial", "'steady'", allowed, "Start at rest, and run until it is steady.")


def _check_faces(model: Model, scalar: Scalar) -> None:
    """Refuse conditions on no surface of the domain, and velocities that bring fluid in with nobody knows what."""
    for given, key in product(scalar.on_faces.values(), ("capacity", "conductivity")):
        if getattr(given, key) is not None:
            raise SceneError(f"{given.field}.{key}", getattr(given, key), "one of bodies alone", "Leave it out.")
    _check_surfaces(scalar.on_faces, [piece.name for piece in model.domain.pieces])
    for number in sorted(model.domain.periodic_pieces):
        name = model.domain.names[number]
        if name in scalar.on_faces:
            found, remedy = f"{name!r}, which is periodic", "Leave the table out: what leaves there comes in again."
            raise SceneError(f"{scalar.on_faces[name].field}.on", found, "a surface where the fluid ends", remedy)
    for condition in model.conditions:
        on_face = scalar.on_faces.get(condition.name)
        if on_face is None and condition.passes and condition.prescribes_normal:
            found = f"nothing on {condition.name!r}, which the fluid passes"
            allowed = "a value of what comes in, or flux = 0 of what goes out"
            raise SceneError("scalar.boundary", found, allowed, "Add a table [[scalar.boundary]].")


def _check_bodies(model: Model, fluid: Fluid, scalar: Scalar) -> None:
    names = [body.name for body in model.all_bodies]
    _check_surfaces(scalar.on_bodies, names)
    for name, shape in zip(names, model.shapes, strict=True):
        given = scalar.on_bodies.get(name)
        if given is not None and given.conductivity is not None:
            _check_inside(shape, fluid, given.field, given.conductivity)


def _check_inside(shape: Body, fluid: Fluid, at: str, conductivity: float) -> None:
    """Refuse a body that conducts where the backend does not solve for it, or no mesher can fill its inside."""
    from rigidfluid.core.mesh.generation.inside import can_be_filled

    if not fluid.backend.part.conduction:
        found = f"{conductivity:g} with backend {fluid.backend.part.name!r}"
        raise SceneError(
            f"{at}.conductivity", found, "a backend that solves inside bodies", "Choose backend = 'scikit-fem'."
        )
    if not can_be_filled(shape):
        found = f"{conductivity:g} of a body of type {shape.name!r}"
        remedy = "Leave it out, so that the body has one value."
        raise SceneError(f"{at}.conductivity", found, "a shape with facets or a CAD shape", remedy)


def _check_surfaces(given: Mapping[str, ScalarOnSurface], known: list[str]) -> None:
    """Refuse names that are not known, and conditions that contradict themselves."""
    for name, condition in given.items():
        at, others = condition.field, (condition.value, condition.capacity)
        if name not in known:
            raise SceneError(f"{at}.on", repr(name), ", ".join(known), suggestion(name, known) or "Correct the name.")
        if condition.flux is not None and any(other is not None for other in others):
            key = "value" if condition.value is not None else "capacity"
            raise SceneError(f"{at}.flux", f"a flux and a {key}", "one of them", "Keep one.")
        if condition.conductivity is not None and condition.capacity is None:
            found, remedy = f"{condition.conductivity:g} without a capacity", "Add the capacity, or leave it out."
            raise SceneError(f"{at}.conductivity", found, "one of a body with a capacity", remedy)
        if condition.flux is None and all(other is None for other in others):
            raise SceneError(f"{at}.value", "nothing", "a value or a flux", "Add one, or leave the table out.")


def _check_function(model: Model, at: str, value: ScalarValue | None) -> None:
    """Refuse a function that gives no numbers at two corners of the domain."""
    if value is not None:
        _values(value, at, model.domain, 0.0, np.array(model.domain.extent))
