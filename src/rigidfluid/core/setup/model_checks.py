"""Refuses models whose objects are valid one by one but not together: doubled names, contradictions."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.nested.placing import check_orientation
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.along_strokes import refuse_overlap_along
from rigidfluid.core.setup.boundary_checks import check_boundary, check_inflow, check_oblique, check_periodic
from rigidfluid.core.setup.contact_laws import check_laws
from rigidfluid.core.setup.fluid import Fluid, NoFluid
from rigidfluid.core.setup.joint_checks import check_joints
from rigidfluid.core.setup.mechanism_checks import refuse_invalid
from rigidfluid.core.setup.mesh_checks import check_cells, check_inserter, check_mesh_table
from rigidfluid.core.setup.pair_forces import check_pair_forces
from rigidfluid.core.setup.placed_bodies import check_names, doubled
from rigidfluid.core.setup.quick_strokes import refuse_quick_mechanisms
from rigidfluid.core.setup.scalar import check_scalar
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.joints.joint import Joint
    from rigidfluid.core.model.body import Body
    from rigidfluid.core.model.mechanism import Mechanism
    from rigidfluid.core.scene.mesh_tables import MeshTable
    from rigidfluid.core.setup.model import Model
    from rigidfluid.core.setup.rigid_body import PlacedMechanism, RigidBody, Start

MOST_STEPS = 10**9
"""A scene of more nominal steps than this is a slip of units."""


def check_model(model: Model) -> None:
    """Refuse, with SceneError, a model that contradicts itself, or that its objects cannot run."""
    if not (model.bodies or model.mechanisms or isinstance(model.fluid, Fluid)):
        allowed = "a body or a mechanism, unless there is a fluid with a mesh"
        raise SceneError("body", "nothing", allowed, "Add a table [[body]] or [[mechanism]].")
    with all_told() as ask:
        for number, placed in enumerate(model.mechanisms):
            ask(_check_mechanism, model, placed, number)
        for number, body in enumerate(model.bodies):
            ask(_check_body, body, model.dimension, f"body.{number}")
    with all_told() as ask:
        for question in _QUESTIONS:
            ask(question, model)


def _check_mechanism(model: Model, placed: PlacedMechanism, number: int) -> None:
    at = f"mechanism.{number}"
    _check_dimension(placed.mechanism, model.dimension, at)
    refuse_invalid(placed.mechanism, at)
    if placed.name in [other.name for other in model.mechanisms[:number]]:
        raise doubled(f"{at}.name", placed.name)
    check_vectors(placed, model.dimension, at)


def _check_body(body: RigidBody, dimension: int, at: str) -> None:
    _check_dimension(body.shape, dimension, at)
    check_vectors(body, dimension, at)
    _check_control(body, at)


def _check_strokes(model: Model) -> None:
    refuse_quick_mechanisms(model.mechanisms_by_name, model.time)
    refuse_overlap_along(model.mechanisms_by_name, model.time.end, model.exact_detector)


def _check_around(model: Model) -> None:
    """Refuse a fluid, or none, and conditions on the domain's surfaces, each of which reads what the one before it has
    found valid."""
    check_boundary(model)
    check_periodic(model)
    if isinstance(model.fluid, Fluid):
        _check_fluid(model, model.fluid)
    else:
        _check_without_fluid(model)


def _check_fluid(model: Model, fluid: Fluid) -> None:
    _check_backend(fluid, wet=True)
    _check_material(fluid)
    _check_source(model, fluid)
    if fluid.initial != "rest" and not fluid.backend.part.initial_flows:
        allowed = f"'rest' with backend {fluid.backend.part.name!r}"
        raise SceneError("fluid.initial", fluid.initial, allowed, "Leave it out, or choose backend = 'scikit-fem'.")
    fluid.fastest_at_start(model.domain)  # says where it is not finite
    check_scalar(model, fluid)
    _check_mesh(model, fluid.mesh)
    check_inserter(fluid.mesh, model.shapes, model.domain)
    check_oblique(model)
    check_inflow(model)


def _check_material(fluid: Fluid) -> None:
    backend, viscosity = fluid.backend.part, fluid.material.dynamic_viscosity
    if not 0.0 < viscosity < np.inf:
        raise SceneError("fluid.viscosity", repr(viscosity), "a finite number above 0", "Correct it.")
    if not isinstance(fluid.material, backend.materials):
        found = f"{type(fluid.material).__name__} with backend {backend.name!r}"
        allowed = ", ".join(material.__name__ for material in backend.materials)
        raise SceneError("fluid.material", found, allowed, "Choose backend = 'scikit-fem', or one of these.")


def _check_source(model: Model, fluid: Fluid) -> None:
    """Refuse a force on the fluid that is none, at two corners of the domain."""
    if fluid.source is not None:
        corners = np.array(model.domain.extent)
        force = np.asarray(fluid.source(0.0, corners))
        if force.shape != corners.shape or not np.isfinite(force).all():
            found = f"forces of shape {force.shape} at {len(corners)} points"
            raise SceneError("fluid.force", found, f"finite forces of shape {corners.shape}", "Correct the function.")


def _check_mesh(model: Model, mesh: MeshTable) -> None:
    """Refuse a mesh that contradicts itself or what is around it, also one that bodies are but inserted into."""
    if mesh.field and not model.fluid.size_fields:
        found, allowed = f"{len(mesh.field)} tables, of which nothing is made", "none with `size_fields` of the fluid"
        raise SceneError("mesh.field", found, allowed, "Give the fields as objects there.")
    check_mesh_table(mesh, model.time)
    check_cells(mesh, model.domain)


def _check_backend(fluid: Fluid | NoFluid, *, wet: bool) -> None:
    backend = fluid.backend.part
    if backend.wet != wet:
        found = f"{backend.name!r}, which is for models {'without' if wet else 'with'} a fluid"
        raise SceneError("fluid.backend", found, f"one for {type(fluid).__name__}", "Choose another backend.")


def _check_dimension(part: Body | Mechanism | Joint, dimension: int, at: str) -> None:
    if part.dimension != dimension:
        found = f"{type(part).__name__} in {part.dimension}D"
        raise SceneError(at, found, f"one in {dimension}D, as the domain is", "Make it with that dimension.")


def _check_stepping(model: Model) -> None:
    if model.stepping.implicit and model.stepping.substeps is not None:
        allowed = 'none together with `stepping = "implicit"`'
        raise SceneError("contact.substeps", model.stepping.substeps, allowed, "Remove one of them.")


def _check_gravity(model: Model) -> None:
    if model.gravity is not None and len(model.gravity) != model.dimension:
        raise SceneError("fluid.gravity", f"{model.gravity}", f"{model.dimension} numbers", "Correct it.")


def _check_without_fluid(model: Model) -> None:
    _check_backend(model.fluid, wet=False)
    if detection_by(model.detection[0].part).on_mesh:
        remedy = 'Use detector = "auto", or a backend with a mesh.'
        found = f"{model.detection[0].part.name!r} without a mesh"
        raise SceneError("contact.detector", found, "a detector that needs none", remedy)
    if model.time.tolerance is not None:
        backend = model.fluid.backend.part.name
        allowed = f"none with backend {backend!r}, whose bodies go through contacts in substeps of their own"
        raise SceneError("time.tolerance", model.time.tolerance, allowed, "Remove it.")
    if model.fluid.insertion is not None:
        _check_mesh(model, model.fluid.insertion)


def check_vectors(placed: Start, dimension: int, at: str) -> None:
    """Refuse, with SceneError, a place and velocities that the ``dimension`` does not have."""
    turns = 1 if dimension == 2 else 3
    lengths = {"position": dimension, "velocity": dimension, "angular_velocity": turns}
    for name, length in lengths.items():
        vector = getattr(placed, name)
        if vector is not None and len(vector) != length:
            raise SceneError(f"{at}.{name}", f"{vector}", f"{length} numbers", "Correct it.")
    check_orientation(placed, dimension, at)


def _check_probes(model: Model) -> None:
    probes = model.output.probes
    outside = ~model.domain.contains(np.array(probes, dtype=float).reshape(-1, model.dimension))
    if outside.any():
        i = int(np.argmax(outside))
        raise SceneError(f"output.probes.{i}", list(probes[i]), "a point of the domain", "Move it inside.")


def _check_stresslets(model: Model) -> None:
    if model.output.stresslets:
        _require("stresslets", model, "output.stresslets", "true", "a backend that gives stresslets")


def _check_walls(model: Model) -> None:
    if model.output.walls:
        _require("boundary_forces", model, "output.walls", "true", "a backend that gives forces on surfaces")


def _check_estimate(model: Model) -> None:
    if model.fluid.estimates_errors:
        mesh = model.fluid.mesh
        field = "mesh.estimate" if mesh is None or mesh.accuracy is None else "mesh.accuracy"
        _require("cell_errors", model, field, "an estimate of errors", "a backend that gives errors of cells")


def _check_goal(model: Model) -> None:
    if not isinstance(model.fluid, Fluid) or model.fluid.mesh.goal == "flow":
        return
    found = repr(model.fluid.mesh.goal)
    if model.fluid.mesh.accuracy is None:
        raise SceneError("mesh.goal", f"{found} without `accuracy`", "it beside an accuracy", "Add accuracy = 0.01.")
    if not model.bodies:
        raise SceneError("mesh.goal", f"{found} without a body", "it beside bodies", "Let the goal be 'flow'.")
    _require("duals", model, "mesh.goal", found, "a backend that gives errors of forces")
    material = model.fluid.material
    if not isinstance(material, Newtonian):
        found = f"{found} with material {material.name!r}"
        raise SceneError("mesh.goal", found, "a viscosity that does not vary", "Let the goal be 'flow'.")


def _check_error_bars(model: Model) -> None:
    if model.output.error_bars:
        _require("refinements", model, "output.error_bars", "true", "a backend that compares meshes")


def _require(capability: str, model: Model, field: str, found: str, allowed: str) -> None:
    """Raise SceneError for the ``found`` value of a ``field`` if the backend lacks a ``capability``."""
    backend = model.fluid.backend.part
    if not getattr(backend, capability):
        remedy = "Use backend = 'scikit-fem', or leave it out."
        raise SceneError(field, f"{found} with backend {backend.name!r}", allowed, remedy)


def _check_sensitivities(model: Model) -> None:
    """Refuse what no derivatives are known for."""
    wanted, found = model.output.sensitivities, _without_derivatives(model)
    if wanted and found:
        remedy = "Differentiate by runs with two values, or leave it out."
        raise SceneError("output.sensitivities", found, "a scene with derivatives", remedy)


def _without_derivatives(model: Model) -> str | None:
    """The first thing that no derivatives are known for, None where a model has none."""
    backend, wet = model.fluid.backend.part, model.wet
    held_flux = any(condition.held_flux is not None for condition in model.conditions)
    found = {
        f"backend {backend.name!r}": wet and not backend.tangents,
        "a transported scalar": model.fluid.scalar,
        "a flux that is held": held_flux,
        "a window": model.window,
        "a source or a sink": model.source_tables or model.sink_tables,
    }
    return next((name for name, is_there in found.items() if is_there), None)


def _check_control(body: RigidBody, at: str) -> None:
    """A body moves freely, is fixed, or follows a prescription: one of them."""
    given = [key for key in ("velocity", "angular_velocity") if getattr(body, key) is not None]
    if body.fixed and (given or body.prescribed):
        other = given[0] if given else "prescribed"
        raise SceneError(f"{at}.fixed", f"true together with {other!r}", "one of them", f"Remove `fixed` or {other!r}.")
    if body.prescribed and given:
        where = f"`{at}.prescribed`"
        statement = "a body with `prescribed` has its velocities there"
        raise SceneError(f"{at}.{given[0]}", statement, None, f"Move it into {where}.")
    if body.prescribed and (body.prescribed.amplitude is None) != (body.prescribed.frequency is None):
        missing = "amplitude" if body.prescribed.amplitude is None else "frequency"
        field = f"{at}.prescribed.{missing}"
        raise SceneError(field, "nothing", "amplitude and frequency together, or neither", f"Add {missing!r}.")


def _check_assemblies(model: Model) -> None:
    """A name that only one body gives is a slip of the pen."""
    wholes = [body.part_of for body in model.bodies]
    for number, whole in enumerate(wholes):
        if whole is not None and wholes.count(whole) == 1:
            others = sorted({name for name in wholes if name is not None and name != whole})
            remedy = suggestion(whole, others) or "Give it to the other parts too, or remove it."
            raise SceneError(f"body.{number}.part_of", repr(whole), "a name that at least two bodies give", remedy)


def _check_times(model: Model) -> None:
    time = model.time
    if time.step > time.end:
        raise SceneError("time.step", time.step, f"at most time.end = {time.end}", "Shorten it, or end later.")
    if time.end / time.step > MOST_STEPS:
        raise SceneError("time.step", time.step, f"at least {time.end / MOST_STEPS:g} for this end", "Lengthen it.")
    if model.output.every < time.step:
        raise SceneError("output.every", model.output.every, f"at least time.step = {time.step}", "Write less often.")
    if time.shortest > time.step:
        raise SceneError("time.shortest", time.shortest, f"at most time.step = {time.step}", "Shorten it.")
    for body in model.bodies:
        _check_frequency(body, time.step)


def _check_frequency(body: RigidBody, step: float) -> None:
    """Longer steps could go more than all of the way to and fro, and not meet it."""
    frequency = abs(body.prescribed.frequency or 0.0) if body.prescribed else 0.0
    if pi * frequency * step > 1.0:
        found = f"{step:g}, {frequency * step:.3g} periods of body {body.name!r}"
        raise SceneError("time.step", found, f"at most {1.0 / (pi * frequency):.3g}", "Shorten it.")


_QUESTIONS: tuple[Callable[[Model], None], ...] = (
    _check_gravity,
    _check_stepping,
    _check_assemblies,
    _check_times,
    check_names,
    check_joints,
    _check_strokes,
    _check_around,
    _check_probes,
    _check_stresslets,
    _check_walls,
    _check_estimate,
    _check_goal,
    _check_sensitivities,
    _check_error_bars,
    check_laws,
    check_pair_forces,
)
"""Questions that do not depend on each other, of a model whose bodies are valid one by one."""
