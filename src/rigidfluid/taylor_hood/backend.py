"""A fluid backend of Taylor–Hood elements P2–P1, but for how its equations are assembled and solved."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np
from pydantic import Field

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.flow_error import ErrorRate, MeshVelocity, RefinedFlow, Refinement
from rigidfluid.core.model.fluid_backend import Filling, FluidBackend
from rigidfluid.core.model.latest import Latest
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Advance, Fields, FluidState, InsideFields, Mesh, Pose, Response, Step, Twist
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix
from rigidfluid.taylor_hood.system.discretisation import Discretisation

if TYPE_CHECKING:
    from rigidfluid.taylor_hood.elements.sampling import Samples
    from rigidfluid.taylor_hood.elements.scalar_assembly import ScalarAssembly
    from rigidfluid.taylor_hood.stepping.insides import Insides
    from rigidfluid.taylor_hood.stepping.scalar_step import ScalarEquations
    from rigidfluid.taylor_hood.system.dimensionless import Dimensionless

_PROVISIONAL = 1e-5
"""Relative residual of steps that will be solved again."""

_IMPULSE = 1e-10
"""Relative residual of an impulsive start: masses hide the rest in round-off, and the short step errs by more."""


class TaylorHoodOptions(PartOptions):
    """Keys of ``[fluid]`` that these backends read."""

    tolerance: float = Field(1e-9, ge=1e-13, lt=1, description="Relative residual of each step's linear system [1]")


class TaylorHoodBackend(FluidBackend):
    """ALE Navier–Stokes or Stokes on triangles or tetrahedra, bodies coupled monolithically.

    Each step solves

    ρ(d₀uⁿ⁺¹ + d₁uⁿ + d₂uⁿ⁻¹, v) + ρ(((u* - w)·∇)uⁿ⁺¹ + ½(∇·u*)uⁿ⁺¹, v) + μ(∇u + ∇uᵀ, ∇v) + (γ∇·u, ∇·v) - (p, ∇·v)
    = (f, v), (∇·u, q) = 0

    on the new mesh, with u* extrapolated and w the mesh velocity by the same derivative weights, for velocities that
    move rigidly with each body (Maury 1999, doi:10.1006/jcph.1999.6342), plus the bodies' own inertia.
    """

    Options: ClassVar[type[PartOptions]] = TaylorHoodOptions
    curved_cells: ClassVar[bool] = True
    initial_flows: ClassVar[bool] = True
    state_format: ClassVar[str | None] = "P2-P1"

    options: TaylorHoodOptions
    problem: FluidProblem

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        super().__init__(options, problem)
        self._numbering: Numbering | None = None
        self._latest: tuple[BoolArray, Dimensionless] | None = None
        self._latest_matrix = Latest[CoupledMatrix]()
        self._latest_attempt: tuple[FluidState, float, FluidState] | None = None
        self._insides: Insides | None = None

    @abstractmethod
    def discretise(self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray) -> Discretisation:
        """The equations on this topology with these motions ``prescribed`` (N,).

        The same ``numbering`` comes again for other motions and after ``forget``.
        """

    def discretise_steady(self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray) -> Discretisation:
        """The same for flows that do not change in time, in case another solver serves where nothing has inertia."""
        return self.discretise(numbering, mesh, prescribed)

    def scalar_assembly(self, numbering: Numbering) -> ScalarAssembly:
        """The integrals of a transported scalar on a topology; asked of backends with `scalars` alone."""
        raise NotImplementedError

    @abstractmethod
    def drop_factors(self) -> None:
        """Forget what the solutions of earlier systems have left behind."""

    @final
    def initial(self, mesh: Mesh, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
        from rigidfluid.taylor_hood.stepping.initial_flow import formula_flow, steady_flow
        from rigidfluid.taylor_hood.stepping.transfer import initial
        from rigidfluid.taylor_hood.system.discretisation import kinetic_energy

        start, pose = self.problem.initial, mesh.images_of(pose)
        target = self._steady_discretisation(mesh) if start == "steady" else self._projecting_discretisation(mesh)
        given = target, self.options.tolerance, mesh, pose, twist
        if start == "rest":
            made = initial(*given)
        else:
            flow = steady_flow(*given) if start == "steady" else formula_flow(*given)
            made = flow, kinetic_energy(target, mesh.geometry, flow["velocity"])
        self.drop_factors()
        return self._started(made[0], mesh, pose), made[1]

    @final
    def struck(self, mesh: Mesh, pose: Pose, twist: Twist, step: Step) -> tuple[FluidState, float, Twist]:
        from rigidfluid.taylor_hood.stepping.transfer import initial, struck

        given = self.options.tolerance, mesh, mesh.images_of(pose)
        motions = Twist(*np.split(step.prescribed_twist, [self.problem.dimension], axis=1))
        if not step.prescribed.all():
            fluid, _ = initial(self._projecting_discretisation(mesh), *given, twist)
            fluid = self._started(fluid, mesh, given[2])
            motions = self._advanced(fluid, mesh, step, max(self.options.tolerance, _IMPULSE)).twist
        bodies = step.kinematics.component_twist(motions)
        fluid, kinetic = struck(self._projecting_discretisation(mesh), *given, bodies)
        self.drop_factors()
        return self._started(fluid, mesh, given[2]), kinetic, motions

    @final
    def advance(self, fluid: FluidState, mesh: Mesh, step: Step) -> Advance:
        tolerance = max(self.options.tolerance, _PROVISIONAL if step.provisional else 0.0)
        advanced = self._advanced(fluid, mesh, step, tolerance)
        return advanced if self.problem.scalar is None else self._with_scalar_step(advanced, fluid, mesh, step)

    @final
    def response(self, fluid: FluidState, mesh: Mesh, step: Step, impulses: FloatArray) -> Response:
        from rigidfluid.taylor_hood.stepping.response import response

        discretisation = self._discretisation(mesh, step.prescribed)
        matrix = self._matrix(discretisation, fluid, mesh, step)
        return response(discretisation, matrix, on_mesh(step, mesh), impulses)

    @final
    def transfer(self, fluid: FluidState, old: Mesh, new: Mesh) -> tuple[FluidState, float]:
        from rigidfluid.taylor_hood.stepping.transfer import Flow, transfer
        from rigidfluid.taylor_hood.system.discretisation import kinetic_energy

        numbering, present = self.numbering_of(old), self._any_discretisation(old)
        scalar_before = None if self.problem.scalar is None else self._scalar_equations(old)
        before = kinetic_energy(present, old.geometry, fluid["velocity"])
        earlier = kinetic_energy(present, fluid["points_previous"], fluid["velocity_previous"])
        target = self._projecting_discretisation(new)
        self.drop_factors()
        flow = Flow(fluid, old, numbering, (before, earlier), present.surfaces.pressure_drops)
        moved = transfer(flow, target, self.options.tolerance, new)
        self.drop_factors()
        if scalar_before is not None:
            from rigidfluid.taylor_hood.stepping.scalar_transfer import conserve

            moved = {**moved, **conserve(scalar_before, fluid, old, self._scalar_equations(new), moved, new)}
        return moved, before - kinetic_energy(target, new.geometry, moved["velocity"])

    @final
    def with_bodies(
        self, fluid: FluidState, old: Mesh, new: Mesh, pose: Pose, twist: Twist, filling: Filling
    ) -> tuple[FluidState, float]:
        from rigidfluid.taylor_hood.elements.state import resting_state
        from rigidfluid.taylor_hood.stepping.momentum import with_momentum
        from rigidfluid.taylor_hood.stepping.transfer import among_other_bodies
        from rigidfluid.taylor_hood.system.discretisation import kinetic_energy

        target = self._projecting_discretisation(new)
        rest = resting_state(target.surfaces, new, new.images_of(pose), twist)
        state = among_other_bodies(fluid, old, filling, target, self.options.tolerance, rest)
        self.drop_factors()
        return with_momentum(state, target, new), kinetic_energy(target, new.geometry, state["velocity"])

    @final
    def prediction_error(self, before: FluidState, after: FluidState, mesh: Mesh, extrapolation: FloatArray) -> float:
        from rigidfluid.taylor_hood.stepping.advance import extrapolated
        from rigidfluid.taylor_hood.system.discretisation import kinetic_energy

        missed = after["velocity"] - extrapolated(before, extrapolation)
        return kinetic_energy(self._any_discretisation(mesh), mesh.geometry, missed)

    @final
    def fields(self, fluid: FluidState, mesh: Mesh) -> Fields:
        numbering = self.numbering_of(mesh)
        pressure = numbering.interpolate_to_nodes(fluid["pressure"])
        points = numbering.node_points(mesh.geometry)
        return Fields(points, numbering.cell_nodes, fluid["velocity"], pressure, fluid.get("scalar"))

    @final
    def insides(self, fluid: FluidState, mesh: Mesh, pose: Pose) -> InsideFields | None:
        if self.problem.scalar is None or not (insides := self._insides_of_bodies()):
            return None
        from rigidfluid.taylor_hood.stepping.scalar_step import INSIDE

        return insides.fields(fluid[INSIDE[0]], mesh.images_of(pose))

    @final
    def probe(self, fluid: FluidState, mesh: Mesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        samples = self._samples(mesh, points)
        velocity, pressure = samples.quadratic(fluid["velocity"]), samples.linear(fluid["pressure"])
        if mesh.periods is not None:
            drops = self._any_discretisation(mesh).surfaces.pressure_drops(fluid["pressure"])
            pressure = pressure + samples.periods @ drops
        return mesh.ranks.bcast((velocity, pressure))

    @final
    def probe_scalar(self, fluid: FluidState, mesh: Mesh, pose: Pose, points: FloatArray) -> FloatArray:
        found = self._samples(mesh, points).quadratic(fluid["scalar"])
        if not (insides := self._insides_of_bodies()):
            return found
        from rigidfluid.taylor_hood.stepping.scalar_step import INSIDE

        ways = np.zeros((0, self.problem.dimension)) if mesh.periods is None else mesh.periods.ways
        lattice = Lattice(ways, np.zeros(self.problem.dimension))
        inside = insides.sampled(fluid[INSIDE[0]], mesh.images_of(pose), points, lattice)
        return np.where(np.isnan(inside), found, inside)

    @final
    def driving(self, fluid: FluidState, mesh: Mesh) -> FloatArray:
        from rigidfluid.taylor_hood.system.driving import fluxes

        if all(condition.image is None for condition in self.problem.conditions):
            return np.zeros((0, 2))
        surfaces = self._any_discretisation(mesh).surfaces
        through = fluxes(
            surfaces, surfaces.first_faces, self.numbering_of(mesh).node_points(mesh.geometry), fluid["velocity"]
        )
        return np.stack([through, surfaces.pressure_drops(fluid["pressure"])], axis=1)

    @final
    def refinement(
        self, flow: RefinedFlow, step: Step, rate: ErrorRate | None, mesh_velocity: MeshVelocity
    ) -> Refinement:
        from rigidfluid.taylor_hood.stepping.refined_flow import InPlace, refinement

        def in_place(mesh: Mesh) -> InPlace:
            beside = type(self)(self.options, self.problem)  # the run's own factors stay as they are
            placed = on_mesh(replace(step, points=mesh.geometry), flow.mesh)
            return InPlace(beside._discretisation(mesh, step.prescribed), mesh, placed, self.options.tolerance)

        return refinement(in_place(flow.mesh), in_place(flow.finer), flow.fluid, rate, mesh_velocity)

    @final
    def carried_errors(self, errors: FloatArray, old: RefinedFlow, new: RefinedFlow) -> FloatArray:
        from rigidfluid.taylor_hood.elements.sampling import Samples
        from rigidfluid.taylor_hood.stepping.refined_flow import on_finer

        there, before = Numbering.from_mesh(new.finer), Numbering.from_mesh(old.finer)
        samples = Samples(old.finer, before, there.node_points(new.finer.geometry))
        velocity = on_finer(old.fluid["velocity"], Numbering.from_mesh(old.mesh), before)
        right = np.stack([samples.quadratic(velocity + error) for error in errors])
        return right - on_finer(new.fluid["velocity"], self.numbering_of(new.mesh), there)

    @final
    def unknowns(self, mesh: Mesh, prescribed: BoolArray) -> int:
        return self._discretisation(mesh, prescribed).unknowns

    @final
    def state_shapes(self, mesh: Mesh, pose: Pose) -> dict[str, tuple[int, ...]]:
        from rigidfluid.taylor_hood.elements.state import state_shapes

        shapes: dict[str, tuple[int, ...]] = {}
        numbering = Numbering.from_mesh(mesh)
        if self.problem.keeps_momentum:
            from rigidfluid.taylor_hood.stepping.momentum import NAMES as MOMENTA

            shapes = dict.fromkeys(MOMENTA, (self.problem.dimension,))
        if self.problem.scalar is not None:
            from rigidfluid.taylor_hood.stepping.scalar_step import INSIDE, NAMES, REMESHING

            shapes |= {**dict.fromkeys(NAMES, (numbering.nodes,)), REMESHING: ()}
            if insides := self._insides_of_bodies():
                shapes |= dict.fromkeys(INSIDE, (insides.nodes,))
        return {**state_shapes(numbering, mesh, pose), **shapes}

    @final
    def joined(self, states: Sequence[FluidState], parts: Sequence[Mesh], mesh: Mesh) -> FluidState:
        from rigidfluid.taylor_hood.elements.pieces import joined

        return joined(states, parts, mesh)

    @final
    def cut(self, fluid: FluidState, mesh: Mesh, parts: Sequence[Mesh]) -> list[FluidState]:
        from rigidfluid.taylor_hood.elements.pieces import cut

        return cut(fluid, mesh, parts)

    @final
    def forget(self) -> None:
        self.drop_factors()
        self._latest = self._latest_attempt = None
        self._latest_matrix = Latest()

    def numbering_of(self, mesh: Mesh) -> Numbering:
        """A topology is known by its array of cells."""
        if self._numbering is None or self._numbering.cells is not mesh.cells:
            self._numbering = Numbering.from_mesh(mesh)
            self._latest = None
        return self._numbering

    def _discretisation(self, mesh: Mesh, prescribed: BoolArray) -> Dimensionless:
        from rigidfluid.taylor_hood.system.dimensionless import Dimensionless

        numbering = self.numbering_of(mesh)
        if self._latest is None or not np.array_equal(self._latest[0], prescribed):
            self.drop_factors()  # of other unknowns
            self._latest = prescribed, Dimensionless(self.discretise(numbering, mesh, prescribed), mesh)
        return self._latest[1]

    def _advanced(self, fluid: FluidState, mesh: Mesh, step: Step, tolerance: float) -> Advance:
        """One step to a ``tolerance``, from where the latest attempt at it has led."""
        from rigidfluid.taylor_hood.stepping.advance import Equations, advance

        discretisation = self._discretisation(mesh, step.prescribed)
        matrix = self._matrix(discretisation, fluid, mesh, step)
        attempt = self._latest_attempt
        guess = None  # that of a longer step, which was rejected, may be far off
        if attempt is not None and attempt[0] is fluid and attempt[1] == step.time:
            guess = attempt[2]
        equations = Equations(discretisation, matrix, fluid, mesh, on_mesh(step, mesh))
        advanced = advance(equations, tolerance, guess)
        self._latest_attempt = fluid, step.time, advanced.fluid
        return advanced

    def _matrix(self, discretisation: Discretisation, fluid: FluidState, mesh: Mesh, step: Step) -> CoupledMatrix:
        """A step is asked for its solution and then for its responses: its matrix is made once."""
        from rigidfluid.taylor_hood.stepping.advance import step_matrix

        return self._latest_matrix.answer(
            (fluid, mesh, step), lambda: step_matrix(discretisation, fluid, mesh, on_mesh(step, mesh))
        )

    def _scalar_equations(self, mesh: Mesh) -> ScalarEquations:
        from rigidfluid.taylor_hood.elements.scalar_surfaces import ScalarSurfaces
        from rigidfluid.taylor_hood.linear_solver.solved_once import solved_once
        from rigidfluid.taylor_hood.stepping.scalar_step import ScalarEquations

        assert self.problem.scalar is not None
        problem, insides, numbering = self.problem.scalar, self._insides_of_bodies(), self.numbering_of(mesh)
        surfaces = ScalarSurfaces(problem, self._any_discretisation(mesh).surfaces, mesh, insides.spaces)
        return ScalarEquations(problem, self.scalar_assembly(numbering), surfaces, insides, solved_once)

    def _insides_of_bodies(self) -> Insides:
        """Elements inside the bodies that conduct, which stay the same."""
        from rigidfluid.taylor_hood.stepping.insides import Insides

        assert self.problem.scalar is not None
        if self._insides is None:
            self._insides = Insides(self.problem.scalar, self.scalar_assembly)
        return self._insides

    def _started(self, fluid: FluidState, mesh: Mesh, pose: Pose) -> FluidState:
        """The fluid's state at the start, with its momentum if that is kept, and the scalar if there is one."""
        from rigidfluid.taylor_hood.stepping.momentum import with_momentum

        fluid = with_momentum(fluid, self._any_discretisation(mesh), mesh)
        if self.problem.scalar is None:
            return fluid
        from rigidfluid.taylor_hood.stepping.scalar_step import start

        return {**fluid, **start(self._scalar_equations(mesh), mesh, pose)}

    def _with_scalar_step(self, advanced: Advance, fluid: FluidState, mesh: Mesh, step: Step) -> Advance:
        """A step with that of the scalar; one that will be solved again has none."""
        from rigidfluid.taylor_hood.stepping.scalar_step import carried, scalar_step

        if step.provisional:
            return replace(advanced, fluid={**advanced.fluid, **carried(fluid)})
        equations = self._scalar_equations(mesh)
        scalar, account = scalar_step(equations, fluid, mesh, on_mesh(step, mesh), advanced.fluid["velocity"])
        return replace(advanced, fluid={**advanced.fluid, **scalar}, scalar=account)

    def _samples(self, mesh: Mesh, points: FloatArray) -> Samples:
        """Samples at points that all processes ask for alike: those of the root, which shares the answers."""
        from rigidfluid.taylor_hood.elements.sampling import Samples

        return Samples(mesh, self.numbering_of(mesh), points if mesh.ranks.is_root else points[:0])

    def _projecting_discretisation(self, mesh: Mesh) -> Discretisation:
        return self._discretisation(mesh, np.ones(self.problem.motions, dtype=bool))

    def _steady_discretisation(self, mesh: Mesh) -> Discretisation:
        from rigidfluid.taylor_hood.system.dimensionless import Dimensionless

        prescribed = np.ones(self.problem.motions, dtype=bool)
        return Dimensionless(self.discretise_steady(self.numbering_of(mesh), mesh, prescribed), mesh)

    def _any_discretisation(self, mesh: Mesh) -> Discretisation:
        """A discretisation on this topology, whichever bodies are prescribed."""
        self.numbering_of(mesh)
        return self._projecting_discretisation(mesh) if self._latest is None else self._latest[1]


def on_mesh(step: Step, mesh: Mesh) -> Step:
    """The step with the pose of the bodies' images that are on the ``mesh``."""
    return step if mesh.periods is None else replace(step, pose=mesh.images_of(step.pose))
