"""The fluid of a model, or none: one object that is always there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator

from rigidfluid.core.fluid.conditions import BoundaryCondition, Value
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Material
from rigidfluid.core.geometry.given_function import guarded_function
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.model.types import Film
from rigidfluid.core.scene.mesh_tables import MeshTable
from rigidfluid.core.setup.checked import AnyRow, NotNegative, Positive, checked
from rigidfluid.core.setup.scalar import Scalar
from rigidfluid.errors import SceneError
from rigidfluid.registry import FLUID_BACKEND, Registry

_SAMPLES = 17
"""Points along each axis where the speed of the flow at the start is looked at."""


def installed_backend(name: str) -> Selected[FluidBackend]:
    """The backend of this name, with the options that it has by default."""
    part = Registry.load().get(FLUID_BACKEND, name)
    return Selected(part, part.Options())


def _guarded_as(field: str) -> AfterValidator:
    """Guards what is a function, given for a key."""
    return AfterValidator(lambda value: guarded_function(value, field) if callable(value) else value)


@checked
class Fluid:
    """A fluid around the bodies: ρ(∂u/∂t + (u·∇)u) = ∇·σ + f, ∇·u = 0.

    Parameters
    ----------
    density : float
        ρ [mass/length^d].
    material : Material
        Its viscosity μ: `Newtonian`, or another that its backend solves for.
    mesh : MeshTable
        How fine its mesh is, and when it is regenerated.
    inertia : bool
        Whether the left side is there; without it the flow is a creeping one, by the Stokes equations.
    source : callable, optional
        Force f on the fluid alone, ``source(time, points)`` (N, d) [force/volume].
    initial : str or callable
        Flow at the start: at `rest` but for what bodies set in motion, `steady`, or ``initial(0, points)`` (N, d)
        [length/time].
    size_fields : sequence of SizeField
        Objects that say how fine cells are, by place and flow.
    backend : Selected
        Class that solves its equations, and its options; `scikit-fem` if not given.
    scalar : Scalar, optional
        What it carries along, as temperature; nothing if not given.
    """

    density: Positive
    material: Material
    mesh: MeshTable
    inertia: bool = True
    source: Annotated[Value | None, _guarded_as("fluid.force")] = None
    initial: Annotated[Literal["rest", "steady"] | Value, _guarded_as("fluid.initial")] = "rest"
    size_fields: Annotated[tuple[SizeField, ...], AnyRow] = ()
    backend: Selected[FluidBackend] = field(default_factory=lambda: installed_backend("scikit-fem"))
    scalar: Scalar | None = None

    @property
    def estimates_errors(self) -> bool:
        """Tell whether errors of cells are wanted."""
        return self.mesh.estimate or self.mesh.accuracy is not None

    @property
    def insertion(self) -> MeshTable:
        """The mesh that bodies can be inserted into."""
        return self.mesh

    @property
    def inert_density(self) -> float:
        """Density of the fluid that bodies have to move with them."""
        return self.density if self.inertia else 0.0

    def fastest_at_start(self, domain: Domain) -> float:
        """Greatest speed in the domain of a flow at the start that is a function, at the points sampled, else 0
        [length/time]."""
        if isinstance(self.initial, str):
            return 0.0
        axes = [np.linspace(low, high, _SAMPLES) for low, high in zip(*domain.extent, strict=True)]
        grid = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
        inside = grid[domain.contains(grid)]
        velocity = np.asarray(self.initial(0.0, inside))
        if velocity.shape != inside.shape or not np.isfinite(velocity).all():
            found, allowed = f"velocities of shape {velocity.shape}", f"finite ones of shape {inside.shape}"
            raise SceneError("fluid.initial", found, allowed, "Correct the function.")
        return float(np.linalg.norm(velocity, axis=1).max(initial=0.0))

    def film(self, bodies: Sequence[Body]) -> Film:
        """Films in gaps, as far as the mesh resolves them."""
        radius = np.array([equal_volume_radius(body) for body in bodies])
        return Film(self.material, radius, self.mesh.size_body / 2**self.mesh.refinements, self.inertia)

    def problem(self, conditions: tuple[BoundaryCondition, ...], motions: Motions, domain: Domain) -> FluidProblem:
        """Equations with conditions on the boundary of a ``domain``, around bodies that ``motions`` carry."""
        images = (each.in_each_image(domain.wrapped) for each in conditions)
        return FluidProblem(
            dimension=domain.dimension,
            bodies=len(motions.carrier),
            density=self.density,
            material=self.material,
            inertia=self.inertia,
            conditions=tuple(images) if domain.periodic else conditions,
            source=None if self.source is None else _in_each_image(self.source, domain),
            carrier=tuple(motions.carrier.tolist()),
            initial=self.initial if isinstance(self.initial, str) else _in_each_image(self.initial, domain),
        )


def _in_each_image(value: Value, domain: Domain) -> Value:
    """The ``value`` in a domain, the same in its images between periodic surfaces, where a mesh may go on."""
    if not domain.periodic:
        return value
    return lambda time, points: value(time, domain.wrapped(points))


@checked
class NoFluid:
    """No fluid that moves: bodies in a vacuum, or in a medium that bears them up by its density.

    Parameters
    ----------
    density : float
        Density of what bodies displace [mass/length^d].
    backend : Selected
        Class that moves bodies without a fluid, and its options; `dry` if not given.
    insertion : MeshTable, optional
        The mesh that bodies can be inserted into; a run has none.
    size_fields : sequence of SizeField
        Objects that say how fine the cells of that mesh are.
    """

    density: NotNegative = 0.0
    backend: Selected[FluidBackend] = field(default_factory=lambda: installed_backend("dry"))

    insertion: MeshTable | None = None
    size_fields: Annotated[tuple[SizeField, ...], AnyRow] = ()

    mesh: ClassVar[None] = None
    inertia: ClassVar[bool] = False
    estimates_errors: ClassVar[bool] = False
    inert_density: ClassVar[float] = 0.0
    scalar: ClassVar[None] = None

    def fastest_at_start(self, domain: Domain) -> float:
        """Zero [length/time]."""
        return 0.0

    def film(self, bodies: Sequence[Body]) -> None:
        """None: there are no films."""

    def problem(self, conditions: tuple[BoundaryCondition, ...], motions: Motions, domain: Domain) -> None:
        """None: there are no equations."""
